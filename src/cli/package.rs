//! `ugv package`: makes an FMU of a vehicle on a terrain.

use super::destination::{ForceArgs, JsonArgs};
use super::failure::Failure;
use super::model::{ModelArgs, load_terrain};
use super::output::{Output, finish_all, notify};
use crate::declaration::Configuration;
use crate::package::{MergeError, PackageError, Platform, Standard, merge_fmus, write_fmu};
use crate::terrain::Terrain;
use crate::vehicle::VehicleModel;
use serde_json::{Value, json};
use std::fs::File;
use std::io::{self, BufReader, Cursor, Read, Write};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  ugv package
  ugv package --vehicle mine.json --terrain soil.json --output mine.fmu
  ugv package --model model.json
  ugv package --fmi 3
  ugv package --library linux64=target/fmu/ugv.so --library win64=target/fmu/win64/ugv.dll
  ugv package --merge linux.fmu mac.fmu --output ugv.fmu";

/// Make an FMU of a vehicle on a terrain.
///
/// Every FMU has the four terrains of the paper; its parameter `terrain` selects one. A terrain from
/// a file or a model is its custom one. An effect with states that depend on the path makes the FMU
/// one for co-simulation alone (transient_shear, multipass, effects over the distance driven), and so
/// does a window on the map.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    #[command(flatten)]
    model: ModelArgs,

    /// Version of the standard; in FMI 3 the quantities of rows and wheels are arrays
    #[arg(
        long,
        value_name = "VERSION",
        value_parser = ["2", "3"],
        default_value = "2",
        overrides_with = "fmi"
    )]
    fmi: String,

    /// The FMU to write [default: ugv.fmu, or ugv-fmi3.fmu with --fmi 3]
    #[arg(long, short, value_name = "FILE.fmu", overrides_with = "output")]
    output: Option<PathBuf>,

    /// Shared library of a platform (linux64, win64, darwin64, aarch64-linux), once for each
    /// [default: the ugv.so that scripts/package.sh built]
    #[arg(long, value_name = "PLATFORM=FILE", value_parser = library)]
    library: Vec<(Platform, PathBuf)>,

    /// FMUs of one model for different platforms, to merge into one FMU; they may differ in their
    /// libraries only
    #[arg(
        long,
        value_name = "FILE.fmu",
        num_args = 2..,
        requires = "output",
        conflicts_with_all = ["fmi", "library", "vehicle", "terrain", "model", "effects"]
    )]
    merge: Vec<PathBuf>,

    #[command(flatten)]
    json: JsonArgs,

    #[command(flatten)]
    replace: ForceArgs,
}

/// Parses PLATFORM=FILE.
fn library(text: &str) -> Result<(Platform, PathBuf), String> {
    let library = text.split_once('=').and_then(|(name, path)| {
        let mut platforms = Platform::ALL.into_iter();
        let platform = platforms.find(|platform| platform.name() == name)?;
        Some((platform, path.into()))
    });
    library.ok_or_else(|| {
        let names = Platform::ALL.map(Platform::name).join(", ");
        format!("expected PLATFORM=FILE with a PLATFORM of {names}")
    })
}

pub fn run(args: &Args) -> Result<(), Failure> {
    if !args.merge.is_empty() {
        return merge(args);
    }
    let configuration = configuration(args)?;
    let files = libraries(&args.library)?;
    let mut libraries = Vec::new();
    for (platform, path) in &files {
        libraries.push((*platform, read(path)?));
    }
    let (standard, default) = match args.fmi.as_str() {
        "3" => (Standard::Fmi3, "ugv-fmi3.fmu"),
        _ => (Standard::Fmi2, "ugv.fmu"),
    };
    let path = args.output.as_deref().unwrap_or(Path::new(default));
    let mut inputs = args.model.files();
    inputs.extend(files.into_iter().map(|(_, path)| path));
    let force = args.replace.force;
    let output = Output::from_inputs(Some(path), &inputs, force)?;
    let json = args.json.output(&inputs, force)?;
    check_distinct(json.as_ref(), &output)?;
    let mut fmu = Cursor::new(Vec::new());
    let written = write_fmu(&mut fmu, standard, &configuration, &libraries);
    written.map_err(|error| match error {
        PackageError::Write(source) => output.failure(source),
        other => Failure::argument(other.to_string())
            .with_remedy("rebuild the library with scripts/package.sh"),
    })?;
    let platforms: Vec<&str> = libraries
        .iter()
        .map(|(platform, _)| platform.name())
        .collect();
    let reasons = configuration.for_co_simulation_alone();
    let results = json!({
        "format": "ugv-package/1",
        "fmu": path.to_string_lossy(),
        "fmi": args.fmi,
        "platforms": platforms,
        "co_simulation_alone": reasons,
    });
    finish(output, fmu.get_ref(), json, &results)?;
    let limits = if reasons.is_empty() {
        String::new()
    } else {
        format!(", for co-simulation alone ({})", reasons.join(", "))
    };
    notify(&format!(
        "{} written, for {}{limits}",
        path.display(),
        platforms.join(", ")
    ));
    Ok(())
}

/// Makes one FMU of several.
fn merge(args: &Args) -> Result<(), Failure> {
    let mut inputs = Vec::new();
    for path in &args.merge {
        let file = File::open(path).map_err(Failure::read(path))?;
        inputs.push((path.display().to_string(), BufReader::new(file)));
    }
    let path = args.output.as_deref().unwrap_or(Path::new("ugv.fmu"));
    // With --force the result may replace one of the inputs.
    let force = args.replace.force;
    let output = Output::from_inputs(Some(path), [], force)?;
    let json = args.json.output(&args.merge, force)?;
    check_distinct(json.as_ref(), &output)?;
    let mut fmu = Cursor::new(Vec::new());
    let merged = merge_fmus(&mut fmu, inputs).map_err(|error| match error {
        MergeError::Write(source) => output.failure(source),
        other => Failure::argument(other.to_string()).with_remedy(remedy(&other)),
    })?;
    let results = json!({
        "format": "ugv-package/1",
        "fmu": path.to_string_lossy(),
        "binaries": merged,
    });
    finish(output, fmu.get_ref(), json, &results)?;
    notify(&format!(
        "{} written, with {}",
        path.display(),
        merged.join(", ")
    ));
    Ok(())
}

fn remedy(error: &MergeError) -> &'static str {
    match error {
        MergeError::Read { .. } | MergeError::Refused { .. } => "name FMUs of `ugv package`",
        MergeError::Differs { entry, .. } if entry.starts_with("binaries/") => {
            "build each platform once, and merge FMUs of one version of the source"
        }
        _ => {
            "package each with the same --fmi, vehicle, terrain and effects, by the same version of ugv"
        }
    }
}

fn check_distinct(json: Option<&Output>, output: &Output) -> Result<(), Failure> {
    json.map_or(Ok(()), |json| {
        json.check_distinct(output, "--json and --output")
    })
}

/// Writes the FMU, and what is in it as JSON.
fn finish(
    mut output: Output,
    fmu: &[u8],
    json: Option<Output>,
    results: &Value,
) -> Result<(), Failure> {
    let written = output.write_all(fmu);
    written.map_err(|source| output.failure(source))?;
    let json = json.map(|json| json.with(&format!("{results:#}\n")));
    finish_all([output].into_iter().chain(json.transpose()?))
}

fn configuration(args: &Args) -> Result<Configuration, Failure> {
    let ModelArgs { model, terrain, .. } = &args.model;
    let configuration = if model.is_some() {
        Configuration::from_specification(args.model.specification()?)
    } else {
        let mut configuration = Configuration {
            vehicle: args.model.vehicle()?,
            ..Configuration::default()
        };
        let preset = terrain
            .to_str()
            .filter(|name| Terrain::preset(name).is_some());
        if !preset.is_some_and(|name| configuration.begin_on(name)) {
            configuration.select_custom(load_terrain(terrain)?);
        }
        args.model.replace_effects(&mut configuration.effects)?;
        configuration
    };
    // Refuses a vehicle and a terrain that do not fit together.
    VehicleModel::from_specification(&configuration.specification())?;
    Ok(configuration)
}

/// The shared libraries, at most one for each platform.
fn libraries(named: &[(Platform, PathBuf)]) -> Result<Vec<(Platform, PathBuf)>, Failure> {
    if named.is_empty() {
        return Ok(vec![(Platform::Linux64, built_library()?)]);
    }
    for (index, (platform, _)) in named.iter().enumerate() {
        if named[..index].iter().any(|(other, _)| other == platform) {
            let name = platform.name();
            return Err(Failure::argument(format!(
                "--library names two libraries for {name}"
            )));
        }
    }
    Ok(named.into())
}

/// The library that the build puts beside the tool's folder, or beside the tool.
fn built_library() -> Result<PathBuf, Failure> {
    let tool = std::env::current_exe().unwrap_or_default();
    let folder = tool.parent().unwrap_or(Path::new("."));
    let places = [folder.join("ugv.so"), folder.join("../fmu/ugv.so")];
    let found = places.into_iter().find(|place| place.is_file());
    found.ok_or_else(|| {
        Failure::argument("there is no ugv.so beside the tool").with_remedy(
            "build it with scripts/package.sh, or name one: --library linux64=path/to/ugv.so",
        )
    })
}

/// Maximum size of a shared library of an FMU \[MB\].
const MAX_SIZE: u64 = 256;

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(Failure::read(path))?;
    let length = file
        .take((MAX_SIZE << 20) + 1)
        .read_to_end(&mut bytes)
        .map_err(Failure::read(path))?;
    if length as u64 > MAX_SIZE << 20 {
        let reason = format!("it is larger than {MAX_SIZE} MB, the limit for a shared library");
        let source = io::Error::new(io::ErrorKind::FileTooLarge, reason);
        return Err(Failure::read(path)(source));
    }
    Ok(bytes)
}
