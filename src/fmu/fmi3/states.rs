//! Saved states, in memory and as bytes.

use super::exports;
use crate::fmu::stored;
use fmi_sys::fmi3::*;

exports! {
    /// Saves the instance's state.
    fmi3GetFMUState: fmi3GetFMUStateTYPE = GetState
    (state: *mut fmi3FMUState)
    |instance| stored::get(instance, state);

    /// Returns to a saved state.
    fmi3SetFMUState: fmi3SetFMUStateTYPE = SetState
    (state: fmi3FMUState)
    |instance| stored::set(instance, state);

    /// Frees a saved state; nothing for null.
    fmi3FreeFMUState: fmi3FreeFMUStateTYPE = GetState
    (state: *mut fmi3FMUState)
    |_| stored::free(state);

    /// The number of bytes that [`fmi3SerializeFMUState`] writes.
    fmi3SerializedFMUStateSize: fmi3SerializedFMUStateSizeTYPE = Serialize
    (state: fmi3FMUState, size: *mut usize)
    |instance| stored::size(instance, state, size);

    /// Writes a saved state as bytes.
    fmi3SerializeFMUState: fmi3SerializeFMUStateTYPE = Serialize
    (state: fmi3FMUState, serialized: *mut fmi3Byte, size: usize)
    |instance| stored::serialize(instance, state, serialized, size);

    /// Makes a state from bytes.
    fmi3DeserializeFMUState: fmi3DeserializeFMUStateTYPE = Serialize
    (serialized: *const fmi3Byte, size: usize, state: *mut fmi3FMUState)
    |instance| stored::deserialize(instance, serialized, size, state);
}
