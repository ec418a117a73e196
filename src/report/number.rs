//! Numbers as people read them.

/// A number with this many significant digits, without an exponent for usual magnitudes.
#[must_use]
pub fn digits(value: f64, count: usize) -> String {
    if value == 0.0 {
        // -0 too, the value of an empty sum.
        return "0".into();
    }
    if !value.is_finite() {
        return format!("{value}");
    }
    // Rounding may make one digit more: 9.9996 is 10.0.
    let rounded = format!("{value:.*e}", count - 1);
    let magnitude = exponent(&rounded);
    if !(-4..6).contains(&magnitude) {
        return rounded;
    }
    let decimals = (count as i32 - 1 - magnitude).max(0) as usize;
    format!("{value:.decimals$}")
}

fn exponent(rounded: &str) -> i32 {
    let exponent = rounded.rsplit('e').next();
    exponent
        .and_then(|digits| digits.parse().ok())
        .unwrap_or_default()
}

/// A number with this many decimals; what rounds to zero has no sign.
#[must_use]
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(size) if size.chars().all(|c| matches!(c, '0' | '.')) => size.into(),
        _ => text,
    }
}

/// Factor and unit in which a value is shown: angles in degrees.
#[must_use]
pub fn shown(unit: &str) -> (f64, &str) {
    match unit {
        "rad" => (1f64.to_degrees(), "deg"),
        "rad/s" => (1f64.to_degrees(), "deg/s"),
        "1" => (1.0, ""),
        _ => (1.0, unit),
    }
}

/// A number and its unit, angles in degrees.
#[must_use]
pub fn with_unit(value: f64, unit: &str) -> String {
    if !value.is_finite() {
        return "-".into();
    }
    let (factor, unit) = shown(unit);
    format!("{} {unit}", digits(value * factor, 2))
        .trim_end()
        .into()
}

/// A value with the ends of its interval, to the precision that the interval justifies.
#[must_use]
pub fn with_interval(value: f64, low: f64, high: f64) -> [String; 3] {
    let all = [value, low, high];
    let half = (high - low) / 2.0;
    let largest = all.map(f64::abs).into_iter().fold(0.0, f64::max);
    let usual = half.is_finite() && half > 0.0 && (1e-4..1e6).contains(&largest);
    // Two digits of the half width, but no more than six of the value.
    let magnitude = exponent(&format!("{half:.1e}"));
    let max = 5 - exponent(&format!("{largest:.0e}"));
    let decimals = (1 - magnitude).clamp(0, max.max(0)) as usize;
    all.map(|value| match value {
        value if value.is_nan() => "-".into(),
        value if usual => fixed(value, decimals),
        value => digits(value, 3),
    })
}

/// A probability in percent, never rounded to certainty.
#[must_use]
pub fn percent(probability: f64) -> String {
    match 100.0 * probability {
        p if !p.is_finite() => "-".into(),
        p if p > 99.0 && p < 100.0 => "over 99 %".into(),
        p if p > 0.0 && p < 0.5 => "under 1 %".into(),
        p => format!("{p:.0} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_the_significant_ones() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.0, "0"),
            (0.012345, "0.0123"),
            (1.0, "1.00"),
            (9.9996, "10.0"),
            (-123.4, "-123"),
            (12345.6, "12346"),
            (1.2345e-7, "1.23e-7"),
        ] {
            assert_eq!(digits(value, 3), expected);
        }
    }

    #[test]
    fn zero_has_no_sign() {
        assert_eq!(fixed(-0.004, 2), "0.00");
        assert_eq!(fixed(-0.006, 2), "-0.01");
    }

    #[test]
    fn angles_are_in_degrees() {
        assert_eq!(with_unit(0.1, "rad"), "5.7 deg");
        assert_eq!(with_unit(0.25, "1"), "0.25");
        assert_eq!(with_unit(12.0, "kg"), "12 kg");
        assert_eq!(with_unit(f64::INFINITY, "kg"), "-");
    }

    #[test]
    fn intervals_set_the_precision() {
        for ((value, low, high), expected) in [
            ((1.776, 1.547, 2.006), ["1.78", "1.55", "2.01"]),
            ((-0.001, -0.04, 0.03), ["-0.001", "-0.040", "0.030"]),
            ((-0.0001, -0.04, 0.03), ["0.000", "-0.040", "0.030"]),
            ((1234.5, 1100.0, 1400.0), ["1234", "1100", "1400"]),
            ((2.5e7, 1e7, 4e7), ["2.50e7", "1.00e7", "4.00e7"]),
            ((0.5, 0.5, 0.5), ["0.500", "0.500", "0.500"]),
            ((0.5, 0.1, f64::INFINITY), ["0.500", "0.100", "inf"]),
            ((f64::NAN, 1.0, 2.0), ["-", "1.00", "2.00"]),
            ((f64::NAN, f64::NAN, f64::NAN), ["-", "-", "-"]),
        ] {
            assert_eq!(with_interval(value, low, high), expected);
        }
    }

    #[test]
    fn nothing_is_certain() {
        for (probability, expected) in [
            (0.973, "97 %"),
            (0.9999, "over 99 %"),
            (0.002, "under 1 %"),
            (0.0, "0 %"),
            (1.0, "100 %"),
            (f64::NAN, "-"),
        ] {
            assert_eq!(percent(probability), expected);
        }
    }
}
