//! The other side of the interface: an FMU of FMI 3.0 unpacked from its file, loaded, and called as other tools call it.
//!
//! Variables are found by the table rather than by parsing the description: the token says that both are of one make.
#![allow(unsafe_code)]

use std::ffi::{CStr, CString, c_char, c_uint, c_void};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::ptr::{null, null_mut};
use std::sync::Mutex;

use libloading::Library;
use zip::ZipArchive;

use crate::fmi::archive;
use crate::fmi::description;
use crate::fmi::fmi3::{fmi3Boolean, fmi3IntermediateUpdateCallback, fmi3LogMessageCallback};
use crate::variables::VARIABLES;

type Instantiate = unsafe extern "C" fn(
    *const c_char,
    *const c_char,
    *const c_char,
    fmi3Boolean,
    fmi3Boolean,
    fmi3Boolean,
    fmi3Boolean,
    *const c_uint,
    usize,
    *mut c_void,
    fmi3LogMessageCallback,
    fmi3IntermediateUpdateCallback,
) -> *mut c_void;
type Free = unsafe extern "C" fn(*mut c_void);
type Enter = unsafe extern "C" fn(*mut c_void, fmi3Boolean, f64, f64, fmi3Boolean, f64) -> c_uint;
type Exit = unsafe extern "C" fn(*mut c_void) -> c_uint;
type Set = unsafe extern "C" fn(*mut c_void, *const c_uint, usize, *const f64, usize) -> c_uint;
type Get<T> = unsafe extern "C" fn(*mut c_void, *const c_uint, usize, *mut T, usize) -> c_uint;
type Step = unsafe extern "C" fn(
    *mut c_void,
    f64,
    f64,
    fmi3Boolean,
    *mut fmi3Boolean,
    *mut fmi3Boolean,
    *mut fmi3Boolean,
    *mut f64,
) -> c_uint;

type Messages = Mutex<Vec<String>>;

/// An FMU that is being simulated.
pub struct Importer {
    handle: *mut c_void,
    messages: Box<Messages>,
    library: Option<Library>,
    folder: PathBuf,
}

unsafe extern "C" fn keep(environment: *mut c_void, _status: c_uint, _category: *const c_char, message: *const c_char) {
    // SAFETY: the environment is the box of messages, which lives longer than the instance; the text ends with NUL.
    let (messages, text) = unsafe { (&*environment.cast::<Messages>(), CStr::from_ptr(message)) };
    if let Ok(mut messages) = messages.lock() {
        messages.push(text.to_string_lossy().into_owned());
    }
}

impl Importer {
    /// Unpacks the FMU's library for this machine, loads it and makes an instance.
    ///
    /// # Errors
    /// What is missing in the file, what the loader says, or what the FMU logged.
    pub fn open(fmu: &Path) -> Result<Self, String> {
        let entry = archive::binary_of_this_machine();
        let failed = |what: &str, error: &dyn std::fmt::Display| format!("{}: {what}: {error}", fmu.display());
        let mut archive = File::open(fmu)
            .map_err(|error| failed("cannot open the FMU", &error))
            .and_then(|file| ZipArchive::new(file).map_err(|error| failed("not a ZIP archive", &error)))?;
        let mut bytes = Vec::new();
        archive
            .by_name(&entry)
            .map_err(|error| failed(&entry, &error))?
            .read_to_end(&mut bytes)
            .map_err(|error| failed(&entry, &error))?;

        let folder = std::env::temp_dir().join(format!("cartilage-contact-{}", std::process::id()));
        let path = folder.join(entry.rsplit('/').next().unwrap_or(&entry));
        std::fs::create_dir_all(&folder)
            .and_then(|()| std::fs::write(&path, bytes))
            .map_err(|error| format!("cannot unpack the FMU to {}: {error}", path.display()))?;
        // From here on dropping removes the folder.
        let mut importer = Self { handle: null_mut(), messages: Box::default(), library: None, folder };
        // SAFETY: the library runs nothing when it is loaded.
        let library = unsafe { Library::new(&path) }.map_err(|error| failed("cannot load the library", &error))?;
        importer.library = Some(library);
        importer.instantiate()?;
        Ok(importer)
    }

    fn instantiate(&mut self) -> Result<(), String> {
        let instantiate: Instantiate = self.function(c"fmi3InstantiateCoSimulation")?;
        let token = CString::new(description::fmi3::token()).map_err(|error| error.to_string())?;
        let environment = std::ptr::from_ref(self.messages.as_ref()).cast_mut().cast();
        let (name, token) = (c"contact".as_ptr(), token.as_ptr());
        // SAFETY: as the standard declares it; the strings live during the call, the messages longer than the instance.
        self.handle = unsafe { instantiate(name, token, null(), 0, 0, 0, 0, null(), 0, environment, Some(keep), None) };
        self.answer("fmi3InstantiateCoSimulation", if self.handle.is_null() { 3 } else { 0 })
    }

    /// A function of the library, of the type that the standard declares.
    fn function<F: Copy>(&self, name: &CStr) -> Result<F, String> {
        let library = self.library.as_ref().ok_or("the library is not loaded")?;
        // SAFETY: the type is the one of the standard for this name, as the types above say.
        unsafe { library.get::<F>(name.to_bytes_with_nul()) }.map(|symbol| *symbol).map_err(|error| error.to_string())
    }

    /// Turns a status into what the FMU logged about it.
    fn answer(&self, function: &str, status: c_uint) -> Result<(), String> {
        let said = self.messages.lock().map(|mut lines| std::mem::take(&mut *lines)).unwrap_or_default();
        if status <= 1 { Ok(()) } else { Err(format!("{function} returned {status}: {}", said.join("; "))) }
    }

    /// Initialises at time 0 with these inputs.
    ///
    /// # Errors
    /// What the FMU logged.
    pub fn start(&self, stop_time: f64, inputs: &[(&str, f64)]) -> Result<(), String> {
        let (enter, exit) = (c"fmi3EnterInitializationMode", c"fmi3ExitInitializationMode");
        // SAFETY: the handle is of this library.
        let status = unsafe { self.function::<Enter>(enter)?(self.handle, 0, 0.0, 0.0, 1, stop_time) };
        self.answer("fmi3EnterInitializationMode", status)?;
        self.set(inputs)?;
        // SAFETY: the handle is of this library.
        let status = unsafe { self.function::<Exit>(exit)?(self.handle) };
        self.answer("fmi3ExitInitializationMode", status)
    }

    /// Sets inputs by name.
    ///
    /// # Errors
    /// The name that there is not, or what the FMU logged.
    pub fn set(&self, inputs: &[(&str, f64)]) -> Result<(), String> {
        for (name, value) in inputs {
            let set: Set = self.function(c"fmi3SetFloat64")?;
            // SAFETY: one reference and one value; the handle is of this library.
            self.answer("fmi3SetFloat64", unsafe { set(self.handle, &reference(name)?, 1, value, 1) })?;
        }
        Ok(())
    }

    /// One communication step.
    ///
    /// # Errors
    /// What the FMU logged.
    pub fn step(&self, time: f64, step: f64) -> Result<(), String> {
        let do_step: Step = self.function(c"fmi3DoStep")?;
        let (mut event, mut end, mut early, mut last) = (0, 0, 0, 0.0);
        // SAFETY: four places to write to; the handle is of this library.
        let status = unsafe { do_step(self.handle, time, step, 1, &mut event, &mut end, &mut early, &mut last) };
        self.answer("fmi3DoStep", status)
    }

    /// Value of a real variable.
    ///
    /// # Errors
    /// The name that there is not, or what the FMU logged.
    pub fn real(&self, name: &str) -> Result<f64, String> {
        let mut value = [0.0];
        self.get(c"fmi3GetFloat64", name, &mut value)?;
        Ok(value[0])
    }

    /// Value of an integer.
    ///
    /// # Errors
    /// The name that there is not, or what the FMU logged.
    pub fn integer(&self, name: &str) -> Result<i32, String> {
        let mut value = [0i32];
        self.get(c"fmi3GetInt32", name, &mut value)?;
        Ok(value[0])
    }

    /// Value of an enumeration, whose items count from 1.
    ///
    /// # Errors
    /// The name that there is not, or what the FMU logged.
    pub fn enumeration(&self, name: &str) -> Result<i64, String> {
        let mut value = [0i64];
        self.get(c"fmi3GetInt64", name, &mut value)?;
        Ok(value[0])
    }

    /// Value of a variable that is true or false.
    ///
    /// # Errors
    /// The name that there is not, or what the FMU logged.
    pub fn boolean(&self, name: &str) -> Result<bool, String> {
        let mut value = [false];
        self.get(c"fmi3GetBoolean", name, &mut value)?;
        Ok(value[0])
    }

    fn get<T>(&self, function: &CStr, name: &str, values: &mut [T]) -> Result<(), String> {
        let get: Get<T> = self.function(function)?;
        // SAFETY: one reference, and as many values as are said; the handle is of this library.
        let status = unsafe { get(self.handle, &reference(name)?, 1, values.as_mut_ptr(), values.len()) };
        self.answer(&function.to_string_lossy(), status)
    }
}

impl Drop for Importer {
    fn drop(&mut self) {
        if let Ok(free) = self.function::<Free>(c"fmi3FreeInstance") {
            // SAFETY: the handle is null or of this library, and is not used again.
            unsafe { free(self.handle) };
        }
        // Some systems do not remove the file of a library that is loaded.
        drop(self.library.take());
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

fn reference(name: &str) -> Result<c_uint, String> {
    let row = VARIABLES.iter().find(|row| row.name == name);
    row.map(|row| row.reference).ok_or_else(|| format!("there is no variable `{name}`"))
}
