//! The arguments that name a vehicle and a terrain.

use super::Failure;
use std::fs;
use std::path::{Path, PathBuf};
use ugv_terrain::spelling::nearest;
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Vehicle, VehicleModel};

/// Which vehicle drives on which terrain.
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
}

impl ModelArgs {
    /// Reads what the arguments name.
    pub fn load(&self) -> Result<VehicleModel, Failure> {
        let vehicle = match &self.vehicle {
            Some(path) => load_vehicle(path)?,
            None => Vehicle::tran2007(),
        };
        VehicleModel::new(vehicle, load_terrain(&self.terrain)?).map_err(Failure::Model)
    }
}

/// Reads a vehicle from a file.
pub fn load_vehicle(path: &Path) -> Result<Vehicle, Failure> {
    Vehicle::from_json(&read(path)?).map_err(|source| Failure::Json {
        path: path.into(),
        source,
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
    Terrain::from_json(&read(name)?).map_err(|source| Failure::Json {
        path: name.into(),
        source,
    })
}

fn read(path: &Path) -> Result<String, Failure> {
    fs::read_to_string(path).map_err(|source| Failure::Read {
        path: path.into(),
        source,
    })
}
