//! The model to begin with, and the fitted one as a file.

use super::Args;
use crate::cli::model::{load_terrain, load_vehicle};
use crate::cli::{Failure, tell};
use serde_json::{Map, Value, json};
use ugv_terrain::fit::Fit;
use ugv_terrain::fit::catalogue::Nominal;
use ugv_terrain::recording::Recording;
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::Vehicle;

/// What the arguments name, or the recordings, or else the paper.
pub fn nominal(args: &Args, recordings: &[Recording]) -> Result<Nominal, Failure> {
    let vehicle = match &args.vehicle {
        Some(path) => load_vehicle(path)?,
        None => recorded_vehicle(recordings, args.quiet)?,
    };
    let terrain = match &args.terrain {
        Some(path) => load_terrain(path)?,
        None => match recordings.iter().find_map(|r| r.about.terrain) {
            Some(terrain) => terrain,
            None => load_terrain("clayed_soil".as_ref())?,
        },
    };
    Ok(Nominal { vehicle, terrain })
}

fn recorded_vehicle(recordings: &[Recording], quiet: bool) -> Result<Vehicle, Failure> {
    let mut told = recordings.iter().filter_map(|r| Some((r, r.about.vehicle.as_ref()?)));
    let Some((first, vehicle)) = told.next() else {
        if !quiet {
            tell("note: no vehicle is told beside the recordings; taking the paper's (see --vehicle)");
        }
        return Ok(Vehicle::tran2007());
    };
    match told.find(|(_, other)| *other != vehicle) {
        Some((other, _)) => Err(Failure::Argument {
            reason: format!("{} and {} were driven by different vehicles", first.name, other.name),
            hint: Some("fit them one by one, or say which vehicle it was with --vehicle".into()),
        }),
        None => Ok(vehicle.clone()),
    }
}

/// The fitted model with its intervals, in SI units and radians; the friction angle of the
/// terrain in degrees as in every terrain's file.
pub fn to_json(model: &Nominal, fitted: &Fit) -> String {
    let intervals: Map<String, Value> = fitted.estimates[..fitted.model_parameters]
        .iter()
        .map(|estimate| {
            let interval = json!({
                "value": estimate.value, "low": estimate.low, "high": estimate.high,
                "unit": estimate.parameter.unit,
            });
            (estimate.parameter.name.clone(), interval)
        })
        .collect();
    let document = json!({
        "vehicle": parsed(&model.vehicle.to_json()),
        "terrain": terrain(&model.terrain),
        "fitted": intervals,
    });
    format!("{document:#}\n")
}

pub fn terrain(terrain: &Terrain) -> Value {
    parsed(&terrain.to_json())
}

fn parsed(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_default()
}
