//! What `ugv inspect` found, as text, JSON and a page.

mod json;
mod page;
mod plots;
mod text;

pub use json::json;
pub use page::page;
pub use text::text;

use crate::inspection::{Delay, Noise, Quality};
use crate::recording::Channel;

/// A number with so many significant digits, without an exponent where it is a usual size.
fn digits(value: f64, count: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    // Rounding may make one digit more: 9.9996 is 10.0.
    let rounded = format!("{value:.*e}", count - 1);
    let exponent = rounded
        .rsplit('e')
        .next()
        .and_then(|digits| digits.parse().ok());
    let magnitude: i32 = exponent.unwrap_or_default();
    if !(-4..6).contains(&magnitude) {
        return rounded;
    }
    let decimals = (count as i32 - 1 - magnitude).max(0) as usize;
    format!("{value:.decimals$}")
}

/// A noise in a few digits: of values that are held or quantised so coarsely that over half of
/// them lie on the line between their neighbours there is nothing to tell.
fn noise(noise: Option<Noise>, with_interval: bool) -> String {
    match noise {
        None => "-".into(),
        Some(noise) if noise.deviation.value == 0.0 => "held".into(),
        Some(Noise { deviation, .. }) => {
            let [value, low, high] =
                [deviation.value, deviation.low, deviation.high].map(|value| digits(value, 2));
            if with_interval {
                format!("{value} ({low} .. {high})")
            } else {
                value
            }
        }
    }
}

/// Seconds with so many decimals; -0 says nothing that 0 does not.
fn seconds(value: f64, decimals: usize) -> String {
    let scale = 10f64.powi(decimals as i32);
    format!("{:.decimals$}", (value * scale).round() / scale + 0.0)
}

/// What a delay is of: "heading behind yaw_rate".
fn title(delay: &Delay) -> String {
    format!(
        "{} behind {}",
        delay.pair.of.name(),
        delay.pair.behind.name()
    )
}

fn word(quality: Quality) -> &'static str {
    match quality {
        Quality::Clear => "clear",
        Quality::Weak => "weak",
        Quality::Unknown => "unknown",
    }
}

/// A sentence on how to take a delay.
fn remark(delay: &Delay) -> &'static str {
    match delay.quality {
        _ if delay.contradicts => "the signals go against each other: look at their signs",
        Quality::Clear => "clear",
        Quality::Weak => "weak: it may vary over the recording",
        Quality::Unknown => "not determined",
    }
}

fn is_wheel(channel: Channel) -> bool {
    matches!(channel, Channel::OmegaLeft | Channel::OmegaRight)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_has_no_sign() {
        assert_eq!(seconds(-0.004, 2), "0.00");
        assert_eq!(seconds(-0.006, 2), "-0.01");
    }

    #[test]
    fn digits_are_those_that_count() {
        for (value, expected) in [
            (0.0, "0"),
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
}
