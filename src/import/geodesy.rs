//! From latitude and longitude to metres.

/// Semi-major axis of the WGS-84 ellipsoid \[m\], NIMA TR8350.2.
const SEMI_MAJOR_AXIS: f64 = 6_378_137.0;
/// Flattening of the WGS-84 ellipsoid, NIMA TR8350.2.
const FLATTENING: f64 = 1.0 / 298.257_223_563;

/// Earth-centred, earth-fixed coordinates \[m\] of latitude and longitude \[rad\] and height
/// above the ellipsoid \[m\].
fn earth_centred([latitude, longitude, height]: [f64; 3]) -> [f64; 3] {
    let eccentricity_squared = FLATTENING * (2.0 - FLATTENING);
    let (sin, cos) = latitude.sin_cos();
    // Radius of curvature in the prime vertical.
    let radius = SEMI_MAJOR_AXIS / (1.0 - eccentricity_squared * sin * sin).sqrt();
    [
        (radius + height) * cos * longitude.cos(),
        (radius + height) * cos * longitude.sin(),
        (radius * (1.0 - eccentricity_squared) + height) * sin,
    ]
}

/// The plane that touches the earth at a point: x east, y north.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LocalPlane {
    origin: [f64; 3],
    latitude: f64,
    longitude: f64,
}

impl LocalPlane {
    /// At latitude and longitude \[deg\] and height above the ellipsoid \[m\].
    pub fn at([latitude, longitude, height]: [f64; 3]) -> Self {
        let (latitude, longitude) = (latitude.to_radians(), longitude.to_radians());
        Self {
            origin: earth_centred([latitude, longitude, height]),
            latitude,
            longitude,
        }
    }

    /// East and north \[m\] of a place given like the origin.
    pub fn east_north(&self, [latitude, longitude, height]: [f64; 3]) -> [f64; 2] {
        let place = earth_centred([latitude.to_radians(), longitude.to_radians(), height]);
        let [x, y, z] = [0, 1, 2].map(|axis| place[axis] - self.origin[axis]);
        let (sin_latitude, cos_latitude) = self.latitude.sin_cos();
        let (sin_longitude, cos_longitude) = self.longitude.sin_cos();
        [
            cos_longitude * y - sin_longitude * x,
            cos_latitude * z - sin_latitude * (cos_longitude * x + sin_longitude * y),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn earth_centred_coordinates_of_known_places() {
        let quarter = 90_f64.to_radians();
        // Equator and pole: the ellipsoid's axes.
        let equator = earth_centred([0.0, quarter, 100.0]);
        assert!((equator[1] - 6_378_237.0).abs() < 1e-6 && equator[0].abs() < 1e-6);
        let pole = earth_centred([quarter, 0.0, 0.0]);
        assert!((pole[2] - 6_356_752.314_245).abs() < 1e-5, "{pole:?}");
    }

    #[test]
    fn short_distances_follow_from_the_radii_of_curvature() {
        // An independent formula: meridian and prime vertical radius times the angle.
        let (latitude, step): (f64, f64) = (48.0, 1e-4);
        let plane = LocalPlane::at([latitude, 11.0, 0.0]);
        let e2 = FLATTENING * (2.0 - FLATTENING);
        let (sin, cos) = latitude.to_radians().sin_cos();
        let prime = SEMI_MAJOR_AXIS / (1.0 - e2 * sin * sin).sqrt();
        let meridian = prime * (1.0 - e2) / (1.0 - e2 * sin * sin);
        let [east, north] = plane.east_north([latitude + step, 11.0, 0.0]);
        // The curvature of 11 m of meridian is below a tenth of a millimetre.
        assert!((north - meridian * step.to_radians()).abs() < 1e-4 && east.abs() < 1e-6);
        let [east, north] = plane.east_north([latitude, 11.0 + step, 0.0]);
        assert!((east - prime * cos * step.to_radians()).abs() < 1e-4 && north.abs() < 1e-4);
        // A higher place above the origin is at the origin.
        let [east, north] = plane.east_north([latitude, 11.0, 250.0]);
        assert!(east.abs() < 1e-6 && north.abs() < 1e-6);
    }
}
