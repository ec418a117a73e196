//! The tables of the page.

use super::fit::Fit;
use super::judge::{Estimate, Judged};
use std::fmt::Write;

/// Digits behind the point of traction, side force, and sinkage, and what they are shown in.
const DIGITS: usize = 2;
const SHOWN: [f64; 3] = [1.0, 1.0, 1e3];

/// A law's line: name, fit, and how it was judged.
pub struct Line {
    pub name: String,
    pub fit: Fit,
    pub judged: Judged,
}

fn with_interval(estimate: &Estimate, scale: f64, digits: usize) -> String {
    // Adding zero takes the sign from what is rounded to nothing.
    let round = |value: f64| {
        let unit = 10f64.powi(digits as i32);
        format!("{:.digits$}", (value * scale * unit).round() / unit + 0.0)
    };
    let [low, high] = estimate.interval.map(round);
    format!("{} ({low} to {high})", round(estimate.value))
}

/// Errors of some laws.
pub fn errors(lines: &[Line]) -> String {
    let mut text = String::from(
        "| law | traction: RMSE \\[N\\] | R² | side force: RMSE \\[N\\] | R² | sinkage: RMSE \\[mm\\] | R² | training cost |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for Line { name, fit, judged } in lines {
        let _ = write!(text, "| {name} ");
        for (output, shown) in SHOWN.into_iter().enumerate() {
            let rmse = with_interval(&judged.rmse[output], shown, DIGITS);
            let r2 = with_interval(&judged.r2[output], 1.0, DIGITS);
            let _ = write!(text, "| {rmse} | {r2} ");
        }
        let _ = writeln!(text, "| {:.0} |", fit.cost);
    }
    text
}

/// Parameters of some fits, side by side.
pub fn constants(lines: &[&Line]) -> String {
    let mut names: Vec<(String, &str)> = Vec::new();
    for parameter in lines.iter().flat_map(|line| &line.fit.law.parameters) {
        if !names.iter().any(|(name, _)| *name == parameter.name) {
            names.push((parameter.name.clone(), parameter.unit));
        }
    }
    let mut text = String::from("| constant |");
    for line in lines {
        let _ = write!(text, " {} |", line.name);
    }
    text += "\n|---|";
    text += &"---|".repeat(lines.len());
    text.push('\n');
    for (name, unit) in names {
        let _ = write!(text, "| {name} \\[{unit}\\] |");
        for line in lines {
            let place = line.fit.law.parameters.iter().position(|p| p.name == name);
            let cell = place.map_or_else(|| "–".into(), |place| constant(&line.fit, place));
            let _ = write!(text, " {cell} |");
        }
        text.push('\n');
    }
    text
}

fn constant(fit: &Fit, place: usize) -> String {
    let value = fit.values[place];
    let digits = if value.abs() >= 100.0 {
        0
    } else if value.abs() >= 10.0 {
        1
    } else {
        2
    };
    match fit.intervals[place] {
        Some([low, high]) => format!("{value:.digits$} ({low:.digits$} to {high:.digits$})"),
        None => format!("{value:.digits$}, at its bound"),
    }
}

/// By how much each law's error is smaller than the first's.
pub fn gains(lines: &[Line]) -> String {
    let mut text = String::from(
        "| law | traction \\[%\\] | side force \\[%\\] | sinkage \\[%\\] |\n|---|---|---|---|\n",
    );
    for line in &lines[1..] {
        let _ = write!(text, "| {} ", line.name);
        for output in 0..3 {
            let gain = line.judged.gain_over(&lines[0].judged, output);
            let _ = write!(text, "| {} ", with_interval(&gain, 100.0, 0));
        }
        text += "|\n";
    }
    text
}
