//! The columns of the recording, each from the samples of one topic.

use super::attitude::{Yaw, unwrap};
use super::collect::{FixSample, ImuSample, OdometrySample, TimedValues, WheelSample};
use super::geodesy::LocalPlane;
use super::message::Load;
use super::mounting::Mounting;
use super::twist::is_in_world;
use crate::recording::Channel;

/// A column of the recording with its source.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its channel; `None` if the recording's reader does not know it.
    pub channel: Option<Channel>,
    /// Its name.
    pub name: &'static str,
    /// Unit of its values.
    pub unit: &'static str,
    /// The topic.
    pub topic: String,
    /// The field of the topic's messages and its conversion.
    pub conversion: String,
    /// Times \[ns\] since 1970, increasing, with finite values.
    pub samples: Vec<(i64, f64)>,
}

/// Remark on accelerations in a conversion.
const TILT: &str = ", at the sensor, including gravity if it tilts";

/// The columns so far, with notes.
#[derive(Debug, Default)]
pub(super) struct ColumnBuilder {
    pub columns: Vec<Column>,
    pub notes: Vec<String>,
}

impl ColumnBuilder {
    /// Adds a column without the samples that are not finite. Returns whether it has any.
    pub fn push(
        &mut self,
        channel: Channel,
        topic: &str,
        conversion: &str,
        samples: TimedValues,
    ) -> bool {
        let names = (channel.name(), channel.unit());
        self.push_named(Some(channel), names, topic, conversion, samples)
    }

    /// The same with name and unit, for a column that may be no channel.
    fn push_named(
        &mut self,
        channel: Option<Channel>,
        (name, unit): (&'static str, &'static str),
        topic: &str,
        conversion: &str,
        samples: TimedValues,
    ) -> bool {
        let before = samples.len();
        let finite = |(_, value): &(i64, f64)| value.is_finite();
        let samples: TimedValues = samples.into_iter().filter(finite).collect();
        let lost = before - samples.len();
        if lost > 0 {
            self.notes.push(format!(
                "{name}: {lost} of {before} values of {topic} are no finite numbers; left out"
            ));
        }
        if samples.is_empty() {
            return false;
        }
        self.columns.push(Column {
            channel,
            name,
            unit,
            topic: topic.into(),
            conversion: conversion.into(),
            samples,
        });
        true
    }

    /// The same for a value that publishers set to zero if they do not measure it.
    fn push_measured(
        &mut self,
        channel: Channel,
        topic: &str,
        conversion: &str,
        samples: TimedValues,
    ) -> bool {
        if !samples.is_empty() && samples.iter().all(|(_, value)| *value == 0.0) {
            self.notes.push(format!(
                "{channel}: {topic} is exactly zero throughout, as from publishers that do not measure it; \
                 left out"
            ));
            return false;
        }
        self.push(channel, topic, conversion, samples)
    }

    /// The unwrapped heading; one of zero throughout only if the user requested it. Returns whether any attitude is known.
    pub fn heading(
        &mut self,
        topic: &str,
        is_requested: bool,
        attitudes: impl Iterator<Item = (i64, Option<Yaw>)>,
    ) -> bool {
        let mut headings = TimedValues::new();
        let (mut total, mut unknown, mut stretched) = (0, 0, 0);
        for (time, attitude) in attitudes {
            total += 1;
            let heading = match attitude {
                Some(Yaw::Of(heading)) => heading,
                Some(Yaw::Normalised(heading)) => {
                    stretched += 1;
                    heading
                }
                Some(Yaw::None) | None => {
                    unknown += 1;
                    continue;
                }
            };
            let before = headings.last().map_or(heading, |(_, before)| *before);
            headings.push((time, unwrap(before, heading)));
        }
        if unknown > 0 {
            self.notes.push(format!(
                "heading: {unknown} of {total} messages of {topic} have no attitude (a quaternion that \
                 is zero, no number, or marked as not measured); left out"
            ));
        }
        if stretched > 0 {
            self.notes.push(format!(
                "heading: {stretched} of {total} quaternions of {topic} are not of length 1; they were \
                 normalised"
            ));
        }
        let conversion = "yaw of the orientation, unwrapped";
        if is_requested {
            self.push(Channel::Heading, topic, conversion, headings)
        } else {
            self.push_measured(Channel::Heading, topic, conversion, headings)
        }
    }

    /// Sums of the joints' efforts or currents of a side; nothing if no joint measures them.
    pub fn loads(&mut self, topic: &str, load: Load, samples: &[(i64, WheelSample)], left: usize) {
        let (names, unit, field) = match load {
            Load::Effort => (["effort_left", "effort_right"], "N m", "effort"),
            Load::Current => (["current_left", "current_right"], "A", "current"),
        };
        for (side, name) in names.into_iter().enumerate() {
            let sum = |sample: &WheelSample| -> f64 {
                let joints = if side == 0 {
                    &sample[..left]
                } else {
                    &sample[left..]
                };
                joints.iter().map(|joint| joint.load).sum()
            };
            let known = |(_, value): &(i64, f64)| value.is_finite();
            let values: TimedValues = series(samples, sum).into_iter().filter(known).collect();
            if values.iter().any(|(_, value)| *value != 0.0) {
                let conversion = format!("{field}, sum of the side's joints");
                self.push_named(None, (name, unit), topic, &conversion, values);
            }
        }
    }

    /// Position of odometry.
    pub fn position(&mut self, topic: &str, samples: &[(i64, OdometrySample)]) {
        for (axis, channel) in [Channel::X, Channel::Y].into_iter().enumerate() {
            let values = series(samples, |sample| sample.position[axis]);
            self.push(channel, topic, &format!("position.{channel}"), values);
        }
    }

    /// Velocities of odometry, with or without the yaw rate.
    pub fn twist(&mut self, topic: &str, samples: &[(i64, OdometrySample)], with_yaw_rate: bool) {
        if is_in_world(samples) {
            self.notes.push(format!(
                "v_x, v_y: those of {topic} fit its positions in the frame of the pose, not in that of \
                 the vehicle, where they belong; left out"
            ));
        } else {
            let fields = [(Channel::VX, "x"), (Channel::VY, "y")];
            for (axis, (channel, field)) in fields.into_iter().enumerate() {
                let values = series(samples, |sample| sample.velocity[axis]);
                let conversion = format!("twist.linear.{field}");
                self.push_measured(channel, topic, &conversion, values);
            }
        }
        if with_yaw_rate {
            let values = series(samples, |sample| sample.yaw_rate);
            self.push_measured(Channel::YawRate, topic, "twist.angular.z", values);
        }
    }

    /// Yaw rate about the vertical, and accelerations if the axes of the IMU are known.
    pub fn imu(
        &mut self,
        topic: &str,
        samples: &[(i64, ImuSample)],
        mounting: Mounting,
        z_down: bool,
    ) {
        let (up, conversion, left) = mounting.axis(z_down);
        let rates = measured(samples, |sample| Some(along(up, sample.angular_velocity?)));
        self.push_measured(Channel::YawRate, topic, &conversion, rates);
        if let Some(left) = left {
            let a_x = measured(samples, |sample| Some(sample.acceleration?[0]));
            self.push_measured(
                Channel::AX,
                topic,
                &format!("linear_acceleration.x{TILT}"),
                a_x,
            );
            let a_y = measured(samples, |sample| Some(left * sample.acceleration?[1]));
            let turned = if left < 0.0 {
                ", negated: z points down"
            } else {
                ""
            };
            let conversion = format!("linear_acceleration.y{turned}{TILT}");
            self.push_measured(Channel::AY, topic, &conversion, a_y);
        }
        self.notes.extend(mounting.note(topic, z_down));
    }

    /// Position of valid satellite fixes, east and north of the first. Returns whether there is any.
    pub fn fixes(&mut self, topic: &str, samples: &[(i64, FixSample)]) -> bool {
        let valid: Vec<&(i64, FixSample)> =
            samples.iter().filter(|(_, fix)| fix.is_valid()).collect();
        let altitudes = valid.iter().map(|(_, fix)| fix.place[2]);
        let altitude = altitudes.clone().find(|altitude| altitude.is_finite());
        let altitude = altitude.unwrap_or(0.0);
        let flat = altitudes.filter(|altitude| !altitude.is_finite()).count();
        let Some([latitude, longitude, _]) = valid.first().map(|(_, fix)| fix.place) else {
            return false;
        };
        if flat > 0 {
            self.notes.push(format!(
                "{topic}: {flat} of {} fixes have no altitude; they count as at {altitude} m",
                valid.len()
            ));
        }
        let plane = LocalPlane::at([latitude, longitude, altitude]);
        let local = |(time, fix): &&(i64, FixSample)| {
            let [latitude, longitude, height] = fix.place;
            let height = if height.is_finite() { height } else { altitude };
            (*time, plane.east_north([latitude, longitude, height]))
        };
        let places: Vec<(i64, [f64; 2])> = valid.iter().map(local).collect();
        let directions = [(Channel::X, "east"), (Channel::Y, "north")];
        for (axis, (channel, direction)) in directions.into_iter().enumerate() {
            let values = places
                .iter()
                .map(|(time, place)| (*time, place[axis]))
                .collect();
            let conversion = format!(
                "metres {direction} of the first fix, {latitude} deg, {longitude} deg, {altitude} m \
                 (WGS-84)"
            );
            self.push(channel, topic, &conversion, values);
        }
        true
    }

    /// The columns in the recording's order.
    pub fn sorted(mut self) -> (Vec<Column>, Vec<String>) {
        self.columns
            .sort_by_key(|column| (column.channel.is_none(), column.channel));
        (self.columns, self.notes)
    }
}

fn series<T>(samples: &[(i64, T)], value: impl Fn(&T) -> f64) -> TimedValues {
    let pairs = samples.iter().map(|(time, sample)| (*time, value(sample)));
    pairs.collect()
}

/// A vector's component along an axis. Components with a factor of zero may be NaN.
fn along(axis: [f64; 3], vector: [f64; 3]) -> f64 {
    let used = axis
        .iter()
        .zip(vector)
        .filter(|(factor, _)| **factor != 0.0);
    used.map(|(factor, value)| factor * value).sum()
}

/// The values that are marked as measured.
fn measured<T>(samples: &[(i64, T)], value: impl Fn(&T) -> Option<f64>) -> TimedValues {
    let pairs = samples
        .iter()
        .filter_map(|(time, sample)| Some((*time, value(sample)?)));
    pairs.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fix(time: i64, status: i8, place: [f64; 3]) -> (i64, FixSample) {
        let sample = FixSample {
            status,
            place,
            deviation: None,
        };
        (time, sample)
    }

    #[test]
    fn columns_are_sorted_and_finite() {
        let mut columns = ColumnBuilder::default();
        assert!(columns.push(
            Channel::X,
            "/a",
            "",
            vec![(0, 1.0), (1, f64::NAN), (2, f64::INFINITY)]
        ));
        assert!(columns.push(Channel::OmegaLeft, "/b", "", vec![(0, 1.0)]));
        assert!(!columns.push(Channel::Y, "/a", "", vec![(0, f64::NAN)]));
        let (columns, notes) = columns.sorted();
        let names: Vec<&str> = columns.iter().map(|column| column.name).collect();
        assert_eq!(names, ["omega_left", "x"]);
        assert_eq!(columns[1].samples, [(0, 1.0)]);
        assert!(notes[0].contains("x: 2 of 3 values"), "{notes:?}");
    }

    #[test]
    fn zeros_throughout_are_no_measurement() {
        let sample = OdometrySample {
            position: [1.0, 2.0],
            yaw: Yaw::Of(0.0),
            velocity: [0.5, 0.0],
            yaw_rate: 0.0,
        };
        let mut columns = ColumnBuilder::default();
        columns.twist("/odom", &[(0, sample.clone()), (1, sample)], true);
        let (columns, notes) = columns.sorted();
        let names: Vec<&str> = columns.iter().map(|column| column.name).collect();
        assert_eq!((names, notes.len()), (vec!["v_x"], 2));
    }

    #[test]
    fn fixes_count_from_the_first_that_is_valid() {
        let nan = f64::NAN;
        let samples = [
            fix(0, -1, [10.0, 20.0, 0.0]),
            fix(1, 0, [nan, 20.0, 0.0]),
            fix(2, 0, [48.0, 11.0, nan]),
            fix(3, 0, [48.0, 11.0, 500.0]),
            fix(4, 0, [48.0, 11.0, 510.0]),
            fix(5, 0, [91.0, 11.0, 510.0]),
        ];
        let mut columns = ColumnBuilder::default();
        assert!(columns.fixes("/fix", &samples));
        let (columns, notes) = columns.sorted();
        let times: Vec<i64> = columns[0].samples.iter().map(|(time, _)| *time).collect();
        assert_eq!(times, [2, 3, 4]);
        assert!(columns[0].samples.iter().all(|(_, east)| east.abs() < 1e-6));
        assert!(
            notes[0].contains("1 of 3 fixes have no altitude"),
            "{notes:?}"
        );
        assert!(!ColumnBuilder::default().fixes("/fix", &samples[..2]));
    }

    #[test]
    fn the_yaw_rate_of_a_camera_is_about_the_vertical() {
        // Its axes point to the right, down and ahead; the vehicle yaws at 0.5 and rolls at 0.1 rad/s.
        let sample = |time: i64| {
            let sample = ImuSample {
                yaw: None,
                angular_velocity: Some([f64::NAN, -0.5, 0.1]),
                acceleration: Some([0.2, -9.81, 0.3]),
            };
            (time, sample)
        };
        let samples: Vec<(i64, ImuSample)> = (0..9).map(sample).collect();
        let mounting = Mounting::Tilted {
            up: [0.0, -1.0, 0.0],
            degrees: 90.0,
            at_rest: true,
        };
        let mut columns = ColumnBuilder::default();
        columns.imu("/camera/imu", &samples, mounting, false);
        let (columns, notes) = columns.sorted();
        assert_eq!(columns.len(), 1, "accelerations are left out");
        assert_eq!(columns[0].channel, Some(Channel::YawRate));
        assert!(columns[0].samples.iter().all(|(_, rate)| *rate == 0.5));
        assert!(notes[0].starts_with("warning: "), "{notes:?}");
        // A sensor upside down has the right sign without an option.
        let mut columns = ColumnBuilder::default();
        columns.imu("/imu", &samples, Mounting::Down, false);
        let (columns, _) = columns.sorted();
        assert_eq!((columns.len(), columns[0].samples[0].1), (1, -0.1));
        let mut columns = ColumnBuilder::default();
        columns.imu("/imu", &samples, Mounting::Upright, false);
        assert_eq!(columns.sorted().0.len(), 3);
    }
}
