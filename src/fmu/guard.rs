//! The way into an instance from C: every function of the interface goes through here.

use super::calls::{Call, Mode};
use super::instance::{Failure, Instance, Outcome, refuse};
use fmi_sys::fmi2::{
    fmi2Component, fmi2Status, fmi2Status_fmi2Discard, fmi2Status_fmi2Error, fmi2Status_fmi2Fatal,
    fmi2Status_fmi2OK,
};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What a component handle points to.
pub(super) struct Handle {
    /// Tells a handle from memory that is something else.
    magic: u64,
    instance: Instance,
}

const MAGIC: u64 = u64::from_le_bytes(*b"ugv-fmu2");

/// Hands an instance to C.
pub(super) fn into_component(instance: Instance) -> fmi2Component {
    let magic = MAGIC;
    Box::into_raw(Box::new(Handle { magic, instance })).cast()
}

/// Takes an instance back from C and drops it.
///
/// # Safety
/// `component` is null or came from [`into_component`] and has not been freed.
pub(super) unsafe fn free(component: fmi2Component) {
    // SAFETY: by the caller's promise the pointer is null or a live handle.
    let Some(handle) = (unsafe { component.cast::<Handle>().as_mut() }) else {
        return;
    };
    if handle.magic != MAGIC {
        return;
    }
    handle.magic = 0;
    // Dropping cannot be expected to panic; if it does, leaking is what is left.
    let _ = catch_unwind(|| {
        // SAFETY: the handle was made by Box::into_raw and is not used after this.
        drop(unsafe { Box::from_raw(component.cast::<Handle>()) });
    });
}

/// Calls into an instance: checks the handle and the order of calls, reports failures to
/// the importer's logger, and contains panics, after which the instance is poisoned.
///
/// # Safety
/// `component` is null or a handle from [`into_component`] that has not been freed, and no
/// other call with it is under way.
pub(super) unsafe fn call(
    component: fmi2Component,
    call: Call,
    function: &'static str,
    body: impl FnOnce(&mut Instance) -> Outcome,
) -> fmi2Status {
    // SAFETY: by the caller's promise the pointer is null or a live handle.
    let handle = match unsafe { component.cast::<Handle>().as_mut() } {
        Some(handle) if handle.magic == MAGIC => handle,
        _ => return fmi2Status_fmi2Error,
    };
    let instance = &mut handle.instance;
    if let Err(message) = call.check(function, instance.core.mode) {
        instance.logger.error(&message);
        return fmi2Status_fmi2Error;
    }
    match catch_unwind(AssertUnwindSafe(|| body(instance))) {
        Ok(Ok(())) => fmi2Status_fmi2OK,
        Ok(Err(Failure::Refused(message))) => {
            instance.logger.error(&format!("{function}: {message}"));
            fmi2Status_fmi2Error
        }
        Ok(Err(Failure::Broken(message))) => {
            instance.core.mode = Mode::Error;
            instance.logger.error(&format!("{function}: {message}"));
            fmi2Status_fmi2Error
        }
        Ok(Err(Failure::Unavailable(message))) => {
            instance.logger.warning(&format!("{function}: {message}"));
            fmi2Status_fmi2Discard
        }
        Err(panic) => {
            instance.core.mode = Mode::Poisoned;
            let message = panic_message(panic.as_ref());
            instance.logger.fatal(&format!(
                "{function} failed internally ({message}); this instance can only be freed"
            ));
            fmi2Status_fmi2Fatal
        }
    }
}

/// What a panic says.
pub(super) fn panic_message(panic: &(dyn std::any::Any + Send)) -> &str {
    panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no message")
}

/// An array that C hands over to be read.
///
/// # Safety
/// `pointer` is null or points to `count` values that live as long as the result is used.
pub(super) unsafe fn read<'a, T>(pointer: *const T, count: usize) -> Outcome<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() || !pointer.is_aligned() {
        return refuse("an array is a null pointer");
    }
    // SAFETY: not null and aligned; the caller promises the rest.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// An array that C hands over to be filled.
///
/// # Safety
/// `pointer` is null or points to `count` values that nobody else uses while the result is.
pub(super) unsafe fn write<'a, T>(pointer: *mut T, count: usize) -> Outcome<&'a mut [T]> {
    if count == 0 {
        return Ok(&mut []);
    }
    if pointer.is_null() || !pointer.is_aligned() {
        return refuse("an array is a null pointer");
    }
    // SAFETY: not null and aligned; the caller promises the rest.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}

/// A single value that C hands over to be filled.
///
/// # Safety
/// As [`write()`] with a count of 1.
pub(super) unsafe fn out<'a, T>(pointer: *mut T) -> Outcome<&'a mut T> {
    // SAFETY: the caller's promise is the one that `write` needs.
    match unsafe { write(pointer, 1) }? {
        [value] => Ok(value),
        _ => refuse("a result has nowhere to go"),
    }
}
