//! What a picture shows of a drive.

use crate::cli::simulate::Stop;
use ugv_terrain::simulation::{State, WheelSpeeds};
use ugv_terrain::vehicle::Vehicle;

/// Points per line: more than pixels, fewer than would make the file large.
const MOST_POINTS: usize = 3000;
/// Longest turn \[rad\] in one step of the path without slip; Simpson's rule then errs by
/// less than 1e-6 of its length.
const LONGEST_TURN: f64 = 0.2;

/// One instant of a drive.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    pub time: f64,
    pub state: State,
    /// Pose of a vehicle that rolls without slip.
    pub no_slip: State,
    pub rim_speed_left: f64,
    pub rim_speed_right: f64,
    pub slip_left: f64,
    pub slip_right: f64,
    pub rolling_resistance: f64,
    pub turning_moment: f64,
    pub turning_resistance: f64,
}

/// A drive from its beginning.
pub struct Trace {
    wheel_radius: f64,
    half_track: f64,
    samples: Vec<Sample>,
    no_slip: State,
    last: Option<(f64, WheelSpeeds)>,
}

impl Trace {
    /// A drive of a vehicle from an initial state.
    pub fn new(vehicle: &Vehicle, state: State) -> Self {
        Self {
            wheel_radius: vehicle.wheel_radius,
            half_track: vehicle.half_track,
            samples: Vec::new(),
            no_slip: state,
            last: None,
        }
    }

    /// Adds an instant.
    pub fn visit(&mut self, stop: &Stop) {
        let speeds = stop.wheel_speeds;
        if let Some((time, from)) = self.last {
            self.roll(from, speeds, stop.time - time);
        }
        self.last = Some((stop.time, speeds));
        // All wheels of a side have the same longitudinal slip: it does not depend on X (13).
        let slip = |wheel: usize| stop.wrench.wheels[wheel].longitudinal_slip;
        self.samples.push(Sample {
            time: stop.time,
            state: stop.state,
            no_slip: self.no_slip,
            rim_speed_left: self.wheel_radius * speeds.left,
            rim_speed_right: self.wheel_radius * speeds.right,
            slip_left: slip(0),
            slip_right: slip(1),
            rolling_resistance: stop.wrench.rolling_resistance,
            turning_moment: stop.wrench.turning_moment,
            turning_resistance: stop.wrench.turning_resistance_moment,
        });
    }

    /// Moves the vehicle that rolls without slip, by Simpson's rule.
    fn roll(&mut self, from: WheelSpeeds, to: WheelSpeeds, seconds: f64) {
        let rates = WheelSpeeds {
            left: (to.left - from.left) / seconds,
            right: (to.right - from.right) / seconds,
        };
        let rolling = |after: f64| {
            let speeds = from.after(rates, after);
            let state = State::default();
            let state = state.rolling_without_slip(speeds, self.wheel_radius, self.half_track);
            (state.v_x, state.yaw_rate)
        };
        let fastest = rolling(0.0).1.abs().max(rolling(seconds).1.abs());
        let parts = (fastest * seconds / LONGEST_TURN).ceil().max(1.0);
        let part = seconds / parts;
        for index in 0..parts as usize {
            let begin = index as f64 * part;
            let rows = [begin, begin + 0.5 * part, begin + part].map(rolling);
            let heading = self.no_slip.heading;
            // The yaw rate is linear: these are exact.
            let middle = heading + (rows[0].1 + rows[1].1) * part / 4.0;
            let end = heading + (rows[0].1 + rows[2].1) * part / 2.0;
            let weighted = [rows[0].0, 4.0 * rows[1].0, rows[2].0];
            for (speed, heading) in weighted.into_iter().zip([heading, middle, end]) {
                self.no_slip.x += part / 6.0 * speed * heading.cos();
                self.no_slip.y += part / 6.0 * speed * heading.sin();
            }
            self.no_slip.heading = end;
        }
    }

    fn start(&self) -> f64 {
        self.samples.first().map_or(0.0, |sample| sample.time)
    }

    /// From the first instant to the last \[s\].
    pub fn duration(&self) -> f64 {
        self.samples
            .last()
            .map_or(0.0, |sample| sample.time - self.start())
    }

    /// What the time axis shows.
    pub fn time_label(&self) -> String {
        match self.start() {
            0.0 => "time [s]".into(),
            start => format!("time after {start} s [s]"),
        }
    }

    /// A value over the time since the beginning.
    pub fn over_time(&self, value: fn(&Sample) -> f64) -> Vec<(f64, f64)> {
        let start = self.start();
        self.points(|sample| (sample.time - start, value(sample)))
    }

    /// A point for each instant, or for as many as a picture can show.
    pub fn points(&self, point: impl Fn(&Sample) -> (f64, f64)) -> Vec<(f64, f64)> {
        let stride = self.samples.len().div_ceil(MOST_POINTS).max(1);
        let last = self.samples.len() - 1;
        let shown = (0..last).step_by(stride).chain([last]);
        shown.map(|index| point(&self.samples[index])).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rolling_without_slip_follows_a_circle() {
        let vehicle = Vehicle::tran2007();
        let mut trace = Trace::new(&vehicle, State::default());
        let speeds = WheelSpeeds {
            left: 4.0,
            right: 8.0,
        };
        // r (4 + 8) / 2 = 1.5 m/s, r (8 - 4) / (2 B) = 1 / 1.22 rad/s.
        let (speed, rate) = (1.5, 1.0 / 1.22);
        let seconds = 5.0;
        trace.roll(speeds, speeds, seconds);
        let (angle, radius) = (rate * seconds, speed / rate);
        let State { x, y, heading, .. } = trace.no_slip;
        assert!((heading - angle).abs() < 1e-12);
        // The bound of LONGEST_TURN, on 7.5 m.
        let tolerance = 7.5e-6;
        assert!((x - radius * f64::sin(angle)).abs() < tolerance);
        assert!((y - radius * (1.0 - f64::cos(angle))).abs() < tolerance);
    }
}
