//! The recording's columns from samples of one topic each.

use super::attitude::{Yaw, unwrap};
use super::collect::{FixSample, ImuSample, OdometrySample};
use super::geodesy::LocalPlane;
use super::mounting::Mounting;
use super::twist::is_in_world;
use super::wheels::Series;

/// A column of the recording with its origin.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name in the recording.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The topic.
    pub topic: String,
    /// What of the topic's messages it is, and how it was converted.
    pub conversion: String,
    /// Times \[ns\] since 1970, increasing, with finite values.
    pub samples: Vec<(i64, f64)>,
}

/// Columns in the order of the recording, with their units.
const ORDER: [(&str, &str); 10] = [
    ("omega_left", "rad/s"),
    ("omega_right", "rad/s"),
    ("x", "m"),
    ("y", "m"),
    ("heading", "rad"),
    ("v_x", "m/s"),
    ("v_y", "m/s"),
    ("yaw_rate", "rad/s"),
    ("a_x", "m/s^2"),
    ("a_y", "m/s^2"),
];

/// What an accelerometer measures besides acceleration.
const TILT: &str = ", at the sensor, with gravity's part where it tilts";

/// Columns so far, and what is to be said about them.
#[derive(Debug, Default)]
pub(super) struct Columns {
    pub columns: Vec<Column>,
    pub notes: Vec<String>,
}

impl Columns {
    /// Adds a column; samples that are not finite are missing. Returns whether any is left.
    pub fn push(&mut self, name: &str, topic: &str, conversion: &str, samples: Series) -> bool {
        let Some((name, unit)) = ORDER.into_iter().find(|(known, _)| *known == name) else {
            return false;
        };
        let before = samples.len();
        let finite = |(_, value): &(i64, f64)| value.is_finite();
        let samples: Series = samples.into_iter().filter(finite).collect();
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
            name,
            unit,
            topic: topic.into(),
            conversion: conversion.into(),
            samples,
        });
        true
    }

    /// The same for what publishers fill with zeros when they do not measure it.
    fn push_measured(
        &mut self,
        name: &str,
        topic: &str,
        conversion: &str,
        samples: Series,
    ) -> bool {
        if !samples.is_empty() && samples.iter().all(|(_, value)| *value == 0.0) {
            self.notes.push(format!(
                "{name}: {topic} says exactly zero throughout, as publishers do that do not measure \
                 it; left out"
            ));
            return false;
        }
        self.push(name, topic, conversion, samples)
    }

    /// Heading without jumps at half a turn, where it is asked for also one of zero throughout. Returns whether any attitude
    /// is known.
    pub fn heading(
        &mut self,
        topic: &str,
        is_asked: bool,
        attitudes: impl Iterator<Item = (i64, Option<Yaw>)>,
    ) -> bool {
        let mut headings = Series::new();
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
        let conversion = "yaw of the orientation, counted on over whole turns";
        if is_asked {
            self.push("heading", topic, conversion, headings)
        } else {
            self.push_measured("heading", topic, conversion, headings)
        }
    }

    /// Position of odometry.
    pub fn position(&mut self, topic: &str, samples: &[(i64, OdometrySample)]) {
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            let values = series(samples, |sample| sample.position[axis]);
            self.push(name, topic, &format!("pose.pose.position.{name}"), values);
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
            for (axis, (name, field)) in [("v_x", "x"), ("v_y", "y")].into_iter().enumerate() {
                let values = series(samples, |sample| sample.velocity[axis]);
                self.push_measured(name, topic, &format!("twist.twist.linear.{field}"), values);
            }
        }
        if with_yaw_rate {
            let values = series(samples, |sample| sample.yaw_rate);
            self.push_measured("yaw_rate", topic, "twist.twist.angular.z", values);
        }
    }

    /// Yaw rate about the vertical, and the accelerations of an IMU whose axes are known.
    pub fn imu(
        &mut self,
        topic: &str,
        samples: &[(i64, ImuSample)],
        mounting: Mounting,
        z_down: bool,
    ) {
        let (up, conversion, left) = mounting.axis(z_down);
        let rates = measured(samples, |sample| Some(along(up, sample.angular_velocity?)));
        self.push_measured("yaw_rate", topic, &conversion, rates);
        if let Some(left) = left {
            let a_x = measured(samples, |sample| Some(sample.acceleration?[0]));
            self.push_measured("a_x", topic, &format!("linear_acceleration.x{TILT}"), a_x);
            let a_y = measured(samples, |sample| Some(left * sample.acceleration?[1]));
            let turned = if left < 0.0 {
                ", negated: z points down"
            } else {
                ""
            };
            let conversion = format!("linear_acceleration.y{turned}{TILT}");
            self.push_measured("a_y", topic, &conversion, a_y);
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
        for (axis, (name, direction)) in [("x", "east"), ("y", "north")].into_iter().enumerate() {
            let values = places
                .iter()
                .map(|(time, place)| (*time, place[axis]))
                .collect();
            let conversion = format!(
                "metres {direction} of the first fix, {latitude} deg, {longitude} deg, {altitude} m \
                 (WGS-84)"
            );
            self.push(name, topic, &conversion, values);
        }
        true
    }

    /// The columns in the recording's order.
    pub fn sorted(mut self) -> (Vec<Column>, Vec<String>) {
        let place = |name: &str| ORDER.iter().position(|(known, _)| *known == name);
        self.columns.sort_by_key(|column| place(column.name));
        (self.columns, self.notes)
    }
}

fn series<T>(samples: &[(i64, T)], value: impl Fn(&T) -> f64) -> Series {
    let pairs = samples.iter().map(|(time, sample)| (*time, value(sample)));
    pairs.collect()
}

/// A vector's part along an axis, of the components that it needs: another may be no number.
fn along(axis: [f64; 3], vector: [f64; 3]) -> f64 {
    let parts = axis.iter().zip(vector).filter(|(part, _)| **part != 0.0);
    parts.map(|(part, value)| part * value).sum()
}

/// Without what is marked as not measured.
fn measured<T>(samples: &[(i64, T)], value: impl Fn(&T) -> Option<f64>) -> Series {
    let pairs = samples
        .iter()
        .filter_map(|(time, sample)| Some((*time, value(sample)?)));
    pairs.collect()
}

#[cfg(test)]
mod tests;
