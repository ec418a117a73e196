//! The vehicle's parameters and where its wheels stand.

use crate::parameter::{Bounds, ParameterError};

/// A skid-steer vehicle with the same wheel at every corner (Table II of the paper).
#[derive(Debug, Clone, PartialEq)]
pub struct Vehicle {
    /// Mass m \[kg\].
    pub mass: f64,
    /// Yaw moment of inertia I_Z about the centre of mass \[kg m^2\].
    pub yaw_inertia: f64,
    /// Wheel radius r \[m\].
    pub wheel_radius: f64,
    /// Wheel width b \[m\].
    pub wheel_width: f64,
    /// Each row's offset ahead of the vehicle's centroid \[m\], front row first.
    pub row_positions: Vec<f64>,
    /// Half the track B \[m\].
    pub half_track: f64,
    /// Offset d of the centre of mass ahead of the centroid \[m\].
    pub com_offset: f64,
    /// Height h of the centre of mass above the ground \[m\].
    pub com_height: f64,
}

const MASS: Bounds = Bounds::open_low("mass", "kg", 0.0, 1e7);
const YAW_INERTIA: Bounds = Bounds::open_low("yaw_inertia", "kg m^2", 0.0, 1e9);
const WHEEL_RADIUS: Bounds = Bounds::open_low("wheel_radius", "m", 0.0, 10.0);
const HALF_TRACK: Bounds = Bounds::open_low("half_track", "m", 0.0, 20.0);
const ROW_POSITION: Bounds = Bounds::closed("row_positions", "m", -50.0, 50.0);
const COM_HEIGHT: Bounds = Bounds::closed("com_height", "m", 0.0, 20.0);

/// The radius of gyration as a share of the way to the wheels' far corners: a plate has 0.58, masses at the
/// corners have 1.
const SHORTEST_GYRATION: f64 = 0.2;
const LONGEST_GYRATION: f64 = 1.5;
/// Where the centre of mass is so many times as far up as the wheels reach out, half of g tips the vehicle over.
const HIGHEST: f64 = 2.0;

impl Vehicle {
    /// Refuses values that describe no vehicle.
    ///
    /// # Errors
    /// The first parameter that is not finite or lies outside its range: among others
    /// wheels wider than the vehicle, rows that are not in order from the front, or a
    /// centre of mass that is not between the first and the last row.
    pub fn validate(&self) -> Result<(), ParameterError> {
        MASS.check(self.mass)?;
        YAW_INERTIA.check(self.yaw_inertia)?;
        WHEEL_RADIUS.check(self.wheel_radius)?;
        HALF_TRACK.check(self.half_track)?;
        let widest = 2.0 * self.half_track;
        let width = Bounds::open_low("wheel_width", "m", 0.0, widest);
        width
            .because("at most twice half_track")
            .check(self.wheel_width)?;
        COM_HEIGHT.check(self.com_height)?;
        self.validate_rows()
    }

    fn validate_rows(&self) -> Result<(), ParameterError> {
        let rows = &self.row_positions;
        Bounds::closed("number of row_positions", "rows", 2.0, 64.0).check(rows.len() as f64)?;
        for &row in rows {
            ROW_POSITION.check(row)?;
        }
        for pair in rows.windows(2) {
            let behind = Bounds::half_open("row_positions", "m", -50.0, pair[0]);
            let behind = behind.because("rows stand in order from the front to the rear");
            behind.check(pair[1])?;
        }
        let (front, rear) = (rows[0], rows[rows.len() - 1]);
        let between = Bounds::open("com_offset", "m", rear, front);
        between
            .because("between the first and the last row")
            .check(self.com_offset)
    }

    /// Which of the numbers hardly belong together, each with what to check. They may still be right: a long boom, a
    /// mast.
    #[must_use]
    pub fn doubts(&self) -> Vec<String> {
        let mut doubts = Vec::new();
        let rows = &self.row_positions;
        let long = 0.5 * (rows[0] - rows[rows.len() - 1]) + self.wheel_radius;
        let reach = long.hypot(self.half_track + 0.5 * self.wheel_width);
        let gyration = (self.yaw_inertia / self.mass).sqrt();
        if !(SHORTEST_GYRATION..=LONGEST_GYRATION).contains(&(gyration / reach)) {
            doubts.push(format!(
                "yaw_inertia {} kg m^2 and mass {} kg make a radius of gyration of {gyration:.2} m, and the wheels' far corners are {reach:.2} m from the middle: check both",
                self.yaw_inertia, self.mass
            ));
        }
        let support = self.half_track.min(long);
        if self.com_height > HIGHEST * support {
            doubts.push(format!(
                "com_height {} m is more than {HIGHEST} times as far up as the wheels reach out from the middle ({support:.2} m), so that half of g tips it over: check com_height, half_track and row_positions",
                self.com_height
            ));
        }
        if let Some(pair) = rows
            .windows(2)
            .find(|pair| pair[0] - pair[1] < 2.0 * self.wheel_radius)
        {
            doubts.push(format!(
                "rows at {} and {} m are closer than two wheels of wheel_radius {} m: check row_positions and wheel_radius",
                pair[0], pair[1], self.wheel_radius
            ));
        }
        doubts
    }

    /// Number of wheels, two to a row.
    #[must_use]
    pub fn wheel_count(&self) -> usize {
        2 * self.row_positions.len()
    }

    /// Wheel `index`'s centre in the body frame \[m\]: X ahead and Y left of the centre
    /// of mass (7). Wheels count from the front left one, left before right.
    #[must_use]
    pub fn wheel_centre(&self, index: usize) -> (f64, f64) {
        let ahead = self.row_positions[index / 2] - self.com_offset;
        let left = if index.is_multiple_of(2) {
            self.half_track
        } else {
            -self.half_track
        };
        (ahead, left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_hardly_belongs_together_is_doubted() {
        let ours = Vehicle {
            mass: 100.0,
            yaw_inertia: 20.0,
            wheel_radius: 0.16,
            wheel_width: 0.1,
            row_positions: vec![0.4, 0.0, -0.4],
            half_track: 0.35,
            com_offset: 0.05,
            com_height: 0.3,
        };
        let doubts = |vehicle: Vehicle| {
            assert!(vehicle.validate().is_ok());
            vehicle.doubts()
        };
        let changed = |change: fn(&mut Vehicle)| {
            let mut other = ours.clone();
            change(&mut other);
            doubts(other)
        };
        assert!(changed(|_| ()).is_empty());
        let told = [
            changed(|v| v.yaw_inertia = 100.0 * v.mass),
            changed(|v| v.mass *= 1000.0),
            changed(|v| v.com_height = 5.0),
            changed(|v| v.wheel_radius *= 3.0),
        ];
        let about = ["yaw_inertia", "yaw_inertia", "com_height", "row_positions"];
        for (told, about) in told.iter().zip(about) {
            assert!(told.iter().any(|doubt| doubt.contains(about)), "{told:?}");
        }
    }
}
