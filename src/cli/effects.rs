//! `ugv effects`: physics beyond the paper, and effects of the sensors.

use super::destination::PrintArgs;
use super::failure::Failure;
use super::output::notify;
use crate::effects::{
    CATALOGUE, Declaration, EffectKind, Effects, ParameterDeclaration, ParameterName, Prior,
};
use clap::builder::PossibleValuesParser;
use std::fmt::Write;

const EXAMPLES: &str = "\
Examples:
  ugv effects                              # list all
  ugv effects grade payload > mine.json    # edit it, then: ugv simulate --effects mine.json ...

An effect is off while its parameters have the values that the list calls off; a file needs only
the other parameters. In a file, grade can have slopes along the drive, linear in between:
  \"grade\": {\"profile\": {\"over\": \"time\", \"points\": [[0, 0, 0], [5, 0.1, 0]]}}
with [at, slope_east, slope_north] over \"time\" [s, from the first row on] or \"distance\" [m], or
  {\"over\": \"place\", \"x\": [...], \"y\": [...], \"slopes\": [[[slope_east, slope_north], ...], ...]}
with a list for each x of a pair for each y. In terrain_change, \"over\" says what its position is
measured over: time, distance or place (default). A window with hard edges limits effects to a time
[s, from the first row on] or a place [m]; outside of it they are off:
  \"drawbar\": {\"force\": 300}, \"window\": {\"effects\": [\"drawbar\"], \"time\": [12.4, 21]}
  or instead of \"time\" \"place\": {\"x\": 5, \"y\": 0, \"radius\": 2} (of the reference point).";

/// List the physics beyond the paper, or print effects as JSON.
///
/// With names, standard output has JSON with typical values, to copy and edit. Standard error has
/// the equation, its source, and the priors of the parameters.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Print these effects, as --effects takes them
    #[arg(value_parser = PossibleValuesParser::new(CATALOGUE.iter().map(|effect| effect.name)))]
    name: Vec<String>,

    #[command(flatten)]
    print: PrintArgs,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    if args.name.is_empty() {
        return args.print.write(&list());
    }
    let mut effects = Effects::NONE;
    for (index, effect) in CATALOGUE.iter().enumerate() {
        if args.name.iter().any(|name| name == effect.name) {
            explain(effect);
            for (place, declared) in effect.parameters.iter().enumerate() {
                if let Some(parameter) = ParameterName::at(index, place) {
                    effects.set(parameter, typical(declared))?;
                }
            }
        }
    }
    args.print.write(&effects.to_json())
}

/// All effects with their parameters.
fn list() -> String {
    let mut text = String::new();
    for (kind, title) in [
        (EffectKind::Physics, "Physics: how the vehicle moves"),
        (
            EffectKind::Measurement,
            "Measurement: what the sensors report",
        ),
    ] {
        let _ = writeln!(text, "{title}\n");
        for effect in CATALOGUE.iter().filter(|effect| effect.kind == kind) {
            let _ = writeln!(text, "  {}: lifts {}", effect.name, effect.lifts);
            for declared in effect.parameters {
                let range = range(declared);
                let state = state(declared);
                let (name, what) = (declared.name, declared.description);
                let _ = writeln!(text, "    {name:<21}{range:<29}{state:<17}{what}");
            }
            text.push('\n');
        }
    }
    text + "`ugv effects NAME` prints equation, source, priors and a file to edit.\n"
}

/// "-0.3 to 0.3 rad".
fn range(declared: &ParameterDeclaration) -> String {
    let ParameterDeclaration {
        low, high, unit, ..
    } = declared;
    let unit = if *unit == "1" { "" } else { unit };
    format!("{low} to {high} {unit}").trim_end().into()
}

/// The value of a parameter that a file leaves out, and whether the effect is off then.
fn state(declared: &ParameterDeclaration) -> String {
    let kind = if declared.switches {
        "off at"
    } else {
        "default"
    };
    format!("{kind} {}", declared.default)
}

fn explain(effect: &Declaration) {
    notify(&format!("{} lifts: {}", effect.name, effect.lifts));
    notify(&format!("  equation: {}", effect.equation));
    notify(&format!("  source: {}", effect.source));
    for declared in effect.parameters {
        let prior = match declared.prior {
            Prior::Normal { mean, deviation } => format!("{mean} +- {deviation}"),
            Prior::LogNormal { median, deviation } => {
                format!("{median} */ {:.2}", deviation.exp())
            }
        };
        notify(&format!(
            "  {}: {}; {}, {}; prior when on {prior}",
            declared.name,
            declared.description,
            range(declared),
            state(declared),
        ));
    }
}

/// A value that switches the effect on, with a common strength.
fn typical(declared: &ParameterDeclaration) -> f64 {
    if !declared.switches {
        return declared.default;
    }
    let (centre, beside) = match declared.prior {
        Prior::Normal { mean, deviation } => (mean, mean + deviation),
        Prior::LogNormal { median, deviation } => (median, median * deviation.exp()),
    };
    let is_off = centre == declared.default;
    let chosen = if is_off { beside } else { centre };
    let rounded = |decimals: f64| {
        let digits = 10_f64.powf(decimals - chosen.abs().log10().floor());
        ((chosen * digits).round() / digits).clamp(declared.low, declared.high)
    };
    // Two digits may be those of the value that switches the effect off.
    let short = rounded(1.0);
    if short == declared.default {
        rounded(2.0)
    } else {
        short
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typical_values_switch_every_effect_on() {
        for (index, effect) in CATALOGUE.iter().enumerate() {
            let mut effects = Effects::NONE;
            for (place, declared) in effect.parameters.iter().enumerate() {
                let parameter = ParameterName::at(index, place).unwrap();
                effects.set(parameter, typical(declared)).unwrap();
            }
            let on = effects.on(effect.kind).map(|effect| effect.name);
            assert_eq!(on.collect::<Vec<_>>(), [effect.name]);
        }
    }

    #[test]
    fn typical_values_are_short() {
        for (name, expected) in [
            ("grade.slope_east", 0.05),
            ("left_right_soil.ratio", 1.5),
            ("drawbar.hitch_height", 0.3),
        ] {
            let (_, declared) = ParameterName::find(name).unwrap().declaration();
            assert_eq!(typical(declared), expected, "{name}");
        }
    }
}
