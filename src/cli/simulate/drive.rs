//! Steps a simulation along a recording's wheel speeds.

use crate::cli::failure::Failure;
use crate::recording::Drive;
use crate::simulation::{Simulation, SimulationError, State, WheelSpeeds};
use crate::vehicle::Wrench;

/// A point of the drive: a row of the input or of the output.
pub struct DrivePoint<'a> {
    /// Time of the recording \[s\].
    pub time: f64,
    /// Pose and velocities.
    pub state: State,
    /// Wheel speeds \[rad/s\].
    pub wheel_speeds: WheelSpeeds,
    /// Forces and moments, in total and of each wheel.
    pub wrench: &'a Wrench,
    /// Whether a row of the output is due.
    pub is_row: bool,
}

/// More rows than this are a typing error.
const MAX_ROWS: f64 = 1e8;
/// An output this close to a row of the input, as a share of the output step, coincides with that row.
const SAME_TIME: f64 = 1e-9;

/// When rows of the output are due: at each row of the input, or on a grid.
pub struct Schedule {
    start: f64,
    end: f64,
    /// Seconds between rows.
    step: Option<f64>,
    /// Index of the grid's next row.
    next: u64,
}

impl Schedule {
    /// # Errors
    /// A step so small that the output is too large.
    pub fn new(recording: &Drive, step: Option<f64>) -> Result<Self, Failure> {
        let start = recording.time[0];
        let rows = step.map_or(0.0, |step| recording.duration() / step);
        if rows > MAX_ROWS {
            return Err(Failure::argument(format!(
                "--output-step gives {rows:.1e} rows; the limit is {MAX_ROWS:.0e}"
            )));
        }
        Ok(Self {
            start,
            // Not start + duration, which may round above it.
            end: recording.time[recording.len() - 1],
            step,
            next: 0,
        })
    }

    /// The grid's next time. If a whole number of steps makes a second, it divides by that number:
    /// 3 steps of 0.1 s end at 0.3 s, not at 0.30000000000000004 s.
    fn next_time(&self, step: f64) -> f64 {
        let per_second = (1.0 / step).round();
        if per_second >= 1.0 && (per_second * step - 1.0).abs() < 1e-12 {
            self.start + self.next as f64 / per_second
        } else {
            self.start + self.next as f64 * step
        }
    }

    fn tolerance(step: f64, time: f64) -> f64 {
        SAME_TIME * step + 4.0 * f64::EPSILON * time.abs()
    }

    /// Whether a row is due at a row of the input. The caller asks once for every row.
    fn due_at(&mut self, knot: f64) -> bool {
        let Some(step) = self.step else { return true };
        let due = (self.next_time(step) - knot).abs() <= Self::tolerance(step, knot);
        self.next += u64::from(due);
        due || knot >= self.end
    }

    /// The next row that is due before a row of the input.
    fn due_before(&mut self, knot: f64) -> Option<f64> {
        let step = self.step?;
        let time = self.next_time(step);
        let due = time < knot - Self::tolerance(step, knot);
        self.next += u64::from(due);
        due.then_some(time)
    }
}

/// Drives along a recording and visits each row of the input and of the output.
///
/// # Errors
/// Whatever stops the simulation, at the recording's time, and errors of the visitor.
pub fn drive(
    recording: &Drive,
    mut schedule: Schedule,
    simulation: &mut Simulation,
    mut visit: impl FnMut(&DrivePoint) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let start = recording.time[0];
    let failed = |error| Failure::Simulation(at_recording_time(error, start));
    for (row, &knot) in recording.time.iter().enumerate() {
        // The simulation counts from zero: its smallest step is a share of its time, too long
        // for a clock that counts from 1970.
        simulation.set_time(knot - start).map_err(failed)?;
        simulation
            .set_wheel_speeds(recording.wheel_speeds(row).into())
            .map_err(failed)?;
        simulation
            .set_wheel_accelerations(recording.wheel_accelerations(row).into())
            .map_err(failed)?;
        visit(&point(simulation, knot, schedule.due_at(knot)).map_err(failed)?)?;
        let Some(&next) = recording.time.get(row + 1) else {
            break;
        };
        let mut now = knot;
        while let Some(time) = schedule.due_before(next) {
            simulation.step(time - now).map_err(failed)?;
            visit(&point(simulation, time, true).map_err(failed)?)?;
            now = time;
        }
        simulation.step(next - now).map_err(failed)?;
    }
    Ok(())
}

fn point(
    simulation: &mut Simulation,
    time: f64,
    is_row: bool,
) -> Result<DrivePoint<'_>, SimulationError> {
    let (state, wheel_speeds) = (simulation.state(), simulation.wheel_speeds());
    Ok(DrivePoint {
        time,
        state,
        wheel_speeds,
        wrench: simulation.wrench()?,
        is_row,
    })
}

fn at_recording_time(mut error: SimulationError, start: f64) -> SimulationError {
    if let SimulationError::Balance { time, .. }
    | SimulationError::StepTooSmall { time, .. }
    | SimulationError::TooStiff { time, .. } = &mut error
    {
        // Microseconds are enough for a message.
        *time = ((*time + start) * 1e6).round() / 1e6;
    }
    error
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::Terrain;
    use crate::vehicle::{Vehicle, VehicleModel};

    fn recording(time: &[f64]) -> Drive {
        Drive {
            time: time.to_vec(),
            omega_left: time.iter().map(|t| t - time[0]).collect(),
            omega_right: vec![2.0; time.len()],
            filled_rows: 0,
        }
    }

    /// Times of the rows, and number of all points.
    fn rows(time: &[f64], step: Option<f64>) -> (Vec<f64>, usize) {
        let recording = recording(time);
        let terrain = Terrain::preset("clayed_soil").unwrap();
        let mut simulation =
            Simulation::new(VehicleModel::new(Vehicle::tran2007(), terrain).unwrap());
        let (mut rows, mut points) = (Vec::new(), 0);
        drive(
            &recording,
            Schedule::new(&recording, step).unwrap(),
            &mut simulation,
            |point| {
                points += 1;
                if point.is_row {
                    rows.push(point.time);
                    // Rounding of the speeds between two rows.
                    assert!((point.wheel_speeds.left - (point.time - time[0])).abs() < 1e-12);
                }
                Ok(())
            },
        )
        .unwrap();
        (rows, points)
    }

    #[test]
    fn rows_of_the_input_are_rows_of_the_output() {
        let time = [1.0, 1.3, 1.35];
        assert_eq!(rows(&time, None), (time.to_vec(), 3));
        assert_eq!(rows(&[5.0], None), (vec![5.0], 1));
    }

    #[test]
    fn grid_has_first_and_last_time_and_no_other_off_the_step() {
        assert_eq!(
            rows(&[0.0, 0.25], Some(0.1)),
            (vec![0.0, 0.1, 0.2, 0.25], 4)
        );
        assert_eq!(rows(&[2.0, 2.05, 2.4], Some(0.2)).0, [2.0, 2.2, 2.4]);
        assert_eq!(rows(&[0.0, 0.3], Some(7.0)).0, [0.0, 0.3]);
        assert_eq!(rows(&[3.0], Some(0.1)).0, [3.0]);
    }

    #[test]
    fn grid_and_input_coincide() {
        // 3 * 0.1 is not 0.3 in binary numbers, nor is 1.7e9 + 0.1.
        let (times, points) = rows(&[0.0, 0.1, 0.2, 0.3], Some(0.1));
        assert_eq!((times, points), (vec![0.0, 0.1, 0.2, 0.3], 4));
        let (times, points) = rows(&[1.7e9, 1.7e9 + 0.1, 1.7e9 + 0.2, 1.7e9 + 0.3], Some(0.1));
        assert_eq!((times.len(), points), (4, 4));
    }

    #[test]
    fn endless_output_is_refused() {
        let schedule = Schedule::new(&recording(&[0.0, 1.0]), Some(1e-12));
        assert!(matches!(schedule, Err(Failure::Argument { .. })));
    }
}
