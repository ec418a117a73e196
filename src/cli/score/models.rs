//! The models of a comparison.

use crate::cli::failure::Failure;
use crate::cli::nominal::{DEFAULT_TERRAIN, NamedModel, NominalArgs, no_vehicle};
use crate::identification::{
    FittedKinematics, Kinematics, KinematicsForm, MotionModel, PredictionWindow, WindowOptions,
};
use crate::recording::IntervalEstimate;
use crate::recording::Recording;
use crate::terrain::Terrain;
use crate::vehicle::{Specification, VehicleModel};
use std::sync::Arc;

/// A fitted number with its unit.
pub struct NamedEstimate {
    pub name: &'static str,
    pub unit: &'static str,
    pub estimate: IntervalEstimate,
}

/// A model that is compared with others.
pub struct ComparedModel {
    /// Its name in tables and files.
    pub name: &'static str,
    /// A short description.
    pub description: String,
    /// Fitted numbers.
    pub parameters: Vec<NamedEstimate>,
    /// `None` if it could not be fitted.
    pub predictor: Option<MotionModel>,
}

/// A soil model with a short description.
pub type DescribedModel = (String, Arc<VehicleModel>);

impl ComparedModel {
    /// Kinematics and soils, the simplest first.
    pub fn all(
        windows: &[PredictionWindow],
        fitted: &[usize],
        nominal: DescribedModel,
        given: Option<DescribedModel>,
    ) -> Vec<Self> {
        let no_slip = Kinematics::no_slip(nominal.1.vehicle());
        let on: Vec<&PredictionWindow> = fitted.iter().map(|index| &windows[*index]).collect();
        let fit = |form| Kinematics::fit(form, &on, &no_slip);
        let mut models = vec![
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
        models.extend(given.map(|given| Self::soil("given_model", given)));
        models
    }

    fn soil(name: &'static str, (description, model): DescribedModel) -> Self {
        Self {
            name,
            description,
            parameters: Vec::new(),
            predictor: Some(MotionModel::Soil(model)),
        }
    }

    fn fitted(name: &'static str, fitted: Option<FittedKinematics>) -> Self {
        let Some(fitted) = fitted else {
            let why = "not fitted: the windows for the fit are too few or too straight (a shorter --horizon \
                       gives more)";
            return Self {
                name,
                description: why.into(),
                parameters: Vec::new(),
                predictor: None,
            };
        };
        let metre = |name, estimate| NamedEstimate {
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
            description: "kinematics fitted to the windows that are not judged".into(),
            parameters,
            predictor: Some(MotionModel::Kinematics(fitted.kinematics)),
        }
    }
}

/// The model of the arguments, which is judged beside the nominal one.
pub struct GivenModel {
    pub named: NamedModel,
    description: String,
}

impl GivenModel {
    pub fn load(args: &NominalArgs) -> Result<Self, Failure> {
        Ok(Self {
            named: args.load()?,
            description: args.describe(),
        })
    }

    /// Whether the model was fitted to the windows that judge it.
    fn is_fitted_to_all_of(&self, recording: &Recording) -> bool {
        let mut to = self.named.fitted_to.iter();
        to.any(|to| to.whole && to.recording == recording.name)
    }

    /// A warning if a recording's windows are not independent of the model.
    pub fn doubt(
        &self,
        recording: &Recording,
        cut: &WindowOptions,
        within_a_run: bool,
    ) -> Option<String> {
        let name = &recording.name;
        if self.is_fitted_to_all_of(recording) {
            return Some(format!(
                "warning: the given model was fitted to all of {name}, also to the windows that judge it here; \
                 judge it by another recording, or judge a model of `ugv fit --half`"
            ));
        }
        let mut to = self.named.fitted_to.iter();
        let is_half = to.any(|to| to.recording == *name);
        // Whole runs are judged or not, however they are cut.
        (is_half && within_a_run && *cut != WindowOptions::default()).then(|| {
            format!(
                "warning: the given model was fitted to one half of {name}, of windows of {} s every {} s with the \
                 recorded heading; windows of other lengths, as here, overlap with that half",
                WindowOptions::default().horizon,
                WindowOptions::default().spacing
            )
        })
    }

    /// The nominal model of a recording, and the one of the arguments.
    pub fn models(
        &self,
        recording: &Recording,
    ) -> Result<(DescribedModel, Option<DescribedModel>), Failure> {
        let (about, named) = (&recording.about, &self.named);
        let (vehicle, of_vehicle) = match (&about.vehicle, &named.vehicle) {
            (Some(recorded), _) => (recorded.clone(), "the recording's vehicle"),
            (None, Some(given)) => (
                given.clone(),
                "the given vehicle (the recording names none)",
            ),
            (None, None) => return Err(no_vehicle(&[recording])),
        };
        let (terrain, of_terrain) = match (about.terrain, &about.terrain_name) {
            (Some(terrain), Some(name)) => (terrain, name.clone()),
            (Some(terrain), None) => (terrain, "the recording's terrain".into()),
            (None, _) => (
                Terrain::preset(DEFAULT_TERRAIN).expect("a preset"),
                format!("{DEFAULT_TERRAIN} by default (the recording names no terrain)"),
            ),
        };
        let model = |specification: &Specification| -> Result<_, Failure> {
            Ok(Arc::new(VehicleModel::from_specification(specification)?))
        };
        let plain = Specification::plain(vehicle, terrain);
        let nominal = (format!("{of_vehicle}, {of_terrain}"), model(&plain)?);
        if named.vehicle.is_none() && named.terrain.is_none() && named.effects.is_none() {
            return Ok((nominal, None));
        }
        let given = Specification {
            vehicle: named.vehicle.clone().unwrap_or(plain.vehicle),
            terrain: named.terrain.unwrap_or(plain.terrain),
            effects: named.effects.clone().unwrap_or_default(),
        };
        let mut description = self.description.clone();
        if self.is_fitted_to_all_of(recording) {
            description += ", fitted to these windows too";
        }
        Ok((nominal, Some((description, model(&given)?))))
    }
}
