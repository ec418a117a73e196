//! What each drive begins with: the model and the start that all have in common, and its own
//! parameters by the FMU's names.

use super::samples::{Sample, Samples};
use crate::cli::Failure;
use crate::cli::initial::{Initial, check, initial_state};
use std::path::Path;
use ugv_terrain::declaration::{Causality, Configuration, Kind, Quantity, variables};
use ugv_terrain::display::shortened;
use ugv_terrain::parameter::ParameterError;
use ugv_terrain::recording::Drive;
use ugv_terrain::simulation::State;
use ugv_terrain::spelling::nearest;
use ugv_terrain::vehicle::{Specification, VehicleModel};

/// Of the states, those that rolling without slip sets.
const FIRST_VELOCITY: usize = 3;

/// What all drives have in common.
pub struct Setup<'a> {
    base: Configuration,
    initial: &'a [Initial],
    /// What each column of the table sets.
    columns: Vec<Quantity>,
    drive: &'a Drive,
}

impl<'a> Setup<'a> {
    /// # Errors
    /// A name that is no parameter of the FMU, or one that `--initial` sets already.
    pub fn new(
        specification: Specification,
        initial: &'a [Initial],
        drive: &'a Drive,
        names: &[String],
    ) -> Result<Self, Failure> {
        let base = Configuration::from_specification(specification);
        let columns = names.iter().map(|name| quantity(&base, name));
        let columns = columns.collect::<Result<Vec<_>, _>>()?;
        for (name, column) in names.iter().zip(&columns) {
            if let Quantity::Initial(index) = column {
                check_free(name, *index, initial)?;
            }
        }
        Ok(Self {
            base,
            initial,
            columns,
            drive,
        })
    }

    /// Refuses a table of which a row describes no vehicle, soil or effect.
    ///
    /// # Errors
    /// The first such row, with the parameter and its range.
    pub fn check(&self, samples: &Samples, table: Option<&Path>) -> Result<(), Failure> {
        let file = table.map_or(String::new(), |path| format!("{}: ", path.display()));
        for sample in &samples.rows {
            self.prepare(sample).map_err(|failure| match failure {
                Failure::Model(error) => Failure::Argument {
                    reason: format!("{file}sample {}: {error}", sample.index),
                    hint: Some(
                        "bound what is drawn (normal:MEAN,SD,LOW,HIGH, log-normal:MEDIAN,FACTOR,LOW,HIGH), or take the row out of the table".into(),
                    ),
                },
                other => other,
            })?;
        }
        Ok(())
    }

    /// Model and start of a drive.
    pub fn prepare(&self, sample: &Sample) -> Result<(VehicleModel, State), Failure> {
        let model = self.model(sample).map_err(Failure::Model)?;
        let speeds = self.drive.wheel_speeds(0).into();
        let mut state = initial_state(self.initial, model.vehicle(), speeds)?.to_array();
        for (column, value) in self.columns.iter().zip(&sample.values) {
            if let Quantity::Initial(index) = column {
                state[*index] = *value;
            }
        }
        Ok((model, State::from_array(state)))
    }

    fn model(&self, sample: &Sample) -> Result<VehicleModel, ParameterError> {
        let mut configuration = self.base.clone();
        for (column, value) in self.columns.iter().zip(&sample.values) {
            Configuration::check_parameter(*column, *value)?;
            if let Quantity::Initial(index) = column {
                check(*index, *value)?;
            }
            configuration.set_parameter(*column, *value);
        }
        VehicleModel::from_specification(&configuration.specification())
    }
}

fn quantity(base: &Configuration, name: &str) -> Result<Quantity, Failure> {
    let parameters = variables(base).into_iter().filter(|variable| {
        let attributes = variable.attributes;
        attributes.causality == Causality::Parameter && attributes.kind == Kind::Real
    });
    let known: Vec<_> = parameters.collect();
    if let Some(variable) = known.iter().find(|variable| variable.name == name) {
        return Ok(variable.quantity);
    }
    let meant = nearest(name, known.iter().map(|variable| variable.name.as_str()));
    Err(Failure::Argument {
        reason: format!(
            "`{}` is no parameter of the FMU of this model",
            shortened(name)
        ),
        hint: Some(format!(
            "the nearest is {}; docs/reference/fmu_variables.md lists soil.*, vehicle.* and initial.*, `ugv effects` the \
             effects.*, of which those that remember must be on in --effects or --model",
            meant.unwrap_or_default()
        )),
    })
}

fn check_free(name: &str, index: usize, initial: &[Initial]) -> Result<(), Failure> {
    let taken = initial.iter().any(|argument| match argument {
        Initial::NoSlip => index >= FIRST_VELOCITY,
        Initial::Value(set, _) => *set == index,
    });
    if taken {
        return Err(Failure::Argument {
            reason: format!("{name} differs from drive to drive, and --initial sets it too"),
            hint: Some("leave it out of one of them".into()),
        });
    }
    Ok(())
}
