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
        Bounds::open_low("wheel_width", "m", 0.0, widest).check(self.wheel_width)?;
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
            behind.check(pair[1])?;
        }
        let (front, rear) = (rows[0], rows[rows.len() - 1]);
        Bounds::open("com_offset", "m", rear, front).check(self.com_offset)
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
