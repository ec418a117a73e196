//! Saved states that C holds: what the functions of both versions of the standard do with them.

use super::guard::{out, read, write};
use super::instance::{Instance, Outcome, refuse};
use super::saved::Saved;
use std::collections::BTreeSet;
use std::ffi::c_void;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Addresses of the states that C holds. The standard does not say what is in the place for a new
/// state, so that an address is a state's only if it is among these.
static LIVE: Mutex<BTreeSet<usize>> = Mutex::new(BTreeSet::new());

fn live() -> MutexGuard<'static, BTreeSet<usize>> {
    // A panic elsewhere leaves the set whole.
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A state that C holds.
///
/// # Safety
/// Nobody frees or replaces the state while the result is used.
unsafe fn saved<'a>(state: *mut c_void) -> Outcome<&'a Saved> {
    if state.is_null() {
        return refuse("the state is a null pointer");
    }
    if !live().contains(&state.addr()) {
        return refuse("the state is none, or has been freed");
    }
    // SAFETY: its address is that of a live state; the caller promises the rest.
    Ok(unsafe { &*state.cast::<Saved>() })
}

/// Hands a state to C, in place of the one that it may hold there.
///
/// # Safety
/// `place` is null or can be written; nobody else uses a state that is there.
unsafe fn hand_over(state: Saved, place: *mut *mut c_void) -> Outcome {
    // SAFETY: the caller's promise.
    let place = unsafe { out(place) }?;
    let mut live = live();
    if live.contains(&place.addr()) {
        // SAFETY: its address is that of a live state; the caller promises the rest.
        unsafe { *place.cast::<Saved>() = state };
    } else {
        *place = Box::into_raw(Box::new(state)).cast();
        live.insert(place.addr());
    }
    Ok(())
}

/// Saves the instance's state.
///
/// # Safety
/// `place` is null or can be written; nobody else uses a state that is there.
pub(super) unsafe fn get(instance: &Instance, place: *mut *mut c_void) -> Outcome {
    // SAFETY: the caller's promise.
    unsafe { hand_over(instance.save(), place) }
}

/// Returns to a saved state.
///
/// # Safety
/// Nobody frees or replaces the state meanwhile.
pub(super) unsafe fn set(instance: &mut Instance, state: *mut c_void) -> Outcome {
    // SAFETY: the caller's promise.
    instance.restore(unsafe { saved(state) }?)
}

/// Frees a saved state; nothing for null.
///
/// # Safety
/// `place` is null or can be read and written; nobody else uses the state that is there.
pub(super) unsafe fn free(place: *mut *mut c_void) -> Outcome {
    if place.is_null() {
        return Ok(());
    }
    // SAFETY: the caller's promise.
    let place = unsafe { out(place) }?;
    let state = std::mem::replace(place, std::ptr::null_mut());
    if state.is_null() {
        return Ok(());
    }
    if !live().remove(&state.addr()) {
        *place = state;
        return refuse("the state is none, or has been freed");
    }
    // SAFETY: its address was that of a live state, and is none from here on: the box was made by
    // `hand_over` and is not used after this.
    drop(unsafe { Box::from_raw(state.cast::<Saved>()) });
    Ok(())
}

/// The number of bytes that [`serialize`] writes.
///
/// # Safety
/// Nobody frees or replaces the state meanwhile; `size` is null or can be written.
pub(super) unsafe fn size(instance: &Instance, state: *mut c_void, size: *mut usize) -> Outcome {
    // SAFETY: the caller's promise.
    unsafe { *out(size)? = instance.serialize(saved(state)?).len() };
    Ok(())
}

/// Writes a saved state as bytes.
///
/// # Safety
/// Nobody frees or replaces the state meanwhile; `bytes` is null or has room for `size`.
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
/// `bytes` is null or holds `size`; `place` is null or can be written, and nobody else uses a state
/// that is there.
pub(super) unsafe fn deserialize(
    instance: &Instance,
    bytes: *const u8,
    size: usize,
    place: *mut *mut c_void,
) -> Outcome {
    // SAFETY: the caller's promise.
    unsafe { hand_over(instance.deserialize(read(bytes, size)?)?, place) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmu::instance::Interface;
    use crate::fmu::test_instance::running;
    use std::ptr::{null_mut, without_provenance_mut};

    /// What a debugger fills memory with that nobody has written yet.
    fn garbage() -> *mut c_void {
        without_provenance_mut(usize::from_ne_bytes([0xaa; size_of::<usize>()]))
    }

    fn instance() -> Instance {
        running(Interface::CoSimulation, "{}")
    }

    /// Keeps other tests from saving a state where one has just been freed.
    fn alone() -> MutexGuard<'static, ()> {
        static ALONE: Mutex<()> = Mutex::new(());
        ALONE.lock().unwrap_or_else(PoisonError::into_inner)
    }

    #[test]
    fn what_is_in_the_place_for_a_state_is_believed_only_if_it_is_one() {
        let _alone = alone();
        let instance = instance();
        let bytes = instance.serialize(&instance.save());
        let (mut first, mut second) = (garbage(), garbage());
        // SAFETY: places that can be written, and bytes that are there.
        unsafe {
            get(&instance, &raw mut first).unwrap();
            deserialize(&instance, bytes.as_ptr(), bytes.len(), &raw mut second).unwrap();
            assert!(first != garbage() && second != garbage() && first != second);
            let address = first;
            get(&instance, &raw mut first).unwrap();
            assert_eq!(first, address, "a live state is replaced where it is");
            free(&raw mut first).unwrap();
            free(&raw mut second).unwrap();
            assert!(first.is_null() && second.is_null());
        }
    }

    #[test]
    fn a_state_that_is_none_any_more_is_refused() {
        let _alone = alone();
        let mut instance = instance();
        let (mut state, mut size) = (null_mut(), 0);
        // SAFETY: places that can be written; the states are live, freed or were none ever.
        unsafe {
            get(&instance, &raw mut state).unwrap();
            let mut copy = state;
            set(&mut instance, state).unwrap();
            free(&raw mut state).unwrap();
            free(&raw mut state).unwrap();
            free(null_mut()).unwrap();
            for mut stale in [copy, garbage()] {
                assert!(set(&mut instance, stale).is_err());
                assert!(super::size(&instance, stale, &raw mut size).is_err());
                assert!(free(&raw mut stale).is_err());
                assert!(!stale.is_null(), "a refused call has changed nothing");
            }
            assert!(free(&raw mut copy).is_err());
        }
    }

    #[test]
    fn a_panic_elsewhere_does_not_keep_states_from_being_saved() {
        let _alone = alone();
        let panicked = std::thread::spawn(|| {
            let _held = live();
            panic!("on purpose");
        });
        assert!(panicked.join().is_err());
        let mut state = null_mut();
        // SAFETY: a place that can be written.
        unsafe {
            get(&instance(), &raw mut state).unwrap();
            free(&raw mut state).unwrap();
        }
    }
}
