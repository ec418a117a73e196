//! What is asked about: every effect of the catalogue, with the parameters that it may take.
//!
//! A knob is one number of an effect, in a coordinate that is 0 away from "off" where the effect is
//! off, with a Gaussian prior around it whose width spans what the catalogue finds plausible.

use super::maps::Maps;
use crate::diagnosis::Subject;
use crate::effects::{
    CATALOGUE, Declaration, EffectKind, Effects, ParameterName, Prior, Soil, TyreCompliance,
};
use crate::fit::parameter::{self, Scale};
use crate::fit::sensor::SensorParameter;
use crate::parameter::ParameterError;
use crate::vehicle::{GRAVITY, ModelParameter, Specification};

/// What a knob turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// A number of the model.
    Model(ModelParameter),
    /// A number of each recording's sensors.
    Sensor(SensorParameter),
}

/// One number of an effect.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateParameter {
    /// The effect, by its place in the catalogue.
    pub effect: usize,
    /// What it turns.
    pub target: Target,
    /// Name within the effect.
    pub name: &'static str,
    /// Coordinate, prior around "off" and range.
    pub parameter: parameter::FreeParameter,
    /// A value to compare with where the effect has no derivative while it is off.
    pub secant: Option<f64>,
    /// The coordinate of a value as the catalogue expects it where the effect is on.
    pub typical: f64,
    /// Whether each recording has its own: what is bound to the place of a drive.
    pub own: bool,
}

/// Everything that is asked about.
#[derive(Debug, Clone)]
pub struct Candidates {
    /// All knobs, effect by effect.
    pub coefficients: Vec<CandidateParameter>,
    /// The effects that have knobs, in the order of the catalogue; laws for what has no name are
    /// not among them.
    pub subjects: Vec<Subject>,
}

/// Names of the effects that are laws without a name begin so.
pub const LAW: &str = "residual_";

/// The effect whose place has to be found before it can be asked about.
pub const TERRAIN_CHANGE: &str = "terrain_change";

/// Parameters without a derivative while their effect is off, with a value to compare with.
const SECANTS: [(&str, f64); 2] = [
    ("multipass.memory", 1.0),
    ("transient_shear.relaxation", 1.0),
];
/// The same of tyres, as a share of the pressure above which they are rigid on the given soil: 60 kPa is rigid
/// on sand, and on clay so flat that no way leads there.
const SOFT_TYRES: (&str, f64) = ("tyre_compliance.pressure", 0.65);
/// Shapes that are fitted along with an effect that is on: with another lever the same moment is another force.
const SHAPES: [&str; 3] = ["drawbar.hitch_behind", "payload.ahead", "payload.left"];
/// Effects whose parameters belong to the place of a drive.
const PLACE_BOUND: [&str; 1] = ["grade"];
/// Terms of laws that have a direction on the map.
const DIRECTIONS: [&str; 2] = ["east", "north"];

impl CandidateParameter {
    /// Whether it shapes an effect that another knob switches on and off.
    #[must_use]
    pub fn is_shape(&self) -> bool {
        SHAPES.contains(&self.parameter.name.as_str())
    }
}

impl Candidates {
    /// All effects of the catalogue, and the laws' features, where the given model lacks them. What has
    /// a direction on the map is left out where recordings have no map in common, or their runs where it is each
    /// recording's own.
    #[must_use]
    pub fn new(nominal: &Specification, maps: Maps) -> Self {
        let (mut coefficients, mut subjects) = (Vec::new(), Vec::new());
        for (effect, declaration) in CATALOGUE.iter().enumerate() {
            let lost = PLACE_BOUND.contains(&declaration.name) && maps == Maps::OfRuns;
            if nominal.effects.is_on(effect) || lost {
                continue;
            }
            let first = coefficients.len();
            match declaration.kind {
                EffectKind::Physics => {
                    let all = physics(effect, declaration, nominal).into_iter();
                    coefficients.extend(all.filter(|coefficient| {
                        maps == Maps::One || !DIRECTIONS.contains(&coefficient.name)
                    }));
                }
                EffectKind::Measurement => coefficients.extend(sensors(effect, declaration)),
            }
            // A change of terrain begins at a boundary that has to be found first: see `boundary`.
            let waits = declaration.name == TERRAIN_CHANGE;
            if coefficients.len() > first && !is_law(effect) && !waits {
                subjects.push(Subject::Effect(effect));
            }
        }
        Self {
            coefficients,
            subjects,
        }
    }

    /// Places of a subject's knobs; none for what is no effect.
    pub fn of(&self, subject: Subject) -> impl Iterator<Item = usize> + '_ {
        let coefficients = self.coefficients.iter().enumerate();
        let ours = coefficients
            .filter(move |(_, coefficient)| subject == Subject::Effect(coefficient.effect));
        ours.map(|(place, _)| place)
    }

    /// Places of the laws' knobs.
    pub fn laws(&self) -> impl Iterator<Item = usize> + '_ {
        let coefficients = self.coefficients.iter().enumerate();
        coefficients
            .filter(|(_, coefficient)| is_law(coefficient.effect))
            .map(|(place, _)| place)
    }
}

/// Whether an effect is a law for what has no name.
#[must_use]
pub fn is_law(effect: usize) -> bool {
    CATALOGUE[effect].name.starts_with(LAW)
}

/// Sets every number of an effect as it is among others.
///
/// # Errors
/// None in truth: what others have is within its range.
pub fn copy(effects: &mut Effects, effect: usize, from: &Effects) -> Result<(), ParameterError> {
    for place in 0..CATALOGUE[effect].parameters.len() {
        if let Some(name) = ParameterName::at(effect, place) {
            effects.set(name, from.get(name))?;
        }
    }
    Ok(())
}

fn physics(
    effect: usize,
    declaration: &'static Declaration,
    nominal: &Specification,
) -> Vec<CandidateParameter> {
    let coefficient =
        |(place, declared): (usize, &'static crate::effects::ParameterDeclaration)| {
            let name = ParameterName::at(effect, place)?;
            let full = name.full_name();
            if !declared.switches && !SHAPES.contains(&full.as_str()) {
                return None;
            }
            let off = nominal.effects.get(name);
            let secant =
                secant(&full, nominal).map(|value| value.clamp(declared.low, declared.high));
            // A pressure is known to a factor; everything else enters as it is.
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
                    prior: parameter::Prior {
                        median: off,
                        deviation,
                    },
                    low: declared.low,
                    high: declared.high,
                },
                secant,
                own: PLACE_BOUND.contains(&declaration.name),
            })
        };
    declaration
        .parameters
        .iter()
        .enumerate()
        .filter_map(coefficient)
        .collect()
}

/// What to compare a parameter with that has no derivative while its effect is off.
fn secant(full: &str, nominal: &Specification) -> Option<f64> {
    let (tyres, share) = SOFT_TYRES;
    if full == tyres {
        let vehicle = &nominal.vehicle;
        let (radius, width) = (vehicle.wheel_radius, vehicle.wheel_width);
        let load = vehicle.mass * GRAVITY / vehicle.wheel_count() as f64;
        let soil = Soil::from_terrain(&nominal.terrain.to_array(), width);
        return Some(share * TyreCompliance::rigid_limit(&soil, load, radius, width));
    }
    let found = SECANTS.iter().find(|(secant, _)| *secant == full);
    found.map(|(_, value)| *value)
}

fn sensors(effect: usize, declaration: &'static Declaration) -> Vec<CandidateParameter> {
    let turned: &[(&'static str, SensorParameter)] = match declaration.name {
        "latency" => &[
            ("pose", SensorParameter::PoseLatency),
            ("wheels", SensorParameter::WheelLatency),
        ],
        "lever_arm" => &[
            ("ahead", SensorParameter::LeverArmX),
            ("left", SensorParameter::LeverArmY),
        ],
        "yaw_rate_bias" => &[("bias", SensorParameter::YawRateBias)],
        "heading_offset" => &[("offset", SensorParameter::HeadingOffset)],
        _ => &[],
    };
    let coefficient = |&(name, sensor): &(&'static str, SensorParameter)| CandidateParameter {
        effect,
        target: Target::Sensor(sensor),
        name,
        parameter: sensor.parameter(""),
        typical: 0.0,
        secant: None,
        own: true,
    };
    turned.iter().map(coefficient).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::Terrain;
    use crate::vehicle::Vehicle;

    #[test]
    fn tyres_are_compared_with_softer_ones_than_the_ground() {
        let at = |terrain: &str| {
            let terrain = Terrain::preset(terrain).unwrap();
            secant(
                SOFT_TYRES.0,
                &Specification::plain(Vehicle::tran2007(), terrain),
            )
        };
        // 31.8 kPa on sand by hand (`tyre_compliance`).
        assert!((at("dry_sand").unwrap() / (SOFT_TYRES.1 * 31.8e3) - 1.0).abs() < 5e-3);
        assert!(at("dry_clay") > Some(200e3));
    }

    #[test]
    fn every_effect_but_a_change_of_terrain_has_knobs_that_are_off() {
        let nominal =
            Specification::plain(Vehicle::tran2007(), Terrain::preset("dry_sand").unwrap());
        let candidates = Candidates::new(&nominal, Maps::One);
        for (effect, declaration) in CATALOGUE.iter().enumerate() {
            let subject = Subject::Effect(effect);
            let found = candidates.subjects.contains(&subject);
            let expected = declaration.name != TERRAIN_CHANGE && !is_law(effect);
            assert_eq!(found, expected, "{}", declaration.name);
            assert!(candidates.of(subject).next().is_some());
        }
        for coefficient in &candidates.coefficients {
            let (low, high) = coefficient.parameter.bounds();
            let off = coefficient.parameter.prior_coordinate();
            assert!(low <= off && off <= high, "{coefficient:?}");
            assert!(
                coefficient.parameter.prior.deviation > 0.0,
                "{coefficient:?}"
            );
        }
        for (maps, lost) in [(Maps::OfRecordings, 0), (Maps::OfRuns, 1)] {
            let apart = Candidates::new(&nominal, maps);
            assert_eq!(apart.subjects.len(), candidates.subjects.len() - lost);
            assert_eq!(apart.laws().count(), candidates.laws().count() - 6);
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
