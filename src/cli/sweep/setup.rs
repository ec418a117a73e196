//! The model and the initial state of each drive: those of all drives, with the parameters of one.

use super::parameters::{ParameterRow, ParameterTable};
use crate::cli::failure::Failure;
use crate::cli::initial::{InitialArgument, check, initial_state};
use crate::declaration::{Causality, Configuration, Kind, Quantity, variables};
use crate::display::shortened;
use crate::parameter::ParameterError;
use crate::recording::Drive;
use crate::simulation::batch::{Rollout, WheelSpeedTable};
use crate::simulation::{Simulation, State};
use crate::spelling::nearest;
use crate::vehicle::{Specification, VehicleModel};
use std::path::Path;
use std::sync::Arc;

/// What all drives have in common.
pub struct Setup<'a> {
    base: Configuration,
    initial: &'a [InitialArgument],
    /// The quantity that each column of the table sets.
    columns: Vec<Quantity>,
    inputs: Arc<WheelSpeedTable>,
}

impl<'a> Setup<'a> {
    /// # Errors
    /// A name that is not a parameter of the FMU, or one that `--initial` sets too.
    pub fn new(
        specification: Specification,
        initial: &'a [InitialArgument],
        drive: &Drive,
        names: &[String],
    ) -> Result<Self, Failure> {
        let base = Configuration::from_specification(specification);
        let columns = names.iter().map(|name| quantity(&base, name));
        let columns = columns.collect::<Result<Vec<_>, _>>()?;
        for (name, column) in names.iter().zip(&columns) {
            if let Quantity::Initial(place) = column
                && initial.iter().any(|argument| argument.sets(*place))
            {
                let reason =
                    format!("{name} differs from drive to drive, and --initial sets it too");
                return Err(Failure::argument(reason).with_remedy("remove one of them"));
            }
        }
        Ok(Self {
            base,
            initial,
            columns,
            inputs: Arc::new(table(drive)?),
        })
    }

    /// Refuses a table with an invalid vehicle, soil or effect.
    ///
    /// # Errors
    /// The first row with one, with the parameter and its range.
    pub fn check(&self, samples: &ParameterTable, table: Option<&Path>) -> Result<(), Failure> {
        let file = table.map_or(String::new(), |path| format!("{}: ", path.display()));
        for sample in &samples.rows {
            self.prepare(sample).map_err(|failure| match failure {
                Failure::Model(error) => {
                    Failure::argument(format!("{file}sample {}: {error}", sample.index))
                        .with_remedy(
                            "bound the distribution (normal:MEAN,SD,LOW,HIGH, log-normal:MEDIAN,FACTOR,LOW,HIGH), \
                             or remove the row from the table",
                        )
                }
                other => other,
            })?;
        }
        Ok(())
    }

    /// A drive: model, initial state and wheel speeds.
    pub fn rollout(&self, sample: &ParameterRow) -> Result<Rollout, Failure> {
        let (model, start) = self.prepare(sample)?;
        let mut simulation = Simulation::new(model);
        simulation.set_state(start)?;
        let inputs = self.inputs.clone();
        Ok(Rollout { simulation, inputs })
    }

    /// Model and initial state of a drive.
    fn prepare(&self, sample: &ParameterRow) -> Result<(VehicleModel, State), Failure> {
        let model = self.model(sample)?;
        let speeds = self.inputs.wheel_speeds()[0];
        let mut state = initial_state(self.initial, model.vehicle(), speeds)?.to_array();
        for (column, value) in self.columns.iter().zip(&sample.values) {
            if let Quantity::Initial(index) = column {
                state[*index] = *value;
            }
        }
        Ok((model, State::from_array(state)))
    }

    fn model(&self, sample: &ParameterRow) -> Result<VehicleModel, ParameterError> {
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

fn table(drive: &Drive) -> Result<WheelSpeedTable, Failure> {
    let rows = 0..drive.len();
    let speeds = rows.map(|row| drive.wheel_speeds(row).into()).collect();
    WheelSpeedTable::new(drive.time.clone(), speeds)
        .map_err(|error| Failure::argument(error.to_string()))
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
    let near = nearest(name, known.iter().map(|variable| variable.name.as_str()));
    let name = shortened(name);
    let reason = format!("`{name}` is not a parameter of the FMU of this model");
    Err(Failure::argument(reason).with_remedy(format!(
        "the nearest is {}; docs/reference/fmu_variables.md lists soil.*, vehicle.* and initial.*, `ugv effects` the \
         effects.*; effects with states must be on in --effects or --model",
        near.unwrap_or_default()
    )))
}
