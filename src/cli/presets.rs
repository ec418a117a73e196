//! `ugv terrains`, `ugv vehicle` and `ugv model`: the presets as JSON, to copy and edit, and what is
//! made of them.

use super::output::write_stdout;
use super::{Failure, model};
use clap::builder::PossibleValuesParser;
use std::fmt::Write;
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Vehicle, VehicleModel};

const TERRAINS_EXAMPLES: &str = "\
Examples:
  ugv terrains
  ugv terrains dry_sand > soil.json    # edit it, then: ugv simulate --terrain soil.json ...";

/// Print the preset terrains as JSON, all of them or one.
#[derive(clap::Args)]
#[command(after_help = TERRAINS_EXAMPLES)]
pub struct TerrainsArgs {
    /// Print this one alone, as --terrain takes it.
    #[arg(value_parser = PossibleValuesParser::new(Terrain::PRESETS))]
    name: Option<String>,
}

const VEHICLE_EXAMPLES: &str = "\
Examples:
  ugv vehicle > mine.json              # edit it, then: ugv simulate --vehicle mine.json ...";

/// Print the preset vehicle as JSON, as --vehicle takes it.
#[derive(clap::Args)]
#[command(after_help = VEHICLE_EXAMPLES)]
pub struct VehicleArgs {}

const MODEL_EXAMPLES: &str = "\
Examples:
  ugv model --vehicle mine.json --terrain dry_sand --effects effects.json > model.json
  ugv simulate --model model.json ...
  ugv package --model model.json";

/// Print vehicle, terrain and effects as one JSON, as --model takes it.
#[derive(clap::Args)]
#[command(after_help = MODEL_EXAMPLES)]
pub struct WholeModelArgs {
    #[command(flatten)]
    model: model::ModelArgs,
}

pub fn model(args: &WholeModelArgs) -> Result<(), Failure> {
    let specification = args.model.specification()?;
    // Refuses what does not fit together.
    VehicleModel::from_specification(&specification).map_err(Failure::Model)?;
    write_stdout(&specification.to_json())
}

pub fn terrains(args: &TerrainsArgs) -> Result<(), Failure> {
    match args.name.as_deref().and_then(Terrain::preset) {
        Some(terrain) => write_stdout(&terrain.to_json()),
        None => write_stdout(&all_terrains()),
    }
}

pub fn vehicle(_: &VehicleArgs) -> Result<(), Failure> {
    write_stdout(&Vehicle::tran2007().to_json())
}

fn all_terrains() -> String {
    let mut text = String::from("{");
    let mut comma = "\n";
    for (name, terrain) in Terrain::PRESETS
        .iter()
        .filter_map(|name| Some((name, Terrain::preset(name)?)))
    {
        let json = terrain.to_json().trim_end().replace('\n', "\n  ");
        let _ = write!(text, "{comma}  \"{name}\": {json}");
        comma = ",\n";
    }
    text + "\n}\n"
}
