//! Saved states that C holds: what the functions of both versions of the standard do with them.

use super::guard::{out, read, write};
use super::instance::{Instance, Outcome, refuse};
use super::saved::Saved;
use std::ffi::c_void;

/// A state that C holds.
///
/// # Safety
/// `state` is null or came from [`get`] or [`deserialize`] and has not been freed.
unsafe fn saved<'a>(state: *mut c_void) -> Outcome<&'a Saved> {
    // SAFETY: the caller's promise.
    match unsafe { state.cast::<Saved>().as_ref() } {
        Some(saved) => Ok(saved),
        None => refuse("the state is a null pointer"),
    }
}

/// Hands a state to C, in place of the one that it may hold there.
///
/// # Safety
/// `place` points to null or to a live state.
unsafe fn hand_over(state: Saved, place: *mut *mut c_void) -> Outcome {
    // SAFETY: the caller's promise.
    let place = unsafe { out(place) }?;
    if place.is_null() {
        *place = Box::into_raw(Box::new(state)).cast();
    } else {
        // SAFETY: not null, so by the caller's promise a live state.
        unsafe { *place.cast::<Saved>() = state };
    }
    Ok(())
}

/// Saves the instance's state.
///
/// # Safety
/// `place` is null or points to null or to a live state.
pub(super) unsafe fn get(instance: &Instance, place: *mut *mut c_void) -> Outcome {
    // SAFETY: the caller's promise.
    unsafe { hand_over(instance.save(), place) }
}

/// Returns to a saved state.
///
/// # Safety
/// `state` is null or a live state.
pub(super) unsafe fn set(instance: &mut Instance, state: *mut c_void) -> Outcome {
    // SAFETY: the caller's promise.
    instance.restore(unsafe { saved(state) }?)
}

/// Frees a saved state; nothing for null.
///
/// # Safety
/// `place` is null or points to null or to a live state, which is none after this.
pub(super) unsafe fn free(place: *mut *mut c_void) -> Outcome {
    // SAFETY: the caller's promise; the box is not used after this.
    unsafe {
        if let Some(state) = place.as_mut().filter(|state| !state.is_null()) {
            drop(Box::from_raw(state.cast::<Saved>()));
            *state = std::ptr::null_mut();
        }
    }
    Ok(())
}

/// The number of bytes that [`serialize`] writes.
///
/// # Safety
/// `state` is null or a live state; `size` is null or can be written.
pub(super) unsafe fn size(instance: &Instance, state: *mut c_void, size: *mut usize) -> Outcome {
    // SAFETY: the caller's promise.
    unsafe { *out(size)? = instance.serialize(saved(state)?).len() };
    Ok(())
}

/// Writes a saved state as bytes.
///
/// # Safety
/// `state` is null or a live state; `bytes` is null or has room for `size`.
pub(super) unsafe fn serialize(
    instance: &Instance,
    state: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> Outcome {
    // SAFETY: the caller's promise.
    let (saved, room) = unsafe { (saved(state)?, write(bytes, size)?) };
    let serialized = instance.serialize(saved);
    match room.get_mut(..serialized.len()) {
        Some(room) => room.copy_from_slice(&serialized),
        None => {
            let needed = serialized.len();
            return refuse(format!("{needed} bytes are needed, not {size}"));
        }
    }
    Ok(())
}

/// Makes a state from bytes.
///
/// # Safety
/// `bytes` is null or holds `size`; `place` is null or points to null or to a live state.
pub(super) unsafe fn deserialize(
    instance: &Instance,
    bytes: *const u8,
    size: usize,
    place: *mut *mut c_void,
) -> Outcome {
    // SAFETY: the caller's promise.
    unsafe { hand_over(instance.deserialize(read(bytes, size)?)?, place) }
}
