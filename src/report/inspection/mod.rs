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
use crate::report::number::digits;

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
}
