//! Saved states of an instance, in memory and as bytes. The importer holds pointers to them.

use super::calls::{Interface, Mode};
use super::guard::{out, read, write};
use super::instance::{Core, Failure, Instance, Outcome, refuse};
use crate::declaration::{self, Configuration};
use crate::simulation::{Simulation, WheelSpeeds};
use std::collections::BTreeSet;
use std::ffi::c_void;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The first bytes of every serialized state: its kind and version.
const MAGIC: &[u8; 8] = b"ugvstat3";

impl Instance {
    fn restore(&mut self, saved: &Core) -> Outcome {
        let configuration = &saved.parameters.configuration;
        if !same_fixtures(configuration, self.configuration()) {
            return refuse(
                "the state was saved from another vehicle, with other terrains, or with other effects",
            );
        }
        let foreign = match self.purpose.interface {
            Interface::CoSimulation => &[Mode::Event, Mode::ContinuousTime],
            Interface::ModelExchange => &[Mode::StepComplete, Mode::StepEvent],
        };
        // The parameters of the state may switch on effects that model exchange does not support.
        let steps = self.purpose.interface == Interface::CoSimulation;
        let exchangeable = steps || configuration.for_co_simulation_alone().is_empty();
        if foreign.contains(&saved.mode) || !exchangeable {
            return refuse("the state was saved from an instance of the other interface");
        }
        if saved.mode == Mode::StepEvent && !self.purpose.has_events {
            return refuse("the state was saved in event mode, which this instance does not have");
        }
        self.core = saved.clone();
        Ok(())
    }

    /// The saved state as bytes: magic, identity of the FMU, numbers, and a checksum of all.
    fn serialize(&self, saved: &Core) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(self.identity().as_bytes());
        let mut core = saved.clone();
        let mut numbers = Vec::new();
        core.visit(&mut |number| numbers.push(*number));
        if let Some(simulation) = &core.simulation {
            numbers.extend(simulation.snapshot());
        }
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes.extend(checksum(&bytes).to_le_bytes());
        bytes
    }

    /// The state behind bytes that [`Instance::serialize`] wrote, in any process.
    fn deserialize(&self, bytes: &[u8]) -> Outcome<Core> {
        let identity = self.identity();
        let Some(rest) = bytes.strip_prefix(MAGIC.as_slice()) else {
            return refuse("these bytes are no state of this FMU");
        };
        let Some(rest) = rest.strip_prefix(identity.as_bytes()) else {
            return refuse("these bytes are the state of another FMU, or of another version of it");
        };
        // A step with forged or damaged numbers might never end.
        let Some((rest, _)) = rest
            .split_last_chunk::<8>()
            .filter(|(_, sum)| checksum(&bytes[..bytes.len() - sum.len()]).to_le_bytes() == **sum)
        else {
            return refuse("these bytes are an incomplete or damaged state");
        };
        let (chunks, remainder) = rest.as_chunks::<8>();
        let numbers: Vec<f64> = chunks
            .iter()
            .map(|chunk| f64::from_le_bytes(*chunk))
            .collect();
        let mut core = self.core.clone();
        let mut count = 0;
        core.visit(&mut |_| count += 1);
        if numbers.len() < count || !remainder.is_empty() {
            return refuse("these bytes are not a whole state");
        }
        let mut next = numbers.iter();
        let has_simulation =
            core.visit(&mut |number| *number = next.next().copied().unwrap_or(0.0));
        core.simulation = None;
        if has_simulation {
            let model = core
                .parameters
                .model()
                .map_err(|e| Failure::Refused(e.to_string()))?;
            let mut simulation = Simulation::new(model);
            if simulation.restore(&numbers[count..]).is_err() {
                return refuse("these bytes are not a whole state");
            }
            core.simulation = Some(simulation);
        }
        Ok(core)
    }

    fn identity(&self) -> String {
        declaration::guid(self.configuration())
    }
}

/// Whether two configurations differ in nothing but what can be set.
fn same_fixtures(one: &Configuration, other: &Configuration) -> bool {
    let effects = [&one.effects, &other.effects];
    let [one_fixed, other_fixed] =
        effects.map(|effects| (effects.boundary, &effects.slope_profile, &effects.window));
    one.rows() == other.rows() && one.presets() == other.presets() && one_fixed == other_fixed
}

/// FNV-1a: detects damaged or truncated bytes, but not forged ones.
fn checksum(bytes: &[u8]) -> u64 {
    const BASIS: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0100_0000_01b3;
    let mix = |sum: u64, byte: &u8| (sum ^ u64::from(*byte)).wrapping_mul(PRIME);
    bytes.iter().fold(BASIS, mix)
}

impl Core {
    /// Visits every number except those of the simulation. Returns whether there is a simulation.
    fn visit(&mut self, visit: &mut impl FnMut(&mut f64)) -> bool {
        let mut mode = f64::from(self.mode as u16);
        visit(&mut mode);
        self.mode = Mode::from_code(mode as u16).unwrap_or(Mode::Error);
        self.parameters.visit(visit);
        let Self { speeds, rates, .. } = self;
        for WheelSpeeds { left, right } in [speeds, rates] {
            visit(left);
            visit(right);
        }
        visit(&mut self.time);
        visit(&mut self.stop_time);
        visit(&mut self.due);
        let mut reported = f64::from(u8::from(self.lift_reported));
        visit(&mut reported);
        self.lift_reported = reported != 0.0;
        let mut present = f64::from(u8::from(self.simulation.is_some()));
        visit(&mut present);
        present != 0.0
    }
}

/// Addresses of the states that C holds. The standard leaves the content of the place for a new state
/// undefined, so that only an address in this set is one of a state.
static LIVE: Mutex<BTreeSet<usize>> = Mutex::new(BTreeSet::new());

fn live() -> MutexGuard<'static, BTreeSet<usize>> {
    // A panic elsewhere does not damage the set.
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The saved state behind a pointer from C.
///
/// # Safety
/// Nobody frees or replaces the state while the result is used.
unsafe fn live_state<'a>(state: *mut c_void) -> Outcome<&'a Core> {
    if state.is_null() {
        return refuse("the state is a null pointer");
    }
    if !live().contains(&state.addr()) {
        return refuse("this is no saved state, or it has been freed");
    }
    // SAFETY: its address is that of a live state; the caller promises the rest.
    Ok(unsafe { &*state.cast::<Core>() })
}

/// Passes a state to C. It replaces a state that may be in the same place.
///
/// # Safety
/// `place` is null or can be written; nobody else uses a state that is there.
unsafe fn hand_over(state: Core, place: *mut *mut c_void) -> Outcome {
    // SAFETY: the caller's promise.
    let place = unsafe { out(place) }?;
    let mut live = live();
    if live.contains(&place.addr()) {
        // SAFETY: its address is that of a live state; the caller promises the rest.
        unsafe { *place.cast::<Core>() = state };
    } else {
        *place = Box::into_raw(Box::new(state)).cast();
        live.insert(place.addr());
    }
    Ok(())
}

/// Saves the state of an instance.
///
/// # Safety
/// `place` is null or can be written; nobody else uses a state that is there.
pub(super) unsafe fn get(instance: &Instance, place: *mut *mut c_void) -> Outcome {
    // SAFETY: the caller's promise.
    unsafe { hand_over(instance.core.clone(), place) }
}

/// Returns to a saved state.
///
/// # Safety
/// Nobody frees or replaces the state meanwhile.
pub(super) unsafe fn set(instance: &mut Instance, state: *mut c_void) -> Outcome {
    // SAFETY: the caller's promise.
    instance.restore(unsafe { live_state(state) }?)
}

/// Frees a saved state. Null is allowed.
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
        return refuse("this is no saved state, or it has been freed");
    }
    // SAFETY: its address was that of a live state, and is removed: the box was made by
    // `hand_over` and is not used after this.
    drop(unsafe { Box::from_raw(state.cast::<Core>()) });
    Ok(())
}

/// The number of bytes that [`serialize`] writes.
///
/// # Safety
/// Nobody frees or replaces the state meanwhile; `size` is null or can be written.
pub(super) unsafe fn size(instance: &Instance, state: *mut c_void, size: *mut usize) -> Outcome {
    // SAFETY: the caller's promise.
    unsafe { *out(size)? = instance.serialize(live_state(state)?).len() };
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
    let (saved, room) = unsafe { (live_state(state)?, write(bytes, size)?) };
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
    use crate::fmu::test_instance::{instance, running, with_effects};
    use std::ptr::{null_mut, without_provenance_mut};

    const MULTIPASS: &str = r#"{"multipass": {"memory": 1.0}}"#;

    fn why(instance: &mut Instance, saved: &Core) -> String {
        match instance.restore(saved) {
            Err(Failure::Refused(why)) => why,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_state_with_more_than_six_states_is_none_of_model_exchange() {
        let mut exchange = instance(Interface::ModelExchange, with_effects("{}"));
        // Before the initialization, when both interfaces stand in the same mode.
        let early = instance(Interface::CoSimulation, with_effects(MULTIPASS));
        for other in [early, running(Interface::CoSimulation, MULTIPASS)] {
            let why = why(&mut exchange, &other.core);
            assert!(why.contains("of the other interface"), "{why}");
        }
    }

    #[test]
    fn a_state_of_other_preset_terrains_is_refused_and_one_of_another_custom_soil_is_not() {
        let mut one = running(Interface::CoSimulation, "{}");
        let mut changed = with_effects("{}");
        changed.terrains[4].cohesion += 1.0;
        one.restore(&instance(Interface::CoSimulation, changed.clone()).core)
            .unwrap();
        changed.terrains[0].cohesion += 1.0;
        let why = why(&mut one, &instance(Interface::CoSimulation, changed).core);
        assert!(why.contains("with other terrains"), "{why}");
    }

    #[test]
    fn the_next_event_is_part_of_the_state() {
        let effects =
            r#"{"grade": {"slope_east": 0.1}, "window": {"effects": ["grade"], "time": [1, 2]}}"#;
        let mut one = running(Interface::ModelExchange, effects);
        one.enter_continuous_time_mode().unwrap();
        let bytes = one.serialize(&one.core);
        let mut other = running(Interface::ModelExchange, effects);
        let saved = other.deserialize(&bytes).unwrap();
        other.restore(&saved).unwrap();
        assert_eq!(other.core.due, 1.0);
        assert_eq!(other.serialize(&other.core), bytes);
    }

    /// The pattern with which a debugger fills memory that has not been written.
    fn garbage() -> *mut c_void {
        without_provenance_mut(usize::from_ne_bytes([0xaa; size_of::<usize>()]))
    }

    fn saving() -> Instance {
        running(Interface::CoSimulation, "{}")
    }

    /// Keeps other tests from saving a state where one has just been freed.
    fn exclusive() -> MutexGuard<'static, ()> {
        static ALONE: Mutex<()> = Mutex::new(());
        ALONE.lock().unwrap_or_else(PoisonError::into_inner)
    }

    #[test]
    fn what_is_in_the_place_for_a_state_is_believed_only_if_it_is_one() {
        let _exclusive = exclusive();
        let instance = saving();
        let bytes = instance.serialize(&instance.core);
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
        let _exclusive = exclusive();
        let mut instance = saving();
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
        let _exclusive = exclusive();
        let panicked = std::thread::spawn(|| {
            let _held = live();
            panic!("on purpose");
        });
        assert!(panicked.join().is_err());
        let mut state = null_mut();
        // SAFETY: a place that can be written.
        unsafe {
            get(&saving(), &raw mut state).unwrap();
            free(&raw mut state).unwrap();
        }
    }
}
