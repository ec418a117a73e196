//! The rut that a wheel meets: which row left it, and how far beside its track.

use super::Chassis;
use super::memory::SPEED_FLOOR;
use crate::contact::{Regularisation, WheelLaw, WheelMemory, WheelMotion};
use crate::effects::Multipass;
use crate::scalar::{Elementary, Scalar};

/// Distance \[m\] below which two rows are taken as one behind the other.
const CLOSEST_ROWS: f64 = 1e-3;

/// Rate of change \[m/s\] of the depth to which the soil that a wheel meets was pressed before; entry angles
/// and memory are those of every wheel.
pub(super) fn rate<S: Scalar>(
    chassis: &Chassis<S>,
    effect: &Multipass<S>,
    motion: &WheelMotion<S>,
    laws: &[WheelLaw<S>],
    regularisation: &Regularisation,
    wheels: &[(S, WheelMemory<S>)],
    index: usize,
) -> S {
    // Which row goes ahead depends on where the wheel travels to.
    let onward = (motion.forward.scale(1.0 / regularisation.travel_speed)).smooth_step();
    let forward = motion.forward.rounded_abs(regularisation.travel_speed);
    let speed = (motion.forward * motion.forward + motion.lateral * motion.lateral)
        .offset(SPEED_FLOOR)
        .sqrt();
    let before = |row: usize| chassis.wheels[row].place[0] - chassis.wheels[index].place[0];
    // In a turn the soil on its way from row to row circles with the vehicle: it is carried aside as far
    // as the point midway between them moves aside, not the wheel.
    let missed = |row: usize| {
        let midway = motion.lateral + motion.yaw_rate * before(row).scale(0.5);
        let beside = before(row) * midway / (forward * S::constant(laws[index].width));
        beside * beside
    };
    let mut rate = S::constant(0.0);
    for (share, way) in [
        (onward, Way::Onward),
        (S::constant(1.0) - onward, Way::Back),
    ] {
        let ahead = way.rows_ahead(index, wheels.len());
        let behind = way.turned().rows_ahead(index, wheels.len()).next();
        // The leading row meets untouched soil, as if a row of its own length ahead.
        let Some(neighbour) = ahead.clone().next().or(behind) else {
            continue;
        };
        let arriving = match ahead.clone().map(missed).reduce(S::least) {
            Some(missed) => {
                let (entry, memory) = &wheels[neighbour];
                effect.arriving(depth(&laws[neighbour], *entry, memory), missed)
            }
            None => S::constant(0.0),
        };
        let apart = before(neighbour).rounded_abs(CLOSEST_ROWS);
        rate += share * speed / apart * (arriving - wheels[index].1.pressed);
    }
    rate
}

/// Where a wheel travels to.
#[derive(Clone, Copy)]
enum Way {
    Onward,
    Back,
}

impl Way {
    fn turned(self) -> Self {
        match self {
            Self::Onward => Self::Back,
            Self::Back => Self::Onward,
        }
    }

    /// The wheels ahead of one of so many on its side, the nearest first.
    fn rows_ahead(self, index: usize, count: usize) -> impl Iterator<Item = usize> + Clone {
        let rows = match self {
            Self::Onward => index / 2,
            Self::Back => (count - 1 - index) / 2,
        };
        (1..=rows).map(move |row| match self {
            Self::Onward => index - 2 * row,
            Self::Back => index + 2 * row,
        })
    }
}

/// Depth of a wheel's lowest point below the untouched surface \[m\]. Where ruts are not felt, all ground is untouched.
fn depth<S: Scalar>(law: &WheelLaw<S>, entry: S, memory: &WheelMemory<S>) -> S {
    let sinkage = law.arc(entry).sinkage();
    match &law.multipass {
        Some(effect) => sinkage + effect.rut(memory.pressed).ground,
        None => sinkage,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_ahead_are_those_of_the_same_side() {
        let ahead = |way: Way, index| way.rows_ahead(index, 8).collect::<Vec<_>>();
        assert_eq!(ahead(Way::Onward, 5), [3, 1]);
        assert!(ahead(Way::Onward, 0).is_empty());
        assert_eq!(ahead(Way::Back, 2), [4, 6]);
        assert!(ahead(Way::Back, 7).is_empty());
    }
}
