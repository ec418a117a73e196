//! `modelDescription.xml` of FMI 2.0, written from the declaration of the variables.

use super::MODEL_IDENTIFIER;
use crate::declaration::{
    Causality, Configuration, Kind, Quantity, Unit, Variable, enumerations, guid, units, variables,
};
use crate::simulation::State;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use std::io;

/// The time that every build carries, so that the same source gives the same bytes.
const GENERATION_TIME: &str = "2026-11-21T00:00:00Z";

type Xml = Writer<Vec<u8>>;

/// Where each variable stands in the list, counted from 1 as the model structure does.
struct Indices<'v> {
    variables: &'v [Variable],
}

impl Indices<'_> {
    fn of(&self, quantity: Quantity) -> usize {
        let position = self.variables.iter().position(|v| v.quantity == quantity);
        position.map_or(0, |index| index + 1)
    }

    fn where_(&self, wanted: impl Fn(&Variable) -> bool) -> Vec<usize> {
        let numbered = self.variables.iter().zip(1..);
        numbered
            .filter(|(v, _)| wanted(v))
            .map(|(_, index)| index)
            .collect()
    }
}

/// Writes the model description of the FMU of a configuration.
///
/// # Panics
/// Never: writing to memory does not fail.
#[must_use]
pub fn model_description(configuration: &Configuration) -> String {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    write(&mut xml, configuration).expect("writing to memory does not fail");
    String::from_utf8(xml.into_inner()).expect("the writer passes UTF-8 on")
}

fn write(xml: &mut Xml, configuration: &Configuration) -> io::Result<()> {
    let variables = variables(configuration);
    let indices = Indices {
        variables: &variables,
    };
    let guid = guid(configuration);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    xml.create_element("fmiModelDescription")
        .with_attributes([
            ("fmiVersion", "2.0"),
            ("modelName", MODEL_IDENTIFIER),
            ("guid", guid.as_str()),
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
            ("numberOfEventIndicators", "0"),
        ])
        .write_inner_content(|xml| {
            write_interfaces(xml, configuration)?;
            xml.create_element("UnitDefinitions")
                .write_inner_content(|xml| {
                    units().iter().try_for_each(|unit| write_unit(xml, unit))
                })?;
            xml.create_element("TypeDefinitions")
                .write_inner_content(write_enumerations)?;
            xml.create_element("LogCategories")
                .write_inner_content(write_log_categories)?;
            xml.create_element("DefaultExperiment")
                .with_attributes([("startTime", "0"), ("stopTime", "10"), ("stepSize", "0.01")])
                .write_empty()?;
            xml.create_element("ModelVariables")
                .write_inner_content(|xml| {
                    variables
                        .iter()
                        .try_for_each(|v| write_variable(xml, v, &indices, configuration))
                })?;
            xml.create_element("ModelStructure")
                .write_inner_content(|xml| write_structure(xml, &indices))?;
            Ok(())
        })?;
    xml.get_mut().push(b'\n');
    Ok(())
}

/// Co-simulation, and model exchange unless the model remembers more than its six states.
fn write_interfaces(xml: &mut Xml, configuration: &Configuration) -> io::Result<()> {
    let common = [
        ("modelIdentifier", MODEL_IDENTIFIER),
        ("canNotUseMemoryManagementFunctions", "true"),
        ("canGetAndSetFMUstate", "true"),
        ("canSerializeFMUstate", "true"),
        ("providesDirectionalDerivative", "true"),
    ];
    if configuration.remembering().is_empty() {
        xml.create_element("ModelExchange")
            .with_attributes(common)
            .with_attribute(("completedIntegratorStepNotNeeded", "true"))
            .write_empty()?;
    }
    xml.create_element("CoSimulation")
        .with_attributes(common)
        .with_attributes([
            ("canHandleVariableCommunicationStepSize", "true"),
            ("canInterpolateInputs", "true"),
            ("maxOutputDerivativeOrder", "1"),
        ])
        .write_empty()?;
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

fn write_enumerations(xml: &mut Xml) -> io::Result<()> {
    for enumeration in enumerations() {
        xml.create_element("SimpleType")
            .with_attributes([
                ("name", enumeration.name),
                ("description", enumeration.description),
            ])
            .write_inner_content(|xml| {
                xml.create_element("Enumeration")
                    .write_inner_content(|xml| {
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
                    })?;
                Ok(())
            })?;
    }
    Ok(())
}

fn write_log_categories(xml: &mut Xml) -> io::Result<()> {
    for (name, description) in [
        (
            "logStatusError",
            "Calls that fail, and why; always reported",
        ),
        (
            "logStatusWarning",
            "What the user should know, such as a lifted wheel; always reported",
        ),
        ("logEvents", "What the integration has cost, at the end"),
    ] {
        xml.create_element("Category")
            .with_attributes([("name", name), ("description", description)])
            .write_empty()?;
    }
    Ok(())
}

fn write_variable(
    xml: &mut Xml,
    variable: &Variable,
    indices: &Indices,
    configuration: &Configuration,
) -> io::Result<()> {
    let attributes = variable.attributes;
    let (causality, variability, initial) = match attributes.causality {
        Causality::Input => ("input", "continuous", None),
        Causality::Output => ("output", "continuous", Some("calculated")),
        Causality::Local => ("local", "continuous", Some("calculated")),
        Causality::Parameter => ("parameter", "fixed", Some("exact")),
    };
    let reference = variable.reference.to_string();
    let mut element = xml.create_element("ScalarVariable").with_attributes([
        ("name", variable.name.as_str()),
        ("valueReference", reference.as_str()),
        ("description", attributes.description),
        ("causality", causality),
        ("variability", variability),
    ]);
    if let Some(initial) = initial {
        element = element.with_attribute(("initial", initial));
    }
    element.write_inner_content(|xml| {
        let selected = (configuration.selected + 1).to_string();
        match attributes.kind {
            Kind::Boolean => xml
                .create_element("Boolean")
                .with_attribute(("start", "false")),
            Kind::Enumeration => xml
                .create_element("Enumeration")
                .with_attributes([("declaredType", "Terrain"), ("start", selected.as_str())]),
            Kind::Real => {
                let mut element = xml.create_element("Real");
                if !attributes.unit.is_empty() {
                    element = element.with_attribute(("unit", attributes.unit));
                }
                let numbers = [
                    ("min", attributes.min),
                    ("max", attributes.max),
                    ("nominal", attributes.nominal),
                    (
                        "start",
                        configuration
                            .parameter(variable.quantity)
                            .or(attributes.start),
                    ),
                ];
                for (name, number) in numbers {
                    if let Some(number) = number {
                        element = element.with_attribute((name, number.to_string().as_str()));
                    }
                }
                if let Quantity::Rate(index) = variable.quantity {
                    let state = indices.of(Quantity::State(index)).to_string();
                    element = element.with_attribute(("derivative", state.as_str()));
                }
                element
            }
        }
        .write_empty()
        .map(drop)
    })?;
    Ok(())
}

/// What a state or rate depends on: its own state alone, or the quantities of its equation.
fn dependencies(quantity: Quantity, indices: &Indices) -> (Vec<usize>, &'static str) {
    let states = |range: &[usize]| -> Vec<usize> {
        range
            .iter()
            .map(|index| indices.of(Quantity::State(*index)))
            .collect()
    };
    // On the pose only effects depend: a grade, and a boundary on the map.
    let everything = || {
        let mut all = states(&[0, 1, 2, 3, 4, 5]);
        all.extend([0, 1].map(|side| indices.of(Quantity::Input(side))));
        all.sort_unstable();
        all
    };
    match quantity {
        Quantity::State(index) => (states(&[index]), "constant"),
        Quantity::Rate(0 | 1) => (states(&[2, 3, 4]), "dependent"),
        Quantity::Rate(2) => (states(&[5]), "constant"),
        _ => (everything(), "dependent"),
    }
}

fn write_structure(xml: &mut Xml, indices: &Indices) -> io::Result<()> {
    let outputs = indices.where_(|v| v.attributes.causality == Causality::Output);
    let rates: Vec<usize> = (0..State::COUNT)
        .map(|state| indices.of(Quantity::Rate(state)))
        .collect();
    let mut initial = [outputs.clone(), rates.clone()].concat();
    initial.sort_unstable();
    xml.create_element("Outputs").write_inner_content(|xml| {
        outputs
            .iter()
            .try_for_each(|index| write_unknown(xml, *index, indices))
    })?;
    xml.create_element("Derivatives")
        .write_inner_content(|xml| {
            rates
                .iter()
                .try_for_each(|index| write_unknown(xml, *index, indices))
        })?;
    // At the start everything may depend on every parameter: no list says so.
    xml.create_element("InitialUnknowns")
        .write_inner_content(|xml| {
            initial.iter().try_for_each(|index| {
                let index = index.to_string();
                let element = xml.create_element("Unknown");
                element
                    .with_attribute(("index", index.as_str()))
                    .write_empty()
                    .map(drop)
            })
        })?;
    Ok(())
}

fn write_unknown(xml: &mut Xml, index: usize, indices: &Indices) -> io::Result<()> {
    let quantity = indices.variables[index - 1].quantity;
    let (known, kind) = dependencies(quantity, indices);
    let kinds = vec![kind; known.len()].join(" ");
    let known: Vec<String> = known.iter().map(usize::to_string).collect();
    xml.create_element("Unknown")
        .with_attributes([
            ("index", index.to_string().as_str()),
            ("dependencies", known.join(" ").as_str()),
            ("dependenciesKind", kinds.as_str()),
        ])
        .write_empty()
        .map(drop)
}
