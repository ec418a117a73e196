//! `ugv terrains`, `ugv vehicle` and `ugv model`: presets and models as JSON, to copy and edit.

use super::destination::PrintArgs;
use super::failure::Failure;
use super::model::{ModelArgs, PAPER, preset_vehicle, vehicle_names};
use super::output::notify;
use crate::import::Preset;
use crate::terrain::Terrain;
use crate::vehicle::{Vehicle, VehicleModel};
use clap::builder::PossibleValuesParser;

const TERRAINS_EXAMPLES: &str = "\
Examples:
  ugv terrains
  ugv terrains dry_sand > soil.json    # edit it, then: ugv simulate --terrain soil.json ...";

/// Print the preset terrains as JSON.
#[derive(clap::Args)]
#[command(after_help = TERRAINS_EXAMPLES)]
pub struct TerrainsArgs {
    /// Print this one, as --terrain takes it.
    #[arg(value_parser = PossibleValuesParser::new(Terrain::PRESETS))]
    name: Option<String>,

    #[command(flatten)]
    print: PrintArgs,
}

const VEHICLE_EXAMPLES: &str = "\
Examples:
  ugv vehicle > mine.json              # edit it, then: ugv simulate --vehicle mine.json ...
  ugv vehicle husky > husky.json       # without payload: add its mass and inertia";

/// Print a preset vehicle as JSON, as --vehicle takes it.
#[derive(clap::Args)]
#[command(after_help = VEHICLE_EXAMPLES)]
pub struct VehicleArgs {
    /// Print this one: the paper's, or one by its maker's published model
    #[arg(default_value = PAPER, value_parser = PossibleValuesParser::new(vehicle_names()))]
    name: String,

    #[command(flatten)]
    print: PrintArgs,
}

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
    model: ModelArgs,

    #[command(flatten)]
    print: PrintArgs,
}

pub fn model(args: &WholeModelArgs) -> Result<(), Failure> {
    let specification = args.model.specification()?;
    // Refuses a vehicle and a terrain that do not fit together.
    VehicleModel::from_specification(&specification)?;
    args.print.write(&specification.to_json())
}

pub fn terrains(args: &TerrainsArgs) -> Result<(), Failure> {
    match args.name.as_deref().and_then(Terrain::preset) {
        Some(terrain) => args.print.write(&terrain.to_json()),
        None => args.print.write(&all_terrains()),
    }
}

pub fn vehicle(args: &VehicleArgs) -> Result<(), Failure> {
    if let Some(preset) = Preset::of_name(&args.name) {
        notify(&format!("note: {}", preset.source()));
    }
    let vehicle = preset_vehicle(&args.name).unwrap_or_else(Vehicle::tran2007);
    args.print.write(&vehicle.to_json())
}

fn all_terrains() -> String {
    let terrains = Terrain::PRESETS.iter().filter_map(|name| {
        let json = Terrain::preset(name)?.to_json();
        let json = json.trim_end().replace('\n', "\n  ");
        Some(format!("  \"{name}\": {json}"))
    });
    format!("{{\n{}\n}}\n", terrains.collect::<Vec<_>>().join(",\n"))
}
