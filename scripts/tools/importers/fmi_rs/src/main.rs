//! Drives an FMU with fmi-rs: `drive cs FMU FOLDER MOTION.csv`, FOLDER with `drive.csv` and `start.json`.

use fmi_rs::fmi3::LibraryKind;
use fmi_rs::model_description::{FMIMajorVersion, fmi2, fmi3, peek_fmi_major_version};
use fmi_rs::sim::{fmi2 as sim2, fmi3 as sim3};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const STEP: f64 = 0.01;
const STOP: f64 = 10.0;
const TOLERANCE: f64 = 1e-9; // of times, by which fmi-rs judges that two are the same

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(2).map(PathBuf::from).collect();
    let [fmu, folder, motion] = arguments.as_slice() else {
        return Err("usage: drive cs FMU FOLDER MOTION.csv".into());
    };
    let unpacked = motion.with_extension("fmu");
    fmi_rs::zip::extract_zip_archive(fmu, &unpacked)?;
    let description = unpacked.join("modelDescription.xml");
    match peek_fmi_major_version(&description)? {
        FMIMajorVersion::V2 => drive_2(&unpacked, &description, folder, motion),
        _ => drive_3(&unpacked, &description, folder, motion),
    }
}

/// The start values as fmi-rs takes them.
fn start_values(folder: &Path) -> Result<Vec<(String, String)>, Box<dyn Error>> {
    let text = std::fs::read_to_string(folder.join("start.json"))?;
    let start: serde_json::Map<String, serde_json::Value> = serde_json::from_str(&text)?;
    Ok(start.into_iter().map(|(name, value)| (name, value.to_string())).collect())
}

fn drive_2(unpacked: &Path, description: &Path, folder: &Path, motion: &Path) -> Result<(), Box<dyn Error>> {
    let model = Arc::new(fmi2::ModelDescription::from_path(description)?);
    let drive = std::fs::File::open(folder.join("drive.csv"))?;
    let input = sim2::input::StaticInput::new(sim2::csv::read_csv(drive, model.clone())?, TOLERANCE);
    let outputs = |(index, variable): (usize, &fmi2::ScalarVariable)| (variable.causality == fmi2::Causality::Output).then_some(index);
    let wanted = model.modelVariables.iter().enumerate().filter_map(outputs).collect();
    let recorder = Arc::new(sim2::recorder::Recorder::new(sim2::Trajectories::new(model.clone(), wanted)));
    let settings = sim2::SimulationSettings {
        unzipdir: unpacked.to_owned(),
        model_description: model,
        start_time: 0.0,
        stop_time: STOP,
        logging_on: false,
        set_stop_time: true,
        output_interval: STEP,
        log_time_scale: false,
        tolerance: TOLERANCE,
        set_tolerance: false,
        start_values: start_values(folder)?,
        log_fmi_calls: false,
        input_file: None,
        early_return_allowed: false,
        event_mode_used: false,
        log_file: None,
        initial_fmu_state_file: None,
        final_fmu_state_file: None,
    };
    sim2::cs::simulate(&settings, Some(Arc::new(input)), recorder.clone())?;
    Ok(sim2::csv::write_csv(&recorder.trajectories.borrow(), motion)?)
}

fn drive_3(unpacked: &Path, description: &Path, folder: &Path, motion: &Path) -> Result<(), Box<dyn Error>> {
    let model = Arc::new(fmi3::ModelDescription::from_path(description)?);
    let drive = std::fs::File::open(folder.join("drive.csv"))?;
    let input = sim3::input::StaticInput::new(sim3::csv::read_csv(drive, model.clone())?, TOLERANCE);
    let outputs = |(index, variable): (usize, &fmi3::ModelVariable)| (variable.causality == fmi3::Causality::Output).then_some(index);
    let wanted = model.modelVariables.iter().enumerate().filter_map(outputs).collect();
    let recorder = Arc::new(sim3::recorder::Recorder::new(sim3::Trajectories::new(model.clone(), wanted)));
    let settings = sim3::SimulationSettings {
        unzipdir: unpacked.to_owned(),
        model_description: model,
        library_kind: LibraryKind::Native,
        enable_dae: false,
        start_time: 0.0,
        stop_time: STOP,
        visible: false,
        logging_on: false,
        set_stop_time: true,
        output_interval: STEP,
        log_time_scale: false,
        tolerance: TOLERANCE,
        set_tolerance: false,
        start_values: start_values(folder)?,
        log_fmi_calls: false,
        intermediate_update: false,
        input_file: None,
        early_return_allowed: false,
        event_mode_used: false,
        log_file: None,
        initial_fmu_state_file: None,
        final_fmu_state_file: None,
    };
    sim3::cs::simulate(&settings, Some(Arc::new(input)), recorder.clone())?;
    let table = motion.with_extension("arrays.csv");
    sim3::csv::write_csv(&recorder.trajectories.borrow(), &table)?;
    Ok(std::fs::write(motion, scalars(&std::fs::read_to_string(table)?))?)
}

/// The table with a column for each element of an array: fmi-rs writes these into one, with blanks between.
fn scalars(table: &str) -> String {
    let mut lines = table.lines();
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let first: Vec<usize> = lines.clone().next().unwrap_or_default().split(',').map(|cell| cell.split(' ').count()).collect();
    let elements = |(name, count): (&&str, &usize)| match count {
        1 => vec![(*name).to_owned()],
        _ => (1..=*count).map(|number| name.replace("wheel.", &format!("wheel[{number}]."))).collect(),
    };
    let header = names.iter().zip(&first).flat_map(elements).collect::<Vec<_>>().join(",");
    let rows = lines.map(|line| line.replace(' ', ","));
    std::iter::once(header).chain(rows).map(|line| line + "\n").collect()
}
