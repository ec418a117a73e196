//! What an FMU is made for: a vehicle, the terrains to choose from, the one to begin with, and the
//! effects.

use super::Quantity;
#[cfg(feature = "fmu")]
use crate::effects::ParameterName;
use crate::effects::{CATALOGUE, Effects, Extent};
use crate::parameter::ParameterError;
use crate::terrain::Terrain;
use crate::vehicle::{Specification, Vehicle};

/// Names of the terrains in the order of their numbers, from 1.
pub const TERRAIN_NAMES: [&str; 5] = [
    "dry_sand",
    "sandy_loam",
    "clayed_soil",
    "dry_clay",
    "custom",
];

const CLAYED_SOIL: usize = 2;
/// What a window that depends on the place is called beside the effects.
const WINDOW_ON_THE_MAP: &str = "a window on the map";
/// Position of the custom soil in [`TERRAIN_NAMES`].
pub(super) const CUSTOM: usize = 4;
/// The one parameter that is not kept in the unit that it is set in.
const FRICTION_ANGLE: Quantity = Quantity::Soil(1);

/// The vehicle, terrains and effects that an FMU starts with; they travel in its `resources/`.
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    /// The vehicle.
    pub vehicle: Vehicle,
    /// The terrains by number, the custom one last.
    pub terrains: [Terrain; 5],
    /// Which of them is chosen, from 0.
    pub selected: usize,
    /// The physics beside the paper's.
    pub effects: Effects,
}

impl Default for Configuration {
    /// The paper's vehicle and terrains, on clayed soil, without effects.
    fn default() -> Self {
        let presets = Terrain::PRESETS
            .map(|name| Terrain::preset(name).expect("the presets are in the crate, and tested"));
        Self::new(Vehicle::tran2007(), presets)
    }
}

impl Configuration {
    pub(super) fn new(vehicle: Vehicle, presets: [Terrain; 4]) -> Self {
        let [sand, loam, clayed, clay] = presets;
        Self {
            vehicle,
            terrains: [sand, loam, clayed, clay, clayed],
            selected: CLAYED_SOIL,
            effects: Effects::NONE,
        }
    }

    /// A model on its own soil, which becomes the custom one and is chosen.
    #[must_use]
    pub fn from_specification(specification: Specification) -> Self {
        let mut configuration = Self {
            vehicle: specification.vehicle,
            effects: specification.effects,
            ..Self::default()
        };
        configuration.select_custom(specification.terrain);
        configuration
    }

    /// The vehicle on the terrain that is chosen, with the effects.
    #[must_use]
    pub fn specification(&self) -> Specification {
        Specification {
            vehicle: self.vehicle.clone(),
            terrain: *self.terrain(),
            effects: self.effects.clone(),
        }
    }

    /// Number of wheel rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.vehicle.row_positions.len()
    }

    /// Why the FMU is for co-simulation alone, by name; empty where it is for model exchange as well. That knows
    /// six states, and so none of what effects make the vehicle and its ground remember; and no event
    /// indicators, which the edge of a window on the map would need.
    #[must_use]
    pub fn for_co_simulation_alone(&self) -> Vec<&'static str> {
        let numbered = CATALOGUE.iter().enumerate();
        let remembering = numbered
            .filter(|(effect, _)| self.effects.remembers(*effect) && self.effects.is_on(*effect));
        let extent = self.effects.window.as_ref().map(|window| window.extent);
        let placed = matches!(extent, Some(Extent::Place { .. }));
        remembering
            .map(|(_, declaration)| declaration.name)
            .chain(placed.then_some(WINDOW_ON_THE_MAP))
            .collect()
    }

    /// The terrains that cannot be set.
    #[cfg(feature = "fmu")]
    pub(crate) fn presets(&self) -> &[Terrain] {
        &self.terrains[..CUSTOM]
    }

    /// Chooses one of the terrains by name; whether there is one.
    pub fn select(&mut self, name: &str) -> bool {
        match TERRAIN_NAMES.iter().position(|known| *known == name) {
            Some(index) => self.selected = index,
            None => return false,
        }
        true
    }

    /// Begins on one of the terrains by name, which is where the custom soil's parameters start as well; whether there is
    /// one.
    pub fn begin_on(&mut self, name: &str) -> bool {
        let is_there = self.select(name);
        self.terrains[CUSTOM] = *self.terrain();
        is_there
    }

    /// Chooses a soil of one's own.
    pub fn select_custom(&mut self, terrain: Terrain) {
        self.terrains[CUSTOM] = terrain;
        self.selected = CUSTOM;
    }

    /// The terrain that is chosen.
    #[must_use]
    pub fn terrain(&self) -> &Terrain {
        &self.terrains[self.selected]
    }

    /// The value of a parameter of the vehicle, the custom soil (the friction angle in
    /// degrees) or an effect; `None` for any other quantity.
    #[must_use]
    pub fn parameter(&self, quantity: Quantity) -> Option<f64> {
        if let Quantity::Effect(parameter) = quantity {
            return Some(self.effects.get(parameter));
        }
        if quantity == FRICTION_ANGLE {
            return Some(self.terrains[CUSTOM].friction_angle_degrees());
        }
        self.clone().slot(quantity).map(|slot| *slot)
    }

    /// Refuses the value of an effect's parameter outside its range; those of the vehicle and the
    /// soil are checked together when a model is made.
    ///
    /// # Errors
    /// A value that is not finite or out of range.
    pub fn check_parameter(quantity: Quantity, value: f64) -> Result<(), ParameterError> {
        match quantity {
            Quantity::Effect(parameter) => {
                let (effect, declared) = parameter.declaration();
                declared.check(effect.name, value)
            }
            _ => Ok(()),
        }
    }

    /// Sets such a parameter to a value that [`Configuration::check_parameter`] accepts; whether
    /// there is one, and it did.
    pub fn set_parameter(&mut self, quantity: Quantity, value: f64) -> bool {
        if let Quantity::Effect(parameter) = quantity {
            return self.effects.set(parameter, value).is_ok();
        }
        let value = if quantity == FRICTION_ANGLE {
            value.to_radians()
        } else {
            value
        };
        self.slot(quantity).map(|slot| *slot = value).is_some()
    }

    /// Visits every number that can be set.
    #[cfg(feature = "fmu")]
    pub(crate) fn visit(&mut self, visit: &mut impl FnMut(&mut f64)) {
        let mut selected = self.selected as f64;
        visit(&mut selected);
        self.selected = (selected as usize).min(CUSTOM);
        for parameter in ParameterName::all() {
            let mut value = self.effects.get(parameter);
            visit(&mut value);
            self.set_parameter(Quantity::Effect(parameter), value);
        }
        let rows = self.rows();
        let vehicle = (0..7).map(Quantity::Vehicle);
        let all = (0..6)
            .map(Quantity::Soil)
            .chain(vehicle)
            .chain((0..rows).map(Quantity::Row));
        for quantity in all {
            if let Some(slot) = self.slot(quantity) {
                visit(slot);
            }
        }
    }

    /// Where a parameter is kept, in SI units and radians.
    fn slot(&mut self, quantity: Quantity) -> Option<&mut f64> {
        let Self {
            vehicle, terrains, ..
        } = self;
        let soil = &mut terrains[CUSTOM];
        Some(match quantity {
            Quantity::Soil(0) => &mut soil.cohesion,
            Quantity::Soil(1) => &mut soil.friction_angle,
            Quantity::Soil(2) => &mut soil.cohesive_modulus,
            Quantity::Soil(3) => &mut soil.frictional_modulus,
            Quantity::Soil(4) => &mut soil.sinkage_exponent,
            Quantity::Soil(5) => &mut soil.shear_modulus,
            Quantity::Vehicle(0) => &mut vehicle.mass,
            Quantity::Vehicle(1) => &mut vehicle.yaw_inertia,
            Quantity::Vehicle(2) => &mut vehicle.wheel_radius,
            Quantity::Vehicle(3) => &mut vehicle.wheel_width,
            Quantity::Vehicle(4) => &mut vehicle.half_track,
            Quantity::Vehicle(5) => &mut vehicle.com_offset,
            Quantity::Vehicle(6) => &mut vehicle.com_height,
            Quantity::Row(index) => vehicle.row_positions.get_mut(index)?,
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::ParameterName;

    #[test]
    fn what_model_exchange_cannot_see_is_for_co_simulation_alone() {
        let drag = r#""drag": {"coefficient": 9}"#;
        for (effects, expected) in [
            ("{}".to_owned(), &[][..]),
            (
                r#"{"multipass": {"memory": 1}, "transient_shear": {"relaxation": 1}}"#.to_owned(),
                &["multipass", "transient_shear"],
            ),
            (
                format!(r#"{{{drag}, "window": {{"effects": ["drag"], "time": [1, 2]}}}}"#),
                &[],
            ),
            (
                format!(
                    r#"{{{drag}, "window": {{"effects": ["drag"], "place": {{"x": 1, "y": 0, "radius": 2}}}}}}"#
                ),
                &["a window on the map"],
            ),
        ] {
            let configuration = Configuration {
                effects: Effects::from_json(&effects).unwrap(),
                ..Configuration::default()
            };
            let found = configuration.for_co_simulation_alone();
            assert_eq!(found, expected, "{effects}");
        }
    }

    #[test]
    fn parameters_are_read_back_as_they_were_set() {
        let mut configuration = Configuration::default();
        for quantity in [
            Quantity::Soil(1),
            Quantity::Soil(4),
            Quantity::Vehicle(6),
            Quantity::Row(3),
        ] {
            assert!(configuration.set_parameter(quantity, 29.3));
            assert_eq!(configuration.parameter(quantity), Some(29.3));
        }
        let payload = ParameterName::find("payload.mass")
            .map(Quantity::Effect)
            .unwrap();
        assert!(configuration.set_parameter(payload, 29.3));
        assert_eq!(configuration.parameter(payload), Some(29.3));
        assert!(!configuration.set_parameter(payload, -1.0));
        assert!(Configuration::check_parameter(payload, -1.0).is_err());
        assert!(!configuration.set_parameter(Quantity::Row(4), 1.0));
        assert_eq!(configuration.parameter(Quantity::Input(0)), None);
    }
}
