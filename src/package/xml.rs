//! What the model descriptions of both versions of the standard have in common.

use super::Standard;
use crate::declaration::{Causality, Enumeration, Quantity, Unit, units};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use std::io;

pub(super) type Xml = Writer<Vec<u8>>;

/// The time that every build carries, so that the same source gives the same bytes.
const GENERATION_TIME: &str = "2026-11-21T00:00:00Z";

/// Attributes that tell where the FMU comes from.
pub(super) const ORIGIN: [(&str, &str); 7] = [
    (
        "description",
        "Wheel-terrain model of a skid-steer UGV after Tran, Kwok, Scheding and Ha (2007)",
    ),
    ("author", "The ugv-terrain developers"),
    ("version", env!("CARGO_PKG_VERSION")),
    ("license", "MIT OR Apache-2.0"),
    (
        "generationTool",
        concat!("ugv-terrain ", env!("CARGO_PKG_VERSION")),
    ),
    ("generationDateAndTime", GENERATION_TIME),
    ("variableNamingConvention", "structured"),
];

/// A document with what `write` writes in it.
pub(super) fn document(write: impl FnOnce(&mut Xml) -> io::Result<()>) -> String {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    let declaration = Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None));
    xml.write_event(declaration)
        .and_then(|()| write(&mut xml))
        .expect("writing to memory does not fail");
    xml.get_mut().push(b'\n');
    String::from_utf8(xml.into_inner()).expect("the writer passes UTF-8 on")
}

pub(super) fn write_units(xml: &mut Xml) -> io::Result<()> {
    xml.create_element("UnitDefinitions")
        .write_inner_content(|xml| units().iter().try_for_each(|unit| write_unit(xml, unit)))?;
    Ok(())
}

fn write_unit(xml: &mut Xml, unit: &Unit) -> io::Result<()> {
    let element = xml
        .create_element("Unit")
        .with_attribute(("name", unit.name));
    // Exponents that depend on the soil cannot be told.
    let Some(base) = unit.base else {
        return element.write_empty().map(drop);
    };
    element.write_inner_content(|xml| {
        let mut element = xml.create_element("BaseUnit");
        for (name, exponent) in base {
            element = element.with_attribute((*name, exponent.to_string().as_str()));
        }
        if let Some(factor) = unit.factor {
            element = element.with_attribute(("factor", factor.to_string().as_str()));
        }
        element.write_empty().map(drop)
    })?;
    Ok(())
}

/// Each category with what it is for, and whether FMI 2.0 and FMI 3.0 are told whatever they ask for.
const LOG_CATEGORIES: [(&str, &str, [bool; 2]); 5] = [
    ("logStatusFatal", "What ends the instance", [true, true]),
    ("logStatusError", "Calls that fail, and why", [true, true]),
    (
        "logStatusWarning",
        "What the user should know, such as a lifted wheel",
        [true, false],
    ),
    (
        "logStatusDiscard",
        "What is not to be had; in model exchange, trials of the solver that cannot be computed",
        [false, false],
    ),
    (
        "logEvents",
        "What the integration has cost, at the end",
        [false, false],
    ),
];

pub(super) fn write_log_categories(xml: &mut Xml, standard: Standard) -> io::Result<()> {
    xml.create_element("LogCategories")
        .write_inner_content(|xml| {
            LOG_CATEGORIES
                .iter()
                .try_for_each(|(name, description, always)| {
                    let is_always = match standard {
                        Standard::Fmi2 => always[0],
                        Standard::Fmi3 => always[1],
                    };
                    let ending = if is_always { "; always reported" } else { "" };
                    let description = format!("{description}{ending}");
                    xml.create_element("Category")
                        .with_attributes([("name", *name), ("description", description.as_str())])
                        .write_empty()
                        .map(drop)
                })
        })?;
    Ok(())
}

/// How a variable of some causality is declared: causality, variability, and what its start is.
pub(super) const fn role(
    causality: Causality,
) -> (&'static str, &'static str, Option<&'static str>) {
    match causality {
        Causality::Input => ("input", "continuous", None),
        Causality::Output => ("output", "continuous", Some("calculated")),
        Causality::Local => ("local", "continuous", Some("calculated")),
        Causality::Parameter => ("parameter", "fixed", Some("exact")),
        Causality::Independent => ("independent", "continuous", None),
    }
}

/// Whether a variable grows without end, so that a solver should not take its size for a measure: the pose.
pub(super) const fn is_unbounded(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::State(0..=2))
}

/// The names of an enumeration's values.
pub(super) fn write_items(xml: &mut Xml, enumeration: &Enumeration) -> io::Result<()> {
    for (name, value, description) in enumeration.items {
        let value = value.to_string();
        xml.create_element("Item")
            .with_attributes([
                ("name", *name),
                ("value", value.as_str()),
                ("description", *description),
            ])
            .write_empty()?;
    }
    Ok(())
}

pub(super) fn write_default_experiment(xml: &mut Xml) -> io::Result<()> {
    xml.create_element("DefaultExperiment")
        .with_attributes([("startTime", "0"), ("stopTime", "10"), ("stepSize", "0.01")])
        .write_empty()?;
    Ok(())
}
