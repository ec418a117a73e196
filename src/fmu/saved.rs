//! Saved states of an instance, in memory and as bytes.

use super::calls::Mode;
use super::instance::{Core, Failure, Instance, Interface, Outcome, refuse};
use crate::declaration::{self, Configuration};
use crate::simulation::{Simulation, WheelSpeeds};

/// A saved state; the importer holds a pointer to it.
pub(super) struct Saved {
    core: Core,
}

/// Bytes that every serialized state begins with: what it is, and its version.
const MAGIC: &[u8; 8] = b"ugvstat2";

impl Instance {
    pub(super) fn save(&self) -> Saved {
        let core = self.core.clone();
        Saved { core }
    }

    pub(super) fn restore(&mut self, saved: &Saved) -> Outcome {
        let configuration = &saved.core.parameters.configuration;
        if !same_fixtures(configuration, self.configuration()) {
            return refuse(
                "the state was saved from another vehicle, with other terrains, or with other effects",
            );
        }
        let foreign = match self.interface {
            Interface::CoSimulation => &[Mode::Event, Mode::ContinuousTime],
            Interface::ModelExchange => &[Mode::StepComplete, Mode::StepEvent],
        };
        // What the state's parameters switch on may be more than model exchange sees.
        let steps = self.interface == Interface::CoSimulation;
        let exchangeable = steps || configuration.for_co_simulation_alone().is_empty();
        if foreign.contains(&saved.core.mode) || !exchangeable {
            return refuse("the state was saved from an instance of the other interface");
        }
        if saved.core.mode == Mode::StepEvent && !self.has_events {
            return refuse("the state was saved in event mode, which this instance has not");
        }
        self.core = saved.core.clone();
        Ok(())
    }

    /// The saved state as bytes: magic, identity of the FMU, numbers, and a checksum of all.
    pub(super) fn serialize(&self, saved: &Saved) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(self.identity().as_bytes());
        let mut core = saved.core.clone();
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
    pub(super) fn deserialize(&self, bytes: &[u8]) -> Outcome<Saved> {
        let identity = self.identity();
        let Some(rest) = bytes.strip_prefix(MAGIC.as_slice()) else {
            return refuse("these bytes are no state of this FMU");
        };
        let Some(rest) = rest.strip_prefix(identity.as_bytes()) else {
            return refuse("these bytes are the state of another FMU, or of another version of it");
        };
        // Numbers that no simulation wrote could keep a step from ever ending.
        let Some((rest, _)) = rest
            .split_last_chunk::<8>()
            .filter(|(_, sum)| checksum(&bytes[..bytes.len() - sum.len()]).to_le_bytes() == **sum)
        else {
            return refuse("these bytes are only a part of a state, or were changed");
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
        Ok(Saved { core })
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

/// FNV-1a: tells bytes that were damaged or cut short, not ones that were forged.
fn checksum(bytes: &[u8]) -> u64 {
    const BASIS: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0100_0000_01b3;
    let mix = |sum: u64, byte: &u8| (sum ^ u64::from(*byte)).wrapping_mul(PRIME);
    bytes.iter().fold(BASIS, mix)
}

impl Core {
    /// Visits every number but the simulation's, and tells whether there is a simulation.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmu::test_instance::{instance, running, with_effects};

    const MULTIPASS: &str = r#"{"multipass": {"memory": 1.0}}"#;

    fn why(instance: &mut Instance, saved: &Saved) -> String {
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
            let why = why(&mut exchange, &other.save());
            assert!(why.contains("of the other interface"), "{why}");
        }
    }

    #[test]
    fn a_state_of_other_preset_terrains_is_refused_and_one_of_another_custom_soil_is_not() {
        let mut one = running(Interface::CoSimulation, "{}");
        let mut changed = with_effects("{}");
        changed.terrains[4].cohesion += 1.0;
        one.restore(&instance(Interface::CoSimulation, changed.clone()).save())
            .unwrap();
        changed.terrains[0].cohesion += 1.0;
        let why = why(&mut one, &instance(Interface::CoSimulation, changed).save());
        assert!(why.contains("with other terrains"), "{why}");
    }

    #[test]
    fn the_next_event_is_part_of_the_state() {
        let effects =
            r#"{"grade": {"slope_east": 0.1}, "window": {"effects": ["grade"], "time": [1, 2]}}"#;
        let mut one = running(Interface::ModelExchange, effects);
        one.enter_continuous_time_mode().unwrap();
        let bytes = one.serialize(&one.save());
        let mut other = running(Interface::ModelExchange, effects);
        let saved = other.deserialize(&bytes).unwrap();
        other.restore(&saved).unwrap();
        assert_eq!(other.core.due, 1.0);
        assert_eq!(other.serialize(&other.save()), bytes);
    }
}
