//! The arguments that name a vehicle, a terrain and effects beyond the paper's physics.

use super::failure::Failure;
use super::output::notify;
use crate::effects::{CATALOGUE, EffectKind, Effects};
use crate::import::Preset;
use crate::json::{FittedTo, JsonError, read_file};
use crate::spelling::nearest;
use crate::terrain::Terrain;
use crate::vehicle::{Specification, Vehicle};
use std::path::{Path, PathBuf};

/// The vehicle, the terrain and the effects of a simulation.
#[derive(clap::Args)]
pub struct ModelArgs {
    /// Vehicle: tran2007 (of the paper), husky, jackal, warthog, scout, or a file as printed by
    /// `ugv vehicle`, or with one under the key `vehicle` [default: tran2007]
    #[arg(long, value_name = "NAME|FILE.json")]
    pub vehicle: Option<PathBuf>,

    /// Terrain: dry_sand, sandy_loam, clayed_soil, dry_clay, or a file as printed by
    /// `ugv terrains NAME`
    #[arg(long, value_name = "NAME|FILE.json", default_value = "clayed_soil")]
    pub terrain: PathBuf,

    /// Vehicle, terrain and effects in one file, as printed by `ugv model`
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["vehicle", "terrain"])]
    pub model: Option<PathBuf>,

    /// Effects beyond the paper's physics, as printed by `ugv effects NAME`; they replace those of
    /// the model [default: none]
    #[arg(long, value_name = "FILE.json")]
    pub effects: Option<PathBuf>,
}

impl ModelArgs {
    /// Reads the files, without a check that vehicle and terrain fit together.
    pub fn specification(&self) -> Result<Specification, Failure> {
        let mut specification = match &self.model {
            Some(path) => load_model(path)?,
            None => Specification::plain(self.vehicle()?, load_terrain(&self.terrain)?),
        };
        self.replace_effects(&mut specification.effects)?;
        Ok(specification)
    }

    /// The vehicle of the arguments that name no model.
    pub fn vehicle(&self) -> Result<Vehicle, Failure> {
        match &self.vehicle {
            Some(path) => load_vehicle(path),
            None => Ok(Vehicle::tran2007()),
        }
    }

    /// Replaces the effects of a model by those of `--effects`.
    pub fn replace_effects(&self, effects: &mut Effects) -> Result<(), Failure> {
        if let Some(path) = &self.effects {
            let named = load_effects(path)?;
            if let (Some(model), false) = (&self.model, *effects == Effects::NONE) {
                notify(&format!(
                    "note: the effects of {} replace those of {} ({})",
                    path.display(),
                    model.display(),
                    names(effects, EffectKind::Physics).unwrap_or("all off".into())
                ));
            }
            *effects = named;
        }
        note_sensors(effects);
        Ok(())
    }

    /// The files that the arguments name.
    pub fn files(&self) -> Vec<PathBuf> {
        let named = [&self.vehicle, &self.model, &self.effects];
        let named = named.into_iter().flatten().chain([&self.terrain]);
        named.filter(|path| path.exists()).cloned().collect()
    }

    /// A name of the ground for people: the terrain's name or the model's file.
    pub fn ground(&self) -> String {
        self.model
            .as_ref()
            .unwrap_or(&self.terrain)
            .to_string_lossy()
            .into_owned()
    }
}

/// Notes that effects of the sensors do not change the motion.
fn note_sensors(effects: &Effects) {
    if let Some(names) = names(effects, EffectKind::Measurement) {
        notify(&format!(
            "note: these effects change what sensors report, not the motion, and are ignored here: {names}"
        ));
    }
}

/// Drops the effects of the sensors, with a note: a fit has parameters for them.
pub fn drop_sensors(effects: &mut Effects) -> Result<(), Failure> {
    note_sensors(effects);
    let sensors = CATALOGUE
        .iter()
        .filter(|effect| effect.kind == EffectKind::Measurement);
    for effect in sensors {
        for parameter in effect.parameters {
            let name = format!("{}.{}", effect.name, parameter.name);
            *effects = effects.clone().with(&name, parameter.default)?;
        }
    }
    Ok(())
}

/// The effects of a kind that are on, if any is.
pub fn names(effects: &Effects, kind: EffectKind) -> Option<String> {
    let names: Vec<&str> = effects.on(kind).map(|effect| effect.name).collect();
    (!names.is_empty()).then(|| names.join(", "))
}

/// Name of the paper's vehicle.
pub const PAPER: &str = "tran2007";

/// The names of all preset vehicles.
pub fn vehicle_names() -> impl Iterator<Item = &'static str> {
    std::iter::once(PAPER).chain(Preset::NAMES)
}

/// A preset vehicle by its name.
pub fn preset_vehicle(name: &str) -> Option<Vehicle> {
    if name == PAPER {
        return Some(Vehicle::tran2007());
    }
    Preset::of_name(name).map(Preset::vehicle)
}

/// Takes a preset by its name, or reads a vehicle from a file.
pub fn load_vehicle(name: &Path) -> Result<Vehicle, Failure> {
    let text = name.to_string_lossy();
    if let Some(vehicle) = preset_vehicle(&text) {
        return Ok(vehicle);
    }
    if name.extension().is_none() && !name.exists() {
        let presets: Vec<&str> = vehicle_names().collect();
        let meant = nearest(&text, presets.iter().copied()).unwrap_or_default();
        let reason = format!(
            "--vehicle {text}: no such file, and no preset vehicle (these are {})",
            presets.join(", ")
        );
        return Err(Failure::argument(reason)
            .with_remedy(format!("the nearest preset is --vehicle {meant}")));
    }
    read(name, Vehicle::from_json)
}

/// Reads vehicle, terrain and effects from a file.
pub fn load_model(path: &Path) -> Result<Specification, Failure> {
    read(path, Specification::from_json)
}

/// As [`load_model`], with the recordings that the model was fitted to.
pub fn load_fitted(path: &Path) -> Result<(Specification, Vec<FittedTo>), Failure> {
    read(path, |text| {
        Ok((Specification::from_json(text)?, FittedTo::from_json(text)))
    })
}

/// Reads effects from a file.
pub fn load_effects(path: &Path) -> Result<Effects, Failure> {
    read(path, Effects::from_json)
}

/// Refuses effects that depend on the start of a drive: commands that cut a drive into pieces do not know it.
pub fn check_piecewise(effects: &Effects) -> Result<(), Failure> {
    if !effects.depend_on_beginning() {
        return Ok(());
    }
    let reason =
        "effects over time or distance driven do not fit pieces of a drive, which start anywhere";
    Err(Failure::argument(reason).with_remedy(
        "give the slope or the boundary a place on the map: \"over\": \"place\"; a window can have a \"place\" \
         instead of a \"time\"",
    ))
}

/// Takes a preset by its name, or reads a terrain from a file.
pub fn load_terrain(name: &Path) -> Result<Terrain, Failure> {
    if let Some(terrain) = name.to_str().and_then(Terrain::preset) {
        return Ok(terrain);
    }
    if !name.exists() {
        let presets = Terrain::PRESETS;
        let meant = nearest(&name.to_string_lossy(), presets).unwrap_or_default();
        let reason = format!(
            "--terrain {}: no such file, and no preset terrain (these are {})",
            name.display(),
            presets.join(", ")
        );
        return Err(Failure::argument(reason)
            .with_remedy(format!("the nearest preset is --terrain {meant}")));
    }
    read(name, Terrain::from_json)
}

fn read<T>(path: &Path, parse: impl Fn(&str) -> Result<T, JsonError>) -> Result<T, Failure> {
    let text = read_file(path).map_err(Failure::read(path))?;
    parse(&text).map_err(|source| Failure::Json {
        path: path.into(),
        source,
    })
}
