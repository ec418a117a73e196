//! The effects' parameters as variables of the FMU.

use super::configuration::Configuration;
use super::row::{Attributes, Causality, Kind};
use super::table::UNITS;
use super::variable::{Quantity, Variable};
use crate::effects::{Boundary, CATALOGUE, EffectKind, ParameterName};
use std::sync::LazyLock;

/// The first value reference of effects, and the number reserved for each.
pub(super) const FIRST: u32 = 500;
pub(super) const PER_EFFECT: u32 = 16;

/// Attributes of all parameters in order, for a boundary that is measured over time and for one that is
/// measured over a length.
static ATTRIBUTES: LazyLock<[Vec<Attributes>; 2]> = LazyLock::new(|| {
    [true, false].map(|over_time| {
        let declared = ParameterName::all().map(|parameter| parameter.declaration().1);
        let attributes = declared.map(|declared| Attributes {
            causality: Causality::Parameter,
            kind: Kind::Real,
            unit: unit(declared.unit, over_time),
            start: None,
            min: Some(declared.low),
            max: Some(declared.high),
            nominal: None,
            description: declared.description,
        });
        attributes.collect()
    })
});

/// A unit in the standard's spelling: N.s2/m2 for "N s^2/m^2", and one of the two in "s or m".
fn unit(written: &str, over_time: bool) -> &'static str {
    let (time, length) = written.split_once(" or ").unwrap_or((written, written));
    let chosen = if over_time { time } else { length };
    let spelled = chosen.replace(' ', ".").replace('^', "");
    let known = UNITS.iter().find(|unit| unit.name == spelled);
    known.map_or("", |unit| unit.name)
}

/// Whether the parameters of an effect are variables. Effects with memory are offered only where
/// they are on initially, since they exclude model exchange.
fn offered(configuration: &Configuration, effect: usize) -> bool {
    let effects = &configuration.effects;
    CATALOGUE[effect].kind == EffectKind::Physics
        && (!effects.remembers(effect) || effects.is_on(effect))
}

fn attributes(configuration: &Configuration, parameter: ParameterName) -> &'static Attributes {
    let over_time = configuration.effects.boundary == Boundary::Time;
    &ATTRIBUTES[usize::from(!over_time)][parameter.index()]
}

/// The variables of the effects that an FMU offers.
pub(super) fn variables(configuration: &Configuration) -> impl Iterator<Item = Variable> {
    let effects = (0..CATALOGUE.len()).filter(|effect| offered(configuration, *effect));
    let places = effects.flat_map(|effect| {
        (0..CATALOGUE[effect].parameters.len()).map(move |place| (effect, place))
    });
    places.filter_map(|(effect, place)| {
        let parameter = ParameterName::at(effect, place)?;
        Some(Variable {
            name: format!("effects.{}", parameter.full_name()),
            reference: FIRST + PER_EFFECT * effect as u32 + place as u32,
            quantity: Quantity::Effect(parameter),
            attributes: attributes(configuration, parameter),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Effects;
    use crate::vehicle::VehicleModel;

    fn names(effects: Effects) -> Vec<(String, &'static str)> {
        let configuration = Configuration {
            effects,
            ..Configuration::default()
        };
        variables(&configuration)
            .map(|v| (v.name, v.attributes.unit))
            .collect()
    }

    #[test]
    fn every_unit_is_known() {
        for parameter in ParameterName::all() {
            let written = parameter.declaration().1.unit;
            assert_ne!(unit(written, true), "", "{written}");
        }
        assert_eq!(unit("N s^2/m^2", true), "N.s2/m2");
        assert_eq!((unit("s or m", true), unit("s or m", false)), ("s", "m"));
    }

    #[test]
    fn effects_that_remember_are_offered_where_they_are_on() {
        let plain = names(Effects::NONE);
        assert_eq!(plain[0], ("effects.grade.slope_east".into(), "rad"));
        assert!(plain.contains(&("effects.terrain_change.position".into(), "m")));
        for absent in [
            "effects.multipass.memory",
            "effects.transient_shear.relaxation",
            "effects.latency.pose",
        ] {
            assert!(plain.iter().all(|(name, _)| name != absent), "{absent}");
        }
        let on = names(Effects::NONE.with("multipass.memory", 1.0).unwrap());
        assert!(
            on.iter()
                .any(|(name, _)| name == "effects.multipass.stiffness_ratio")
        );
        assert_eq!(on.len(), plain.len() + 2);
        let mut timed = Effects::NONE;
        timed.boundary = Boundary::Time;
        assert!(names(timed.clone()).contains(&("effects.terrain_change.position".into(), "s")));
        timed.boundary = Boundary::Distance;
        assert_eq!(names(timed).len(), plain.len() - 7);
    }

    #[test]
    fn what_remembers_is_what_the_model_says() {
        for boundary in [Boundary::Time, Boundary::Distance, Boundary::Place] {
            for parameter in ParameterName::all().filter(|p| p.declaration().1.switches) {
                let (effect, declared) = parameter.declaration();
                let off = declared.default == declared.high;
                let value = if off { declared.low } else { declared.high };
                let mut configuration = Configuration::default();
                configuration.effects.boundary = boundary;
                configuration.effects.set(parameter, value).unwrap();
                let model = VehicleModel::from_specification(&configuration.specification());
                let remembers = model.unwrap().memory_count() > 0;
                let expected: &[&str] = if remembers { &[effect.name] } else { &[] };
                assert_eq!(
                    configuration.for_co_simulation_alone(),
                    expected,
                    "{boundary:?}"
                );
            }
        }
    }
}
