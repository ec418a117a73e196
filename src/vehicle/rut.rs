//! The rut that a wheel meets: of all tracks that the wheels left, the deepest before it.

use super::situation::{Pose, Situation};
use super::tracks::{Crossing, Front, Mark, Placed, View};
use super::{Chassis, Tracks};
use crate::contact::Wheel;
use crate::effects::Multipass;
use crate::scalar::{Dual, Elementary, Scalar};
use std::array::from_fn;

/// How far before its axle a wheel meets the soil, and over which way that then works under it, in
/// radii.
const REACH: f64 = 1.0 / 3.0;
/// Least speed over distance \[m\] with a slope: keeps the speed's root smooth.
pub(super) const SPEED_FLOOR: f64 = 1e-18;

/// Wheels, their tracks and how deep they stand.
pub(super) struct Ruts<'a, S> {
    chassis: &'a Chassis<S>,
    effect: &'a Multipass<S>,
    at: &'a Situation<S>,
    view: View<'a>,
    /// How deep each wheel stands below the untouched surface \[m\].
    depths: Vec<S>,
}

/// How the rate of what a wheel meets depends on a sample of a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TrackSlope {
    /// The wheel that meets it, and the one whose track it is.
    pub wheel: usize,
    pub left_by: usize,
    /// Place of the sample among those that are kept.
    pub sample: usize,
    /// By the sample's x, y, heading and depth.
    pub by: [f64; 4],
}

impl<'a, S: Scalar> Ruts<'a, S> {
    pub fn new(
        chassis: &'a Chassis<S>,
        effect: &'a Multipass<S>,
        at: &'a Situation<S>,
        wheel: impl Fn(usize) -> Wheel<S>,
        tracks: Tracks<'a>,
    ) -> Self {
        let wheels = 0..chassis.wheels.len();
        let depths: Vec<S> = wheels.map(|index| depth(&wheel(index))).collect();
        Self {
            view: View::new(tracks, chassis, at, &depths),
            chassis,
            effect,
            at,
            depths,
        }
    }

    /// Where a wheel meets the soil.
    fn front(&self, index: usize) -> Front<S> {
        let wheel = &self.chassis.wheels[index];
        let forward = self.chassis.wheel_motion(self.at, index).forward;
        let way = if forward.value() < 0.0 { -REACH } else { REACH };
        let [ahead, left] = wheel.place;
        Front {
            place: [ahead + wheel.law.radius.scale(way), left],
            width: wheel.law.width,
        }
    }

    fn deepest(&self, front: &Front<S>) -> Option<Crossing> {
        self.view.deepest(&Front {
            place: front.place.map(|x| x.value()),
            width: front.width,
        })
    }

    /// Rate of change \[m/s\] of the depth to which the soil that a wheel meets was pressed before.
    pub fn rate(&self, index: usize, pressed: S) -> S {
        let front = self.front(index);
        let pose = self.at.pose();
        let met = self.deepest(&front).map(|from| {
            let to = Crossing {
                sample: from.sample + 1,
                ..from
            };
            let now = self.depths[from.wheel];
            let [from_mark, to_mark] = [from, to].map(|mark| self.view.mark(mark, &pose, now));
            front.met(&from_mark, &to_mark, self.chassis.wheels[from.wheel].place)
        });
        let arriving = met.map_or(S::constant(0.0), |met| self.effect.memory * met);
        self.pace(index) * (arriving - pressed)
    }

    /// How soon soil has passed under a wheel \[1/s\].
    fn pace(&self, index: usize) -> S {
        let motion = self.chassis.wheel_motion(self.at, index);
        let speed = (motion.forward * motion.forward + motion.lateral * motion.lateral)
            .offset(SPEED_FLOOR)
            .sqrt();
        speed / self.chassis.wheels[index].law.radius.scale(REACH)
    }
}

impl Ruts<'_, f64> {
    /// How the rates of what the wheels meet depend on the tracks' samples.
    pub fn slopes(&self) -> Vec<TrackSlope> {
        let mut slopes = Vec::new();
        for wheel in 0..self.depths.len() {
            let front = self.front(wheel);
            let Some(crossing) = self.deepest(&front) else {
                continue;
            };
            slopes.extend(self.crossing_slopes(wheel, &front, crossing));
        }
        slopes
    }

    fn crossing_slopes(
        &self,
        wheel: usize,
        front: &Front<f64>,
        crossing: Crossing,
    ) -> impl Iterator<Item = TrackSlope> {
        type D = Dual<f64, 8>;
        let lift = D::constant;
        let at = self.at.pose();
        let pose = Pose {
            place: at.place.map(lift),
            velocity: at.velocity.map(lift),
            yaw_rate: lift(at.yaw_rate),
        };
        let left_by = crossing.wheel;
        let ends = [crossing.sample, crossing.sample + 1];
        let [from, to] = [0, 1].map(|end| {
            let sample = ends[end];
            let Some(numbers) = self.view.recorded(sample) else {
                let here = Crossing { sample, ..crossing };
                return self.view.mark(here, &pose, lift(self.depths[left_by]));
            };
            let own = [numbers[0], numbers[1], numbers[2], numbers[3 + left_by]];
            let own: [D; 4] = from_fn(|k| Dual::variable(own[k], 4 * end + k));
            Mark {
                placed: Placed::seen_from([own[0], own[1], own[2]], pose.place),
                depth: own[3],
            }
        });
        let lifted = Front {
            place: front.place.map(lift),
            width: front.width,
        };
        let place = self.chassis.wheels[left_by].place.map(lift);
        let met = lifted.met(&from, &to, place);
        let share = self.pace(wheel) * self.effect.memory;
        let recorded = ends.map(|sample| self.view.recorded(sample).is_some());
        (0..2)
            .filter(move |end| recorded[*end])
            .map(move |end| TrackSlope {
                wheel,
                left_by,
                sample: ends[end],
                by: from_fn(|k| share * met.eps[4 * end + k]),
            })
    }
}

/// Depth of a wheel's lowest point below the untouched surface \[m\]. Where ruts are not felt, all ground is untouched.
fn depth<S: Scalar>(wheel: &Wheel<S>) -> S {
    let sinkage = wheel.law.arc(wheel.reach).sinkage();
    match &wheel.law.multipass {
        Some(effect) => sinkage + effect.rut(wheel.memory.pressed).ground,
        None => sinkage,
    }
}
