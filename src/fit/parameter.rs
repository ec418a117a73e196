//! A parameter to be fitted: its scale, prior and bounds.

/// The coordinate in which a parameter's prior is Gaussian and in which the fit steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// The value itself.
    Linear,
    /// Its logarithm: positive parameters that are known to a factor.
    Log,
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
    /// What is known of it before the data.
    pub prior: Prior,
    /// Smallest value that the fit may take.
    pub low: f64,
    /// Largest value that the fit may take.
    pub high: f64,
}

/// 95 % quantile of the normal distribution: bounds a 90 % interval.
pub const NORMAL_95: f64 = 1.644_853_626_951_472_7;

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
    fn intervals_of_logarithmic_parameters_are_factors() {
        let parameter = FreeParameter {
            name: "k".into(),
            unit: "1",
            scale: Scale::Log,
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
