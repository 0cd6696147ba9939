//! The functions of FMI 3.0 for types that no variable of this FMU has. The standard wants all of them in the library.
//!
//! # Safety
//! As for [`fmi3`](super).
#![allow(unsafe_code, clippy::missing_safety_doc)]

use std::ffi::{c_char, c_uint, c_void};

use super::fmi3Boolean;
use crate::fmi::boundary::{array, guard};
use crate::fmi::phase::Call;

/// No variable is a Float32: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat32(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *mut f32,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetFloat32", |it| {
            it.none_of_type(Call::Get, "Float32", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a Int8: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetInt8(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *mut i8,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetInt8", |it| {
            it.none_of_type(Call::Get, "Int8", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a UInt8: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetUInt8(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *mut u8,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetUInt8", |it| {
            it.none_of_type(Call::Get, "UInt8", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a Int16: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetInt16(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *mut i16,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetInt16", |it| {
            it.none_of_type(Call::Get, "Int16", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a UInt16: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetUInt16(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *mut u16,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetUInt16", |it| {
            it.none_of_type(Call::Get, "UInt16", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a UInt32: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetUInt32(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *mut u32,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetUInt32", |it| {
            it.none_of_type(Call::Get, "UInt32", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a UInt64: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetUInt64(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *mut u64,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetUInt64", |it| {
            it.none_of_type(Call::Get, "UInt64", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a String: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetString(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *mut *const c_char,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetString", |it| {
            it.none_of_type(Call::Get, "String", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a Binary: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetBinary(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _value_sizes: *mut usize,
    _values: *mut *const u8,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetBinary", |it| {
            it.none_of_type(Call::Get, "Binary", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a Clock: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetClock(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *mut fmi3Boolean,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3GetClock", |it| {
            it.none_of_type(Call::Get, "Clock", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a Float32: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat32(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *const f32,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3SetFloat32", |it| {
            it.none_of_type(Call::Set, "Float32", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a Int8: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetInt8(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *const i8,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3SetInt8", |it| {
            it.none_of_type(Call::Set, "Int8", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a UInt8: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetUInt8(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *const u8,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3SetUInt8", |it| {
            it.none_of_type(Call::Set, "UInt8", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a Int16: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetInt16(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *const i16,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3SetInt16", |it| {
            it.none_of_type(Call::Set, "Int16", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a UInt16: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetUInt16(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *const u16,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3SetUInt16", |it| {
            it.none_of_type(Call::Set, "UInt16", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a UInt32: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetUInt32(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *const u32,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3SetUInt32", |it| {
            it.none_of_type(Call::Set, "UInt32", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a UInt64: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetUInt64(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *const u64,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3SetUInt64", |it| {
            it.none_of_type(Call::Set, "UInt64", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a String: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetString(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *const *const c_char,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3SetString", |it| {
            it.none_of_type(Call::Set, "String", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a Binary: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetBinary(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _value_sizes: *const usize,
    _values: *const *const u8,
    _value_count: usize,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3SetBinary", |it| {
            it.none_of_type(Call::Set, "Binary", array("valueReferences", references, count)?)
        })
    }
}

/// No variable is a Clock: only an empty array is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetClock(
    instance: *mut c_void,
    references: *const c_uint,
    count: usize,
    _values: *const fmi3Boolean,
) -> c_uint {
    unsafe {
        guard(instance, "fmi3SetClock", |it| {
            it.none_of_type(Call::Set, "Clock", array("valueReferences", references, count)?)
        })
    }
}
