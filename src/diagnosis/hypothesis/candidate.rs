//! Candidates: every effect of the catalogue with its free parameters.
//!
//! A coefficient is one parameter of an effect, in a coordinate with a Gaussian prior around "off" whose width spans
//! the values that the catalogue finds plausible.

use super::maps::Maps;
use crate::diagnosis::Subject;
use crate::effects::{
    Acts, CATALOGUE, EffectKind, Effects, FirstStep, ParameterDeclaration, ParameterName, Prior,
    Soil, StandingWheel, TerrainChange,
};
use crate::fit::parameter::{self, Scale};
use crate::fit::sensor::SensorParameter;
use crate::parameter::ParameterError;
use crate::vehicle::{GRAVITY, ModelParameter, Specification};
use std::ops::Index;

/// The target of a coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// A parameter of the model.
    Model(ModelParameter),
    /// A parameter of each recording's sensors.
    Sensor(SensorParameter),
}

/// One parameter of an effect.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateParameter {
    /// The effect, by its place in the catalogue.
    pub effect: usize,
    /// Its target.
    pub target: Target,
    /// Name within the effect.
    pub name: &'static str,
    /// Coordinate, prior around "off" and range.
    pub parameter: parameter::FreeParameter,
    /// The value for a difference quotient, if the effect has no derivative while it is off.
    pub secant: Option<f64>,
    /// The coordinate of the value that the catalogue expects of an effect that is on.
    pub typical: f64,
    /// Whether each recording has a separate value, as for effects of the place.
    pub own: bool,
}

/// All candidates.
#[derive(Debug, Clone)]
pub struct Candidates {
    /// All coefficients, effect by effect.
    pub coefficients: Vec<CandidateParameter>,
    /// The effects with coefficients, in the order of the catalogue, without the residual models.
    pub subjects: Vec<Subject>,
}

/// The effect whose boundary must be located before it can be fitted.
pub const TERRAIN_CHANGE: &str = TerrainChange::<f64>::DECLARATION.name;

impl CandidateParameter {
    /// The coordinate at which its effect is off.
    #[must_use]
    pub fn off(&self) -> f64 {
        self.parameter.prior_coordinate()
    }

    /// Whether it shapes an effect that another parameter switches on and off.
    #[must_use]
    pub fn is_shape(&self) -> bool {
        match self.target {
            Target::Model(ModelParameter::Effect(name)) => name.declaration().1.estimated_shape,
            _ => false,
        }
    }
}

impl Candidates {
    /// All effects and residual models that are off in the given model. Effects with a direction on the map need a
    /// map that recordings share, or that runs share if each recording has a separate value.
    #[must_use]
    pub fn new(nominal: &Specification, maps: Maps) -> Self {
        let (mut coefficients, mut subjects) = (Vec::new(), Vec::new());
        for (effect, declaration) in CATALOGUE.iter().enumerate() {
            let lost = declaration.acts == Acts::Slope && maps == Maps::OfRuns;
            if nominal.effects.is_on(effect) || lost {
                continue;
            }
            let first = coefficients.len();
            match declaration.kind {
                EffectKind::Physics => coefficients.extend(physics(effect, nominal, maps)),
                EffectKind::Measurement => coefficients.extend(sensors(effect)),
            }
            // A change of terrain has a boundary that must be located first.
            let waits = declaration.name == TERRAIN_CHANGE;
            if coefficients.len() > first && !is_residual_model(effect) && !waits {
                subjects.push(Subject::Effect(effect));
            }
        }
        Self {
            coefficients,
            subjects,
        }
    }

    /// Indices of a subject's coefficients; none if it is not an effect.
    pub fn of(&self, subject: Subject) -> impl Iterator<Item = usize> + '_ {
        let coefficients = self.coefficients.iter().enumerate();
        let ours = coefficients
            .filter(move |(_, coefficient)| subject == Subject::Effect(coefficient.effect));
        ours.map(|(place, _)| place)
    }

    /// Index of a coefficient by its name, such as `drag.coefficient`.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<usize> {
        let mut all = self.coefficients.iter();
        all.position(|one| one.parameter.name == name)
    }

    /// Indices of the residual models' coefficients.
    pub fn residual_models(&self) -> impl Iterator<Item = usize> + '_ {
        let coefficients = self.coefficients.iter().enumerate();
        coefficients
            .filter(|(_, coefficient)| is_residual_model(coefficient.effect))
            .map(|(place, _)| place)
    }
}

impl Index<usize> for Candidates {
    type Output = CandidateParameter;

    fn index(&self, coefficient: usize) -> &CandidateParameter {
        &self.coefficients[coefficient]
    }
}

/// Whether an effect is a feature of an empirical residual model.
#[must_use]
pub fn is_residual_model(effect: usize) -> bool {
    matches!(CATALOGUE[effect].acts, Acts::Residual(_))
}

/// Copies every parameter of an effect from other effects.
///
/// # Errors
/// A value beyond its range; effects never hold one.
pub fn copy(effects: &mut Effects, effect: usize, from: &Effects) -> Result<(), ParameterError> {
    for place in 0..CATALOGUE[effect].parameters.len() {
        if let Some(name) = ParameterName::at(effect, place) {
            effects.set(name, from.get(name))?;
        }
    }
    Ok(())
}

fn physics(effect: usize, nominal: &Specification, maps: Maps) -> Vec<CandidateParameter> {
    let declaration = CATALOGUE[effect];
    let coefficient =
        |(place, declared): (usize, &'static crate::effects::ParameterDeclaration)| {
            let name = ParameterName::at(effect, place)?;
            let full = name.full_name();
            let free = declared.switches || declared.estimated_shape;
            if !free || declared.on_map && maps != Maps::One {
                return None;
            }
            let off = nominal.effects.get(name);
            let secant = secant(declared, nominal);
            // A parameter that is off at its upper bound, as a pressure, has a logarithmic scale.
            let scale = if off == declared.high && declared.low > 0.0 {
                Scale::Log
            } else {
                Scale::Linear
            };
            let deviation = match (declared.prior, scale) {
                (Prior::Normal { mean, deviation }, _) => deviation.hypot(mean - off),
                (Prior::LogNormal { median, deviation }, Scale::Linear) if off == 0.0 => {
                    median * deviation.exp()
                }
                (Prior::LogNormal { deviation, .. }, Scale::Linear) => deviation * off,
                (Prior::LogNormal { median, .. }, Scale::Log) => (median / off).ln().abs(),
            };
            let expected = match (declared.switches, secant, declared.prior) {
                (false, ..) => off,
                (true, Some(value), _) => value,
                (true, None, Prior::Normal { mean, .. }) => mean,
                (true, None, Prior::LogNormal { median, .. }) => median,
            };
            let typical = match scale {
                Scale::Linear => expected,
                Scale::Log => expected.ln(),
            };
            Some(CandidateParameter {
                typical,
                effect,
                target: Target::Model(ModelParameter::Effect(name)),
                name: declared.name,
                parameter: parameter::FreeParameter {
                    name: full,
                    unit: declared.unit,
                    scale,
                    acts_by: parameter::ActsBy::Coordinate,
                    prior: parameter::Prior {
                        median: off,
                        deviation,
                    },
                    low: declared.low,
                    high: declared.high,
                },
                secant,
                own: declaration.acts == Acts::Slope,
            })
        };
    declaration
        .parameters
        .iter()
        .enumerate()
        .filter_map(coefficient)
        .collect()
}

/// The value for the difference quotient of a parameter without a derivative at "off".
fn secant(declared: &ParameterDeclaration, nominal: &Specification) -> Option<f64> {
    let value = match declared.first_step {
        FirstStep::Derivative => return None,
        FirstStep::To(value) => value,
        FirstStep::Of(value) => {
            let vehicle = &nominal.vehicle;
            let (radius, width) = (vehicle.wheel_radius, vehicle.wheel_width);
            value(&StandingWheel {
                soil: Soil::from_terrain(&nominal.terrain.to_array(), width),
                load: vehicle.mass * GRAVITY / vehicle.wheel_count() as f64,
                radius,
                width,
            })
        }
    };
    Some(value.clamp(declared.low, declared.high))
}

fn sensors(effect: usize) -> impl Iterator<Item = CandidateParameter> {
    let own = SensorParameter::ALL.into_iter();
    let own = own.filter(move |sensor| sensor.declared().effect() == effect);
    own.map(move |sensor| CandidateParameter {
        effect,
        target: Target::Sensor(sensor),
        name: sensor.declared().declaration().1.name,
        parameter: sensor.parameter(""),
        typical: 0.0,
        secant: None,
        own: true,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::testing::on;
    use crate::terrain::Terrain;
    use crate::vehicle::Vehicle;

    #[test]
    fn tyres_are_compared_with_softer_ones_than_the_ground() {
        let pressure = ParameterName::find("tyre_compliance.pressure").unwrap();
        let at = |terrain: &str| {
            let terrain = Terrain::preset(terrain).unwrap();
            let nominal = Specification::plain(Vehicle::tran2007(), terrain);
            secant(pressure.declaration().1, &nominal).unwrap()
        };
        // 31.8 kPa on sand by hand (`tyre_compliance`).
        assert!((at("dry_sand") / (0.65 * 31.8e3) - 1.0).abs() < 5e-3);
        assert!(at("dry_clay") > 200e3);
    }

    #[test]
    fn every_effect_but_a_change_of_terrain_has_knobs_that_are_off() {
        let nominal = on("dry_sand");
        let candidates = Candidates::new(&nominal, Maps::One);
        for (effect, declaration) in CATALOGUE.iter().enumerate() {
            let subject = Subject::Effect(effect);
            let found = candidates.subjects.contains(&subject);
            let expected = declaration.name != TERRAIN_CHANGE && !is_residual_model(effect);
            assert_eq!(found, expected, "{}", declaration.name);
            assert!(candidates.of(subject).next().is_some());
        }
        for coefficient in &candidates.coefficients {
            let (low, high) = coefficient.parameter.bounds();
            let off = coefficient.off();
            assert!(low <= off && off <= high, "{coefficient:?}");
            assert!(
                coefficient.parameter.prior.deviation > 0.0,
                "{coefficient:?}"
            );
        }
        for (maps, lost) in [(Maps::OfRecordings, 0), (Maps::OfRuns, 1)] {
            let apart = Candidates::new(&nominal, maps);
            assert_eq!(apart.subjects.len(), candidates.subjects.len() - lost);
            assert_eq!(
                apart.residual_models().count(),
                candidates.residual_models().count() - 6
            );
        }
        let mut sloped = nominal.clone();
        sloped.effects = sloped.effects.with("grade.slope_east", 0.1).unwrap();
        assert!(
            !Candidates::new(&sloped, Maps::One)
                .subjects
                .contains(&Subject::Effect(0))
        );
    }
}
