//! Between C and safe Rust: handles, slices, strings, the logger, panics.
//!
//! Every function of [`fmi2`](crate::fmi::fmi2) and [`fmi3`](crate::fmi::fmi3) passes through [`guard`], so that neither a null handle nor a panic gets
//! further than here.
#![allow(unsafe_code)]

use std::ffi::{CStr, CString, c_char, c_uint, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::fmi::answer::{Answer, Refusal, refuse};
use crate::fmi::instance::Instance;
use crate::fmi::log::{Category, Line, Log, Status};
use crate::fmi::standard::Standard;
use crate::fmi::state::SavedState;
use crate::memory;

/// The importer's message function in FMI 2. It is variadic as `printf` is, and `message` is its format.
pub type Logger = unsafe extern "C" fn(
    environment: *mut c_void,
    instance_name: *const c_char,
    status: c_uint,
    category: *const c_char,
    message: *const c_char,
    ...
);

/// The importer's message function in FMI 3: `message` is text, not a format.
pub type PlainLogger =
    unsafe extern "C" fn(environment: *mut c_void, status: c_uint, category: *const c_char, message: *const c_char);

/// The importer's message function, if it gave one.
#[derive(Clone)]
pub enum Listener {
    /// FMI 2's, with the name of the instance.
    Formatting(Option<Logger>, CString),
    /// FMI 3's.
    Plain(Option<PlainLogger>),
}

/// Where messages go: a copy, because FMI 2's struct lives only during fmi2Instantiate.
#[derive(Clone)]
pub struct Messenger {
    /// The importer's function.
    pub listener: Listener,
    /// Passed through to it.
    pub environment: *mut c_void,
}

impl Messenger {
    /// Hands a line to the importer.
    pub fn tell(&self, line: &Line) {
        // `#` starts a variable reference in FMI's messages; NUL would end the text.
        let mut message = line.message.replace('#', "##").replace('\0', " ");
        if matches!(self.listener, Listener::Formatting(..)) {
            // A format without arguments: importers that cannot take variable arguments, such as ctypes, show the format itself.
            message = message.replace('%', "%%");
        }
        let (Ok(category), Ok(message)) = (CString::new(line.category.name()), CString::new(message)) else { return };
        let (environment, status) = (self.environment, line.status as c_uint);
        // SAFETY: the importer vouches for its logger and environment until the instance is freed; the strings outlive
        // the call.
        unsafe {
            match &self.listener {
                Listener::Formatting(Some(logger), name) => {
                    logger(environment, name.as_ptr(), status, category.as_ptr(), message.as_ptr());
                }
                Listener::Plain(Some(logger)) => logger(environment, status, category.as_ptr(), message.as_ptr()),
                Listener::Formatting(None, _) | Listener::Plain(None) => {}
            }
        }
    }
}

/// What a handle points to.
pub struct Component {
    instance: Instance,
    messenger: Messenger,
    poisoned: bool,
}

/// Makes a handle, which [`release`] ends; or null, and tells why `function` refuses.
pub fn create(
    standard: Standard,
    function: &str,
    may: impl FnOnce() -> Answer<()>,
    log: Log,
    messenger: Messenger,
    resources: Option<String>,
) -> *mut c_void {
    match catch_unwind(AssertUnwindSafe(|| memory::reserve_little().map_err(Refusal::from).and_then(|()| may()))) {
        Ok(Ok(())) => {
            let instance = Instance::new(standard, log).with_resources(resources);
            Box::into_raw(Box::new(Component { instance, messenger, poisoned: false })).cast()
        }
        Ok(Err(refusal)) => {
            let message = format!("{function}: {}", refusal.message);
            messenger.tell(&Line { status: Status::Error, category: Category::Error, message });
            std::ptr::null_mut()
        }
        Err(_) => std::ptr::null_mut(),
    }
}

/// Ends a handle. Null is ignored.
///
/// # Safety
/// The handle is from [`create`], and nobody uses it any more.
pub unsafe fn release(handle: *mut c_void) {
    if !handle.is_null() {
        // SAFETY: as the caller vouches.
        let component = unsafe { Box::from_raw(handle.cast::<Component>()) };
        // A panic in a destructor has nobody left to be told.
        let _ = catch_unwind(AssertUnwindSafe(|| drop(component)));
    }
}

/// Runs the body of an FMI function and turns its outcome into a status; tells the importer why it was not OK.
///
/// A panic poisons the instance: from then on it answers `Fatal` to everything.
///
/// # Safety
/// The handle is null or from [`create`], and no other call with it is under way.
pub unsafe fn guard(handle: *mut c_void, function: &str, body: impl FnOnce(&mut Instance) -> Answer<()>) -> c_uint {
    if handle.is_null() {
        return Status::Error as c_uint;
    }
    let (status, lines, messenger) = {
        // SAFETY: as the caller vouches.
        let component = unsafe { &mut *handle.cast::<Component>() };
        if component.poisoned {
            return Status::Fatal as c_uint;
        }
        let instance = &mut component.instance;
        let status = match catch_unwind(AssertUnwindSafe(|| body(instance))) {
            Ok(Ok(())) => Status::Ok,
            Ok(Err(refusal)) => {
                let category = if refusal.status == Status::Discard { Category::Discard } else { Category::Error };
                instance.log.add(refusal.status, category, format!("{function}: {}", refusal.message));
                refusal.status
            }
            Err(panic) => {
                component.poisoned = true;
                let what = panic
                    .downcast_ref::<&str>()
                    .map(ToString::to_string)
                    .or_else(|| panic.downcast_ref::<String>().cloned())
                    .unwrap_or_default();
                let message = format!("{function}: a fault in the FMU, please report it: {what}");
                instance.log.add(Status::Fatal, Category::Fatal, message);
                Status::Fatal
            }
        };
        (status, instance.log.take(), component.messenger.clone())
    };
    // The component is not borrowed while the importer's code runs.
    lines.iter().for_each(|line| messenger.tell(line));
    status as c_uint
}

/// An array from C. An empty one may come as a null pointer.
///
/// # Safety
/// Where `length` is not 0, `first` is null or points to that many values that nobody changes meanwhile.
pub unsafe fn array<'a, T>(name: &str, first: *const T, length: usize) -> Answer<&'a [T]> {
    if length == 0 {
        return Ok(&[]);
    }
    usable(name, first, length)?;
    // SAFETY: checked for null, alignment and size; the rest as the caller vouches.
    Ok(unsafe { std::slice::from_raw_parts(first, length) })
}

/// An array from C to write to.
///
/// # Safety
/// As for [`array()`], and nobody reads it meanwhile.
pub unsafe fn array_mut<'a, T>(name: &str, first: *mut T, length: usize) -> Answer<&'a mut [T]> {
    if length == 0 {
        return Ok(&mut []);
    }
    usable(name, first, length)?;
    // SAFETY: checked for null, alignment and size; the rest as the caller vouches.
    Ok(unsafe { std::slice::from_raw_parts_mut(first, length) })
}

/// One value in C's memory to write to.
///
/// # Safety
/// `place` is null or points to a value that nobody else uses meanwhile.
pub unsafe fn place<'a, T>(name: &str, place: *mut T) -> Answer<&'a mut T> {
    usable(name, place, 1)?;
    // SAFETY: checked for null and alignment; the rest as the caller vouches.
    Ok(unsafe { &mut *place })
}

fn usable<T>(name: &str, first: *const T, length: usize) -> Answer<()> {
    if first.is_null() {
        return refuse(format!("{name} is a null pointer, but {length} values are asked for"));
    }
    if !first.is_aligned() || length > isize::MAX as usize / size_of::<T>().max(1) {
        return refuse(format!("{name} does not point to {length} values"));
    }
    Ok(())
}

/// A string from C; `None` for null. What is not UTF-8 is replaced.
///
/// # Safety
/// `text` is null or ends with NUL.
pub unsafe fn string(text: *const c_char) -> Option<String> {
    // SAFETY: as the caller vouches.
    (!text.is_null()).then(|| unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned())
}

/// Hands out a state; in the memory of `*place` where that is not null.
///
/// # Safety
/// `state` is null or points to null or to a state of this FMU.
pub unsafe fn hand_out(saved: SavedState, state: *mut *mut c_void) -> Answer<()> {
    // SAFETY: as the caller vouches.
    let state = unsafe { place("FMUState", state)? };
    if state.is_null() {
        *state = Box::into_raw(Box::new(saved)).cast();
    } else {
        // SAFETY: as the caller vouches.
        unsafe { *state.cast::<SavedState>() = saved };
    }
    Ok(())
}

/// A state that was handed out.
///
/// # Safety
/// `state` is null or a state of this FMU.
pub unsafe fn handed_out<'a>(state: *mut c_void) -> Answer<&'a SavedState> {
    // SAFETY: as the caller vouches.
    unsafe { place("FMUState", state.cast::<SavedState>()).map(|saved| &*saved) }
}

/// Frees a state and sets it to null. Null is ignored.
///
/// # Safety
/// As for [`hand_out`].
pub unsafe fn take_back(state: *mut *mut c_void) -> Answer<()> {
    // SAFETY: as the caller vouches.
    unsafe {
        if !state.is_null() && !(*state).is_null() {
            drop(Box::from_raw((*state).cast::<SavedState>()));
            *state = std::ptr::null_mut();
        }
    }
    Ok(())
}

/// Writes a state as bytes into an array of just that size.
///
/// # Safety
/// As for [`handed_out`] and [`array_mut`].
pub unsafe fn write_state(state: *mut c_void, bytes: *mut u8, size: usize) -> Answer<()> {
    // SAFETY: as the caller vouches.
    let written = unsafe { handed_out(state)?.to_bytes()? };
    if size != written.len() {
        return refuse(format!("size = {size} is not allowed: this state has {} bytes", written.len()));
    }
    // SAFETY: as the caller vouches.
    unsafe { array_mut("serializedState", bytes, size)?.copy_from_slice(&written) };
    Ok(())
}

/// Switches log categories.
///
/// # Safety
/// `categories` is null or points to that many strings.
pub unsafe fn set_debug_logging(
    it: &mut Instance,
    on: bool,
    count: usize,
    categories: *const *const c_char,
) -> Answer<()> {
    // SAFETY: as the caller vouches.
    let names = unsafe { array("categories", categories, count)? };
    // SAFETY: as the caller vouches.
    let names: Vec<String> = names.iter().map(|name| unsafe { string(*name) }.unwrap_or_default()).collect();
    it.log.switch(on, &names).or_else(refuse)
}
