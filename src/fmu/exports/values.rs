//! Reading and writing variables.

use super::conforms;
use crate::fmu::calls::Call;
use crate::fmu::guard::{call, read, write};
use crate::fmu::values::none_of;
use fmi_sys::fmi2::*;

conforms! {
    fmi2GetRealTYPE = fmi2GetReal;
    fmi2GetIntegerTYPE = fmi2GetInteger;
    fmi2GetBooleanTYPE = fmi2GetBoolean;
    fmi2GetStringTYPE = fmi2GetString;
    fmi2SetRealTYPE = fmi2SetReal;
    fmi2SetIntegerTYPE = fmi2SetInteger;
    fmi2SetBooleanTYPE = fmi2SetBoolean;
    fmi2SetStringTYPE = fmi2SetString;
}

/// Reads variables of type Real.
///
/// # Safety
/// A live component; arrays of the given length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    values: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::Get, "fmi2GetReal", |instance| {
            instance.get_reals(read(references, count)?, write(values, count)?)
        })
    }
}

/// Sets variables of type Real.
///
/// # Safety
/// A live component; arrays of the given length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    values: *const fmi2Real,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::Set, "fmi2SetReal", |instance| {
            instance.set_reals(read(references, count)?, read(values, count)?)
        })
    }
}

/// Reads variables of type Integer or of an enumeration.
///
/// # Safety
/// A live component; arrays of the given length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    values: *mut fmi2Integer,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::Get, "fmi2GetInteger", |instance| {
            instance.get_enumerations(read(references, count)?, write(values, count)?)
        })
    }
}

/// Sets variables of type Integer or of an enumeration.
///
/// # Safety
/// A live component; arrays of the given length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    values: *const fmi2Integer,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::Set, "fmi2SetInteger", |instance| {
            instance.set_enumerations(read(references, count)?, read(values, count)?)
        })
    }
}

/// Reads variables of type Boolean.
///
/// # Safety
/// A live component; arrays of the given length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBoolean(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    values: *mut fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::Get, "fmi2GetBoolean", |instance| {
            instance.get_booleans(read(references, count)?, write(values, count)?)
        })
    }
}

/// Sets variables of type Boolean.
///
/// # Safety
/// A live component; arrays of the given length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetBoolean(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    values: *const fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::Set, "fmi2SetBoolean", |instance| {
            let values = read(values, count)?;
            instance.set_booleans(read(references, count)?, values, |value| value != 0)
        })
    }
}

/// There are no variables of type String; reading none of them succeeds.
///
/// # Safety
/// A live component; arrays of the given length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetString(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    _values: *mut fmi2String,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::Get, "fmi2GetString", |_| {
            none_of("String", read(references, count)?)
        })
    }
}

/// There are no variables of type String; setting none of them succeeds.
///
/// # Safety
/// A live component; arrays of the given length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetString(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    _values: *const fmi2String,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::Set, "fmi2SetString", |_| {
            none_of("String", read(references, count)?)
        })
    }
}
