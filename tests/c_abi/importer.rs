//! An importer in miniature: makes instances, keeps their messages, knows variables by name.

use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};
use std::ptr::{null, null_mut};
use std::sync::Mutex;

use cartilage_contact::fmi::boundary;
use cartilage_contact::fmi::description::token;
use cartilage_contact::fmi::fmi2::*;
use cartilage_contact::variables::VARIABLES;

pub const OK: c_uint = 0;
pub const DISCARD: c_uint = 2;
pub const ERROR: c_uint = 3;
pub const FATAL: c_uint = 4;

/// A depth [m] at which the bones of two layers of 1 mm have gone through each other.
pub const UNREACHABLE: f64 = 3e-3;

pub type Messages = Mutex<Vec<(c_uint, String, String)>>;

/// Keeps what it is told. Rust cannot define a variadic function; on this platform one with enough arguments is the same.
unsafe extern "C" fn keep(
    environment: *mut c_void,
    _instance: *const c_char,
    status: c_uint,
    category: *const c_char,
    format: *const c_char,
    text: *const c_char,
) {
    let read = |text| unsafe { CStr::from_ptr(text) }.to_str().unwrap().to_owned();
    assert_eq!(read(format), "%s", "a message must not be used as a format");
    let messages = unsafe { &*environment.cast::<Messages>() };
    messages.lock().unwrap().push((status, read(category), read(text)));
}

/// An instance with its messages.
pub struct Fmu {
    pub handle: *mut c_void,
    messages: Box<Messages>,
}

impl Fmu {
    pub fn instantiate(name: &str, kind: c_uint, guid: &str) -> Self {
        let messages: Box<Messages> = Box::default();
        let callbacks = fmi2CallbackFunctions {
            logger: Some(unsafe { std::mem::transmute::<*const (), boundary::Logger>(keep as *const ()) }),
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            component_environment: std::ptr::from_ref(messages.as_ref()).cast_mut().cast(),
        };
        let (name, guid) = (CString::new(name).unwrap(), CString::new(guid).unwrap());
        let handle = unsafe { fmi2Instantiate(name.as_ptr(), kind, guid.as_ptr(), null(), &callbacks, 0, 0) };
        Self { handle, messages }
    }

    pub fn in_phase(phase: Phase) -> Self {
        let fmu = Self::instantiate("contact", 1, token());
        let c = fmu.handle;
        unsafe {
            // Few elements: these tests are about calls, not about numbers.
            assert_eq!(fmu.set_integer("mesh.columns", 16), OK);
            assert_eq!(fmu.set_integer("mesh.rows", 2), OK);
            if phase != Phase::Instantiated {
                assert_eq!(fmi2SetupExperiment(c, 0, 0.0, 0.0, 1, 1.0), OK);
                assert_eq!(fmi2EnterInitializationMode(c), OK);
            }
            if ![Phase::Instantiated, Phase::Initialization].contains(&phase) {
                assert_eq!(fmi2ExitInitializationMode(c), OK);
            }
            if phase == Phase::StepFailed {
                assert_eq!(fmu.set_real("penetration_depth", UNREACHABLE), OK);
                assert_eq!(fmu.step(0.0, 0.1), DISCARD);
            }
            if phase == Phase::Terminated {
                assert_eq!(fmi2Terminate(c), OK);
            }
        }
        fmu.take_messages();
        fmu
    }

    pub fn take_messages(&self) -> Vec<(c_uint, String, String)> {
        std::mem::take(&mut self.messages.lock().unwrap())
    }

    /// The one message of a refused call.
    pub fn message(&self) -> String {
        let messages = self.take_messages();
        assert_eq!(messages.len(), 1, "{messages:?}");
        messages[0].2.clone()
    }

    pub fn set_real(&self, name: &str, value: f64) -> c_uint {
        unsafe { fmi2SetReal(self.handle, &reference(name), 1, &value) }
    }

    pub fn set_integer(&self, name: &str, value: c_int) -> c_uint {
        unsafe { fmi2SetInteger(self.handle, &reference(name), 1, &value) }
    }

    pub fn get_real(&self, name: &str) -> f64 {
        let mut value = f64::NAN;
        assert_eq!(unsafe { fmi2GetReal(self.handle, &reference(name), 1, &mut value) }, OK);
        value
    }

    pub fn step(&self, from: f64, size: f64) -> c_uint {
        unsafe { fmi2DoStep(self.handle, from, size, 1) }
    }
}

impl Drop for Fmu {
    fn drop(&mut self) {
        unsafe { fmi2FreeInstance(self.handle) }
    }
}

pub fn reference(name: &str) -> c_uint {
    VARIABLES.iter().position(|variable| variable.name == name).unwrap() as c_uint
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Phase {
    Instantiated,
    Initialization,
    StepComplete,
    StepFailed,
    Terminated,
}

pub fn with_state(c: *mut c_void, use_it: fn(*mut c_void, *mut c_void) -> c_uint) -> c_uint {
    let mut state = null_mut();
    unsafe {
        let got = fmi2GetFMUstate(c, &mut state);
        if got != OK {
            return got;
        }
        let status = use_it(c, state);
        assert_eq!(fmi2FreeFMUstate(c, &mut state), OK);
        assert!(state.is_null());
        status
    }
}

pub fn bytes(c: *mut c_void, state: *mut c_void) -> Vec<u8> {
    let mut size = 0;
    unsafe {
        assert_eq!(fmi2SerializedFMUstateSize(c, state, &mut size), OK);
        let mut bytes = vec![0_u8; size];
        assert_eq!(fmi2SerializeFMUstate(c, state, bytes.as_mut_ptr().cast(), size), OK);
        bytes
    }
}

pub fn from_bytes(c: *mut c_void, bytes: &[u8]) -> c_uint {
    let mut state = null_mut();
    unsafe {
        let status = fmi2DeSerializeFMUstate(c, bytes.as_ptr().cast(), bytes.len(), &mut state);
        assert_eq!(fmi2FreeFMUstate(c, &mut state), OK);
        status
    }
}
