//! Units of columns, by the names that programs and people give them.

use std::f64::consts::{PI, TAU};

/// What a column measures; it decides which units the column may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// \[s\].
    Time,
    /// Angular speed of wheels \[rad/s\], or the speed of their rims, which the wheel radius converts.
    WheelSpeed,
    /// \[rad\].
    Angle,
    /// \[rad/s\].
    AngularVelocity,
    /// \[m\].
    Length,
    /// \[m/s\].
    Velocity,
    /// \[m/s^2\].
    Acceleration,
    /// A text.
    Label,
}

/// The size of a unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum UnitSize {
    /// In the column's SI unit.
    Si(f64),
    /// In metres per second, of the rims of wheels.
    Rim(f64),
}

const DEGREE: f64 = PI / 180.0;
const MINUTE: f64 = 60.0;
const HOUR: f64 = 3600.0;
const INCH: f64 = 0.0254;
const FOOT: f64 = 0.3048;
const MILE: f64 = 1609.344;
/// Standard gravity \[m/s^2\].
const GRAVITY: f64 = 9.806_65;

type Units = &'static [(&'static str, f64)];

const TIME: Units = &[
    ("s sec secs second seconds", 1.0),
    ("ms msec millis millisecond milliseconds", 1e-3),
    ("us usec micros microsecond microseconds", 1e-6),
    ("ns nsec nanos nanosecond nanoseconds", 1e-9),
    ("min minute minutes", MINUTE),
    ("h hour hours", HOUR),
];
const ANGLE: Units = &[
    ("rad radian radians", 1.0),
    ("deg degs degree degrees", DEGREE),
    ("mrad", 1e-3),
    ("rev turn turns", TAU),
    // Not "grad": these are degrees in German.
    ("gon", PI / 200.0),
];
const ANGULAR_VELOCITY: Units = &[
    ("rad/s rads radps", 1.0),
    ("deg/s degs dps degps", DEGREE),
    ("mrad/s", 1e-3),
    ("rpm rev/min r/min u/min 1/min", TAU / MINUTE),
    ("rev/s", TAU),
];
const LENGTH: Units = &[
    ("m meter meters metre metres", 1.0),
    ("cm", 1e-2),
    ("mm", 1e-3),
    ("km", 1e3),
    ("in inch inches", INCH),
    ("ft foot feet", FOOT),
];
const VELOCITY: Units = &[
    ("m/s mps", 1.0),
    ("cm/s", 1e-2),
    ("mm/s", 1e-3),
    ("km/h kmh kph kmph", 1e3 / HOUR),
    ("mph", MILE / HOUR),
    ("ft/s", FOOT),
];
const ACCELERATION: Units = &[
    ("m/s^2 m/s2 m/s/s mps2", 1.0),
    ("mm/s^2 mm/s2", 1e-3),
    ("g", GRAVITY),
];

impl Quantity {
    fn units(self) -> Units {
        match self {
            Self::Time => TIME,
            Self::Angle => ANGLE,
            Self::WheelSpeed | Self::AngularVelocity => ANGULAR_VELOCITY,
            Self::Length => LENGTH,
            Self::Velocity => VELOCITY,
            Self::Acceleration => ACCELERATION,
            Self::Label => &[],
        }
    }

    /// The size of a unit of this quantity; `None` for a unit of another one.
    pub fn size(self, unit: &str) -> Option<UnitSize> {
        let unit = plain(unit);
        let find = |units: Units| {
            let named = |(names, _): &&(&str, f64)| names.split(' ').any(|name| name == unit);
            units.iter().find(named).map(|(_, size)| *size)
        };
        let size = find(self.units()).map(UnitSize::Si);
        match self {
            Self::WheelSpeed => size.or_else(|| find(VELOCITY).map(UnitSize::Rim)),
            _ => size,
        }
    }

    /// The first name of each unit, for messages.
    pub fn names(self) -> String {
        let rims = if self == Self::WheelSpeed {
            VELOCITY
        } else {
            &[]
        };
        let all = self.units().iter().chain(rims);
        let names = all.filter_map(|(names, _)| names.split(' ').next());
        names.collect::<Vec<_>>().join(", ")
    }
}

/// Whether a text is a unit of any quantity, or stands for none.
pub fn is_unit(text: &str) -> bool {
    let all = [
        TIME,
        ANGLE,
        ANGULAR_VELOCITY,
        LENGTH,
        VELOCITY,
        ACCELERATION,
    ];
    let text = plain(text);
    let mut names = all
        .into_iter()
        .flatten()
        .flat_map(|(names, _)| names.split(' '));
    matches!(text.as_str(), "-" | "" | "1") || names.any(|name| name == text)
}

/// A unit in small letters, with `/` for a quotient and without brackets.
fn plain(unit: &str) -> String {
    let unit = unit
        .trim()
        .trim_matches(['[', ']', '(', ')', '{', '}', '<', '>']);
    let unit: String = unit
        .to_lowercase()
        .chars()
        .filter(|c| !c.is_whitespace())
        .collect();
    let unit = unit
        .replace('°', "deg")
        .replace(['µ', 'μ'], "u")
        .replace('²', "^2")
        .replace("per", "/")
        .replace("**", "^")
        .replace("sec", "s");
    // "rad s^-1", "m.s-2": a negative power is a quotient.
    for (power, quotient) in [
        ("s^-1", "/s"),
        ("s-1", "/s"),
        ("s^-2", "/s^2"),
        ("s-2", "/s^2"),
    ] {
        if let Some(start) = unit.strip_suffix(power) {
            return format!("{}{quotient}", start.trim_end_matches(['.', '*', '·']));
        }
    }
    unit
}

#[cfg(test)]
mod tests {
    use super::*;

    fn si(quantity: Quantity, unit: &str) -> f64 {
        match quantity.size(unit) {
            Some(UnitSize::Si(size)) => size,
            other => panic!("{unit}: {other:?}"),
        }
    }

    #[test]
    fn units_have_the_sizes_of_their_definitions() {
        for (quantity, unit, size) in [
            (Quantity::AngularVelocity, "rad/s", 1.0),
            (Quantity::AngularVelocity, "[rad s^-1]", 1.0),
            (Quantity::WheelSpeed, "RPM", 0.104_719_755_119_659_77),
            (Quantity::AngularVelocity, "°/s", 0.017_453_292_519_943_295),
            (Quantity::Angle, "Deg", 0.017_453_292_519_943_295),
            (Quantity::Time, "µs", 1e-6),
            (Quantity::Velocity, "km/h", 0.277_777_777_777_777_8),
            (Quantity::Velocity, "m.s-1", 1.0),
            (Quantity::Acceleration, "m/s²", 1.0),
            (Quantity::Acceleration, "g", 9.806_65),
            (Quantity::Length, "mm", 1e-3),
        ] {
            assert!((si(quantity, unit) / size - 1.0).abs() < 1e-15, "{unit}");
        }
        assert_eq!(Quantity::WheelSpeed.size("mm/s"), Some(UnitSize::Rim(1e-3)));
    }

    #[test]
    fn units_of_other_quantities_are_none() {
        assert_eq!(Quantity::Angle.size("m"), None);
        assert_eq!(Quantity::AngularVelocity.size("m/s"), None);
        assert_eq!(Quantity::Label.size("s"), None);
        assert!(is_unit("(rad/s)") && is_unit("-") && !is_unit("front"));
    }
}
