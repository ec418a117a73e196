//! The motion as CSV.

use super::drive::DrivePoint;
use crate::declaration::{Causality, Configuration, Variable, variables};
use crate::vehicle::Vehicle;
use std::io::{self, Write};

/// The columns after the time: inputs and outputs of the FMU.
pub fn columns(vehicle: &Vehicle) -> Vec<Variable> {
    let configuration = Configuration {
        vehicle: vehicle.clone(),
        ..Configuration::default()
    };
    let mut columns = variables(&configuration);
    columns.retain(|v| matches!(v.attributes.causality, Causality::Input | Causality::Output));
    columns
}

/// The header line.
pub fn header(columns: &[Variable]) -> String {
    let names = columns.iter().map(|column| column.name.as_str());
    let names: Vec<&str> = ["time"].into_iter().chain(names).collect();
    names.join(",") + "\n"
}

/// Writes a row; its numbers read back to the last bit.
pub fn write_row(out: &mut impl Write, columns: &[Variable], point: &DrivePoint) -> io::Result<()> {
    write!(out, "{:?}", unsigned_zero(point.time))?;
    for column in columns {
        let quantity = column.quantity;
        let value = quantity.output(point.wheel_speeds, point.state, point.wrench);
        let value = value.expect("inputs and outputs have values");
        write!(out, ",{:?}", unsigned_zero(value))?;
    }
    writeln!(out)
}

/// -0 becomes 0.
fn unsigned_zero(value: f64) -> f64 {
    value + 0.0
}
