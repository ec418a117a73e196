//! What outputs and rates depend on, at the start and while the simulation runs.

use super::configuration::Configuration;
use super::row::Causality;
use super::variable::{Quantity, Side};
use super::variables::{ArrayVariable, Elements, Naming};
use crate::effects::{Boundary, Extent, SlopeProfile};

/// The kind of a dependency.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DependencyKind {
    /// As a constant factor.
    Constant,
    /// In any way.
    Dependent,
}

impl DependencyKind {
    /// The name in the model description, the same in every version of the standard.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Dependent => "dependent",
        }
    }
}

/// What an output or the rate of a state depends on: its own state only, or the quantities of its
/// equation (inputs, then states, then the time). Empty for other quantities.
#[must_use]
pub fn dependencies(
    quantity: Quantity,
    configuration: &Configuration,
) -> (Vec<Quantity>, DependencyKind) {
    let states = |indices: &[usize]| indices.iter().copied().map(Quantity::State).collect();
    match quantity {
        Quantity::State(index) => (states(&[index]), DependencyKind::Constant),
        Quantity::Rate(0 | 1) => (states(&[2, 3, 4]), DependencyKind::Dependent),
        Quantity::Rate(2) => (states(&[5]), DependencyKind::Constant),
        // The forces depend on the pose through effects: a grade, or a boundary on the map.
        Quantity::Rate(_) | Quantity::Total(_) | Quantity::Wheel(..) => {
            let inputs = Side::BOTH.into_iter().map(Quantity::Input);
            let mut all: Vec<Quantity> = inputs.chain((0..6).map(Quantity::State)).collect();
            if configuration.depends_on_time() {
                all.push(Quantity::Time);
            }
            (all, DependencyKind::Dependent)
        }
        _ => (Vec::new(), DependencyKind::Dependent),
    }
}

/// The initial value that determines a coordinate of the pose at the start.
#[must_use]
pub fn initial_pose(quantity: Quantity) -> Option<Quantity> {
    match quantity {
        Quantity::State(index @ 0..=2) => Some(Quantity::Initial(index)),
        _ => None,
    }
}

/// The variables that an output or a rate may depend on at the start: the pose on its initial values, all
/// others on everything that can be set, and on the start time where forces may depend on it.
#[must_use]
pub fn initial_dependencies(
    quantity: Quantity,
    configuration: &Configuration,
) -> Vec<ArrayVariable> {
    let mut known = Naming::Arrays.variables(configuration);
    if let Some(own) = initial_pose(quantity) {
        known.retain(|variable| variable.elements == Elements::One(own));
        return known;
    }
    known.retain(|variable| match variable.attributes.causality {
        Causality::Input | Causality::Parameter => true,
        Causality::Independent => configuration.depends_on_time(),
        Causality::Output | Causality::Local => false,
    });
    known
}

impl Configuration {
    /// Whether forces may depend on the time itself: a boundary, slopes or a window over it.
    #[must_use]
    pub fn depends_on_time(&self) -> bool {
        let effects = &self.effects;
        let window = effects.window.as_ref().map(|window| window.extent);
        effects.boundary == Boundary::Time
            || matches!(effects.slope_profile, Some(SlopeProfile::Time(_)))
            || matches!(window, Some(Extent::Time { .. }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Effects;

    #[test]
    fn forces_depend_on_the_time_where_effects_do() {
        let mut configuration = Configuration::default();
        let count =
            |configuration: &Configuration| dependencies(Quantity::Total(0), configuration).0.len();
        assert_eq!(count(&configuration), 8);
        for effects in [
            r#"{"grade": {"profile": {"over": "time", "points": [[0, 0.1, 0]]}}}"#,
            r#"{"grade": {"slope_east": 0.1}, "window": {"effects": ["grade"], "time": [1, 2]}}"#,
        ] {
            configuration.effects = Effects::from_json(effects).unwrap();
            assert_eq!(count(&configuration), 9, "{effects}");
        }
    }

    #[test]
    fn at_the_start_all_depends_on_what_can_be_set() {
        let mut configuration = Configuration::default();
        let names = |configuration: &Configuration| -> Vec<String> {
            let known = initial_dependencies(Quantity::State(3), configuration).into_iter();
            known.map(|variable| variable.name).collect()
        };
        let plain = names(&configuration);
        for (name, there) in [
            ("omega_left", true),
            ("terrain", true),
            ("initial.v_x", true),
            ("initial.no_slip", true),
            ("vehicle.row_positions", true),
            ("time", false),
            ("v_x", false),
            ("der(v_x)", false),
        ] {
            assert_eq!(plain.iter().any(|known| known == name), there, "{name}");
        }
        let profile = r#"{"grade": {"profile": {"over": "time", "points": [[0, 0.1, 0]]}}}"#;
        configuration.effects = Effects::from_json(profile).unwrap();
        assert!(names(&configuration).contains(&"time".to_owned()));
        let pose =
            (0..3).flat_map(|index| initial_dependencies(Quantity::State(index), &configuration));
        let pose: Vec<String> = pose.map(|variable| variable.name).collect();
        assert_eq!(pose, ["initial.x", "initial.y", "initial.heading"]);
    }
}
