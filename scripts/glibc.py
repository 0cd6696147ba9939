"""What a Linux library needs of the machine it is loaded on: other libraries, and the version of glibc.

    python3 scripts/glibc.py LIBRARY [CEILING]

Prints both; ends with exit code 1 where the version is above the ceiling, or where a library is needed that not every
Linux has. Needs `objdump`, which comes with the linker.
"""

import re
import subprocess
import sys

# Part of glibc and of the compiler's runtime, on every Linux with glibc.
EVERYWHERE = r"(libc|libm|libdl|libpthread|librt|libgcc_s|ld-linux-x86-64|ld-linux-aarch64)\.so\.\d+"


def needs(library):
    """Names of the libraries that are needed, and the highest version of glibc's symbols as a pair of numbers."""
    text = subprocess.run(["objdump", "-p", str(library)], capture_output=True, text=True, check=True).stdout
    libraries = re.findall(r"^\s+NEEDED\s+(\S+)$", text, re.MULTILINE)
    versions = re.findall(r"\bGLIBC_(\d+)\.(\d+)", text)
    return libraries, max((int(major), int(minor)) for major, minor in versions)


def check(library, ceiling=None):
    """What is wrong with it, one text each."""
    libraries, version = needs(library)
    wrong = [f"needs {name}, which not every Linux has" for name in libraries if not re.fullmatch(EVERYWHERE, name)]
    if ceiling and version > tuple(int(part) for part in ceiling.split(".")):
        wrong.append(f"needs glibc {version[0]}.{version[1]}: more than {ceiling}")
    return wrong


if __name__ == "__main__":
    names, (major, minor) = needs(sys.argv[1])
    print(f"{sys.argv[1]} needs glibc {major}.{minor} and {', '.join(names)}")
    problems = check(*sys.argv[1:3])
    print("\n".join(problems))
    sys.exit(bool(problems))
