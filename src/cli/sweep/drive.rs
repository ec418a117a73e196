//! One drive, and its result.

use crate::simulation::State;
use crate::simulation::batch::Rollout;
use crate::vehicle::Wrench;
use serde_json::{Value, json};
use std::io::{self, Write};

/// Columns of the result, after the parameters.
pub const COLUMNS: &str = "time,x,y,heading,v_x,v_y,yaw_rate,distance,largest_slip,mean_slip,\
                           largest_sinkage,resistance_work,error";

/// Where a drive ended, and what happened until then, from the rows of the input.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveResult {
    /// Seconds from the start to the last row that it reached.
    time: f64,
    /// Pose and velocities there.
    state: State,
    /// Length of the path \[m\].
    distance: f64,
    slip: Slip,
    /// Largest sinkage of any wheel \[m\].
    largest_sinkage: f64,
    /// Integral of rolling resistance times |v_x| over time \[J\].
    resistance_work: f64,
    /// Why the drive ended before its last row, if it did.
    pub error: Option<String>,
}

/// |longitudinal slip| of all wheels in all rows except the first, in which the wheels start.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Slip {
    largest: f64,
    sum: f64,
    count: u64,
}

/// Drives, and reads the outputs at each row.
pub fn drive(member: &mut Rollout) -> DriveResult {
    let mut result = DriveResult::at(member.simulation.state());
    let inputs = member.inputs.clone();
    let time = inputs.time();
    let mut power = 0.0;
    let driven = member.run(|row, simulation| {
        let state = simulation.state();
        let wrench = simulation.wrench()?;
        power = if row == 0 {
            result.first(wrench)
        } else {
            result.time = time[row] - time[0];
            result.next(state, wrench, power, time[row] - time[row - 1])
        };
        Ok(())
    });
    result.error = driven.err().map(|error| error.to_string());
    result
}

/// Power lost to rolling resistance \[W\].
fn power(state: &State, wrench: &Wrench) -> f64 {
    wrench.rolling_resistance * state.v_x.abs()
}

impl DriveResult {
    /// Nothing driven yet.
    fn at(start: State) -> Self {
        Self {
            time: 0.0,
            state: start,
            distance: 0.0,
            slip: Slip::default(),
            largest_sinkage: 0.0,
            resistance_work: 0.0,
            error: None,
        }
    }

    fn first(&mut self, wrench: &Wrench) -> f64 {
        self.sink(wrench);
        power(&self.state, wrench)
    }

    fn next(&mut self, state: State, wrench: &Wrench, power_before: f64, seconds: f64) -> f64 {
        let (east, north) = (state.x - self.state.x, state.y - self.state.y);
        // Not hypot, whose last bit differs between mathematical libraries.
        self.distance += (east * east + north * north).sqrt();
        self.state = state;
        self.sink(wrench);
        for wheel in &wrench.wheels {
            let slip = wheel.longitudinal_slip.abs();
            self.slip.largest = self.slip.largest.max(slip);
            self.slip.sum += slip;
            self.slip.count += 1;
        }
        let power = power(&state, wrench);
        self.resistance_work += 0.5 * (power_before + power) * seconds;
        power
    }

    fn sink(&mut self, wrench: &Wrench) {
        let sinkages = wrench.wheels.iter().map(|wheel| wheel.sinkage);
        self.largest_sinkage = sinkages.fold(self.largest_sinkage, f64::max);
    }

    /// The cells by the names of their columns; a missing value is null.
    pub fn json(&self) -> Value {
        let [x, y, heading, v_x, v_y, yaw_rate] = self.state.to_array().map(|value| value + 0.0);
        let slip = Some(self.slip).filter(|slip| slip.count > 0);
        json!({
            "time": self.time,
            "x": x, "y": y, "heading": heading, "v_x": v_x, "v_y": v_y, "yaw_rate": yaw_rate,
            "distance": self.distance,
            "largest_slip": slip.map(|slip| slip.largest),
            "mean_slip": slip.map(|slip| slip.sum / slip.count as f64),
            "largest_sinkage": self.largest_sinkage + 0.0,
            "resistance_work": self.resistance_work + 0.0,
            "error": self.error,
        })
    }

    /// Writes the cells, each after a comma; a missing value is an empty cell. The numbers read back to the
    /// last bit.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let (slip, count) = (&self.slip, self.slip.count);
        let slips = (count > 0).then(|| [slip.largest, slip.sum / count as f64]);
        write!(out, ",{:?}", self.time)?;
        for value in self.state.to_array() {
            write!(out, ",{:?}", value + 0.0)?;
        }
        write!(out, ",{:?}", self.distance)?;
        match slips {
            Some([largest, mean]) => write!(out, ",{largest:?},{mean:?}")?,
            None => write!(out, ",,")?,
        }
        let (sinkage, work) = (self.largest_sinkage + 0.0, self.resistance_work + 0.0);
        write!(out, ",{sinkage:?},{work:?},")?;
        if let Some(error) = &self.error {
            write!(out, "\"{}\"", error.replace('"', "\"\""))?;
        }
        writeln!(out)
    }
}
