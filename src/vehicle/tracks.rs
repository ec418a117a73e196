//! Where the wheels' tracks lie, seen from the vehicle, and the path by which a vehicle approached the start of a drive.

use super::Chassis;
use super::situation::{Pose, Situation};
use crate::scalar::{Dual, Elementary, Scalar};
use std::f64::consts::TAU;

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
    /// Whether a sample is near the vehicle; what is not cannot be met.
    near: Vec<bool>,
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
            near: Vec::new(),
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
                // Tracks that lie farther away than the vehicle is long cross none of its lines.
                let far = places.iter().map(|[ahead, left]| ahead.hypot(*left));
                let far = 3.0 * far.fold(0.0, f64::max) + 2.0 * spacing(&places) + chassis.reach();
                for sample in points.chunks_exact(places.len()) {
                    let [east, north] = sample[0];
                    let near = (east - x).hypot(north - y) < far;
                    view.near.push(near);
                    if near {
                        view.points.extend(sample.iter().map(seen));
                    } else {
                        view.points.extend(sample.iter().map(|_| [f64::NAN; 2]));
                    }
                }
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
        view.near.resize(view.points.len() / places.len(), true);
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
            if !(self.near[sample] && self.near[sample + 1]) {
                continue;
            }
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

/// Slowest speed \[m/s\] at which a vehicle is taken to have come here. Most recordings start at rest, where noise of the
/// velocity decides neither the direction nor the curvature of the way there.
const CRAWL: f64 = 0.05;
/// For how long the present motion is taken to have lasted, and how far a vehicle is taken to have come straight on to
/// where a course starts, in samples.
const STEADY_SAMPLES: usize = 3 * SAMPLES_PER_BASE as usize;
/// A vehicle approached the start of a course in reverse if the course leads backwards by at least so many samples.
const BACK_SAMPLES: f64 = 0.5 * SAMPLES_PER_BASE;

/// How a vehicle came here.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum ApproachPath {
    /// In its present motion, whatever it is.
    Steadily,
    /// Over these poses, the oldest first, seen from the present one: ahead, to the left \[m\] and turned \[rad\].
    Along(Vec<[f64; 3]>),
}

impl ApproachPath {
    /// Over a course of poses as of [`ApproachPath::Along`], of which enough are kept for tracks; straight up to its start.
    pub fn along(places: &[[f64; 2]], course: &[[f64; 3]]) -> Self {
        Self::Along(course_samples(places, course))
    }

    /// As models see it.
    pub fn tracks(&self) -> Tracks<'_> {
        match self {
            Self::Steadily => Tracks::STEADY,
            Self::Along(course) => Tracks::along(course),
        }
    }

    /// Poses x, y, heading in which a vehicle left samples that is now in the state of these numbers.
    pub fn poses(&self, places: &[[f64; 2]], state: [f64; 6]) -> Vec<[f64; 3]> {
        let [x, y, heading, v_x, v_y, yaw_rate] = state;
        let (pose, velocity) = ([x, y, heading], [v_x, v_y]);
        match self {
            Self::Steadily => steady_seconds(places, velocity, yaw_rate)
                .map(|seconds| steady_pose(seconds, pose, velocity, yaw_rate))
                .collect(),
            Self::Along(course) => course.iter().map(|seen| course_pose(*seen, pose)).collect(),
        }
    }

    /// Derivatives of these poses by the state, one row for each of x, y and heading.
    pub fn slopes(&self, places: &[[f64; 2]], state: [f64; 6]) -> Vec<[[f64; 6]; 3]> {
        match self {
            Self::Steadily => steady_seconds(places, [state[3], state[4]], state[5])
                .map(|seconds| steady_pose_slopes(seconds, state))
                .collect(),
            Self::Along(course) => {
                let each = course.iter();
                each.map(|seen| course_pose_slopes(*seen, state)).collect()
            }
        }
    }
}

/// Seconds ago at which samples were left, the oldest first, where the vehicle came here in its present motion.
pub(super) fn steady_seconds(
    places: &[[f64; 2]],
    velocity: [f64; 2],
    yaw_rate: f64,
) -> impl Iterator<Item = f64> {
    let [x, y] = came_with(velocity);
    let speed = |[ahead, left]: &[f64; 2]| (x - yaw_rate * left).hypot(y + yaw_rate * ahead);
    let fastest = places.iter().map(speed).fold(CRAWL, f64::max);
    let interval = spacing(places) / fastest;
    (0..STEADY_SAMPLES).map(move |sample| (STEADY_SAMPLES - sample) as f64 * interval)
}

/// The pose x, y, heading so many seconds ago of a vehicle that came here in its present motion.
fn steady_pose<S: Scalar>(
    seconds: f64,
    [x, y, heading]: [S; 3],
    velocity: [S; 2],
    yaw_rate: S,
) -> [S; 3] {
    let placed = Placed::before(seconds, velocity, yaw_rate);
    let (sin, cos) = heading.sin_cos();
    [
        x + placed.ahead * cos - placed.left * sin,
        y + placed.ahead * sin + placed.left * cos,
        heading - yaw_rate.scale(seconds),
    ]
}

/// The velocity with which a vehicle came here: at rest, and where it hardly rolls back, straight on.
pub(super) fn came_with<S: Scalar>(velocity: [S; 2]) -> [S; 2] {
    let [x, y] = velocity;
    let sign = if x.value() < -CRAWL { -1.0 } else { 1.0 };
    [x.rounded_abs(CRAWL).scale(sign), y]
}

/// Derivatives of [`steady_pose`] by x, y, heading, both velocities and the yaw rate.
fn steady_pose_slopes(seconds: f64, state: [f64; 6]) -> [[f64; 6]; 3] {
    let [x, y, heading, v_x, v_y, yaw_rate] =
        std::array::from_fn(|k| Dual::<f64, 6>::variable(state[k], k));
    steady_pose(seconds, [x, y, heading], [v_x, v_y], yaw_rate).map(|number| number.eps)
}

/// Of a course the poses at which a vehicle left its tracks, steadily from one to the next where they are far apart, and
/// before them some over which it came straight on.
fn course_samples(places: &[[f64; 2]], course: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let far = spacing(places);
    let points = |pose| wheel_places(pose, places).collect::<Vec<_>>();
    let mut samples = Vec::new();
    let mut last = [0.0; 3];
    let mut left = points(last);
    for pose in course.iter().rev() {
        let pieces = (wheel_travel(&left, *pose, places) / far).floor();
        if pieces < 1.0 {
            continue;
        }
        let room = TRACK_SAMPLES - samples.len();
        let shares = (1..=pieces as usize).map(|piece| piece as f64 / pieces);
        samples.extend(shares.take(room).map(|share| between(last, *pose, share)));
        if samples.len() == TRACK_SAMPLES {
            break;
        }
        last = *pose;
        left = points(last);
    }
    let first = samples.last().copied().unwrap_or([0.0; 3]);
    let (sin, cos) = first[2].sin_cos();
    let back = if in_reverse(&samples, far) { far } else { -far };
    let room = (TRACK_SAMPLES - samples.len()).min(STEADY_SAMPLES);
    samples.extend((1..=room).map(|sample| {
        let way = back * sample as f64;
        [first[0] + way * cos, first[1] + way * sin, first[2]]
    }));
    samples.reverse();
    samples
}

/// Whether the oldest samples, the newest first and so far apart, lead backwards, by more than noise at a standstill does.
fn in_reverse(samples: &[[f64; 3]], far: f64) -> bool {
    let oldest = samples.len().saturating_sub(SAMPLES_PER_BASE as usize)..samples.len();
    let ahead = oldest.map(|k| {
        let from = samples[k];
        let to = k.checked_sub(1).map_or([0.0; 3], |newer| samples[newer]);
        let (sin, cos) = from[2].sin_cos();
        (to[0] - from[0]) * cos + (to[1] - from[1]) * sin
    });
    ahead.sum::<f64>() < -BACK_SAMPLES * far
}

/// The pose after a share of a steady motion from one to another, by the shorter turn: headings may be wrapped.
fn between(from: [f64; 3], to: [f64; 3], share: f64) -> [f64; 3] {
    let [ahead, left, turned] = seen_from(to, from);
    let turned = turned - TAU * (turned / TAU).round();
    let half = 0.5 * turned;
    // A chord is as long as the arc times sin(h)/h, and turned by h, half of what the arc turns.
    let chord = |half: f64| {
        if half.abs() < 1e-4 {
            1.0
        } else {
            half.sin() / half
        }
    };
    let long = share * chord(share * half) / chord(half);
    let (sin, cos) = ((share - 1.0) * half).sin_cos();
    let seen = [
        long * (ahead * cos - left * sin),
        long * (ahead * sin + left * cos),
        share * turned,
    ];
    course_pose(seen, from)
}

/// The pose x, y, heading of a sample of a course that leads to another.
fn course_pose<S: Scalar>(sample: [f64; 3], [x, y, heading]: [S; 3]) -> [S; 3] {
    let (sin, cos) = heading.sin_cos();
    let [ahead, left, turned] = sample;
    [
        x + cos.scale(ahead) - sin.scale(left),
        y + sin.scale(ahead) + cos.scale(left),
        heading.offset(turned),
    ]
}

/// Derivatives of [`course_pose`] by x, y, heading, both velocities and the yaw rate.
fn course_pose_slopes(sample: [f64; 3], state: [f64; 6]) -> [[f64; 6]; 3] {
    let [x, y, heading] = std::array::from_fn(|k| Dual::<f64, 6>::variable(state[k], k));
    course_pose(sample, [x, y, heading]).map(|number| number.eps)
}

/// How a pose looks from another: ahead, to the left \[m\] and turned \[rad\].
#[must_use]
pub fn seen_from(pose: [f64; 3], from: [f64; 3]) -> [f64; 3] {
    let placed = Placed::seen_from(pose, from);
    [placed.ahead, placed.left, pose[2] - from[2]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

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

    const PLACES: [[f64; 2]; 4] = [[0.5, 0.4], [0.5, -0.4], [-0.5, 0.4], [-0.5, -0.4]];

    #[test]
    fn noise_of_a_start_at_rest_hardly_moves_the_way_there() {
        let still = ApproachPath::Steadily.poses(&PLACES, [0.0; 6]);
        for (forward, yaw_rate) in [(2e-3, 1e-3), (-2e-3, 1e-3), (-2e-3, -1e-3)] {
            let noisy =
                ApproachPath::Steadily.poses(&PLACES, [0.0, 0.0, 0.0, forward, 0.0, yaw_rate]);
            for (still, noisy) in still.iter().zip(noisy) {
                let moved = (still[0] - noisy[0]).hypot(still[1] - noisy[1]);
                assert!(moved < 0.1, "{still:?} {noisy:?}");
            }
        }
    }

    #[test]
    fn a_steady_motion_is_where_small_steps_back_lead() {
        for (velocity, yaw_rate) in [([1.2, 0.1], 0.7), ([-0.3, 0.2], -2.0), ([1.0, 0.0], 1e-4)] {
            let start = [3.0, -2.0, 0.4];
            let [x_speed, y_speed] = came_with(velocity);
            let (mut pose, steps) = (start, 100_000);
            let step = 1.5 / f64::from(steps);
            for _ in 0..steps {
                let (sin, cos) = (pose[2] - 0.5 * step * yaw_rate).sin_cos();
                pose[0] -= step * (x_speed * cos - y_speed * sin);
                pose[1] -= step * (x_speed * sin + y_speed * cos);
                pose[2] -= step * yaw_rate;
            }
            let exact = steady_pose(1.5, start, velocity, yaw_rate);
            for (exact, stepped) in exact.iter().zip(pose) {
                assert!((exact - stepped).abs() < 1e-9, "{exact} {stepped}");
            }
        }
    }

    #[test]
    fn samples_of_a_steady_motion_are_as_far_apart_as_those_of_a_drive() {
        let seconds: Vec<f64> = steady_seconds(&PLACES, [1.0, 0.0], 0.0).collect();
        assert_eq!(seconds.len(), STEADY_SAMPLES);
        assert!(seconds.windows(2).all(|pair| pair[0] > pair[1]));
        let apart = seconds[STEADY_SAMPLES - 1] * 1.0;
        assert!(
            (apart / spacing(&PLACES) - 1.0).abs() < CRAWL * CRAWL,
            "{apart}"
        );
    }

    #[test]
    fn a_course_is_left_in_samples_as_far_apart_as_those_of_a_drive_and_led_to_straight_on() {
        // In reverse: it comes from ahead.
        let course: Vec<[f64; 3]> = (1..=40)
            .rev()
            .map(|k| [0.021 * f64::from(k), 0.0, 0.0])
            .collect();
        let samples = course_samples(&PLACES, &course);
        assert_eq!(samples.len(), 8 + STEADY_SAMPLES);
        for pair in samples.windows(2) {
            let apart = pair[0][0] - pair[1][0];
            assert!((0.0999..0.1051).contains(&apart), "{pair:?}");
        }
        // On the spot the outermost wheel counts.
        let turned = |k: i32| [0.0, 0.0, -0.01 * f64::from(k)];
        let course: Vec<[f64; 3]> = (1..=200).rev().map(turned).collect();
        let samples = course_samples(&PLACES, &course);
        let radius = 0.5f64.hypot(0.4);
        let steps = samples[STEADY_SAMPLES..].windows(2);
        for pair in steps.map(|pair| radius * (pair[1][2] - pair[0][2])) {
            assert!((0.1..0.1 + 0.01 * radius).contains(&pair), "{pair}");
        }
        // A vehicle that stood came straight on; a long course takes all samples.
        assert_eq!(
            course_samples(&PLACES, &[[0.0; 3]; 9]).len(),
            STEADY_SAMPLES
        );
        let long: Vec<[f64; 3]> = (1..=900)
            .rev()
            .map(|k| [-0.1 * f64::from(k), 0.0, 0.0])
            .collect();
        assert_eq!(course_samples(&PLACES, &long).len(), TRACK_SAMPLES);
    }

    #[test]
    fn poses_that_are_far_apart_are_joined_by_a_steady_motion() {
        // On a circle of 1 m with the outer wheels 0.1 m apart: two poses are as good as many.
        let at = |angle: f64| [angle.sin(), 1.0 - angle.cos(), angle];
        let [many, few] = [0.005, 0.8].map(|step: f64| {
            let poses = (1..=(1.6 / step).round() as i32).rev();
            let course: Vec<[f64; 3]> = poses.map(|k| at(-step * f64::from(k))).collect();
            course_samples(&PLACES, &course)
        });
        for samples in [&many, &few] {
            for [x, y, heading] in samples[STEADY_SAMPLES..].iter().copied() {
                let [exact_x, exact_y, _] = at(heading);
                assert!((x - exact_x).hypot(y - exact_y) < 1e-9, "{x} {y}");
            }
        }
        assert!(
            many.len().abs_diff(few.len()) <= 3,
            "{} {}",
            many.len(),
            few.len()
        );
        // Far more than there is room for.
        let far = course_samples(&PLACES, &[[-1e9, 0.0, 0.0]]);
        assert_eq!(far.len(), TRACK_SAMPLES);
        assert!(
            far.windows(2)
                .all(|pair| (pair[1][0] - pair[0][0] - 0.1).abs() < 1e-3)
        );
        // On the spot, with headings that are wrapped.
        let [x, y, heading] = between([1.0, 2.0, 3.0], [1.0, 2.0, -3.0], 0.5);
        assert_eq!((x, y), (1.0, 2.0));
        assert!((heading - PI).abs() < 1e-12, "{heading}");
    }

    #[test]
    fn noise_at_a_standstill_does_not_lay_tracks_ahead() {
        for x in [0.07, 0.12, -0.12] {
            let samples = course_samples(&PLACES, &[[x, 0.0, 0.0], [x - 0.13, 0.0, 0.0]]);
            assert!(samples[0][0] < -2.0, "{x} {:?}", samples[0]);
        }
    }

    #[test]
    fn poses_of_a_course_move_with_the_pose_that_it_leads_to() {
        let (sample, state) = ([-1.0, 0.3, 0.7], [2.0, -1.0, 0.4, 1.0, 0.1, 0.2]);
        let slopes = course_pose_slopes(sample, state);
        for k in 0..6 {
            let step = 1e-6;
            let at = |sign: f64| {
                let mut state = state;
                state[k] += sign * step;
                course_pose(sample, [state[0], state[1], state[2]])
            };
            let (up, down) = (at(1.0), at(-1.0));
            for row in 0..3 {
                let slope = (up[row] - down[row]) / (2.0 * step);
                assert!((slope - slopes[row][k]).abs() < 1e-8, "{row} {k}");
            }
        }
        let pose = [state[0], state[1], state[2]];
        let seen = seen_from(course_pose(sample, pose), pose);
        assert!(seen.iter().zip(sample).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
