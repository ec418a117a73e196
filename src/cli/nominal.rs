//! The model that recordings are compared with: what the arguments name, or the recordings.

use super::model::{
    check_piecewise, load_effects, load_model, load_terrain, load_vehicle, without_sensors,
};
use super::{Failure, tell};
use std::path::PathBuf;
use ugv_terrain::effects::Effects;
use ugv_terrain::json::FittedTo;
use ugv_terrain::recording::{Recording, different_names, read_recording_of};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Specification, Vehicle};

/// Which model; what is not named comes from what stands beside the recordings.
#[derive(clap::Args)]
pub struct NominalArgs {
    /// Vehicle [default: that of the recordings, or else the paper's]
    #[arg(long, value_name = "FILE.json")]
    vehicle: Option<PathBuf>,

    /// Terrain to begin with: a preset or a file
    /// [default: that of the recordings, or else clayed_soil]
    #[arg(long, value_name = "NAME|FILE.json")]
    terrain: Option<PathBuf>,

    /// Vehicle, terrain and effects to begin with, as `ugv model` prints it
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["vehicle", "terrain"])]
    model: Option<PathBuf>,

    /// Physics that the paper leaves out, as `ugv effects NAME` prints it [default: the model's]
    #[arg(long, value_name = "FILE.json")]
    effects: Option<PathBuf>,
}

/// What the arguments name.
pub struct NominalModel {
    model: Option<Specification>,
    vehicle: Option<Vehicle>,
    terrain: Option<Terrain>,
    effects: Option<Effects>,
}

impl NominalArgs {
    /// Reads the files that the arguments name.
    pub fn load(&self) -> Result<NominalModel, Failure> {
        Ok(NominalModel {
            model: self.model.as_deref().map(load_model).transpose()?,
            vehicle: self.vehicle.as_deref().map(load_vehicle).transpose()?,
            terrain: self.terrain.as_deref().map(load_terrain).transpose()?,
            effects: self.effects.as_deref().map(load_effects).transpose()?,
        })
    }

    /// The files that the arguments name.
    pub fn files(&self) -> Vec<PathBuf> {
        let named = [&self.vehicle, &self.terrain, &self.model, &self.effects];
        let named = named.into_iter().flatten();
        named.filter(|path| path.exists()).cloned().collect()
    }
}

impl NominalModel {
    /// Reads recordings, with what stands beside them; no two of one name. Units of wheel speeds are seen by the vehicle that
    /// is named here where none stands beside them.
    pub fn read(&self, paths: &[PathBuf]) -> Result<Vec<Recording>, Failure> {
        let of_model = self.model.as_ref().map(|model| &model.vehicle);
        let vehicle = of_model.or(self.vehicle.as_ref());
        let each = paths.iter().map(|path| read_recording_of(path, vehicle));
        let recordings: Vec<Recording> = each
            .collect::<Result<_, _>>()
            .map_err(Failure::ReadRecording)?;
        different_names(recordings.iter().map(|one| one.name.as_str()))
            .map_err(Failure::SameName)?;
        Ok(recordings)
    }

    /// Whether nobody named a vehicle: neither an argument nor a recording.
    pub fn lacks_vehicle(&self, recordings: &[Recording]) -> bool {
        let mut recordings = recordings.iter();
        self.model.is_none()
            && self.vehicle.is_none()
            && recordings.all(|recording| recording.about.vehicle.is_none())
    }

    /// What is named, or stands beside the recordings, or else the paper's.
    pub fn nominal(self, recordings: &[Recording], quiet: bool) -> Result<Specification, Failure> {
        let mut nominal = match self.model {
            Some(model) => model,
            None => {
                let vehicle = match self.vehicle {
                    Some(vehicle) => vehicle,
                    None => recorded_vehicle(recordings, quiet)?,
                };
                let terrain = match self.terrain {
                    Some(terrain) => terrain,
                    None => recorded_terrain(recordings, quiet)?,
                };
                Specification::plain(vehicle, terrain)
            }
        };
        if let Some(effects) = self.effects {
            nominal.effects = effects;
        }
        check_piecewise(&nominal.effects)?;
        without_sensors(&mut nominal.effects)?;
        Ok(nominal)
    }
}

/// That of the first recording that tells one: the others drive on the same, or so the fit has it.
fn recorded_terrain(recordings: &[Recording], quiet: bool) -> Result<Terrain, Failure> {
    let told = |recording: &&Recording| recording.about.terrain.is_some();
    let Some(first) = recordings.iter().find(told) else {
        return load_terrain("clayed_soil".as_ref());
    };
    let differs = |other: &&Recording| other.about.terrain != first.about.terrain;
    let other = recordings.iter().filter(told).find(differs);
    if let Some(other) = other.filter(|_| !quiet) {
        tell(&format!(
            "note: {} and {} tell different terrains; beginning with that of {} for all (see --terrain)",
            first.name, other.name, first.name
        ));
    }
    match first.about.terrain {
        Some(terrain) => Ok(terrain),
        None => load_terrain("clayed_soil".as_ref()),
    }
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
            hint: Some("take them one by one, or say which vehicle it was with --vehicle".into()),
        }),
        None => Ok(vehicle.clone()),
    }
}

/// What a model is fitted to, as its file tells.
pub fn fitted_to(recordings: &[Recording], whole: bool) -> Vec<FittedTo> {
    let one = |recording: &Recording| FittedTo {
        recording: recording.name.clone(),
        whole,
    };
    recordings.iter().map(one).collect()
}
