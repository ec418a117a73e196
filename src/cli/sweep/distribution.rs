//! The values of a parameter: `NAME=DISTRIBUTION` of `--vary`.

use crate::display;
use statrs::distribution::{ContinuousCDF, Normal};
use std::str::FromStr;

const FORMS: &str = "uniform:LOW,HIGH, log-uniform:LOW,HIGH, normal:MEAN,SD[,LOW,HIGH], \
                     log-normal:MEDIAN,FACTOR[,LOW,HIGH], list:A,B,... or grid:LOW,HIGH,COUNT";
/// A larger grid is a typing error.
const MAX_GRID: f64 = 1e6;

/// A parameter that differs from drive to drive.
#[derive(Debug, Clone, PartialEq)]
pub struct VariedParameter {
    /// Its name in the FMU.
    pub name: String,
    pub values: VariedValues,
}

/// Its values.
#[derive(Debug, Clone, PartialEq)]
pub enum VariedValues {
    /// These, each with every sample.
    Listed(Vec<f64>),
    /// One for each sample.
    Drawn(Distribution),
}

/// A distribution, on a logarithmic or a linear scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distribution {
    shape: Shape,
    is_log: bool,
    /// All values lie within.
    range: (f64, f64),
}

/// The shape on the scale of the distribution.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    Uniform,
    Normal { mean: f64, deviation: f64 },
}

impl Distribution {
    /// The value below which this share of the values lies, for 0 < share < 1.
    pub fn quantile(&self, share: f64) -> f64 {
        let (low, high) = self.range;
        let scaled = |value: f64| self.scaled(value);
        let value = match self.shape {
            Shape::Uniform => scaled(low) + share * (scaled(high) - scaled(low)),
            Shape::Normal { mean, deviation } => {
                let (below, up_to, is_mirrored) = self.tails(mean, deviation);
                let share = if is_mirrored { 1.0 - share } else { share };
                let off = Normal::standard().inverse_cdf(below + share * (up_to - below));
                mean + deviation * if is_mirrored { -off } else { off }
            }
        };
        let value = if self.is_log { value.exp() } else { value };
        value.clamp(low, high)
    }

    fn scaled(&self, value: f64) -> f64 {
        if self.is_log { value.ln() } else { value }
    }

    /// Shares of a normal distribution below both ends of the range. If both are in the upper tail, shares of the mirror image,
    /// because those of the lower tail keep their digits.
    fn tails(&self, mean: f64, deviation: f64) -> (f64, f64, bool) {
        let normal = Normal::standard();
        let [low, high] =
            [self.range.0, self.range.1].map(|end| (self.scaled(end) - mean) / deviation);
        if low > 0.0 {
            (normal.cdf(-high), normal.cdf(-low), true)
        } else {
            (normal.cdf(low), normal.cdf(high), false)
        }
    }

    /// Share of the distribution within its range; 0 if it is too small for a number.
    fn share_within(&self) -> f64 {
        match self.shape {
            Shape::Uniform => 1.0,
            Shape::Normal { mean, deviation } => {
                let (below, up_to, _) = self.tails(mean, deviation);
                up_to - below
            }
        }
    }
}

impl FromStr for VariedParameter {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some((name, values)) = text.split_once('=') else {
            return Err(format!("found `{text}`, expected NAME=DISTRIBUTION"));
        };
        Ok(Self {
            name: name.trim().into(),
            values: values.trim().parse()?,
        })
    }
}

impl FromStr for VariedValues {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (form, numbers) = text.split_once(':').unwrap_or((text, ""));
        let numbers = numbers.split(',').map(number);
        let numbers = numbers.collect::<Result<Vec<f64>, String>>();
        match (form, numbers?.as_slice()) {
            ("list", values) => Ok(Self::Listed(values.into())),
            ("grid", [low, high, count]) => grid(*low, *high, *count).map(Self::Listed),
            (form, numbers) => drawn(form, numbers).map(Self::Drawn),
        }
    }
}

fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse() {
        Ok(value) if f64::is_finite(value) => Ok(value),
        _ => Err(format!("found `{text}`, expected a number in {FORMS}")),
    }
}

fn grid(low: f64, high: f64, count: f64) -> Result<Vec<f64>, String> {
    if !(2.0..=MAX_GRID).contains(&count) || count.fract() != 0.0 {
        return Err(format!(
            "a grid of {} values: expected a whole number from 2 to {MAX_GRID:.0e}",
            display::number(count)
        ));
    }
    let share = |index: u32| f64::from(index) / (count - 1.0);
    Ok((0..count as u32)
        .map(|index| low * (1.0 - share(index)) + high * share(index))
        .collect())
}

fn drawn(form: &str, numbers: &[f64]) -> Result<Distribution, String> {
    let (is_log, form) = match form.strip_prefix("log-") {
        Some(form) => (true, form),
        None => (false, form),
    };
    let unbounded = if is_log {
        (f64::MIN_POSITIVE, f64::MAX)
    } else {
        (f64::MIN, f64::MAX)
    };
    let (shape, range) = match (form, numbers) {
        ("uniform", [low, high]) => (None, (*low, *high)),
        ("normal", [centre, spread]) => (Some((*centre, *spread)), unbounded),
        ("normal", [centre, spread, low, high]) => (Some((*centre, *spread)), (*low, *high)),
        _ => return Err(format!("expected {FORMS}")),
    };
    if range.0 >= range.1 {
        let (low, high) = range;
        return Err(format!(
            "the low end {} is not below the high end {}",
            display::number(low),
            display::number(high)
        ));
    }
    if is_log && range.0 <= 0.0 {
        return Err(format!(
            "{} has no logarithm: expected numbers above 0",
            display::number(range.0)
        ));
    }
    let shape = match shape {
        None => Shape::Uniform,
        Some((median, factor)) if is_log => {
            if median <= 0.0 || factor <= 1.0 {
                return Err(format!(
                    "log-normal:{},{}: expected a median above 0, and a factor above 1 \
                     (two thirds of the values lie between median / factor and median * factor)",
                    display::number(median),
                    display::number(factor)
                ));
            }
            Shape::Normal {
                mean: median.ln(),
                deviation: factor.ln(),
            }
        }
        Some((_, deviation)) if deviation <= 0.0 => {
            return Err(format!(
                "a standard deviation of {} is not above 0",
                display::number(deviation)
            ));
        }
        Some((mean, deviation)) => Shape::Normal { mean, deviation },
    };
    let drawn = Distribution {
        shape,
        is_log,
        range,
    };
    if drawn.share_within() <= 0.0 {
        return Err(format!(
            "nothing lies between {} and {}, to the last digit: expected bounds farther apart or nearer to the \
             mean, or uniform:LOW,HIGH",
            range.0, range.1
        ));
    }
    Ok(drawn)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Error of statrs' inverse of the error function.
    const ROUNDING: f64 = 1e-9;

    fn quantile(text: &str, share: f64) -> f64 {
        match text.parse().unwrap() {
            VariedValues::Drawn(distribution) => distribution.quantile(share),
            VariedValues::Listed(_) => panic!("{text} is a list"),
        }
    }

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (text, share, expected) in [
            ("uniform:2,4", 0.25, 2.5),
            ("log-uniform:1,100", 0.5, 10.0),
            ("normal:3,2", 0.5, 3.0),
            ("normal:3,2", 0.975, 3.0 + 2.0 * 1.959963984540054),
            ("log-normal:1000,2", 0.5, 1000.0),
            ("log-normal:1000,2", 0.841_344_746_068_542_9, 2000.0),
            // Half of a normal: its median is the quartile of the whole.
            ("normal:0,1,0,1e9", 0.5, 0.674_489_750_196_081_7),
            // Far out, where the share below is 1 to the last digit (SciPy's norm.isf).
            ("normal:0,1,9,10", 0.5, 9.075_779_713_738_546),
            ("normal:0,1,-10,-9", 0.5, -9.075_779_713_738_546),
        ] {
            let found = quantile(text, share);
            assert!(
                (found - expected).abs() < ROUNDING * expected.abs().max(1.0),
                "{text} at {share}: {found}, expected {expected}"
            );
        }
    }

    #[test]
    fn nothing_lies_outside_the_range() {
        for share in [1e-16, 0.3, 1.0 - 1e-16] {
            assert!((0.5..=2.0).contains(&quantile("normal:1,5,0.5,2", share)));
            assert!((0.5..=2.0).contains(&quantile("log-normal:9,3,0.5,2", share)));
        }
    }

    #[test]
    fn lists_and_grids_name_their_values() {
        let listed = |text: &str| text.parse::<VariedValues>();
        assert_eq!(listed("list:3,1"), Ok(VariedValues::Listed(vec![3.0, 1.0])));
        let grid = VariedValues::Listed(vec![1.0, 1.5, 2.0]);
        assert_eq!(listed("grid:1,2,3"), Ok(grid));
    }

    #[test]
    fn faults_are_explained() {
        for (text, expected) in [
            ("soil.cohesion", "expected NAME=DISTRIBUTION"),
            ("a=gauss:1,2", "expected uniform:LOW,HIGH"),
            ("a=uniform:1", "expected uniform:LOW,HIGH"),
            ("a=uniform:1,x", "found `x`, expected a number"),
            ("a=uniform:2,1", "the low end 2 is not below the high end 1"),
            ("a=log-uniform:0,1", "0 has no logarithm"),
            ("a=normal:1,0", "a standard deviation of 0"),
            ("a=log-normal:5,0.5", "a factor above 1"),
            ("a=grid:1,2,1.5", "a grid of 1.5 values"),
            ("a=normal:5,1,100,200", "nothing lies between 100 and 200"),
            ("a=log-normal:1040,1.05,10000,20000", "nothing lies between"),
        ] {
            let message = text.parse::<VariedParameter>().unwrap_err();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }
}
