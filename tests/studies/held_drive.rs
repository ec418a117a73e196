//! Drives the library itself with wheel speeds that are held from one row to the next, which is what
//! `scripts/tools/importers.sh` compares importers of the FMU with:
//!
//! ```text
//! cargo run --release --example held_drive -- DRIVE.csv START.json MOTION.csv
//! ```
//!
//! `DRIVE.csv` has the columns `time,omega_left,omega_right` and ends with the time at which the drive ends;
//! `START.json` the FMU's start values by name. `MOTION.csv` has two rows for each time, which the column
//! `side` tells apart: `end` of the step before, and `begin` of the next one, with its wheel speeds.

#[path = "../fmu/support/outputs.rs"]
mod outputs;

use serde_json::{Map, Value};
use std::error::Error;
use std::fmt::Write;
use std::process::ExitCode;
use ugv_terrain::declaration::{Causality, Configuration, Quantity, Variable, variables};
use ugv_terrain::simulation::{Simulation, State, WheelSpeeds};
use ugv_terrain::vehicle::VehicleModel;

type Failure = Box<dyn Error>;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [drive, start, motion] = arguments.as_slice() else {
        eprintln!("usage: held_drive DRIVE.csv START.json MOTION.csv");
        return ExitCode::from(2);
    };
    let done = read(drive)
        .and_then(|drive| Ok((drive, serde_json::from_str(&read(start)?)?)))
        .and_then(|(drive, start)| Ok(std::fs::write(motion, drive_held(&drive, &start)?)?));
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("held_drive: {error}");
            ExitCode::FAILURE
        }
    }
}

fn read(path: &str) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|error| format!("{path}: {error}").into())
}

/// The motion, as a table.
fn drive_held(drive: &str, start: &Map<String, Value>) -> Result<String, Failure> {
    let rows = rows(drive)?;
    let (mut simulation, configuration) = started(start, rows[0].1)?;
    let outputs: Vec<Variable> = variables(&configuration)
        .into_iter()
        .filter(|variable| variable.attributes.causality == Causality::Output)
        .collect();
    let mut table = String::from("side,time");
    for variable in &outputs {
        write!(table, ",{}", variable.name)?;
    }
    let mut now = rows[0].0;
    for (time, speeds) in rows {
        if time > now {
            simulation.step(time - now)?;
        }
        now = time;
        for side in ["end", "begin"] {
            if side == "begin" {
                simulation.set_wheel_speeds(speeds)?;
            }
            write!(table, "\n{side},{time}")?;
            for value in outputs::values(&mut simulation, &outputs) {
                write!(table, ",{value}")?;
            }
        }
    }
    table.push('\n');
    Ok(table)
}

/// Times and wheel speeds.
fn rows(drive: &str) -> Result<Vec<(f64, WheelSpeeds)>, Failure> {
    let mut lines = drive.lines();
    if lines.next() != Some("time,omega_left,omega_right") {
        return Err("the drive's first line is not `time,omega_left,omega_right`".into());
    }
    let row = |line: &str| -> Result<_, Failure> {
        let numbers = line.split(',').map(str::parse);
        match numbers.collect::<Result<Vec<f64>, _>>()?.as_slice() {
            &[time, left, right] => Ok((time, WheelSpeeds { left, right })),
            _ => Err(format!("the drive has a line that is not three numbers: {line}").into()),
        }
    };
    let rows = lines.map(row).collect::<Result<Vec<_>, _>>()?;
    if rows.is_empty() {
        return Err("the drive has no row".into());
    }
    Ok(rows)
}

/// The simulation that the FMU's start values make.
fn started(
    start: &Map<String, Value>,
    speeds: WheelSpeeds,
) -> Result<(Simulation, Configuration), Failure> {
    let mut configuration = Configuration::default();
    let (mut initial, mut no_slip) = ([0.0; State::COUNT], false);
    let known = variables(&configuration);
    for (name, value) in start {
        let bad = || format!("start value {name}: {value} does not fit");
        let variable = known.iter().find(|variable| variable.name == *name);
        let quantity = variable.ok_or_else(|| format!("no variable is called {name}"))?;
        match quantity.quantity {
            Quantity::NoSlip => no_slip = value.as_bool().ok_or_else(bad)?,
            Quantity::Terrain => {
                let number = value.as_u64().filter(|number| (1..=5).contains(number));
                configuration.selected = number.ok_or_else(bad)? as usize - 1;
            }
            Quantity::Initial(index) => initial[index] = value.as_f64().ok_or_else(bad)?,
            parameter => {
                let number = value.as_f64().ok_or_else(bad)?;
                if !configuration.set_parameter(parameter, number) {
                    return Err(bad().into());
                }
            }
        }
    }
    let mut state = State::from_array(initial);
    if no_slip {
        let vehicle = &configuration.vehicle;
        state = state.rolling_without_slip(speeds, vehicle.wheel_radius, vehicle.half_track);
    }
    let model = VehicleModel::from_specification(&configuration.specification())?;
    let mut simulation = Simulation::new(model);
    simulation.set_state(state)?;
    simulation.set_wheel_speeds(speeds)?;
    Ok((simulation, configuration))
}
