//! The content of an FMU: a vehicle, the terrains to choose from, the selected one, and the effects.

use crate::effects::{CATALOGUE, Effects, Extent};
use crate::terrain::Terrain;
use crate::vehicle::{Specification, Vehicle};

/// Name and description of the terrains in the order of their numbers, from 1.
pub const TERRAINS: [(&str, &str); 5] = [
    ("dry_sand", "Dry sand (Tran et al. 2007, Table I)"),
    ("sandy_loam", "Sandy loam (Tran et al. 2007, Table I)"),
    ("clayed_soil", "Clayed soil (Tran et al. 2007, Table I)"),
    ("dry_clay", "Dry clay (Tran et al. 2007, Table I)"),
    ("custom", "The soil of the parameters soil.*"),
];
/// Name and description of their enumeration.
pub const TERRAIN_TYPE: (&str, &str) = ("Terrain", "Soil under the wheels");

const CLAYED_SOIL: usize = 2;
/// The name of a window over places, beside the names of effects.
const WINDOW_ON_THE_MAP: &str = "a window on the map";
/// Index of the custom soil in [`TERRAINS`].
pub(super) const CUSTOM: usize = 4;

/// Vehicle, terrains and effects of an FMU, as in its `resources/` folder.
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    /// The vehicle.
    pub vehicle: Vehicle,
    /// The terrains by number, the custom one last.
    pub terrains: [Terrain; 5],
    /// Index of the selected terrain, from 0.
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

    /// A model whose soil becomes the custom one, which is selected.
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

    /// The vehicle on the selected terrain, with the effects.
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

    /// What restricts the FMU to co-simulation, by name; empty where it supports model exchange as well.
    /// Model exchange has six states, so that effects with memory are excluded, and no event
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

    /// Selects a terrain by name. False if there is none of that name.
    pub fn select(&mut self, name: &str) -> bool {
        match TERRAINS.iter().position(|(known, _)| *known == name) {
            Some(index) => self.selected = index,
            None => return false,
        }
        true
    }

    /// Selects a terrain by name and sets the parameters of the custom soil to it. False if there is none of that name.
    pub fn begin_on(&mut self, name: &str) -> bool {
        let is_there = self.select(name);
        self.terrains[CUSTOM] = *self.terrain();
        is_there
    }

    /// Sets and selects the custom soil.
    pub fn select_custom(&mut self, terrain: Terrain) {
        self.terrains[CUSTOM] = terrain;
        self.selected = CUSTOM;
    }

    /// The selected terrain.
    #[must_use]
    pub fn terrain(&self) -> &Terrain {
        &self.terrains[self.selected]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
