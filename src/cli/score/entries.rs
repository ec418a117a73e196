//! The models of a contest.

use super::Described;
use ugv_terrain::identification::{FittedKinematics, Kinematics, KinematicsForm};
use ugv_terrain::identification::{MotionModel, PredictionWindow};
use ugv_terrain::recording::IntervalEstimate;

/// A fitted number with its unit.
pub struct ParameterEntry {
    pub name: &'static str,
    pub unit: &'static str,
    pub estimate: IntervalEstimate,
}

/// A model that takes part.
pub struct Entry {
    /// Its name in tables and files.
    pub name: &'static str,
    /// What it is, in a few words.
    pub description: String,
    /// Numbers that were fitted.
    pub parameters: Vec<ParameterEntry>,
    /// `None` where it could not be fitted.
    pub predictor: Option<MotionModel>,
}

impl Entry {
    /// Kinematics and soils, the simplest first.
    pub fn all(
        windows: &[PredictionWindow],
        fitted: &[usize],
        nominal: Described,
        given: Option<Described>,
    ) -> Vec<Self> {
        let no_slip = Kinematics::no_slip(nominal.1.vehicle());
        let on: Vec<&PredictionWindow> = fitted.iter().map(|index| &windows[*index]).collect();
        let fit = |form| Kinematics::fit(form, &on, &no_slip);
        let mut entries = vec![
            Self {
                name: "no_slip",
                description: format!(
                    "r = {} m, track = {} m of the vehicle",
                    no_slip.wheel_radius, no_slip.track
                ),
                parameters: Vec::new(),
                predictor: Some(MotionModel::Kinematics(no_slip)),
            },
            Self::fitted("two_parameter", fit(KinematicsForm::TwoParameter)),
            Self::fitted("three_parameter", fit(KinematicsForm::ThreeParameter)),
            Self::soil("nominal_soil", nominal),
        ];
        entries.extend(given.map(|given| Self::soil("given_model", given)));
        entries
    }

    fn soil(name: &'static str, (description, model): Described) -> Self {
        Self {
            name,
            description,
            parameters: Vec::new(),
            predictor: Some(MotionModel::Soil(model)),
        }
    }

    fn fitted(name: &'static str, fitted: Option<FittedKinematics>) -> Self {
        let Some(fitted) = fitted else {
            return Self {
                name,
                description:
                    "not fitted: the other windows are too few or too straight (a shorter \
                              --horizon leaves more)"
                        .into(),
                parameters: Vec::new(),
                predictor: None,
            };
        };
        let metre = |name, estimate| ParameterEntry {
            name,
            unit: "m",
            estimate,
        };
        let mut parameters = vec![
            metre("wheel_radius", fitted.wheel_radius),
            metre("track", fitted.track),
        ];
        parameters.extend(fitted.icr_x.map(|estimate| metre("icr_x", estimate)));
        Self {
            name,
            description: "kinematics fitted on the windows that are not judged".into(),
            parameters,
            predictor: Some(MotionModel::Kinematics(fitted.kinematics)),
        }
    }
}
