//! The page that the FMU carries as its documentation.

use crate::declaration::{Causality, Configuration, Kind, TERRAIN_NAMES, Variable, variables};
use crate::effects::{CATALOGUE, Declaration, Kind as EffectKind};
use quick_xml::escape::escape;

const TEMPLATE: &str = include_str!("../../modelDescription/documentation.html");

/// The page with its tables of effects and variables.
#[must_use]
pub fn documentation(configuration: &Configuration) -> String {
    let variables = variables(configuration);
    let rows: Vec<String> = variables.iter().map(|v| row(v, configuration)).collect();
    let interfaces = if configuration.remembering().is_empty() {
        "co-simulation and model exchange"
    } else {
        "co-simulation"
    };
    TEMPLATE
        .replace("{{version}}", env!("CARGO_PKG_VERSION"))
        .replace("{{interfaces}}", interfaces)
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

fn row(variable: &Variable, configuration: &Configuration) -> String {
    let attributes = variable.attributes;
    let causality = match attributes.causality {
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Local => "local",
        Causality::Parameter => "parameter",
    };
    let start = match attributes.kind {
        Kind::Boolean => "false".to_owned(),
        Kind::Enumeration => TERRAIN_NAMES[configuration.selected].to_owned(),
        Kind::Real => configuration
            .parameter(variable.quantity)
            .or(attributes.start)
            .map_or(String::new(), |number| number.to_string()),
    };
    format!(
        "<tr><td><code>{}</code></td><td>{}</td><td>{causality}</td><td>{}</td><td>{start}</td><td>{}</td></tr>",
        escape(&variable.name),
        variable.reference,
        escape(attributes.unit),
        escape(attributes.description),
    )
}
