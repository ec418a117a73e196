//! Slopes along a drive.

use crate::display::number;
use crate::scalar::Scalar;
use thiserror::Error;

/// Slopes towards the east and the north over time, distance or place, linear in between and
/// constant beyond.
#[derive(Debug, Clone, PartialEq)]
pub enum SlopeProfile {
    /// Over the time \[s\].
    Time(Points),
    /// Over the distance driven \[m\].
    Distance(Points),
    /// Over a grid on the map.
    Place(Grid),
}

/// Slopes at increasing places.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    at: Vec<f64>,
    slopes: Vec<[f64; 2]>,
}

impl SlopeProfile {
    /// The first moment after `time` \[s\] at which the slope changes its rate, whatever the vehicle does.
    #[must_use]
    pub fn next_knot(&self, time: f64) -> Option<f64> {
        let Self::Time(points) = self else {
            return None;
        };
        let next = points.at.partition_point(|at| *at <= time);
        points.at.get(next).copied()
    }

    /// The shortest way \[m\] between places where the slope changes its rate; `None` where there is
    /// no such way.
    #[must_use]
    pub fn min_feature_length(&self) -> Option<f64> {
        let axes: [&[f64]; 2] = match self {
            Self::Time(_) => [&[], &[]],
            Self::Distance(points) => [&points.at, &[]],
            Self::Place(grid) => [&grid.x, &grid.y],
        };
        let ways = axes.into_iter().flat_map(|axis| axis.windows(2));
        ways.map(|pair| pair[1] - pair[0]).reduce(f64::min)
    }
}

/// Slopes at the corners of a rectangular grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    x: Vec<f64>,
    y: Vec<f64>,
    /// For each x, for each y.
    slopes: Vec<[f64; 2]>,
}

/// Why numbers make no profile.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ProfileError {
    /// No points.
    #[error("a slope profile needs at least one point")]
    Empty,
    /// Places that do not increase, with the first offender.
    #[error("the profile's points must increase, but not so at {}", number(*.0))]
    Order(f64),
    /// A slope outside of -0.3..0.3 rad, or a number that is not finite.
    #[error("a slope of {} rad is outside -0.3..0.3 rad", number(*.0))]
    Slope(f64),
    /// So many slopes where the grid has so many corners.
    #[error("found {0} slopes for the {1} corners of the grid")]
    Count(usize, usize),
}

/// Steepest slope \[rad\].
const STEEPEST: f64 = 0.3;

fn check_axis(axis: &[f64]) -> Result<(), ProfileError> {
    if axis.is_empty() {
        return Err(ProfileError::Empty);
    }
    let unordered = axis
        .windows(2)
        .find(|pair| pair[1] <= pair[0] || !pair[1].is_finite());
    match unordered {
        _ if !axis[0].is_finite() => Err(ProfileError::Order(axis[0])),
        Some(pair) => Err(ProfileError::Order(pair[1])),
        None => Ok(()),
    }
}

fn check_slopes(slopes: &[[f64; 2]], expected: usize) -> Result<(), ProfileError> {
    if slopes.len() != expected {
        return Err(ProfileError::Count(slopes.len(), expected));
    }
    match slopes
        .iter()
        .flatten()
        .find(|slope| slope.is_nan() || slope.abs() > STEEPEST)
    {
        Some(slope) => Err(ProfileError::Slope(*slope)),
        None => Ok(()),
    }
}

/// The interval that holds a value, and how far it lies in it.
fn bracket<S: Scalar>(axis: &[f64], value: S) -> (usize, S) {
    let last = axis.len().saturating_sub(2);
    let cell = axis
        .partition_point(|at| *at <= value.value())
        .saturating_sub(1)
        .min(last);
    let Some(end) = axis.get(cell + 1) else {
        return (0, S::constant(0.0));
    };
    let share = value.offset(-axis[cell]).scale(1.0 / (end - axis[cell]));
    let held = share.value().clamp(0.0, 1.0);
    (
        cell,
        if held == share.value() {
            share
        } else {
            S::constant(held)
        },
    )
}

impl Points {
    /// Slopes \[rad\] towards east and north at increasing places.
    ///
    /// # Errors
    /// No points, places that do not increase, slopes beyond 0.3 rad.
    pub fn new(at: Vec<f64>, slopes: Vec<[f64; 2]>) -> Result<Self, ProfileError> {
        check_axis(&at)?;
        check_slopes(&slopes, at.len())?;
        Ok(Self { at, slopes })
    }

    /// The places and the slopes there.
    pub fn iter(&self) -> impl Iterator<Item = (f64, [f64; 2])> {
        self.at.iter().copied().zip(self.slopes.iter().copied())
    }

    fn slopes<S: Scalar>(&self, value: S) -> [S; 2] {
        let (cell, share) = bracket(&self.at, value);
        let next = self.slopes.get(cell + 1).unwrap_or(&self.slopes[cell]);
        [0, 1].map(|axis| {
            let start = self.slopes[cell][axis];
            share.scale(next[axis] - start).offset(start)
        })
    }
}

impl Grid {
    /// Slopes \[rad\] towards east and north at the corners of a grid, for each x all y.
    ///
    /// # Errors
    /// An empty axis or one that does not increase, a wrong number of slopes, or slopes beyond
    /// 0.3 rad.
    pub fn new(x: Vec<f64>, y: Vec<f64>, slopes: Vec<[f64; 2]>) -> Result<Self, ProfileError> {
        check_axis(&x)?;
        check_axis(&y)?;
        check_slopes(&slopes, x.len() * y.len())?;
        Ok(Self { x, y, slopes })
    }

    /// Both axes, and the slopes: for each x all y.
    #[must_use]
    pub fn parts(&self) -> (&[f64], &[f64], &[[f64; 2]]) {
        (&self.x, &self.y, &self.slopes)
    }

    fn slopes<S: Scalar>(&self, place: [S; 2]) -> [S; 2] {
        let ((column, along), (row, up)) = (bracket(&self.x, place[0]), bracket(&self.y, place[1]));
        let corner = |dx: usize, dy: usize| {
            let (i, j) = (
                (column + dx).min(self.x.len() - 1),
                (row + dy).min(self.y.len() - 1),
            );
            self.slopes[i * self.y.len() + j]
        };
        let mix = |a: S, b: S, share: S| a + (b - a) * share;
        [0, 1].map(|axis| {
            let at = |dx, dy| S::constant(corner(dx, dy)[axis]);
            let low = mix(at(0, 0), at(1, 0), along);
            mix(low, mix(at(0, 1), at(1, 1), along), up)
        })
    }
}

impl SlopeProfile {
    /// Slopes \[rad\] towards east and north.
    pub fn slopes<S: Scalar>(&self, time: S, distance: S, place: [S; 2]) -> [S; 2] {
        match self {
            Self::Time(points) => points.slopes(time),
            Self::Distance(points) => points.slopes(distance),
            Self::Place(grid) => grid.slopes(place),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_linear_between_points_and_constant_beyond() {
        let points = Points::new(vec![0.0, 2.0], vec![[0.0, 0.1], [0.2, 0.1]]).unwrap();
        let profile = SlopeProfile::Time(points);
        let east = |time| profile.slopes(time, 9.0, [9.0; 2])[0];
        for (time, expected) in [(-1.0, 0.0), (0.5, 0.05), (2.0, 0.2), (7.0, 0.2)] {
            assert!((east(time) - expected).abs() < 1e-15, "{time}");
        }
        let one = SlopeProfile::Distance(Points::new(vec![3.0], vec![[0.1, -0.1]]).unwrap());
        assert_eq!(one.slopes(0.0, 50.0, [0.0; 2]), [0.1, -0.1]);
    }

    #[test]
    fn grids_are_bilinear() {
        let slopes = vec![[0.0, 0.0], [0.1, 0.0], [0.2, 0.0], [0.3, 0.0]];
        let grid = Grid::new(vec![0.0, 1.0], vec![0.0, 1.0], slopes).unwrap();
        let profile = SlopeProfile::Place(grid);
        let east = |x, y| profile.slopes(0.0, 0.0, [x, y])[0];
        for (x, y, expected) in [
            (0.0, 1.0, 0.1),
            (1.0, 0.0, 0.2),
            (0.5, 0.5, 0.15),
            (9.0, 9.0, 0.3),
        ] {
            assert!((east(x, y) - expected).abs() < 1e-15, "{x} {y}");
        }
    }

    #[test]
    fn numbers_that_make_no_profile_are_refused() {
        assert_eq!(Points::new(vec![], vec![]), Err(ProfileError::Empty));
        let slope = [0.0; 2];
        assert_eq!(
            Points::new(vec![1.0, 1.0], vec![slope; 2]),
            Err(ProfileError::Order(1.0))
        );
        assert_eq!(
            Points::new(vec![1.0], vec![[0.4, 0.0]]),
            Err(ProfileError::Slope(0.4))
        );
        assert_eq!(
            Points::new(vec![1.0], vec![slope; 2]),
            Err(ProfileError::Count(2, 1))
        );
        assert!(Points::new(vec![f64::NAN], vec![slope]).is_err());
        assert!(Points::new(vec![1.0], vec![[f64::NAN, 0.0]]).is_err());
    }
}
