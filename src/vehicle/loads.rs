//! Vertical load of each wheel for any row positions: the plane (27) that satisfies the sums (26) of the rolling
//! moments (23). For four rows it is (28).

use super::Vehicle;

/// Gravitational acceleration g \[m/s^2\], the paper's value.
pub const GRAVITY: f64 = 9.81;

/// The plane F_Z = u + v X + w Y (27) through the wheels that carries the weight and
/// balances the moments of the accelerations:
/// sum F_Z = m g, sum X F_Z = -m h a_X, sum Y F_Z = -m h a_Y.
#[derive(Debug, Clone)]
pub struct LoadPlane {
    weight: f64,
    /// Per wheel: load at rest \[N\], and its change with a_X and a_Y \[N s^2/m\].
    wheels: Vec<[f64; 3]>,
}

impl LoadPlane {
    /// The plane of a vehicle (which has at least two distinct rows).
    #[must_use]
    pub fn new(vehicle: &Vehicle) -> Self {
        let count = vehicle.wheel_count();
        let centres: Vec<_> = (0..count).map(|i| vehicle.wheel_centre(i)).collect();
        let weight = vehicle.mass * GRAVITY;
        let leverage = vehicle.mass * vehicle.com_height;
        let mean = centres.iter().map(|c| c.0).sum::<f64>() / count as f64;
        let spread: f64 = centres.iter().map(|c| (c.0 - mean).powi(2)).sum();
        let breadth: f64 = centres.iter().map(|c| c.1.powi(2)).sum();
        let wheels = centres
            .iter()
            .map(|&(x, y)| {
                // u = m g / N - v mean; v = (-m h a_X - m g mean) / spread.
                let lever = (x - mean) / spread;
                [
                    weight / count as f64 - weight * mean * lever,
                    -leverage * lever,
                    -leverage * y / breadth,
                ]
            })
            .collect();
        Self { weight, wheels }
    }

    /// Weight m g \[N\].
    #[must_use]
    pub fn weight(&self) -> f64 {
        self.weight
    }

    /// Load of one wheel \[N\] on the plane, and its change with a_X and a_Y. Negative
    /// where the ground would have to pull.
    fn on_plane(&self, index: usize, [a_x, a_y]: [f64; 2]) -> f64 {
        let [rest, by_x, by_y] = self.wheels[index];
        rest + by_x * a_x + by_y * a_y
    }

    /// Writes each wheel's load \[N\] and its derivatives by a_X and a_Y \[N s^2/m\].
    ///
    /// A wheel that the plane would have to pull down is lifted: it carries nothing, and
    /// the loads of the others are scaled so that they still carry m g. Returns whether
    /// any wheel is lifted.
    pub fn distribute(&self, acceleration: [f64; 2], loads: &mut [[f64; 3]]) -> bool {
        let mut carried = 0.0;
        let mut carried_by = [0.0; 2];
        let mut lifted = false;
        for (index, load) in loads.iter_mut().enumerate() {
            let value = self.on_plane(index, acceleration);
            *load = if value > 0.0 {
                [value, self.wheels[index][1], self.wheels[index][2]]
            } else {
                lifted = true;
                [0.0; 3]
            };
            carried += load[0];
            carried_by[0] += load[1];
            carried_by[1] += load[2];
        }
        if lifted {
            let share = self.weight / carried;
            for [load, by_x, by_y] in loads.iter_mut().filter(|l| l[0] > 0.0) {
                *by_x = share * (*by_x - *load * carried_by[0] / carried);
                *by_y = share * (*by_y - *load * carried_by[1] / carried);
                *load *= share;
            }
        }
        lifted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding in sums of eight loads of some 600 N.
    const ROUNDING: f64 = 1e-9;

    fn loads(vehicle: &Vehicle, acceleration: [f64; 2]) -> (Vec<f64>, bool) {
        let mut loads = vec![[0.0; 3]; vehicle.wheel_count()];
        let lifted = LoadPlane::new(vehicle).distribute(acceleration, &mut loads);
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
