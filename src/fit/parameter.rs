//! A parameter to be fitted: its scale, prior and bounds.

/// The coordinate in which a parameter's prior is Gaussian and in which the fit steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// The value itself.
    Linear,
    /// Its logarithm: positive parameters that are known to a factor.
    Log,
}

/// The quantity in which a parameter acts about linearly. A straight step in another one is soon off the valley of values
/// that drive alike: k z^n is the same along ln k + n ln z, c + p tan(phi) along c and tan(phi).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActsBy {
    /// The coordinate.
    Coordinate,
    /// The value.
    Value,
    /// The tangent of the value, an angle.
    Tangent,
}

/// What is known of a parameter before the data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Median, in the parameter's unit.
    pub median: f64,
    /// Standard deviation on the parameter's scale: in its unit, or of its logarithm.
    pub deviation: f64,
}

/// A parameter to be fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeParameter {
    /// Name in files, as `cohesion` or `drawbar.force`; of a sensor with its recording's before it.
    pub name: String,
    /// Unit of its value.
    pub unit: &'static str,
    /// Its scale.
    pub scale: Scale,
    /// The quantity in which steps are straight.
    pub acts_by: ActsBy,
    /// What is known of it before the data.
    pub prior: Prior,
    /// Smallest value that the fit may take.
    pub low: f64,
    /// Largest value that the fit may take.
    pub high: f64,
}

/// 95 % quantile of the normal distribution: bounds a 90 % interval.
pub const NORMAL_95: f64 = 1.644_853_626_951_472_7;

/// A step leaves at least this share of a positive value.
const LEAST_SHARE: f64 = 0.1;

impl FreeParameter {
    /// The coordinate of a value.
    #[must_use]
    pub fn coordinate(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => value,
            Scale::Log => value.ln(),
        }
    }

    /// The value of a coordinate. That of a bound's coordinate is the bound, whatever rounding does.
    #[must_use]
    pub fn value(&self, coordinate: f64) -> f64 {
        match self.scale {
            Scale::Linear => coordinate,
            Scale::Log if coordinate == self.high.ln() => self.high,
            Scale::Log if coordinate == self.low.ln() => self.low,
            Scale::Log => coordinate.exp(),
        }
    }

    /// The derivative of the value by the coordinate, at a value.
    #[must_use]
    pub fn slope(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => 1.0,
            Scale::Log => value,
        }
    }

    /// The coordinate after a step that is straight in the quantity by which the parameter acts. A short one is a step of the
    /// coordinate.
    #[must_use]
    pub fn after(&self, coordinate: f64, step: f64) -> f64 {
        match (self.acts_by, self.scale) {
            (ActsBy::Value, Scale::Log) => coordinate + (1.0 + step).max(LEAST_SHARE).ln(),
            (ActsBy::Tangent, Scale::Linear) => {
                let tangent = coordinate.tan();
                (tangent + step * (1.0 + tangent * tangent)).atan()
            }
            _ => coordinate + step,
        }
    }

    /// The coordinates of the bounds.
    #[must_use]
    pub fn bounds(&self) -> (f64, f64) {
        (self.coordinate(self.low), self.coordinate(self.high))
    }

    /// The coordinate of the prior's median.
    #[must_use]
    pub fn prior_coordinate(&self) -> f64 {
        self.coordinate(self.prior.median)
    }

    /// Values that lie so many standard deviations to both sides of a coordinate, within
    /// the bounds.
    #[must_use]
    pub fn interval(&self, coordinate: f64, half_width: f64) -> (f64, f64) {
        let (low, high) = self.bounds();
        (
            self.value((coordinate - half_width).max(low)),
            self.value((coordinate + half_width).min(high)),
        )
    }

    /// The prior's 90 % interval.
    #[must_use]
    pub fn prior_interval(&self) -> (f64, f64) {
        self.interval(self.prior_coordinate(), NORMAL_95 * self.prior.deviation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_straight_in_what_a_parameter_acts_by() {
        let parameter = |scale, acts_by| FreeParameter {
            name: "p".into(),
            unit: "1",
            scale,
            acts_by,
            prior: Prior {
                median: 1.0,
                deviation: 1.0,
            },
            low: 0.01,
            high: 10.0,
        };
        // k z^n, with a step along which it is the same to first order.
        let modulus = parameter(Scale::Log, ActsBy::Coordinate);
        let exponent = parameter(Scale::Log, ActsBy::Value);
        let (k, n, log_sinkage) = (14.0, 0.8_f64.ln(), 0.03_f64.ln());
        let log_pressure = |k: f64, n: f64| k + n.exp() * log_sinkage;
        let step = 0.4;
        let ahead = -n.exp() * step * log_sinkage;
        let after = log_pressure(modulus.after(k, ahead), exponent.after(n, step));
        assert!((after - log_pressure(k, n)).abs() < 1e-12);
        // c + p tan(phi).
        let cohesion = exponent;
        let friction = parameter(Scale::Linear, ActsBy::Tangent);
        let (c, phi, pressure) = (3e3_f64.ln(), 0.4_f64, 1e4);
        let strength = |c: f64, phi: f64| c.exp() + pressure * phi.tan();
        let step = -0.1;
        let slope = pressure * (1.0 + phi.tan().powi(2));
        let after = strength(
            cohesion.after(c, -slope * step / c.exp()),
            friction.after(phi, step),
        );
        assert!((after / strength(c, phi) - 1.0).abs() < 1e-12);
        // Short steps are those of the coordinate; however long, a value stays positive.
        for one in [&modulus, &cohesion, &friction] {
            let slope = (one.after(0.5, 1e-6) - 0.5) / 1e-6;
            assert!((slope - 1.0).abs() < 1e-5);
            assert!(one.after(0.5, -5.0).is_finite());
        }
    }

    #[test]
    fn intervals_of_logarithmic_parameters_are_factors() {
        let parameter = FreeParameter {
            name: "k".into(),
            unit: "1",
            scale: Scale::Log,
            acts_by: ActsBy::Coordinate,
            prior: Prior {
                median: 10.0,
                deviation: 2f64.ln() / NORMAL_95,
            },
            low: 1.0,
            high: 15.0,
        };
        let (low, high) = parameter.prior_interval();
        // Twice the median would be 20, beyond the bound.
        assert!((low - 5.0).abs() < 1e-12 && (high - 15.0).abs() < 1e-12);
        let (value, h) = (3.0, 1e-6);
        let at = parameter.coordinate(value);
        let slope = (parameter.value(at + h) - parameter.value(at - h)) / (2.0 * h);
        assert!((slope - parameter.slope(value)).abs() < 1e-8);
        for bound in [0.1, 3.0, 7.3] {
            let (low, high) = (bound, 2.0 * bound);
            let parameter = FreeParameter {
                low,
                high,
                ..parameter.clone()
            };
            let (lowest, highest) = parameter.bounds();
            assert_eq!(
                (parameter.value(lowest), parameter.value(highest)),
                (low, high)
            );
        }
    }
}
