//! Steps a simulation along a recording's wheel speeds.

use crate::cli::Failure;
use ugv_terrain::recording::Drive;
use ugv_terrain::simulation::{Simulation, SimulationError, State, WheelSpeeds};
use ugv_terrain::vehicle::Wrench;

/// An instant at which the simulation stands still to be looked at.
pub struct Stop<'a> {
    /// Time of the recording \[s\].
    pub time: f64,
    /// Pose and velocities.
    pub state: State,
    /// Wheel speeds \[rad/s\].
    pub wheel_speeds: WheelSpeeds,
    /// Forces, moments and each wheel's share.
    pub wrench: &'a Wrench,
    /// Whether a row of the output is due.
    pub is_row: bool,
}

/// More rows than this are a slip of the pen.
const MOST_ROWS: f64 = 1e8;
/// An output this close to a row of the input, as a share of the output step, is that row.
const SAME_TIME: f64 = 1e-9;

/// When rows of the output are due: at each row of the input, or on a grid of its own.
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
    /// A step so small that the output would never end.
    pub fn new(recording: &Drive, step: Option<f64>) -> Result<Self, Failure> {
        let start = recording.time[0];
        let rows = step.map_or(0.0, |step| recording.duration() / step);
        if rows > MOST_ROWS {
            return Err(Failure::Argument {
                reason: format!(
                    "--output-step would give {rows:.1e} rows, more than {MOST_ROWS:.0e}"
                ),
                hint: None,
            });
        }
        Ok(Self {
            start,
            // Not start + duration, which may round above it.
            end: recording.time[recording.len() - 1],
            step,
            next: 0,
        })
    }

    /// The grid's next time. Where a whole number of steps makes a second, it divides by
    /// that number: 3 steps of 0.1 s end at 0.3 s, not at 0.30000000000000004 s.
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

    /// Whether a row is due at a row of the input; every such row is to be asked about.
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

/// Drives along a recording and shows every stop: each row of the input, and each row of the
/// output.
///
/// # Errors
/// Whatever stops the simulation, at the recording's time, and whatever the visitor refuses.
pub fn drive(
    recording: &Drive,
    mut schedule: Schedule,
    simulation: &mut Simulation,
    mut visit: impl FnMut(&Stop) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let start = recording.time[0];
    let failed = |error| Failure::Simulation(at_recording_time(error, start));
    for (row, &knot) in recording.time.iter().enumerate() {
        // The simulation counts from zero: its smallest step is a share of its time, which
        // a clock that started in 1970 would make far too long.
        simulation.set_time(knot - start).map_err(failed)?;
        simulation
            .set_wheel_speeds(recording.wheel_speeds(row).into())
            .map_err(failed)?;
        simulation
            .set_wheel_accelerations(recording.wheel_accelerations(row).into())
            .map_err(failed)?;
        visit(&stop(simulation, knot, schedule.due_at(knot)).map_err(failed)?)?;
        let Some(&next) = recording.time.get(row + 1) else {
            break;
        };
        let mut now = knot;
        while let Some(time) = schedule.due_before(next) {
            simulation.step(time - now).map_err(failed)?;
            visit(&stop(simulation, time, true).map_err(failed)?)?;
            now = time;
        }
        simulation.step(next - now).map_err(failed)?;
    }
    Ok(())
}

fn stop(simulation: &mut Simulation, time: f64, is_row: bool) -> Result<Stop<'_>, SimulationError> {
    let (state, wheel_speeds) = (simulation.state(), simulation.wheel_speeds());
    Ok(Stop {
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
    use ugv_terrain::terrain::Terrain;
    use ugv_terrain::vehicle::{Vehicle, VehicleModel};

    fn recording(time: &[f64]) -> Drive {
        Drive {
            time: time.to_vec(),
            omega_left: time.iter().map(|t| t - time[0]).collect(),
            omega_right: vec![2.0; time.len()],
            filled_rows: 0,
        }
    }

    /// Times of the rows, and number of all stops.
    fn rows(time: &[f64], step: Option<f64>) -> (Vec<f64>, usize) {
        let recording = recording(time);
        let terrain = Terrain::preset("clayed_soil").unwrap();
        let mut simulation =
            Simulation::new(VehicleModel::new(Vehicle::tran2007(), terrain).unwrap());
        let (mut rows, mut stops) = (Vec::new(), 0);
        drive(
            &recording,
            Schedule::new(&recording, step).unwrap(),
            &mut simulation,
            |stop| {
                stops += 1;
                if stop.is_row {
                    rows.push(stop.time);
                    // Rounding of the speeds between two rows.
                    assert!((stop.wheel_speeds.left - (stop.time - time[0])).abs() < 1e-12);
                }
                Ok(())
            },
        )
        .unwrap();
        (rows, stops)
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
    fn grid_and_input_meet_in_one_stop() {
        // 3 * 0.1 is not 0.3 in binary numbers, nor is 1.7e9 + 0.1.
        let (times, stops) = rows(&[0.0, 0.1, 0.2, 0.3], Some(0.1));
        assert_eq!((times, stops), (vec![0.0, 0.1, 0.2, 0.3], 4));
        let (times, stops) = rows(&[1.7e9, 1.7e9 + 0.1, 1.7e9 + 0.2, 1.7e9 + 0.3], Some(0.1));
        assert_eq!((times.len(), stops), (4, 4));
    }

    #[test]
    fn endless_output_is_refused() {
        let schedule = Schedule::new(&recording(&[0.0, 1.0]), Some(1e-12));
        assert!(matches!(schedule, Err(Failure::Argument { .. })));
    }
}
