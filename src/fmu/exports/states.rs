//! Saved states, in memory and as bytes.

use super::conforms;
use crate::fmu::calls::Call;
use crate::fmu::guard::call;
use crate::fmu::stored;
use fmi_sys::fmi2::*;

conforms! {
    fmi2GetFMUstateTYPE = fmi2GetFMUstate;
    fmi2SetFMUstateTYPE = fmi2SetFMUstate;
    fmi2FreeFMUstateTYPE = fmi2FreeFMUstate;
    fmi2SerializedFMUstateSizeTYPE = fmi2SerializedFMUstateSize;
    fmi2SerializeFMUstateTYPE = fmi2SerializeFMUstate;
    fmi2DeSerializeFMUstateTYPE = fmi2DeSerializeFMUstate;
}

/// Saves the instance's state.
///
/// # Safety
/// A live component; `state` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(
    component: fmi2Component,
    state: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::GetState, "fmi2GetFMUstate", |instance| {
            stored::get(instance, state)
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
            stored::set(instance, state)
        })
    }
}

/// Frees a saved state; nothing for null.
///
/// # Safety
/// A live component; `state` is null or can be read and written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(
    component: fmi2Component,
    state: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::GetState, "fmi2FreeFMUstate", |_| {
            stored::free(state)
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
            |instance| stored::size(instance, state, size),
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
            |instance| stored::serialize(instance, state, serialized.cast(), size),
        )
    }
}

/// Makes a state from bytes.
///
/// # Safety
/// A live component; `size` bytes; `state` can be written.
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
            |instance| stored::deserialize(instance, serialized.cast(), size, state),
        )
    }
}
