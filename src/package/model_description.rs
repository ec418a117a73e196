//! `modelDescription.xml` of FMI 2.0, written from the declaration of the variables.

use super::xml::{
    ORIGIN, Xml, document, is_unbounded, role, write_default_experiment, write_items,
    write_log_categories, write_units,
};
use super::{MODEL_IDENTIFIER, Standard};
use crate::declaration::{
    Causality, Configuration, Kind, Quantity, Variable, dependencies, enumerations, guid,
    initial_pose, variables,
};
use crate::simulation::State;
use std::io;

/// Where each variable stands in the list, counted from 1 as the model structure does.
struct Indices<'v> {
    configuration: &'v Configuration,
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
    document(|xml| write(xml, configuration))
}

fn write(xml: &mut Xml, configuration: &Configuration) -> io::Result<()> {
    let variables = variables(configuration);
    let indices = Indices {
        configuration,
        variables: &variables,
    };
    let guid = guid(configuration);
    xml.create_element("fmiModelDescription")
        .with_attributes([
            ("fmiVersion", "2.0"),
            ("modelName", MODEL_IDENTIFIER),
            ("guid", guid.as_str()),
        ])
        .with_attributes(ORIGIN)
        .with_attribute(("numberOfEventIndicators", "0"))
        .write_inner_content(|xml| {
            write_interfaces(xml, configuration)?;
            write_units(xml)?;
            xml.create_element("TypeDefinitions")
                .write_inner_content(write_enumerations)?;
            write_log_categories(xml, Standard::Fmi2)?;
            write_default_experiment(xml)?;
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
    Ok(())
}

/// Co-simulation, and model exchange where that sees all that the model does.
fn write_interfaces(xml: &mut Xml, configuration: &Configuration) -> io::Result<()> {
    let common = [
        ("modelIdentifier", MODEL_IDENTIFIER),
        ("canNotUseMemoryManagementFunctions", "true"),
        ("canGetAndSetFMUstate", "true"),
        ("canSerializeFMUstate", "true"),
        ("providesDirectionalDerivative", "true"),
    ];
    if configuration.for_co_simulation_alone().is_empty() {
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

fn write_enumerations(xml: &mut Xml) -> io::Result<()> {
    for enumeration in enumerations() {
        xml.create_element("SimpleType")
            .with_attributes([
                ("name", enumeration.name),
                ("description", enumeration.description),
            ])
            .write_inner_content(|xml| {
                xml.create_element("Enumeration")
                    .write_inner_content(|xml| write_items(xml, enumeration))
                    .map(drop)
            })?;
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
    let (causality, variability, initial) = role(attributes.causality);
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
                if is_unbounded(variable.quantity) {
                    element = element.with_attribute(("unbounded", "true"));
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
    xml.create_element("InitialUnknowns")
        .write_inner_content(|xml| {
            initial.iter().try_for_each(|index| {
                let quantity = indices.variables[index - 1].quantity;
                let index = index.to_string();
                let element = xml.create_element("Unknown");
                let element = element.with_attribute(("index", index.as_str()));
                // Where no list says so, it may depend on whatever can be set.
                let element = match initial_pose(quantity) {
                    Some(own) => element
                        .with_attribute(("dependencies", indices.of(own).to_string().as_str())),
                    None => element,
                };
                element.write_empty().map(drop)
            })
        })?;
    Ok(())
}

fn write_unknown(xml: &mut Xml, index: usize, indices: &Indices) -> io::Result<()> {
    let quantity = indices.variables[index - 1].quantity;
    let (known, kind) = dependencies(quantity, indices.configuration);
    // The time is no variable here.
    let known = known.into_iter().filter(|q| *q != Quantity::Time);
    let mut known: Vec<usize> = known.map(|quantity| indices.of(quantity)).collect();
    known.sort_unstable();
    let kinds = vec![kind.name(); known.len()].join(" ");
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
