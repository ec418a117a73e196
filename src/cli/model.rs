//! The arguments that name a vehicle, a terrain and the effects besides the paper's physics.

use super::{Failure, tell};
use std::path::{Path, PathBuf};
use ugv_terrain::effects::{CATALOGUE, EffectKind, Effects};
use ugv_terrain::json::{FittedTo, JsonError, read_file};
use ugv_terrain::spelling::nearest;
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Specification, Vehicle};

/// Which vehicle drives on which terrain, with which effects.
#[derive(clap::Args)]
pub struct ModelArgs {
    /// Vehicle, as `ugv vehicle` prints it; a file with one under the key `vehicle` will do
    /// [default: the vehicle of the paper]
    #[arg(long, value_name = "FILE.json")]
    pub vehicle: Option<PathBuf>,

    /// Terrain: dry_sand, sandy_loam, clayed_soil, dry_clay, or a file as `ugv terrains NAME`
    /// prints it
    #[arg(long, value_name = "NAME|FILE.json", default_value = "clayed_soil")]
    pub terrain: PathBuf,

    /// Vehicle, terrain and effects in one file, as `ugv model` prints it
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["vehicle", "terrain"])]
    pub model: Option<PathBuf>,

    /// Physics that the paper leaves out, as `ugv effects NAME` prints it; takes the place of the
    /// model's effects [default: none]
    #[arg(long, value_name = "FILE.json")]
    pub effects: Option<PathBuf>,
}

impl ModelArgs {
    /// Reads what the arguments name; whether it fits together is not checked.
    pub fn specification(&self) -> Result<Specification, Failure> {
        let mut specification = match &self.model {
            Some(path) => load_model(path)?,
            None => Specification::plain(self.vehicle()?, load_terrain(&self.terrain)?),
        };
        self.replace_effects(&mut specification.effects)?;
        Ok(specification)
    }

    /// The vehicle of the arguments, where they name no model.
    pub fn vehicle(&self) -> Result<Vehicle, Failure> {
        match &self.vehicle {
            Some(path) => load_vehicle(path),
            None => Ok(Vehicle::tran2007()),
        }
    }

    /// Puts the effects of `--effects` in the place of a model's.
    pub fn replace_effects(&self, effects: &mut Effects) -> Result<(), Failure> {
        if let Some(path) = &self.effects {
            let own = load_effects(path)?;
            if let (Some(model), false) = (&self.model, *effects == Effects::NONE) {
                tell(&format!(
                    "note: the effects of {} take the place of those in {} ({})",
                    path.display(),
                    model.display(),
                    names(effects, EffectKind::Physics).unwrap_or("all of them off".into())
                ));
            }
            *effects = own;
        }
        tell_of_sensors(effects);
        Ok(())
    }

    /// The files that the arguments name.
    pub fn files(&self) -> Vec<PathBuf> {
        let named = [&self.vehicle, &self.model, &self.effects];
        let named = named.into_iter().flatten().chain([&self.terrain]);
        named.filter(|path| path.exists()).cloned().collect()
    }

    /// What the vehicle drives on, for people: the terrain's name or the model's file.
    pub fn ground(&self) -> String {
        self.model
            .as_ref()
            .unwrap_or(&self.terrain)
            .to_string_lossy()
            .into_owned()
    }
}

/// Says that what is of the sensors moves nothing.
pub fn tell_of_sensors(effects: &Effects) {
    if let Some(names) = names(effects, EffectKind::Measurement) {
        let change = if names.contains(',') {
            "change"
        } else {
            "changes"
        };
        tell(&format!(
            "note: {names} {change} what sensors report, not how the vehicle moves; left out here"
        ));
    }
}

/// Leaves out what is of the sensors, and says so: a fit has numbers of its own for it.
pub fn without_sensors(effects: &mut Effects) -> Result<(), Failure> {
    tell_of_sensors(effects);
    for effect in CATALOGUE
        .iter()
        .filter(|e| e.kind == EffectKind::Measurement)
    {
        for parameter in effect.parameters {
            let name = format!("{}.{}", effect.name, parameter.name);
            *effects = effects
                .clone()
                .with(&name, parameter.default)
                .map_err(Failure::Model)?;
        }
    }
    Ok(())
}

/// The effects of a kind that are on, if any is.
pub fn names(effects: &Effects, kind: EffectKind) -> Option<String> {
    let names: Vec<&str> = effects.on(kind).map(|effect| effect.name).collect();
    (!names.is_empty()).then(|| names.join(", "))
}

/// Reads a vehicle from a file.
pub fn load_vehicle(path: &Path) -> Result<Vehicle, Failure> {
    read(path, Vehicle::from_json)
}

/// Reads vehicle, terrain and effects from a file.
pub fn load_model(path: &Path) -> Result<Specification, Failure> {
    read(path, Specification::from_json)
}

/// As [`load_model`], with what the model was fitted to.
pub fn load_fitted(path: &Path) -> Result<(Specification, Vec<FittedTo>), Failure> {
    read(path, |text| {
        Ok((Specification::from_json(text)?, FittedTo::from_json(text)))
    })
}

/// Reads effects from a file.
pub fn load_effects(path: &Path) -> Result<Effects, Failure> {
    read(path, Effects::from_json)
}

/// Refuses effects that depend on when a drive began, where its pieces are looked at one by one.
pub fn check_piecewise(effects: &Effects) -> Result<(), Failure> {
    if !effects.depend_on_beginning() {
        return Ok(());
    }
    Err(Failure::Argument {
        reason:
            "effects over the time or the distance driven do not fit pieces of a drive, each with \
                 a beginning of its own"
                .into(),
        hint: Some(
            "say where on the map the slope or the boundary lies: \"over\": \"place\"; a window's \
             \"place\" may stand for its \"time\""
                .into(),
        ),
    })
}

/// Takes a preset by its name, or reads a terrain from a file.
pub fn load_terrain(name: &Path) -> Result<Terrain, Failure> {
    if let Some(terrain) = name.to_str().and_then(Terrain::preset) {
        return Ok(terrain);
    }
    if !name.exists() {
        let presets = Terrain::PRESETS;
        let meant = nearest(&name.to_string_lossy(), presets).unwrap_or_default();
        return Err(Failure::Argument {
            reason: format!(
                "--terrain {}: no such file, and no preset terrain (these are {})",
                name.display(),
                presets.join(", ")
            ),
            hint: Some(format!("the nearest preset is --terrain {meant}")),
        });
    }
    read(name, Terrain::from_json)
}

fn read<T>(path: &Path, parse: impl Fn(&str) -> Result<T, JsonError>) -> Result<T, Failure> {
    let text = read_file(path).map_err(|source| Failure::Read {
        path: path.into(),
        source,
    })?;
    parse(&text).map_err(|source| Failure::Json {
        path: path.into(),
        source,
    })
}
