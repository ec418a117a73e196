//! `ugv package`: makes an FMU of a vehicle on a terrain.

use super::model::{ModelArgs, load_terrain};
use super::output::Output;
use super::{Failure, tell};
use std::fs::File;
use std::io::{self, BufReader, Cursor, Read, Write};
use std::path::{Path, PathBuf};
use ugv_terrain::declaration::Configuration;
use ugv_terrain::package::{MergeError, PackageError, Platform, Standard, merge_fmus, write_fmu};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::VehicleModel;

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
/// The four terrains of the paper are in every FMU, to be chosen by its parameter `terrain`;
/// a terrain from a file, or a model's, becomes its custom one. An effect that adds states of its own
/// (transient_shear, multipass, what is measured over the distance driven) makes the FMU one for
/// co-simulation alone, and so does a window on the map.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    #[command(flatten)]
    model: ModelArgs,

    /// Version of the standard; to FMI 3 the quantities of rows and wheels are arrays
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
    #[arg(long, value_name = "PLATFORM=FILE")]
    library: Vec<String>,

    /// FMUs of the same model with libraries of different platforms, to be made one FMU with all of
    /// them; everything else in them has to be equal
    #[arg(
        long,
        value_name = "FILE.fmu",
        num_args = 2..,
        requires = "output",
        conflicts_with_all = ["fmi", "library", "vehicle", "terrain", "model", "effects"]
    )]
    merge: Vec<PathBuf>,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    if !args.merge.is_empty() {
        return merge(args);
    }
    let configuration = configuration(args)?;
    let libraries = libraries(&args.library)?;
    let (standard, default) = match args.fmi.as_str() {
        "3" => (Standard::Fmi3, "ugv-fmi3.fmu"),
        _ => (Standard::Fmi2, "ugv.fmu"),
    };
    let path = args.output.as_deref().unwrap_or(Path::new(default));
    let mut read = args.model.files();
    read.extend(libraries.iter().map(|library| library.path.clone()));
    let output = Output::of(Some(path), &read)?;
    let libraries: Vec<(Platform, Vec<u8>)> = libraries
        .into_iter()
        .map(|library| (library.platform, library.bytes))
        .collect();
    let mut fmu = Cursor::new(Vec::new());
    let written = write_fmu(&mut fmu, standard, &configuration, &libraries);
    written.map_err(|error| match error {
        PackageError::Write(source) => output.failure(source),
        other => Failure::Argument {
            reason: other.to_string(),
            hint: Some("build the library anew with scripts/package.sh".into()),
        },
    })?;
    put(output, fmu.get_ref())?;
    let platforms: Vec<&str> = libraries
        .iter()
        .map(|(platform, _)| platform.name())
        .collect();
    let alone = configuration.for_co_simulation_alone();
    let limits = if alone.is_empty() {
        String::new()
    } else {
        format!(", for co-simulation alone ({})", alone.join(", "))
    };
    tell(&format!(
        "{} written, for {}{limits}",
        path.display(),
        platforms.join(", ")
    ));
    Ok(())
}

/// Makes one FMU of several.
fn merge(args: &Args) -> Result<(), Failure> {
    let mut parts = Vec::new();
    for path in &args.merge {
        let file = File::open(path).map_err(|source| unread(path, source))?;
        parts.push((path.display().to_string(), BufReader::new(file)));
    }
    let path = args.output.as_deref().unwrap_or(Path::new("ugv.fmu"));
    // One of the parts may be replaced by all of them.
    let output = Output::to(Some(path))?;
    let mut fmu = Cursor::new(Vec::new());
    let merged = merge_fmus(&mut fmu, parts).map_err(|error| match error {
        MergeError::Write(source) => output.failure(source),
        other => Failure::Argument {
            hint: Some(remedy(&other).into()),
            reason: other.to_string(),
        },
    })?;
    put(output, fmu.get_ref())?;
    tell(&format!(
        "{} written, with {}",
        path.display(),
        merged.join(", ")
    ));
    Ok(())
}

fn remedy(error: &MergeError) -> &'static str {
    match error {
        MergeError::Read { .. } | MergeError::Refused { .. } => {
            "name FMUs that `ugv package` wrote"
        }
        MergeError::Differs { entry, .. } if entry.starts_with("binaries/") => {
            "build each platform once, and merge FMUs of one source only"
        }
        _ => {
            "package each with the same --fmi, vehicle, terrain and effects, by the same version of ugv"
        }
    }
}

/// Brings an FMU to where it belongs.
fn put(mut output: Output, fmu: &[u8]) -> Result<(), Failure> {
    let written = output.write_all(fmu);
    written.map_err(|source| output.failure(source))?;
    output.finish()
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
    // Refuses what does not fit together.
    VehicleModel::from_specification(&configuration.specification()).map_err(Failure::Model)?;
    Ok(configuration)
}

/// A shared library with its file.
struct Library {
    platform: Platform,
    path: PathBuf,
    bytes: Vec<u8>,
}

impl Library {
    fn read(platform: Platform, path: PathBuf) -> Result<Self, Failure> {
        let bytes = read(&path)?;
        Ok(Self {
            platform,
            path,
            bytes,
        })
    }
}

fn libraries(named: &[String]) -> Result<Vec<Library>, Failure> {
    if named.is_empty() {
        return Ok(vec![Library::read(Platform::Linux64, built_library()?)?]);
    }
    let mut libraries: Vec<Library> = Vec::new();
    for argument in named {
        let platform = argument.split_once('=').and_then(|(name, path)| {
            let known = Platform::ALL
                .into_iter()
                .find(|platform| platform.name() == name)?;
            Some((known, path))
        });
        let Some((platform, path)) = platform else {
            return Err(Failure::Argument {
                reason: format!("--library {argument}: PLATFORM=FILE is expected"),
                hint: Some(format!(
                    "the platforms are {}",
                    Platform::ALL.map(Platform::name).join(", ")
                )),
            });
        };
        if libraries.iter().any(|other| other.platform == platform) {
            return Err(Failure::Argument {
                reason: format!("--library {argument}: there is one for this platform already"),
                hint: None,
            });
        }
        libraries.push(Library::read(platform, path.into())?);
    }
    Ok(libraries)
}

/// The library that the build leaves beside the tool's own folder, or beside the tool.
fn built_library() -> Result<PathBuf, Failure> {
    let tool = std::env::current_exe().unwrap_or_default();
    let folder = tool.parent().unwrap_or(Path::new("."));
    let places = [folder.join("ugv.so"), folder.join("../fmu/ugv.so")];
    places
        .into_iter()
        .find(|place| place.is_file())
        .ok_or_else(|| Failure::Argument {
            reason: "there is no ugv.so beside the tool".into(),
            hint: Some(
                "build it with scripts/package.sh, or name one: --library linux64=path/to/ugv.so"
                    .into(),
            ),
        })
}

/// Larger files are no shared library of an FMU \[MB\].
const LARGEST: u64 = 256;

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let opened = File::open(path);
    let read = opened.and_then(|file| file.take((LARGEST << 20) + 1).read_to_end(&mut bytes));
    match read {
        Ok(length) if length as u64 > LARGEST << 20 => {
            let reason = format!("it is larger than {LARGEST} MB, the limit for a shared library");
            Err(unread(
                path,
                io::Error::new(io::ErrorKind::FileTooLarge, reason),
            ))
        }
        Ok(_) => Ok(bytes),
        Err(source) => Err(unread(path, source)),
    }
}

fn unread(path: &Path, source: io::Error) -> Failure {
    let path = path.into();
    Failure::Read { path, source }
}
