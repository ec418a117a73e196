//! Saved states, in memory and as bytes.

use super::conforms;
use crate::fmu::calls::Call;
use crate::fmu::guard::{call, out, read, write};
use crate::fmu::instance::{Outcome, refuse};
use crate::fmu::saved::Saved;
use fmi_sys::fmi2::*;

conforms! {
    fmi2GetFMUstateTYPE = fmi2GetFMUstate;
    fmi2SetFMUstateTYPE = fmi2SetFMUstate;
    fmi2FreeFMUstateTYPE = fmi2FreeFMUstate;
    fmi2SerializedFMUstateSizeTYPE = fmi2SerializedFMUstateSize;
    fmi2SerializeFMUstateTYPE = fmi2SerializeFMUstate;
    fmi2DeSerializeFMUstateTYPE = fmi2DeSerializeFMUstate;
}

/// A state that C holds.
///
/// # Safety
/// `state` is null or came from [`fmi2GetFMUstate`] or [`fmi2DeSerializeFMUstate`] and has
/// not been freed.
unsafe fn saved<'a>(state: fmi2FMUstate) -> Outcome<&'a Saved> {
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
unsafe fn hand_over(state: Saved, place: *mut fmi2FMUstate) -> Outcome {
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
/// A live component; `state` points to null or to a live state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(
    component: fmi2Component,
    state: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::GetState, "fmi2GetFMUstate", |instance| {
            hand_over(instance.save(), state)
        })
    }
}

/// Returns to a saved state.
///
/// # Safety
/// A live component and a live state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(
    component: fmi2Component,
    state: fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::SetState, "fmi2SetFMUstate", |instance| {
            instance.restore(saved(state)?)
        })
    }
}

/// Frees a saved state; nothing for null.
///
/// # Safety
/// A live component; `state` is null or points to null or to a live state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(
    component: fmi2Component,
    state: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises; the box is not used after this.
    unsafe {
        call(component, Call::GetState, "fmi2FreeFMUstate", |_| {
            if let Some(state) = state.as_mut().filter(|state| !state.is_null()) {
                drop(Box::from_raw(state.cast::<Saved>()));
                *state = std::ptr::null_mut();
            }
            Ok(())
        })
    }
}

/// The number of bytes that [`fmi2SerializeFMUstate`] writes.
///
/// # Safety
/// A live component and a live state; `size` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    component: fmi2Component,
    state: fmi2FMUstate,
    size: *mut usize,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::Serialize,
            "fmi2SerializedFMUstateSize",
            |instance| {
                *out(size)? = instance.serialize(saved(state)?).len();
                Ok(())
            },
        )
    }
}

/// Writes a saved state as bytes.
///
/// # Safety
/// A live component and a live state; room for `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    component: fmi2Component,
    state: fmi2FMUstate,
    serialized: *mut fmi2Byte,
    size: usize,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::Serialize,
            "fmi2SerializeFMUstate",
            |instance| {
                let bytes = instance.serialize(saved(state)?);
                let room = write(serialized.cast::<u8>(), size)?;
                match room.get_mut(..bytes.len()) {
                    Some(room) => room.copy_from_slice(&bytes),
                    None => return refuse(format!("{} bytes are needed, not {size}", bytes.len())),
                }
                Ok(())
            },
        )
    }
}

/// Makes a state from bytes.
///
/// # Safety
/// A live component; `size` bytes; `state` points to null or to a live state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    component: fmi2Component,
    serialized: *const fmi2Byte,
    size: usize,
    state: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::Serialize,
            "fmi2DeSerializeFMUstate",
            |instance| {
                hand_over(
                    instance.deserialize(read(serialized.cast::<u8>(), size)?)?,
                    state,
                )
            },
        )
    }
}
