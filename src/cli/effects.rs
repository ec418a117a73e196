//! `ugv effects`: the physics that the paper leaves out, and what sensors add.

use super::output::write_stdout;
use super::{Failure, tell};
use clap::builder::PossibleValuesParser;
use std::fmt::Write;
use ugv_terrain::effects::{
    CATALOGUE, Declaration, EffectKind, Effects, ParameterDeclaration, ParameterName, Prior,
};

const EXAMPLES: &str = "\
Examples:
  ugv effects                              # what there is
  ugv effects grade payload > mine.json    # edit it, then: ugv simulate --effects mine.json ...

An effect is off while its parameters have the values that the list calls off; a file of effects
needs only what differs. In a file, grade may also hold slopes along the drive, linear in between:
  \"grade\": {\"profile\": {\"over\": \"time\", \"points\": [[0, 0, 0], [5, 0.1, 0]]}}
with [at, slope_east, slope_north] over \"time\" [s, from the first row on] or \"distance\" [m], or
  {\"over\": \"place\", \"x\": [...], \"y\": [...], \"slopes\": [[[slope_east, slope_north], ...], ...]}
with a list for each x of a pair for each y; terrain_change tells by \"over\" (time, distance or place)
what its position is measured over, place where nothing is said. Effects that act for a while [s, from
the first row on] or somewhere [m] stand beside a window with hard edges, outside of which they are off:
  \"drawbar\": {\"force\": 300}, \"window\": {\"effects\": [\"drawbar\"], \"time\": [12.4, 21]}
  or in the place of \"time\" \"place\": {\"x\": 5, \"y\": 0, \"radius\": 2} (the reference point's).";

/// List the physics that the paper leaves out, or print effects as JSON.
///
/// With names the JSON on standard output has typical values, to copy and edit; standard error
/// tells the equation, its source, and what is believed of the parameters before any data.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Print these effects, as --effects takes them
    #[arg(value_parser = PossibleValuesParser::new(CATALOGUE.iter().map(|effect| effect.name)))]
    name: Vec<String>,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    if args.name.is_empty() {
        return write_stdout(&list());
    }
    let mut effects = Effects::NONE;
    for (index, effect) in CATALOGUE.iter().enumerate() {
        if args.name.iter().any(|name| name == effect.name) {
            explain(effect);
            for (place, declared) in effect.parameters.iter().enumerate() {
                if let Some(parameter) = ParameterName::at(index, place) {
                    effects
                        .set(parameter, typical(declared))
                        .map_err(Failure::Model)?;
                }
            }
        }
    }
    write_stdout(&effects.to_json())
}

/// All effects with their parameters.
fn list() -> String {
    let mut text = String::new();
    for (kind, title) in [
        (EffectKind::Physics, "Physics: how the vehicle moves"),
        (
            EffectKind::Measurement,
            "Measurement: what sensors report of it",
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
    text + "`ugv effects NAME` prints equation, source and a file to edit.\n"
}

/// "-0.3 to 0.3 rad".
fn range(declared: &ParameterDeclaration) -> String {
    let ParameterDeclaration {
        low, high, unit, ..
    } = declared;
    let unit = if *unit == "1" { "" } else { unit };
    format!("{low} to {high} {unit}").trim_end().into()
}

/// What the value means where none is given.
fn state(declared: &ParameterDeclaration) -> String {
    let kind = if declared.switches {
        "off at"
    } else {
        "default"
    };
    format!("{kind} {}", declared.default)
}

fn explain(effect: &Declaration) {
    tell(&format!("{} lifts: {}", effect.name, effect.lifts));
    tell(&format!("  equation: {}", effect.equation));
    tell(&format!("  source: {}", effect.source));
    for declared in effect.parameters {
        let believed = match declared.prior {
            Prior::Normal { mean, deviation } => format!("{mean} +- {deviation}"),
            Prior::LogNormal { median, deviation } => {
                format!("{median}, up or down by a factor of {:.2}", deviation.exp())
            }
        };
        tell(&format!(
            "  {}: {}; {}, {}; where on, believed to be {believed}",
            declared.name,
            declared.description,
            range(declared),
            state(declared),
        ));
    }
}

/// A value at which the effect is on, as strong as it commonly is.
fn typical(declared: &ParameterDeclaration) -> f64 {
    if !declared.switches {
        return declared.default;
    }
    let (centre, beside) = match declared.prior {
        Prior::Normal { mean, deviation } => (mean, mean + deviation),
        Prior::LogNormal { median, deviation } => (median, median * deviation.exp()),
    };
    let chosen = if centre == declared.default {
        beside
    } else {
        centre
    };
    let rounded = |decimals: f64| {
        let digits = 10_f64.powf(decimals - chosen.abs().log10().floor());
        ((chosen * digits).round() / digits).clamp(declared.low, declared.high)
    };
    // Not so short that the effect is off again.
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
        let slope = ParameterName::find("grade.slope_east")
            .unwrap()
            .declaration()
            .1;
        assert_eq!(typical(slope), 0.05);
        let ratio = ParameterName::find("left_right_soil.ratio")
            .unwrap()
            .declaration()
            .1;
        assert_eq!(typical(ratio), 1.5);
        let hitch = ParameterName::find("drawbar.hitch_height")
            .unwrap()
            .declaration()
            .1;
        assert_eq!(typical(hitch), 0.3);
    }
}
