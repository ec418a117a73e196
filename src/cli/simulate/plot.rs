//! A picture of a drive: path, speeds, slips, resistance and moments.

use super::drive::DrivePoint;
use crate::report::chart::{Chart, Line, Stroke, Underlay, sheet};
use crate::simulation::{State, WheelSpeeds};
use crate::vehicle::Vehicle;

/// Longest turn \[rad\] in one step of the path without slip: Simpson's rule then has an error below 1e-6 of its length.
const LONGEST_TURN: f64 = 0.2;
/// Height of a diagram.
const HEIGHT: f64 = 250.0;

/// What the picture shows of a point of the drive.
#[derive(Debug, Clone, Copy)]
struct TracePoint {
    time: f64,
    state: State,
    /// State of a vehicle that rolls without slip.
    no_slip: State,
    rim_speeds: [f64; 2],
    slips: [f64; 2],
    rolling_resistance: f64,
    turning_moment: f64,
    turning_resistance: f64,
}

/// The points of a drive.
pub struct Trace {
    wheel_radius: f64,
    half_track: f64,
    points: Vec<TracePoint>,
    no_slip: State,
    last: Option<(f64, WheelSpeeds)>,
}

impl Trace {
    /// A drive of a vehicle from an initial state.
    pub fn new(vehicle: &Vehicle, state: State) -> Self {
        Self {
            wheel_radius: vehicle.wheel_radius,
            half_track: vehicle.half_track,
            points: Vec::new(),
            no_slip: state,
            last: None,
        }
    }

    /// Adds a point.
    pub fn visit(&mut self, point: &DrivePoint) {
        let speeds = point.wheel_speeds;
        if let Some((time, from)) = self.last {
            self.roll(from, speeds, point.time - time);
        }
        self.last = Some((point.time, speeds));
        // All wheels of a side have the same longitudinal slip: it does not depend on X (13). At standstill it grows
        // without bound.
        let slip = |wheel: usize| point.wrench.wheels[wheel].longitudinal_slip;
        self.points.push(TracePoint {
            time: point.time,
            state: point.state,
            no_slip: self.no_slip,
            rim_speeds: [speeds.left, speeds.right].map(|speed| self.wheel_radius * speed),
            slips: [slip(0), slip(1)].map(|slip| slip.clamp(-1.0, 1.0)),
            rolling_resistance: point.wrench.rolling_resistance,
            turning_moment: point.wrench.turning_moment,
            turning_resistance: point.wrench.turning_resistance_moment,
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
        let steps = (fastest * seconds / LONGEST_TURN).ceil().max(1.0);
        let step = seconds / steps;
        for index in 0..steps as usize {
            let start = index as f64 * step;
            let rates = [start, start + 0.5 * step, start + step].map(rolling);
            let heading = self.no_slip.heading;
            // Exact, because the yaw rate is linear in time.
            let middle = heading + (rates[0].1 + rates[1].1) * step / 4.0;
            let end = heading + (rates[0].1 + rates[2].1) * step / 2.0;
            let weighted = [rates[0].0, 4.0 * rates[1].0, rates[2].0];
            for (speed, heading) in weighted.into_iter().zip([heading, middle, end]) {
                self.no_slip.x += step / 6.0 * speed * heading.cos();
                self.no_slip.y += step / 6.0 * speed * heading.sin();
            }
            self.no_slip.heading = end;
        }
    }

    /// Draws the drive as SVG.
    pub fn draw(&self, terrain: &str) -> String {
        let [start, end] = [self.points.first(), self.points.last()]
            .map(|point| point.map_or(0.0, |point| point.time));
        let title = format!("{:.6} s on {terrain}", end - start);
        let title = title.replacen(".000000 s", " s", 1);
        let time_label = match start {
            0.0 => "time [s]".into(),
            start => format!("time after {start} s [s]"),
        };
        let over_time = |title: &str, y_label: &str, lines: Vec<Line>| Chart {
            lines,
            underlays: vec![("", Underlay::Zero)],
            height: HEIGHT,
            ..Chart::new(title, time_label.clone(), y_label)
        };
        let line = |name: &str, value: fn(&TracePoint) -> f64| {
            self.line(name, |point| (point.time - start, value(point)))
        };
        let path = Chart {
            lines: vec![
                self.line("driven", |point| (point.state.x, point.state.y)),
                self.line("rolling without slip", |point| {
                    (point.no_slip.x, point.no_slip.y)
                }),
                self.start(),
            ],
            is_map: true,
            height: HEIGHT,
            ..Chart::new("Path", "x, east [m]", "y, north [m]")
        };
        let speeds = over_time(
            "Wheel rims and vehicle",
            "speed [m/s]",
            vec![
                line("r \u{3c9} left", |point| point.rim_speeds[0]),
                line("r \u{3c9} right", |point| point.rim_speeds[1]),
                line("V_X", |point| point.state.v_x),
                line("V_Y", |point| point.state.v_y),
            ],
        );
        let slips = over_time(
            "Longitudinal slip at the wheels' lowest points",
            "slip [-]",
            vec![
                line("left wheels", |point| point.slips[0]),
                line("right wheels", |point| point.slips[1]),
            ],
        );
        let resistances = over_time(
            "Resistance and moments",
            "force [N], moment [N m]",
            vec![
                line("rolling resistance [N]", |point| point.rolling_resistance),
                line("turning moment [N m]", |point| point.turning_moment),
                line("turning resistance [N m]", |point| point.turning_resistance),
            ],
        );
        sheet(&title, &[path, speeds, slips, resistances])
    }

    fn line(&self, name: &str, point: impl Fn(&TracePoint) -> (f64, f64)) -> Line {
        Line {
            name: name.into(),
            pieces: vec![self.points.iter().map(point).collect()],
            ..Line::default()
        }
    }

    fn start(&self) -> Line {
        let start = self.points.iter().take(1);
        Line {
            name: "start".into(),
            pieces: vec![start.map(|point| (point.state.x, point.state.y)).collect()],
            stroke: Stroke::Points,
            ..Line::default()
        }
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
