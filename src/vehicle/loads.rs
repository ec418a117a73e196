//! Vertical load of each wheel for any row positions: the plane (27) that satisfies the sums (26) of the rolling
//! moments (23). For four rows it is (28).

use crate::scalar::Scalar;

/// Gravitational acceleration g \[m/s^2\], the paper's value.
pub const GRAVITY: f64 = 9.81;

/// The plane F_Z = u + v X + w Y (27) through the wheels that carries a force and balances two moments.
#[derive(Debug, Clone)]
pub(crate) struct LoadPlane<S> {
    /// Each wheel's load \[N\] for a newton of the force, and for a newton metre of each moment.
    shares: Vec<[S; 3]>,
}

/// What the loads have to balance, about the centre of mass.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LoadTargets<S> {
    /// Sum of the loads \[N\]: m g on flat ground.
    pub normal: S,
    /// Sum of X F_Z and of Y F_Z \[N m\] without acceleration.
    pub moments: [S; 2],
    /// m h \[kg m\]: the ground's specific force s takes m h s_X and m h s_Y from the two moments.
    pub leverage: S,
}

impl<S: Scalar> LoadPlane<S> {
    /// Through wheels at these places ahead and to the left of the centre of mass \[m\], at least two distinct rows.
    pub fn new(places: &[[S; 2]]) -> Self {
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
        let share = |place: &[S; 2]| {
            let [ahead, left] = [0, 1].map(|axis| (place[axis] - mean[axis]) / spread[axis]);
            let level = S::constant(inverse) - mean[0] * ahead - mean[1] * left;
            [level, ahead, left]
        };
        Self {
            shares: places.iter().map(share).collect(),
        }
    }

    /// Writes each wheel's load \[N\] where the ground exerts the specific force s \[m/s^2\], and its derivatives by s_X
    /// and s_Y \[kg\].
    ///
    /// A wheel that the plane would have to pull down is lifted: it carries nothing, and
    /// the loads of the others are scaled so that they still carry all. Returns whether
    /// any wheel is lifted.
    pub fn distribute(
        &self,
        targets: &LoadTargets<S>,
        specific: [S; 2],
        loads: &mut [[S; 3]],
    ) -> bool {
        let zero = S::constant(0.0);
        let moments = [0, 1].map(|axis| targets.moments[axis] - targets.leverage * specific[axis]);
        let mut carried = [zero; 3];
        let mut lifted = false;
        for (share, load) in self.shares.iter().zip(&mut *loads) {
            let value = targets.normal * share[0] + moments[0] * share[1] + moments[1] * share[2];
            *load = if value.value() > 0.0 {
                let by = |share: S| -(targets.leverage * share);
                [value, by(share[1]), by(share[2])]
            } else {
                lifted = true;
                [zero; 3]
            };
            for (sum, part) in carried.iter_mut().zip(*load) {
                *sum += part;
            }
        }
        if lifted {
            let [carried, by_x, by_y] = carried;
            let share = targets.normal / carried;
            for load in loads.iter_mut().filter(|load| load[0].value() > 0.0) {
                load[1] = share * (load[1] - load[0] * by_x / carried);
                load[2] = share * (load[2] - load[0] * by_y / carried);
                load[0] = share * load[0];
            }
        }
        lifted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::Vehicle;

    /// Rounding in sums of eight loads of some 600 N.
    const ROUNDING: f64 = 1e-9;

    fn loads(vehicle: &Vehicle, acceleration: [f64; 2]) -> (Vec<f64>, bool) {
        let wheels = 0..vehicle.wheel_count();
        let places: Vec<[f64; 2]> = wheels.map(|i| vehicle.wheel_centre(i).into()).collect();
        let targets = LoadTargets {
            normal: vehicle.mass * GRAVITY,
            moments: [0.0; 2],
            leverage: vehicle.mass * vehicle.com_height,
        };
        let mut loads = vec![[0.0; 3]; places.len()];
        let lifted = LoadPlane::new(&places).distribute(&targets, acceleration, &mut loads);
        (loads.iter().map(|l| l[0]).collect(), lifted)
    }

    #[test]
    fn four_rows_give_equation_28() {
        let (a_x, a_y) = (1.3, -0.7);
        let (m, a, half_track, d, h, g) = (490.0, 0.61, 0.61, 0.17, 0.35, GRAVITY);
        let (loads, _) = loads(&Vehicle::tran2007(), [a_x, a_y]);
        for (index, load) in loads.iter().enumerate() {
            let rows = [(6.0, -6.0), (2.0, -2.0), (-2.0, 2.0), (-6.0, 6.0)];
            let (by_d, by_x) = rows[index / 2];
            let side = if index % 2 == 0 { -5.0 } else { 5.0 };
            let expected = m / (40.0 * a * half_track)
                * ((5.0 * a + by_d * d) * half_track * g
                    + by_x * half_track * h * a_x
                    + side * a * h * a_y);
            assert!((load - expected).abs() < ROUNDING, "wheel {index}");
        }
    }

    #[test]
    fn uneven_rows_balance_weight_and_moments() {
        let vehicle = Vehicle {
            row_positions: vec![0.9, 0.2, -0.7],
            ..Vehicle::tran2007()
        };
        let acceleration = [-0.8, 0.4];
        let (loads, lifted) = loads(&vehicle, acceleration);
        assert!(!lifted);
        let moment = |axis: fn((f64, f64)) -> f64| -> f64 {
            let arm = |i| axis(vehicle.wheel_centre(i));
            loads
                .iter()
                .enumerate()
                .map(|(i, load)| arm(i) * load)
                .sum()
        };
        let leverage = vehicle.mass * vehicle.com_height;
        assert!((moment(|_| 1.0) - vehicle.mass * GRAVITY).abs() < ROUNDING);
        assert!((moment(|c| c.0) + leverage * acceleration[0]).abs() < ROUNDING);
        assert!((moment(|c| c.1) + leverage * acceleration[1]).abs() < ROUNDING);
    }

    #[test]
    fn a_lifted_wheel_carries_nothing_and_the_others_the_weight() {
        let (loads, lifted) = loads(&Vehicle::tran2007(), [0.0, 25.0]);
        assert!(lifted);
        assert!(loads.iter().step_by(2).all(|&load| load == 0.0));
        let sum: f64 = loads.iter().sum();
        assert!((sum - 490.0 * GRAVITY).abs() < ROUNDING);
    }
}
