//! The model that recordings are compared with: from the arguments, or from the JSON files beside the recordings.

use super::columns::ColumnArgs;
use super::failure::Failure;
use super::log::LogArgs;
use super::model::{
    check_piecewise, drop_sensors, load_effects, load_fitted, load_terrain, load_vehicle,
    vehicle_names,
};
use super::recordings;
use crate::effects::Effects;
use crate::import::ImportOptions;
use crate::json::FittedTo;
use crate::recording::{ColumnRequest, Recording, different_names};
use crate::report::diagnosis::Source;
use crate::terrain::Terrain;
use crate::vehicle::{Specification, Vehicle};
use std::path::PathBuf;

/// Name of the terrain that is assumed if nothing names one.
pub const DEFAULT_TERRAIN: &str = "clayed_soil";

/// What the JSON file beside a recording has for its vehicle.
const SIDECAR: &str = r#"{"vehicle": {"mass": .., "yaw_inertia": .., "wheel_radius": .., "wheel_width": .., "row_positions": [..], "half_track": .., "com_offset": .., "com_height": ..}}"#;

/// The files of a model.
#[derive(clap::Args)]
pub struct NominalArgs {
    /// Vehicle: a file as printed by `ugv vehicle`, or tran2007 (the paper's), husky, jackal,
    /// warthog, scout [default: that of the JSON file beside a recording; without one it is required]
    #[arg(long, value_name = "NAME|FILE.json")]
    vehicle: Option<PathBuf>,

    /// Terrain, a preset or a file; a fit starts from it
    /// [default: that of the recordings, or else clayed_soil]
    #[arg(long, value_name = "NAME|FILE.json")]
    terrain: Option<PathBuf>,

    /// Vehicle, terrain and effects in one file, as printed by `ugv fit` and `ugv model`
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["vehicle", "terrain"])]
    model: Option<PathBuf>,

    /// Effects beyond the paper's physics, as printed by `ugv effects NAME` [default: the model's]
    #[arg(long, value_name = "FILE.json")]
    effects: Option<PathBuf>,

    #[command(flatten)]
    columns: ColumnArgs,

    #[command(flatten)]
    log: LogArgs,
}

/// What the arguments name.
pub struct NamedModel {
    pub vehicle: Option<Vehicle>,
    pub terrain: Option<Terrain>,
    pub effects: Option<Effects>,
    /// What a model from one file was fitted to.
    pub fitted_to: Vec<FittedTo>,
    /// Columns of recordings that have another name or unit.
    pub columns: Vec<ColumnRequest>,
    /// How robots' logs are imported.
    pub log: ImportOptions,
}

impl NominalArgs {
    /// Refuses options that apply to none of the recordings.
    pub fn check(&self, recordings: &[PathBuf]) -> Result<(), Failure> {
        self.log.check(recordings)
    }

    /// Reads the files.
    pub fn load(&self) -> Result<NamedModel, Failure> {
        let mut named = NamedModel {
            vehicle: self.vehicle.as_deref().map(load_vehicle).transpose()?,
            terrain: self.terrain.as_deref().map(load_terrain).transpose()?,
            effects: self.effects.as_deref().map(load_effects).transpose()?,
            fitted_to: Vec::new(),
            columns: self.columns.columns.clone(),
            log: self.log.options(),
        };
        if let Some(path) = &self.model {
            let (model, fitted_to) = load_fitted(path)?;
            named.fitted_to = fitted_to;
            named.vehicle = Some(model.vehicle);
            named.terrain = Some(model.terrain);
            named.effects.get_or_insert(model.effects);
        }
        if let Some(effects) = &mut named.effects {
            check_piecewise(effects)?;
            drop_sensors(effects)?;
        }
        Ok(named)
    }

    /// The arguments and their values, for people.
    pub fn describe(&self) -> String {
        let arguments = [
            ("vehicle", &self.vehicle),
            ("terrain", &self.terrain),
            ("model", &self.model),
            ("effects", &self.effects),
        ];
        let named = arguments
            .iter()
            .filter_map(|(key, path)| Some(format!("{key} {}", path.as_ref()?.display())));
        named.collect::<Vec<_>>().join(", ")
    }

    /// Where vehicle and terrain are from.
    pub fn sources(&self, recordings: &[Recording]) -> [Source; 2] {
        let source =
            |argument: &Option<PathBuf>, is_recorded: fn(&Recording) -> bool| match argument
                .as_ref()
                .or(self.model.as_ref())
            {
                Some(path) => Source::Named(path.display().to_string()),
                None if recordings.iter().any(is_recorded) => Source::Recorded,
                None => Source::Assumed,
            };
        // The sidecar of a log with a vehicle has precedence, and says the same or better.
        let preset = self.log.preset().filter(|preset| {
            let of_preset = |one: &Recording| one.about.vehicle.as_ref() == Some(&preset.vehicle());
            recordings.iter().all(of_preset)
        });
        let vehicle = match (preset, &self.vehicle, &self.model) {
            (Some(preset), None, None) => Source::Named(format!("--preset {}", preset.name())),
            _ => source(&self.vehicle, |one| one.about.vehicle.is_some()),
        };
        [
            vehicle,
            source(&self.terrain, |one| one.about.terrain.is_some()),
        ]
    }

    /// The files that the arguments name. The name of a preset terrain is not a file.
    pub fn files(&self) -> Vec<PathBuf> {
        let named = [&self.vehicle, &self.terrain, &self.model, &self.effects];
        let named = named.into_iter().flatten();
        named.filter(|path| path.exists()).cloned().collect()
    }
}

impl NamedModel {
    /// Reads recordings of different names, with the JSON files beside them. Units of wheel speeds are recognised by
    /// the vehicle of the JSON file, or else by the named one. What the user has to know is added to the notes.
    pub fn read(
        &self,
        paths: &[PathBuf],
        notes: &mut Vec<String>,
    ) -> Result<Vec<Recording>, Failure> {
        let vehicle = self.vehicle.as_ref();
        let mut recordings = Vec::new();
        for path in paths {
            let (recording, imported) = recordings::read(path, vehicle, &self.columns, &self.log)?;
            notes.extend(imported);
            recordings.push(recording);
        }
        different_names(recordings.iter().map(|one| one.name.as_str()))?;
        notes.extend(recordings.iter().flat_map(Recording::warnings));
        Ok(recordings)
    }

    /// Refuses recordings of an unknown vehicle: a wrong mass or track looks like missing physics.
    ///
    /// # Errors
    /// Says how a vehicle is named, if neither the arguments nor the recordings do.
    pub fn check_vehicle<'a>(
        &self,
        recordings: impl IntoIterator<Item = &'a Recording>,
    ) -> Result<(), Failure> {
        let recordings: Vec<&Recording> = recordings.into_iter().collect();
        let is_known = |one: &&Recording| one.about.vehicle.is_some();
        if self.vehicle.is_some() || recordings.iter().any(is_known) {
            return Ok(());
        }
        Err(no_vehicle(&recordings))
    }

    /// What the arguments name, or else the recordings, or else the paper's soil; notes say what was chosen.
    ///
    /// # Errors
    /// As [`NamedModel::check_vehicle`], and recordings of different vehicles.
    pub fn nominal(
        self,
        recordings: &[Recording],
        notes: &mut Vec<String>,
    ) -> Result<Specification, Failure> {
        self.check_vehicle(recordings)?;
        Ok(Specification {
            vehicle: match self.vehicle {
                Some(vehicle) => vehicle,
                None => recorded_vehicle(recordings)?,
            },
            terrain: match self.terrain {
                Some(terrain) => terrain,
                None => recorded_terrain(recordings, notes)?,
            },
            effects: self.effects.unwrap_or_default(),
        })
    }
}

/// Nobody names the vehicle of these recordings.
pub fn no_vehicle(recordings: &[&Recording]) -> Failure {
    let names = recordings.iter().map(|one| format!("{}.json", one.name));
    let names: Vec<String> = names.collect();
    let reason = format!(
        "no vehicle: there is no --vehicle or --model, and no {} with the key `vehicle`",
        names.join(" or ")
    );
    Failure::argument(reason).with_remedy(format!(
        "--vehicle mine.json (`ugv vehicle > mine.json` prints one to edit), or --vehicle {}; or {SIDECAR} in the \
         JSON file beside the recording",
        vehicle_names().collect::<Vec<_>>().join("|")
    ))
}

/// The terrain of the first recording that has one: a fit assumes one soil for all.
fn recorded_terrain(recordings: &[Recording], notes: &mut Vec<String>) -> Result<Terrain, Failure> {
    let mut named = recordings
        .iter()
        .filter_map(|r| Some((r, r.about.terrain?)));
    let Some((first, terrain)) = named.next() else {
        return load_terrain(DEFAULT_TERRAIN.as_ref());
    };
    if let Some((other, _)) = named.find(|(_, other)| *other != terrain) {
        notes.push(format!(
            "note: {} and {} have different terrains; the fit starts from that of {} for all (see --terrain)",
            first.name, other.name, first.name
        ));
    }
    Ok(terrain)
}

/// The one vehicle of all recordings that name one.
fn recorded_vehicle(recordings: &[Recording]) -> Result<Vehicle, Failure> {
    let mut named = recordings
        .iter()
        .filter_map(|r| Some((r, r.about.vehicle.as_ref()?)));
    let Some((first, vehicle)) = named.next() else {
        return Err(no_vehicle(&recordings.iter().collect::<Vec<_>>()));
    };
    match named.find(|(_, other)| *other != vehicle) {
        Some((other, _)) => {
            let (one, other) = (&first.name, &other.name);
            Err(
                Failure::argument(format!("{one} and {other} have different vehicles"))
                    .with_remedy("give them one by one, or name the vehicle with --vehicle"),
            )
        }
        None => Ok(vehicle.clone()),
    }
}

/// What a model is fitted to, for its file.
pub fn fitted_to(recordings: &[Recording], whole: bool) -> Vec<FittedTo> {
    let one = |recording: &Recording| FittedTo {
        recording: recording.name.clone(),
        whole,
    };
    recordings.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_remedy_names_every_key_of_a_vehicle() {
        let vehicle = Vehicle::tran2007().to_json();
        let vehicle: serde_json::Map<String, serde_json::Value> =
            serde_json::from_str(&vehicle).unwrap();
        for key in vehicle.keys() {
            assert!(SIDECAR.contains(&format!("\"{key}\"")), "{key}");
        }
    }
}
