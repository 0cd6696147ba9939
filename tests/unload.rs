//! The library is loaded and unloaded again and again, as a tool does that keeps running: nothing of it stays.
#![cfg(all(target_os = "linux", target_env = "gnu"))]
#![allow(unsafe_code, clippy::unwrap_used)]

use std::ffi::{c_char, c_int, c_uint, c_void};
use std::path::{Path, PathBuf};
use std::ptr::{null, null_mut};

use cartilage_contact::fmi::description::fmi2;
use cartilage_contact::fmi::fmi2::fmi2CallbackFunctions;
use cartilage_contact::variables;
use libloading::{Library, Symbol};

/// Of the C library: what is taken from the heap.
#[repr(C)]
struct Heap {
    other: [usize; 4],
    mapped: usize,
    more: [usize; 2],
    used: usize,
    rest: [usize; 2],
}

unsafe extern "C" {
    fn mallinfo2() -> Heap;
}

/// Bytes that are taken, not given back.
fn taken() -> usize {
    let Heap { mapped, used, .. } = unsafe { mallinfo2() };
    mapped + used
}

/// Where the build for the tests puts it.
fn library() -> PathBuf {
    Path::new(env!("CARGO_BIN_EXE_cartilage-contact")).with_file_name("deps").join("libcartilage_contact.so")
}

fn is_loaded() -> bool {
    std::fs::read_to_string("/proc/self/maps").unwrap().contains("libcartilage_contact.so")
}

type OfHandle = unsafe extern "C" fn(*mut c_void) -> c_uint;

/// Loads the library, makes an instance and, if wanted, solves; then frees and unloads it.
fn visit(solve: bool) {
    unsafe {
        let library = Library::new(library()).unwrap();
        let instantiate: Symbol<
            unsafe extern "C" fn(
                *const c_char,
                c_uint,
                *const c_char,
                *const c_char,
                *const fmi2CallbackFunctions,
                c_int,
                c_int,
            ) -> *mut c_void,
        > = library.get(b"fmi2Instantiate").unwrap();
        let callbacks = fmi2CallbackFunctions {
            logger: None,
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            component_environment: null_mut(),
        };
        let token = std::ffi::CString::new(fmi2::token()).unwrap();
        let handle = instantiate(c"contact".as_ptr(), 1, token.as_ptr(), null(), &callbacks, 0, 0);
        assert!(!handle.is_null());
        if solve {
            let set: Symbol<unsafe extern "C" fn(*mut c_void, *const c_uint, usize, *const c_int) -> c_uint> =
                library.get(b"fmi2SetInteger").unwrap();
            let mesh = ["mesh.columns", "mesh.rows"].map(|name| variables::find(name).unwrap().reference);
            assert_eq!(set(handle, mesh.as_ptr(), 2, [24, 3].as_ptr()), 0);
            for function in ["fmi2EnterInitializationMode", "fmi2ExitInitializationMode", "fmi2Terminate"] {
                let call: Symbol<OfHandle> = library.get(function.as_bytes()).unwrap();
                assert_eq!(call(handle), 0, "{function}");
            }
        }
        let free: Symbol<unsafe extern "C" fn(*mut c_void)> = library.get(b"fmi2FreeInstance").unwrap();
        free(handle);
        library.close().unwrap();
    }
}

#[test]
fn nothing_stays_of_a_library_that_was_unloaded() {
    // One thread of this test alone changes the heap; what the loader keeps for itself it has after some rounds.
    (0..1000).for_each(|_| visit(false));
    assert!(!is_loaded());
    let thousand_visits = || {
        let before = taken();
        (0..1000).for_each(|_| visit(false));
        assert!(!is_loaded());
        taken().saturating_sub(before)
    };
    // Its tables grow now and then, by some kilobytes once: not with every thousand.
    let grown = [(); 3].map(|()| thousand_visits());
    println!("1000 visits leave {grown:?} bytes");
    assert!(grown.iter().min() < Some(&2048), "{grown:?} bytes");

    // A solution leaves a buffer with its thread, and with it the library, until the thread ends: no more with each visit.
    let in_thread = || std::thread::spawn(|| visit(true)).join().unwrap();
    (0..20).for_each(|_| in_thread());
    let before = taken();
    (0..40).for_each(|_| in_thread());
    let grown = taken().saturating_sub(before);
    println!("40 visits with a solution leave {grown} bytes");
    assert!(grown < 16384, "{grown} bytes");
    visit(false);
    assert!(!is_loaded(), "the next unloading takes it away");
}
