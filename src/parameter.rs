//! Ranges of physical parameters, and the error that a value outside of one gives.

use crate::display::number;
use std::fmt;

/// The range that a parameter must lie in, with its name and unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    name: &'static str,
    unit: &'static str,
    low: f64,
    high: f64,
    low_included: bool,
    high_included: bool,
    why: &'static str,
}

impl Bounds {
    /// low <= value <= high.
    #[must_use]
    pub const fn closed(name: &'static str, unit: &'static str, low: f64, high: f64) -> Self {
        Self {
            name,
            unit,
            low,
            high,
            low_included: true,
            high_included: true,
            why: "",
        }
    }

    /// low < value <= high.
    #[must_use]
    pub const fn open_low(name: &'static str, unit: &'static str, low: f64, high: f64) -> Self {
        let mut bounds = Self::closed(name, unit, low, high);
        bounds.low_included = false;
        bounds
    }

    /// low <= value < high.
    #[must_use]
    pub const fn half_open(name: &'static str, unit: &'static str, low: f64, high: f64) -> Self {
        let mut bounds = Self::closed(name, unit, low, high);
        bounds.high_included = false;
        bounds
    }

    /// low < value < high.
    #[must_use]
    pub const fn open(name: &'static str, unit: &'static str, low: f64, high: f64) -> Self {
        let mut bounds = Self::open_low(name, unit, low, high);
        bounds.high_included = false;
        bounds
    }

    /// The same range, with what makes it so, for those whose value is outside of it.
    #[must_use]
    pub const fn because(mut self, why: &'static str) -> Self {
        self.why = why;
        self
    }

    /// Whether a value is finite and within the range.
    ///
    /// # Errors
    /// Names the parameter, the value, the unit and the range.
    pub fn check(&self, value: f64) -> Result<(), ParameterError> {
        let above = value > self.low || (self.low_included && value == self.low);
        let below = value < self.high || (self.high_included && value == self.high);
        if value.is_finite() && above && below {
            return Ok(());
        }
        Err(ParameterError {
            name: self.name.into(),
            value,
            unit: self.unit,
            range: self.to_string(),
            why: self.why,
        })
    }
}

impl fmt::Display for Bounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let open = if self.low_included { '[' } else { '(' };
        let close = if self.high_included { ']' } else { ')' };
        write!(
            f,
            "{open}{}, {}{close}",
            number(self.low),
            number(self.high)
        )
    }
}

/// A physical parameter that describes no vehicle, soil or setting.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterError {
    /// The parameter's name, as in the JSON files.
    pub name: String,
    /// The value that was given.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// The range that it must lie in.
    pub range: String,
    /// What makes the range so; empty where it always is.
    pub why: &'static str,
}

impl ParameterError {
    /// A parameter that nothing has.
    #[must_use]
    pub fn unknown(name: &str, value: f64) -> Self {
        Self {
            name: name.into(),
            value,
            unit: "",
            range: "(no such parameter)".into(),
            why: "",
        }
    }
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            value,
            unit,
            range,
            why,
        } = self;
        let value = number(*value);
        match *unit {
            "1" => write!(f, "{name} = {value} is outside its range {range}"),
            _ => write!(
                f,
                "{name} = {value} {unit} is outside its range {range} {unit}"
            ),
        }?;
        match *why {
            "" => Ok(()),
            why => write!(f, " ({why})"),
        }
    }
}

impl std::error::Error for ParameterError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_belong_or_do_not() {
        let bounds = Bounds::open_low("n", "1", 0.0, 3.0);
        assert!(bounds.check(0.0).is_err());
        assert!(bounds.check(3.0).is_ok());
        assert!(bounds.check(f64::NAN).is_err());
        assert!(
            Bounds::half_open("phi", "deg", 0.0, 90.0)
                .check(90.0)
                .is_err()
        );
        assert!(Bounds::open("d", "m", -1.0, 1.0).check(-1.0).is_err());
    }

    #[test]
    fn message_has_name_value_unit_and_range() {
        let error = Bounds::open_low("mass", "kg", 0.0, 1e6)
            .check(-3.0)
            .unwrap_err();
        assert_eq!(
            error.to_string(),
            "mass = -3 kg is outside its range (0, 1000000] kg"
        );
        let error = Bounds::closed("share", "1", 0.0, 1.0)
            .check(2.0)
            .unwrap_err();
        assert_eq!(error.to_string(), "share = 2 is outside its range [0, 1]");
        let narrow = Bounds::closed("share", "1", 0.0, 0.5).because("half of all");
        assert_eq!(
            narrow.check(2.0).unwrap_err().to_string(),
            "share = 2 is outside its range [0, 0.5] (half of all)"
        );
    }
}
