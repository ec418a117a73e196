//! Manoeuvres as wheel speeds: smooth, from rest to rest, about half a minute each.
//!
//! Speeds follow those of the recordings; in bends they stay below a lateral acceleration that every vehicle bears.

use crate::recording::{Drive, Recording};
use crate::vehicle::Vehicle;
use std::f64::consts::{PI, TAU};

/// Wheel rim speeds \[m/s\] at the end of a ramp.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Key {
    /// Duration \[s\].
    seconds: f64,
    /// Mean of both sides.
    forward: f64,
    /// Half the difference, right minus left.
    turn: f64,
}

/// A manoeuvre.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Name.
    pub name: &'static str,
    keys: Vec<Key>,
    /// Duration of its main section \[s\].
    pub part: f64,
    /// Number of repetitions.
    pub times: usize,
}

/// Speed and dimensions that limit manoeuvres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveLimits {
    /// Wheel rim speed in the recordings \[m/s\].
    pub speed: f64,
    /// Wheel radius \[m\].
    pub wheel_radius: f64,
    /// Half the track \[m\].
    pub half_track: f64,
}

/// Time step of the wheel speeds \[s\].
pub const STEP: f64 = 0.2;
/// Maximum acceleration \[m/s^2\].
const ACCELERATION: f64 = 0.8;
/// Shortest ramp \[s\].
const SHORTEST_RAMP: f64 = 1.0;
/// Maximum lateral acceleration in bends \[m/s^2\].
const LATERAL: f64 = 1.5;
/// Maximum rate of pivots for wheels without slip \[rad/s\].
const PIVOT: f64 = 1.5;
/// Repetitions end after this time \[s\].
const LONG: f64 = 32.0;
/// Quantile of the recorded wheel speeds that counts as reached.
const QUANTILE: f64 = 0.9;
/// Slower wheels stand \[rad/s\].
const STANDSTILL: f64 = 0.05;
/// Turns as shares of the speed: of wide circles, tight ones, and a slalom's swing.
const WIDE: f64 = 0.2;
const TIGHT: f64 = 0.45;
const SWING: f64 = 0.35;

impl DriveLimits {
    /// The limits from recordings. `None` if the wheels never turn.
    #[must_use]
    pub fn of(recordings: &[Recording], vehicle: &Vehicle) -> Option<Self> {
        let runs = recordings.iter().flat_map(|recording| &recording.runs);
        let mut speeds: Vec<f64> = runs
            .filter_map(crate::recording::Run::drive)
            .flat_map(|drive| {
                let fastest = |row| {
                    let [left, right] = drive.wheel_speeds(row).map(f64::abs);
                    left.max(right)
                };
                (0..drive.len()).map(fastest).collect::<Vec<f64>>()
            })
            .filter(|speed| *speed > STANDSTILL)
            .collect();
        speeds.sort_by(f64::total_cmp);
        let last = speeds.len().checked_sub(1)?;
        Some(Self {
            speed: speeds[(QUANTILE * last as f64).round() as usize] * vehicle.wheel_radius,
            wheel_radius: vehicle.wheel_radius,
            half_track: vehicle.half_track,
        })
    }

    /// Speed in a bend with this turn as a share of the speed.
    fn bend(&self, turn: f64) -> f64 {
        let bearable = (LATERAL * self.half_track / turn).sqrt();
        bearable.min(self.speed / (1.0 + turn))
    }

    fn pivot(&self) -> f64 {
        (0.4 * self.speed).min(PIVOT * self.half_track)
    }
}

/// All manoeuvres. `yaw_rate` gives the steady yaw rate at a forward speed and turn of the rims; manoeuvres that need
/// it are omitted without a value.
#[must_use]
pub fn courses(reach: &DriveLimits, yaw_rate: impl Fn(f64, f64) -> Option<f64>) -> Vec<Course> {
    let (top, pivot) = (reach.speed, reach.pivot());
    let mut all = vec![
        Course::new("straight", 28.0).to(0.6 * top, 0.0, 28.0),
        [0.3, 0.6, 1.0, 0.45]
            .into_iter()
            .fold(Course::new("varied_speed", 6.0), |course, share| {
                course.to(share * top, 0.0, 6.0)
            }),
        Course::new("accelerate_and_brake", 1.0).repeat(|course, _| {
            let fast = course.to(top, 0.0, 1.0);
            fast.to(0.25 * top, 0.0, 1.0)
        }),
        Course::new("stop_and_go", 3.0)
            .repeat(|course, _| course.to(0.7 * top, 0.0, 3.0).to(0.0, 0.0, 1.5)),
    ];
    let speed = reach.bend(SWING);
    let slalom = Course::new("slalom", 3.0).to(speed, 0.0, 1.0);
    all.push(slalom.repeat(|course, count| {
        let side = if count % 2 == 0 { 1.0 } else { -1.0 };
        course.glide(speed, side * SWING * speed, 3.0)
    }));
    let speed = reach.bend(TIGHT);
    let spiral = Course::new("spiral", 28.0).to(speed, 0.0, 1.0);
    all.push(spiral.glide(speed, TIGHT * speed, 28.0));
    let speed = reach.bend(WIDE);
    let left = Course::new("circles", 14.0).to(speed, WIDE * speed, 14.0);
    all.push(left.to(speed, -WIDE * speed, 14.0));
    let left = Course::new("pivots", 11.0).to(0.0, pivot, 11.0);
    all.push(left.to(0.0, 0.0, 1.0).to(0.0, -pivot, 11.0));
    let speed = reach.bend(TIGHT);
    if let Some(rate) = yaw_rate(speed, TIGHT * speed) {
        let round = (TAU / rate).clamp(4.0, 18.0);
        let left = Course::new("figure_eight", round).to(speed, TIGHT * speed, round);
        all.push(left.to(speed, -TIGHT * speed, round));
    }
    if let Some(rate) = yaw_rate(0.0, pivot) {
        let there = Course::new("there_and_back", 12.0).to(0.6 * top, 0.0, 12.0);
        let turned = there.to(0.0, 0.0, 0.5);
        // The ramps together turn by half of what as long a steady turn would.
        let held = (PI / rate - ramp(pivot)).clamp(0.0, 15.0);
        let turned = turned.to(0.0, pivot, held).to(0.0, 0.0, 0.5);
        all.push(turned.to(0.6 * top, 0.0, 12.0));
    }
    all.into_iter()
        .map(|course| course.to(0.0, 0.0, 0.5))
        .collect()
}

/// A steady turn, for its yaw rate.
#[must_use]
pub fn steady(forward: f64, turn: f64) -> Course {
    Course::new("steady", 4.0).to(forward, turn, 4.0)
}

/// Duration of a change of speed \[s\].
fn ramp(change: f64) -> f64 {
    // The cubic step is half again as steep in its middle as on average.
    (1.5 * change.abs() / ACCELERATION).max(SHORTEST_RAMP)
}

impl Course {
    fn new(name: &'static str, part: f64) -> Self {
        Self {
            name,
            keys: vec![Key {
                seconds: 0.0,
                forward: 0.0,
                turn: 0.0,
            }],
            part,
            times: 1,
        }
    }

    /// Reaches speeds and holds them.
    fn to(self, forward: f64, turn: f64, held: f64) -> Self {
        let mut course = self.glide(forward, turn, 0.0);
        course.keys.push(Key {
            seconds: held,
            forward,
            turn,
        });
        course
    }

    /// Reaches speeds within this time, or at maximum acceleration.
    fn glide(mut self, forward: f64, turn: f64, seconds: f64) -> Self {
        let last = self.keys[self.keys.len() - 1];
        let change = (forward - last.forward).abs() + (turn - last.turn).abs();
        self.keys.push(Key {
            seconds: ramp(change).max(seconds),
            forward,
            turn,
        });
        self
    }

    /// Repeats a section until the course is long enough.
    fn repeat(mut self, each: impl Fn(Self, usize) -> Self) -> Self {
        self.times = 0;
        while self.seconds() < LONG {
            let times = self.times;
            self = each(self, times);
            self.times = times + 1;
        }
        self
    }

    /// Duration \[s\].
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.keys.iter().map(|key| key.seconds).sum()
    }

    /// Rim speeds of both sides at a time \[m/s\].
    fn sides(&self, time: f64) -> [f64; 2] {
        let mut end = 0.0;
        let pair = self.keys.windows(2).find(|pair| {
            end += pair[1].seconds;
            time < end
        });
        let Some([from, to]) = pair.and_then(|pair| <[Key; 2]>::try_from(pair).ok()) else {
            let last = self.keys[self.keys.len() - 1];
            return [last.forward - last.turn, last.forward + last.turn];
        };
        let share = 1.0 - (end - time) / to.seconds;
        let step = share * share * (3.0 - 2.0 * share);
        let at = |from: f64, to: f64| from + step * (to - from);
        let (forward, turn) = (at(from.forward, to.forward), at(from.turn, to.turn));
        [forward - turn, forward + turn]
    }

    /// The wheel speeds.
    #[must_use]
    pub fn drive(&self, wheel_radius: f64) -> Drive {
        let rows = (self.seconds() / STEP).ceil() as usize;
        let time: Vec<f64> = (0..=rows).map(|row| row as f64 * STEP).collect();
        let side = |side: usize| {
            let each = time.iter();
            each.map(|time| self.sides(*time)[side] / wheel_radius)
                .collect()
        };
        Drive {
            omega_left: side(0),
            omega_right: side(1),
            filled_rows: 0,
            time,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{Channel, Run};

    fn reach() -> DriveLimits {
        DriveLimits {
            speed: 1.2,
            wheel_radius: 0.2,
            half_track: 0.4,
        }
    }

    #[test]
    fn courses_are_smooth_from_rest_to_rest_within_reach() {
        let all = courses(&reach(), |_, turn| Some(turn));
        assert_eq!(all.len(), 10);
        for course in &all {
            let drive = course.drive(0.2);
            let name = course.name;
            assert!((18.0..45.0).contains(&course.seconds()), "{name}");
            assert_eq!(drive.wheel_speeds(0), [0.0; 2], "{name}");
            assert!(
                drive.wheel_speeds(drive.len() - 1)[0].abs() < 1e-9,
                "{name}"
            );
            for row in 0..drive.len() {
                let rim = |values: [f64; 2]| values.map(|v| (0.2 * v).abs());
                for speed in rim(drive.wheel_speeds(row)) {
                    assert!(speed <= 1.2 + 1e-9, "{name} {speed}");
                }
                for rate in rim(drive.wheel_accelerations(row)) {
                    assert!(rate <= ACCELERATION + 1e-9, "{name} {rate}");
                }
            }
        }
        // Without a yaw rate, manoeuvres that need it are omitted.
        assert_eq!(courses(&reach(), |_, _| None).len(), 8);
    }

    #[test]
    fn reach_is_what_the_wheels_did() {
        let series = |speed: f64| (0..100).map(|k| (f64::from(k), speed)).collect();
        let run = Run::new("")
            .with(Channel::OmegaLeft, series(-3.0))
            .with(Channel::OmegaRight, series(2.0));
        let mut recording = Recording {
            runs: vec![run],
            ..Recording::default()
        };
        let vehicle = Vehicle::tran2007();
        let found = DriveLimits::of(std::slice::from_ref(&recording), &vehicle).unwrap();
        assert!((found.speed - 3.0 * vehicle.wheel_radius).abs() < 1e-12);
        recording.runs.clear();
        assert_eq!(DriveLimits::of(&[recording], &vehicle), None);
    }
}
