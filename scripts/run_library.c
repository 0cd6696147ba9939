/* Loads the FMU's library and solves one state with it: run_library LIBRARY TOKEN REFERENCE. REFERENCE is that of `load`;
   exit code 1 where something fails. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#ifdef _WIN32
#include <windows.h>
#define OPEN(path) LoadLibraryA(path)
#define FIND(name) GetProcAddress((HMODULE)library, name)
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW)
#define FIND(name) dlsym(library, name)
#endif

typedef void *component;
typedef struct {
    void (*logger)(component, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(component, int);
    component environment;
} callbacks;

static void logger(component environment, const char *name, int status, const char *category, const char *message, ...)
{
    (void)environment, (void)name, (void)category;
    va_list arguments;
    va_start(arguments, message);
    fprintf(stderr, "status %d: ", status);
    vfprintf(stderr, message, arguments);
    fputc('\n', stderr);
    va_end(arguments);
}

#define FUNCTION(result, name, ...) result (*name)(__VA_ARGS__) = (result (*)(__VA_ARGS__))(void *)FIND(#name)
#define CHECK(call)                                   \
    if ((call) != 0) {                                \
        fprintf(stderr, "%s did not succeed\n", #call); \
        return 1;                                     \
    }

int main(int count, char **arguments)
{
    if (count != 4) {
        fprintf(stderr, "needs a library, its token, and the value reference of its load\n");
        return 1;
    }
    void *library = (void *)OPEN(arguments[1]);
    if (!library) {
        fprintf(stderr, "%s cannot be loaded\n", arguments[1]);
        return 1;
    }
    FUNCTION(component, fmi2Instantiate, const char *, int, const char *, const char *, const callbacks *, int, int);
    FUNCTION(int, fmi2SetupExperiment, component, int, double, double, int, double);
    FUNCTION(int, fmi2EnterInitializationMode, component);
    FUNCTION(int, fmi2ExitInitializationMode, component);
    FUNCTION(int, fmi2DoStep, component, double, double, int);
    FUNCTION(int, fmi2GetReal, component, const unsigned *, size_t, double *);
    FUNCTION(void, fmi2FreeInstance, component);

    callbacks known = {logger, NULL, NULL, NULL, NULL};
    component contact = fmi2Instantiate("contact", 1, arguments[2], NULL, &known, 0, 0);
    if (!contact) return 1;
    unsigned reference = (unsigned)atoi(arguments[3]);
    double load = NAN;
    CHECK(fmi2SetupExperiment(contact, 0, 0, 0, 0, 0))
    CHECK(fmi2EnterInitializationMode(contact))
    CHECK(fmi2ExitInitializationMode(contact))
    CHECK(fmi2DoStep(contact, 0, 0.1, 1))
    CHECK(fmi2GetReal(contact, &reference, 1, &load))
    fmi2FreeInstance(contact);
    printf("load at the start values: %.9e N/m\n", load);
    return !(load > 0 && isfinite(load));
}
