//! Loads on a vehicle whose centre of mass may lie anywhere, under more than its own inertia.

use crate::scalar::Scalar;

/// What the loads have to balance, about the centre of mass.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LoadTargets<S> {
    /// Sum of the loads \[N\].
    pub normal: S,
    /// Sum of X F_Z and of Y F_Z \[N m\].
    pub moments: [S; 2],
}

impl<S: Scalar> LoadTargets<S> {
    /// The moments \[N m\] that act already, less those of the ground's specific force s \[m/s^2\] at the
    /// leverage m h \[kg m\] below the centre of mass.
    #[inline(always)]
    pub fn new(normal: S, moments: [S; 2], leverage: S, specific: [S; 2]) -> Self {
        Self {
            normal,
            moments: [0, 1].map(|axis| moments[axis] - leverage * specific[axis]),
        }
    }
}

/// Writes the loads of the plane (27) through wheels at these places from the centre of mass.
///
/// As [`super::super::LoadPlane::distribute`]: a wheel that would have to be pulled down carries
/// nothing, and the others are scaled to carry all. Returns whether there is one.
pub(crate) fn spread_loads<S: Scalar>(
    places: &[[S; 2]],
    targets: &LoadTargets<S>,
    loads: &mut [S],
) -> bool {
    let zero = S::constant(0.0);
    let inverse = 1.0 / places.len() as f64;
    let mut mean = [zero; 2];
    for place in places {
        mean[0] += place[0].scale(inverse);
        mean[1] += place[1].scale(inverse);
    }
    let mut spread = [zero; 2];
    for place in places {
        for axis in 0..2 {
            let from_mean = place[axis] - mean[axis];
            spread[axis] += from_mean * from_mean;
        }
    }
    let tilt =
        [0, 1].map(|axis| (targets.moments[axis] - targets.normal * mean[axis]) / spread[axis]);
    let (mut carried, mut lifted) = (zero, false);
    for (place, load) in places.iter().zip(&mut *loads) {
        *load = targets.normal.scale(inverse)
            + tilt[0] * (place[0] - mean[0])
            + tilt[1] * (place[1] - mean[1]);
        if load.value() > 0.0 {
            carried += *load;
        } else {
            (*load, lifted) = (zero, true);
        }
    }
    if lifted {
        let share = targets.normal / carried;
        for load in loads {
            *load = *load * share;
        }
    }
    lifted
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding in sums of loads of some 1000 N.
    const ROUNDING: f64 = 1e-9;

    #[test]
    fn loads_balance_force_and_both_moments() {
        let places = [[0.8, 0.7], [0.8, -0.5], [-0.2, 0.7], [-0.2, -0.5]];
        let targets = LoadTargets {
            normal: 4000.0,
            moments: [150.0, -90.0],
        };
        let mut loads = [0.0; 4];
        assert!(!spread_loads(&places, &targets, &mut loads));
        let sum = |arm: fn(&[f64; 2]) -> f64| -> f64 {
            places.iter().zip(&loads).map(|(p, l)| arm(p) * l).sum()
        };
        assert!((sum(|_| 1.0) - 4000.0).abs() < ROUNDING);
        assert!((sum(|p| p[0]) - 150.0).abs() < ROUNDING);
        assert!((sum(|p| p[1]) + 90.0).abs() < ROUNDING);
    }

    #[test]
    fn a_lifted_wheel_leaves_its_share_to_the_others() {
        let places = [[0.5, 0.6], [0.5, -0.6], [-0.5, 0.6], [-0.5, -0.6]];
        let targets = LoadTargets {
            normal: 4000.0,
            moments: [0.0, 3000.0],
        };
        let mut loads = [0.0; 4];
        assert!(spread_loads(&places, &targets, &mut loads));
        assert_eq!((loads[1], loads[3]), (0.0, 0.0));
        assert!((loads.iter().sum::<f64>() - 4000.0).abs() < ROUNDING);
    }
}
