//! Where the wheels' tracks lie, seen from the vehicle.

use super::approach_path::{came_with, steady_seconds};
use super::{Chassis, Situation};
use crate::scalar::{Elementary, Scalar};

/// Samples of the tracks that are kept.
pub(crate) const TRACK_SAMPLES: usize = 128;
/// Samples over the distance from the first row to the last.
pub(super) const SAMPLES_PER_BASE: f64 = 10.0;
/// Half angle \[rad\] of an arc below which its chord is a series.
const SMALL: f64 = 1e-2;
/// Length \[m\] below which a piece of a track lies along the line on which a wheel meets it, not across.
const ALONG: f64 = 1e-9;

/// The tracks that the wheels left behind; by default none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tracks<'a>(TrackKind<'a>);

#[derive(Debug, Clone, Copy, PartialEq)]
enum TrackKind<'a> {
    Left {
        samples: &'a [f64],
        points: &'a [[f64; 2]],
    },
    Steady,
    Along(&'a [[f64; 3]]),
}

impl Default for TrackKind<'_> {
    fn default() -> Self {
        Self::Left {
            samples: &[],
            points: &[],
        }
    }
}

impl<'a> Tracks<'a> {
    /// As if the vehicle had come here in its present motion, each wheel as deep as now.
    pub(crate) const STEADY: Self = Self(TrackKind::Steady);

    /// As if the vehicle had come here over poses, the oldest first, seen from the present one: ahead, to the left \[m\] and
    /// turned \[rad\]; each wheel as deep as now.
    pub(crate) fn along(course: &'a [[f64; 3]]) -> Self {
        Self(TrackKind::Along(course))
    }

    /// Samples, the oldest first: of each x, y \[m\] and heading \[rad\] of the vehicle, then the depth \[m\] below the
    /// untouched surface to which each wheel pressed the soil there; and where the wheels were, east and north \[m\].
    pub(crate) fn left(samples: &'a [f64], points: &'a [[f64; 2]]) -> Self {
        Self(TrackKind::Left { samples, points })
    }
}

/// Numbers of a sample: the pose, and a depth for each wheel.
pub(crate) fn sample_size(wheels: usize) -> usize {
    3 + wheels
}

/// Distance \[m\] that the fastest wheel goes from one sample to the next, where the wheels are at these places.
pub(crate) fn spacing(places: &[[f64; 2]]) -> f64 {
    let ends = places.first().zip(places.last());
    ends.map_or(1.0, |(first, last)| (first[0] - last[0]).abs()) / SAMPLES_PER_BASE
}

/// East and north of the wheels at these places of a vehicle in a pose x, y, heading.
pub(crate) fn wheel_places(
    [x, y, heading]: [f64; 3],
    places: &[[f64; 2]],
) -> impl Iterator<Item = [f64; 2]> {
    let (sin, cos) = heading.sin_cos();
    let place = move |[ahead, left]: &[f64; 2]| {
        [x + ahead * cos - left * sin, y + ahead * sin + left * cos]
    };
    places.iter().map(place)
}

/// How far the wheel comes that comes furthest from where the wheels were to where they are in a pose \[m\].
pub(crate) fn wheel_travel(from: &[[f64; 2]], to: [f64; 3], places: &[[f64; 2]]) -> f64 {
    let pairs = from.iter().zip(wheel_places(to, places));
    pairs
        .map(|(from, to)| (to[0] - from[0]).hypot(to[1] - from[1]))
        .fold(0.0, f64::max)
}

/// A pose in the frame of another: how far ahead and to the left \[m\], and how far turned.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed<S> {
    pub ahead: S,
    pub left: S,
    sin: S,
    cos: S,
}

impl<S: Scalar> Placed<S> {
    /// The present one.
    fn here() -> Self {
        let [zero, one] = [0.0, 1.0].map(S::constant);
        Self {
            ahead: zero,
            left: zero,
            sin: zero,
            cos: one,
        }
    }

    /// A pose that is already seen from there: ahead, to the left and turned.
    fn at([ahead, left, turned]: [S; 3]) -> Self {
        let (sin, cos) = turned.sin_cos();
        Self {
            ahead,
            left,
            sin,
            cos,
        }
    }

    /// A pose x, y, heading seen from another.
    pub fn seen_from(pose: [S; 3], from: [S; 3]) -> Self {
        let [east, north, turned] = std::array::from_fn(|k| pose[k] - from[k]);
        let (sin, cos) = from[2].sin_cos();
        let (turned_sin, turned_cos) = turned.sin_cos();
        Self {
            ahead: east * cos + north * sin,
            left: north * cos - east * sin,
            sin: turned_sin,
            cos: turned_cos,
        }
    }

    /// Where a vehicle in steady motion was so many seconds ago.
    pub fn before(seconds: f64, velocity: [S; 2], yaw_rate: S) -> Self {
        let [x, y] = came_with(velocity);
        let half = yaw_rate.scale(0.5 * seconds);
        let (half_sin, half_cos) = half.sin_cos();
        let square = half * half;
        let chord = if half.value().abs() < SMALL {
            (square * square).scale(1.0 / 120.0) + square.scale(-1.0 / 6.0).offset(1.0)
        } else {
            half_sin / half
        };
        let chord = chord.scale(-seconds);
        let (sin, cos) = (-yaw_rate.scale(seconds)).sin_cos();
        Self {
            ahead: chord * (x * half_cos + y * half_sin),
            left: chord * (y * half_cos - x * half_sin),
            sin,
            cos,
        }
    }

    /// A place on the vehicle.
    fn point(&self, [ahead, left]: [S; 2]) -> [S; 2] {
        [
            self.ahead + ahead * self.cos - left * self.sin,
            self.left + ahead * self.sin + left * self.cos,
        ]
    }
}

/// A part of a wheel's track: between a sample and the one that follows, or the present.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Crossing {
    pub wheel: usize,
    pub sample: usize,
}

/// A sample of one wheel's track.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark<S> {
    pub placed: Placed<S>,
    pub depth: S,
}

/// A line across the vehicle on which a wheel meets the soil.
#[derive(Debug, Clone, Copy)]
pub(super) struct Front<S> {
    /// How far ahead of the reference point it lies, and how far to the left the wheel's middle \[m\].
    pub place: [S; 2],
    /// The wheel's width \[m\].
    pub width: f64,
}

impl<S: Scalar> Front<S> {
    /// Depth of a track where it crosses the line \[m\], less what lies beside the wheel.
    pub fn met(&self, from: &Mark<S>, to: &Mark<S>, wheel: [S; 2]) -> S {
        self.between(
            from.placed.point(wheel),
            to.placed.point(wheel),
            from.depth,
            to.depth,
        )
    }

    fn between(&self, from: [S; 2], to: [S; 2], depth: S, deeper: S) -> S {
        let part = (self.place[0] - from[0]) / (to[0] - from[0]);
        let along = |a: S, b: S| a + part * (b - a);
        let beside = (along(from[1], to[1]) - self.place[1]).scale(1.0 / self.width);
        along(depth, deeper) / (beside * beside).offset(1.0)
    }
}

/// All tracks as they lie around the vehicle.
pub(super) struct View<'a> {
    /// Numbers of the recorded samples.
    samples: &'a [f64],
    wheels: usize,
    /// Seconds ago at which each sample was left, in a steady motion.
    seconds: Vec<f64>,
    /// Poses at which each sample was left, where the vehicle came here over these.
    course: &'a [[f64; 3]],
    /// How deep each wheel stands now \[m\].
    depths: Vec<f64>,
    /// Every wheel's points, sample by sample, the present ones last: ahead and to the left \[m\].
    points: Vec<[f64; 2]>,
}

impl<'a> View<'a> {
    pub fn new<S: Scalar>(
        tracks: Tracks<'a>,
        chassis: &Chassis<S>,
        at: &Situation<S>,
        depths: &[S],
    ) -> Self {
        let places = chassis.places();
        let at = Pose {
            place: [at.position[0], at.position[1], at.heading].map(|x| x.value()),
            velocity: at.velocity.map(|x| x.value()),
            yaw_rate: at.yaw_rate.value(),
        };
        let mut view = Self {
            samples: &[],
            wheels: places.len(),
            seconds: Vec::new(),
            course: &[],
            depths: depths.iter().map(|depth| depth.value()).collect(),
            points: Vec::new(),
        };
        match tracks.0 {
            TrackKind::Left { samples, points } => {
                view.samples = samples;
                let [x, y, heading] = at.place;
                let (sin, cos) = heading.sin_cos();
                let seen = |[east, north]: &[f64; 2]| {
                    let (east, north) = (east - x, north - y);
                    [east * cos + north * sin, north * cos - east * sin]
                };
                view.points.extend(points.iter().map(seen));
            }
            TrackKind::Steady => {
                view.seconds = steady_seconds(&places, at.velocity, at.yaw_rate).collect();
                for seconds in &view.seconds {
                    let placed = Placed::before(*seconds, at.velocity, at.yaw_rate);
                    let points = places.iter().map(|place| placed.point(*place));
                    view.points.extend(points);
                }
            }
            TrackKind::Along(course) => {
                view.course = course;
                for pose in course {
                    let placed = Placed::at(*pose);
                    let points = places.iter().map(|place| placed.point(*place));
                    view.points.extend(points);
                }
            }
        }
        view.points.extend(&places);
        view
    }

    /// The numbers of a recorded sample; `None` for the present and for what is steady.
    pub fn recorded(&self, sample: usize) -> Option<&'a [f64]> {
        let size = sample_size(self.wheels);
        self.samples.get(sample * size..(sample + 1) * size)
    }

    fn placed<S: Scalar>(&self, sample: usize, at: &Pose<S>) -> Placed<S> {
        if let Some(numbers) = self.recorded(sample) {
            let pose = [numbers[0], numbers[1], numbers[2]].map(S::constant);
            return Placed::seen_from(pose, at.place);
        }
        if let Some(pose) = self.course.get(sample) {
            return Placed::at(pose.map(S::constant));
        }
        let seconds = self.seconds.get(sample);
        seconds.map_or(Placed::here(), |seconds| {
            Placed::before(*seconds, at.velocity, at.yaw_rate)
        })
    }

    /// A wheel's track at a sample; `now` is how deep the wheel stands.
    pub fn mark<S: Scalar>(&self, crossing: Crossing, at: &Pose<S>, now: S) -> Mark<S> {
        let Crossing { wheel, sample } = crossing;
        let depth = self.recorded(sample).map(|n| S::constant(n[3 + wheel]));
        Mark {
            placed: self.placed(sample, at),
            depth: depth.unwrap_or(now),
        }
    }

    fn depth(&self, sample: usize, wheel: usize) -> f64 {
        self.recorded(sample)
            .map_or(self.depths[wheel], |numbers| numbers[3 + wheel])
    }

    /// Of all tracks that cross a line the one that leaves the wheel the deepest rut.
    pub fn deepest(&self, front: &Front<f64>) -> Option<Crossing> {
        let mut deepest = (0.0, None);
        let rows = self.points.chunks_exact(self.wheels);
        let pairs = rows.clone().zip(rows.skip(1)).enumerate();
        for (sample, (from, to)) in pairs {
            for (wheel, (from, to)) in from.iter().zip(to).enumerate() {
                let across = (from[0] > front.place[0]) != (to[0] > front.place[0]);
                if !across || (to[0] - from[0]).abs() < ALONG {
                    continue;
                }
                let depths = [sample, sample + 1].map(|sample| self.depth(sample, wheel));
                let met = front.between(*from, *to, depths[0], depths[1]);
                if met > deepest.0 {
                    deepest = (met, Some(Crossing { wheel, sample }));
                }
            }
        }
        deepest.1
    }
}

/// Where a vehicle is and how it moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pose<S> {
    pub place: [S; 3],
    pub velocity: [S; 2],
    pub yaw_rate: S,
}

impl<S: Copy> Situation<S> {
    /// Where the vehicle is and how it moves.
    pub(super) fn pose(&self) -> Pose<S> {
        Pose {
            place: [self.position[0], self.position[1], self.heading],
            velocity: self.velocity,
            yaw_rate: self.yaw_rate,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_track_beside_the_wheel_by_its_width_is_half_as_deep() {
        let front = Front {
            place: [0.0, 0.4],
            width: 0.2,
        };
        let [back, ahead] = [-1.0, 1.0].map(|ahead| Mark {
            placed: Placed {
                ahead,
                ..Placed::here()
            },
            depth: 0.02 + 0.01 * ahead,
        });
        assert!((front.met(&back, &ahead, [0.0, 0.4]) - 0.02).abs() < 1e-15);
        assert!((front.met(&back, &ahead, [0.0, 0.6]) - 0.01).abs() < 1e-15);
        assert!(front.met(&back, &ahead, [0.0, 1.4]) < 0.02 * 0.05);
    }
}
