//! The page that the FMU carries as its documentation.

use super::standard::Standard;
use crate::declaration::{ArrayVariable, Causality, Configuration, Kind, TERRAINS};
use crate::effects::{CATALOGUE, Declaration, EffectKind, Effects};
use quick_xml::escape::escape;

/// What only FMI 2.0 has.
const RAMPS: &str = "; input derivatives of order 1 make the wheel speeds
change linearly within the step that follows";

const TEMPLATE: &str = include_str!("../../modelDescription/documentation.html");

/// The page with its tables of effects and variables.
#[must_use]
pub fn documentation(standard: Standard, configuration: &Configuration) -> String {
    let variables = standard.naming().variables(configuration);
    let rows: Vec<String> = variables.iter().map(|v| row(v, configuration)).collect();
    let (version, ramps) = match standard {
        Standard::Fmi2 => ("2.0", RAMPS),
        Standard::Fmi3 => ("3.0", ""),
    };
    let interfaces = if configuration.for_co_simulation_alone().is_empty() {
        "co-simulation and model exchange"
    } else {
        "co-simulation"
    };
    TEMPLATE
        .replace("{{version}}", env!("CARGO_PKG_VERSION"))
        .replace("{{standard}}", version)
        .replace("{{ramps}}", ramps)
        .replace("{{interfaces}}", interfaces)
        .replace("{{file}}", &file(configuration))
        .replace("{{effects}}", &effects(configuration).join("\n"))
        .replace("{{variables}}", &rows.join("\n"))
}

/// One row for each effect of the model's.
fn effects(configuration: &Configuration) -> Vec<String> {
    let numbered = CATALOGUE.iter().enumerate();
    let physics = numbered.filter(|(_, effect)| effect.kind == EffectKind::Physics);
    let row = |(index, effect): (usize, &&Declaration)| {
        let on = if configuration.effects.is_on(index) {
            "on"
        } else {
            ""
        };
        format!(
            "<tr><td><code>{}</code></td><td>{on}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            effect.name,
            escape(effect.lifts),
            escape(effect.equation),
            escape(effect.source),
        )
    };
    physics.map(row).collect()
}

/// What is on, as its file has it: windows, profiles and boundaries are no variables.
fn file(configuration: &Configuration) -> String {
    if configuration.effects == Effects::NONE {
        return String::new();
    }
    let text = configuration.effects.to_json();
    format!(
        "<p>As packaged (<code>resources/effects.json</code>):</p>\n<pre>{}</pre>\n",
        escape(text.trim_end())
    )
}

fn row(variable: &ArrayVariable, configuration: &Configuration) -> String {
    let attributes = variable.attributes;
    let causality = match attributes.causality {
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Local => "local",
        Causality::Parameter => "parameter",
        Causality::Independent => "independent",
    };
    let start = match attributes.kind {
        Kind::Boolean => "false".to_owned(),
        Kind::Enumeration => TERRAINS[configuration.selected].0.to_owned(),
        Kind::Real => variable.starts(configuration),
    };
    let name = match variable.elements.dimension() {
        Some(size) => format!("{}[{size}]", variable.name),
        None => variable.name.clone(),
    };
    format!(
        "<tr><td><code>{}</code></td><td>{}</td><td>{causality}</td><td>{}</td><td>{start}</td><td>{}</td></tr>",
        escape(&name),
        variable.reference,
        escape(attributes.unit),
        escape(attributes.description),
    )
}
