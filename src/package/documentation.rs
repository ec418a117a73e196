//! The page that the FMU carries as its documentation.

use crate::declaration::{Causality, Configuration, Kind, TERRAIN_NAMES, Variable, variables};
use quick_xml::escape::escape;

const TEMPLATE: &str = include_str!("../../modelDescription/documentation.html");

/// The page with its table of variables.
#[must_use]
pub fn documentation(configuration: &Configuration) -> String {
    let variables = variables(configuration.vehicle.row_positions.len());
    let rows: Vec<String> = variables.iter().map(|v| row(v, configuration)).collect();
    TEMPLATE
        .replace("{{version}}", env!("CARGO_PKG_VERSION"))
        .replace("{{variables}}", &rows.join("\n"))
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
