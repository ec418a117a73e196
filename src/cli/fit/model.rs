//! The model to begin with.

use super::Args;
use crate::cli::model::{load_terrain, load_vehicle};
use crate::cli::{Failure, tell};
use ugv_terrain::recording::Recording;
use ugv_terrain::vehicle::{Specification, Vehicle};

/// What the arguments name, or the recordings, or else the paper.
pub fn nominal(args: &Args, recordings: &[Recording]) -> Result<Specification, Failure> {
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
    Ok(Specification::plain(vehicle, terrain))
}

fn recorded_vehicle(recordings: &[Recording], quiet: bool) -> Result<Vehicle, Failure> {
    let mut told = recordings
        .iter()
        .filter_map(|r| Some((r, r.about.vehicle.as_ref()?)));
    let Some((first, vehicle)) = told.next() else {
        if !quiet {
            tell(
                "note: no vehicle is told beside the recordings; taking the paper's (see --vehicle)",
            );
        }
        return Ok(Vehicle::tran2007());
    };
    match told.find(|(_, other)| *other != vehicle) {
        Some((other, _)) => Err(Failure::Argument {
            reason: format!(
                "{} and {} were driven by different vehicles",
                first.name, other.name
            ),
            hint: Some("fit them one by one, or say which vehicle it was with --vehicle".into()),
        }),
        None => Ok(vehicle.clone()),
    }
}
