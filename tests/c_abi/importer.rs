//! An importer in miniature: makes instances, keeps their messages, knows variables by name.

use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};
use std::ptr::{null, null_mut};
use std::sync::Mutex;

use cartilage_contact::fmi::boundary;
use cartilage_contact::fmi::description::{fmi2, fmi3};
use cartilage_contact::fmi::fmi2::*;
use cartilage_contact::fmi::fmi3::*;
use cartilage_contact::fmi::standard::Standard;
use cartilage_contact::variables::VARIABLES;

pub const OK: c_uint = 0;
pub const WARNING: c_uint = 1;
pub const DISCARD: c_uint = 2;
pub const ERROR: c_uint = 3;
pub const FATAL: c_uint = 4;

/// A depth \[m\] at which the bones of two layers of 1 mm have gone through each other.
pub const UNREACHABLE: f64 = 3e-3;

pub type Messages = Mutex<Vec<(c_uint, String, String)>>;

/// Keeps what it is told. Rust cannot define a variadic function; on this platform one with enough arguments is the same.
///
/// FMI 2's messages are formats: there are no arguments, so every `%` has to be doubled.
unsafe extern "C" fn keep(
    environment: *mut c_void,
    _instance: *const c_char,
    status: c_uint,
    category: *const c_char,
    format: *const c_char,
) {
    let format = unsafe { CStr::from_ptr(format) }.to_str().unwrap();
    assert!(!format.replace("%%", "").contains('%'), "{format} asks for arguments");
    let text = CString::new(format.replace("%%", "%")).unwrap();
    unsafe { keep_plain(environment, status, category, text.as_ptr()) }
}

/// FMI 3's messages are text.
unsafe extern "C" fn keep_plain(
    environment: *mut c_void,
    status: c_uint,
    category: *const c_char,
    message: *const c_char,
) {
    let read = |text| unsafe { CStr::from_ptr(text) }.to_str().unwrap().to_owned();
    let messages = unsafe { &*environment.cast::<Messages>() };
    messages.lock().unwrap().push((status, read(category), read(message)));
}

/// Both versions of FMI, for the tests that hold for both.
pub const BOTH: [Standard; 2] = [Standard::Fmi2, Standard::Fmi3];

/// An instance with its messages.
pub struct Fmu {
    pub handle: *mut c_void,
    pub standard: Standard,
    messages: Box<Messages>,
}

impl Fmu {
    /// By FMI 2, in every way that can be wrong.
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
        Self { handle, standard: Standard::Fmi2, messages }
    }

    /// By FMI 3, in every way that can be wrong.
    pub fn instantiate3(name: &str, token: &str, events: bool, intermediate: &[c_uint]) -> Self {
        let messages: Box<Messages> = Box::default();
        let environment: *mut c_void = std::ptr::from_ref(messages.as_ref()).cast_mut().cast();
        let (name, token) = (CString::new(name).unwrap(), CString::new(token).unwrap());
        let (name, token) = (name.as_ptr(), token.as_ptr());
        let (variables, count) = (intermediate.as_ptr(), intermediate.len());
        let events = u8::from(events);
        let log = Some(keep_plain as boundary::PlainLogger);
        let handle = unsafe {
            fmi3InstantiateCoSimulation(name, token, null(), 0, 0, events, 0, variables, count, environment, log, None)
        };
        Self { handle, standard: Standard::Fmi3, messages }
    }

    /// Calls with a handle that belongs to another; it is not freed.
    pub fn borrowed(standard: Standard, handle: *mut c_void) -> std::mem::ManuallyDrop<Self> {
        std::mem::ManuallyDrop::new(Self { handle, standard, messages: Box::default() })
    }

    pub fn fresh(standard: Standard) -> Self {
        match standard {
            Standard::Fmi2 => Self::instantiate("contact", 1, fmi2::token()),
            Standard::Fmi3 => Self::instantiate3("contact", fmi3::token(), false, &[]),
        }
    }

    pub fn in_phase(standard: Standard, phase: Phase) -> Self {
        let fmu = Self::fresh(standard);
        // Few elements: these tests are about calls, not about numbers.
        assert_eq!(fmu.set_integer("mesh.columns", 16), OK);
        assert_eq!(fmu.set_integer("mesh.rows", 2), OK);
        if phase != Phase::Instantiated {
            assert_eq!(fmu.enter_initialization(1.0), OK);
        }
        if ![Phase::Instantiated, Phase::Initialization].contains(&phase) {
            assert_eq!(fmu.exit_initialization(), OK);
        }
        if phase == Phase::StepFailed {
            assert_eq!(fmu.set_real("penetration_depth", UNREACHABLE), OK);
            assert_eq!(fmu.step(0.0, 0.1), DISCARD);
        }
        if phase == Phase::Terminated {
            assert_eq!(fmu.call(fmi2Terminate, fmi3Terminate), OK);
        }
        fmu.take_messages();
        fmu
    }

    /// A function of the handle alone, of either version.
    pub fn call(
        &self,
        of_fmi2: unsafe extern "C" fn(*mut c_void) -> c_uint,
        of_fmi3: unsafe extern "C" fn(*mut c_void) -> c_uint,
    ) -> c_uint {
        unsafe { if self.standard == Standard::Fmi2 { of_fmi2(self.handle) } else { of_fmi3(self.handle) } }
    }

    pub fn enter_initialization(&self, stop: f64) -> c_uint {
        let c = self.handle;
        match self.standard {
            Standard::Fmi2 => unsafe {
                assert_eq!(fmi2SetupExperiment(c, 0, 0.0, 0.0, 1, stop), OK);
                fmi2EnterInitializationMode(c)
            },
            Standard::Fmi3 => unsafe { fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 1, stop) },
        }
    }

    pub fn exit_initialization(&self) -> c_uint {
        self.call(fmi2ExitInitializationMode, fmi3ExitInitializationMode)
    }

    pub fn take_messages(&self) -> Vec<(c_uint, String, String)> {
        std::mem::take(&mut self.messages.lock().unwrap())
    }

    /// The one message of a refused call, besides warnings.
    pub fn message(&self) -> String {
        let messages: Vec<_> = self.take_messages().into_iter().filter(|message| message.0 > WARNING).collect();
        assert_eq!(messages.len(), 1, "{messages:?}");
        messages[0].2.clone()
    }

    pub fn set_real(&self, name: &str, value: f64) -> c_uint {
        self.set_reals(&[reference(name)], &[value])
    }

    pub fn set_reals(&self, references: &[c_uint], values: &[f64]) -> c_uint {
        let (first, n, values) = (references.as_ptr(), references.len(), values.as_ptr());
        match self.standard {
            Standard::Fmi2 => unsafe { fmi2SetReal(self.handle, first, n, values) },
            Standard::Fmi3 => unsafe { fmi3SetFloat64(self.handle, first, n, values, n) },
        }
    }

    pub fn set_integer(&self, name: &str, value: c_int) -> c_uint {
        match self.standard {
            Standard::Fmi2 => unsafe { fmi2SetInteger(self.handle, &reference(name), 1, &value) },
            Standard::Fmi3 => unsafe { fmi3SetInt32(self.handle, &reference(name), 1, &value, 1) },
        }
    }

    /// By number, from 1.
    pub fn set_choice(&self, name: &str, value: c_int) -> c_uint {
        match self.standard {
            Standard::Fmi2 => self.set_integer(name, value),
            Standard::Fmi3 => unsafe { fmi3SetInt64(self.handle, &reference(name), 1, &value.into(), 1) },
        }
    }

    pub fn get_integer(&self, name: &str) -> c_int {
        let mut value = 0;
        let status = match self.standard {
            Standard::Fmi2 => unsafe { fmi2GetInteger(self.handle, &reference(name), 1, &mut value) },
            Standard::Fmi3 => unsafe { fmi3GetInt32(self.handle, &reference(name), 1, &mut value, 1) },
        };
        assert_eq!(status, OK);
        value
    }

    pub fn get_real(&self, name: &str) -> f64 {
        let mut value = f64::NAN;
        let status = match self.standard {
            Standard::Fmi2 => unsafe { fmi2GetReal(self.handle, &reference(name), 1, &mut value) },
            Standard::Fmi3 => unsafe { fmi3GetFloat64(self.handle, &reference(name), 1, &mut value, 1) },
        };
        assert_eq!(status, OK);
        value
    }

    pub fn step(&self, from: f64, size: f64) -> c_uint {
        match self.standard {
            Standard::Fmi2 => unsafe { fmi2DoStep(self.handle, from, size, 1) },
            Standard::Fmi3 => {
                let (mut flags, mut last) = ([1_u8; 3], f64::NAN);
                let [a, b, c] = &mut flags;
                let status = unsafe { fmi3DoStep(self.handle, from, size, 1, a, b, c, &mut last) };
                assert_eq!(flags, [0; 3]);
                assert!(last.is_finite());
                status
            }
        }
    }

    pub fn directional(&self, unknown: &str, known: &str, seed: f64) -> (c_uint, f64) {
        let (unknown, known, mut value) = (reference(unknown), reference(known), f64::NAN);
        let c = self.handle;
        let status = match self.standard {
            Standard::Fmi2 => unsafe { fmi2GetDirectionalDerivative(c, &unknown, 1, &known, 1, &seed, &mut value) },
            Standard::Fmi3 => unsafe {
                fmi3GetDirectionalDerivative(c, &unknown, 1, &known, 1, &seed, 1, &mut value, 1)
            },
        };
        (status, value)
    }

    pub fn output_rate(&self, name: &str, order: c_int) -> (c_uint, f64) {
        let (output, mut value) = (reference(name), f64::NAN);
        let status = match self.standard {
            Standard::Fmi2 => unsafe { fmi2GetRealOutputDerivatives(self.handle, &output, 1, &order, &mut value) },
            Standard::Fmi3 => unsafe { fmi3GetOutputDerivatives(self.handle, &output, 1, &order, &mut value, 1) },
        };
        (status, value)
    }

    pub fn get_state(&self, state: &mut *mut c_void) -> c_uint {
        match self.standard {
            Standard::Fmi2 => unsafe { fmi2GetFMUstate(self.handle, state) },
            Standard::Fmi3 => unsafe { fmi3GetFMUState(self.handle, state) },
        }
    }

    pub fn set_state(&self, state: *mut c_void) -> c_uint {
        match self.standard {
            Standard::Fmi2 => unsafe { fmi2SetFMUstate(self.handle, state) },
            Standard::Fmi3 => unsafe { fmi3SetFMUState(self.handle, state) },
        }
    }

    pub fn free_state(&self, mut state: *mut c_void) {
        let status = match self.standard {
            Standard::Fmi2 => unsafe { fmi2FreeFMUstate(self.handle, &mut state) },
            Standard::Fmi3 => unsafe { fmi3FreeFMUState(self.handle, &mut state) },
        };
        assert_eq!(status, OK);
        assert!(state.is_null());
    }

    pub fn bytes(&self, state: *mut c_void) -> Vec<u8> {
        let (c, mut size) = (self.handle, 0);
        let read = |size: &mut usize| match self.standard {
            Standard::Fmi2 => unsafe { fmi2SerializedFMUstateSize(c, state, size) },
            Standard::Fmi3 => unsafe { fmi3SerializedFMUStateSize(c, state, size) },
        };
        assert_eq!(read(&mut size), OK);
        let mut bytes = vec![0_u8; size];
        let written = match self.standard {
            Standard::Fmi2 => unsafe { fmi2SerializeFMUstate(c, state, bytes.as_mut_ptr().cast(), size) },
            Standard::Fmi3 => unsafe { fmi3SerializeFMUState(c, state, bytes.as_mut_ptr(), size) },
        };
        assert_eq!(written, OK);
        bytes
    }

    /// The state that these bytes are of; null if they are refused.
    pub fn state_from(&self, bytes: &[u8]) -> (c_uint, *mut c_void) {
        let (c, size, mut state) = (self.handle, bytes.len(), null_mut());
        let status = match self.standard {
            Standard::Fmi2 => unsafe { fmi2DeSerializeFMUstate(c, bytes.as_ptr().cast(), size, &mut state) },
            Standard::Fmi3 => unsafe { fmi3DeserializeFMUState(c, bytes.as_ptr(), size, &mut state) },
        };
        (status, state)
    }

    pub fn read_bytes(&self, bytes: &[u8]) -> c_uint {
        let (status, state) = self.state_from(bytes);
        self.free_state(state);
        status
    }
}

impl Drop for Fmu {
    fn drop(&mut self) {
        match self.standard {
            Standard::Fmi2 => unsafe { fmi2FreeInstance(self.handle) },
            Standard::Fmi3 => unsafe { fmi3FreeInstance(self.handle) },
        }
    }
}

pub fn reference(name: &str) -> c_uint {
    VARIABLES.iter().find(|variable| variable.name == name).unwrap().reference
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Phase {
    Instantiated,
    Initialization,
    StepComplete,
    StepFailed,
    Terminated,
}
