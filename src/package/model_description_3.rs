//! `modelDescription.xml` of FMI 3.0, written from the declaration of the variables.

use super::xml::{
    ORIGIN, Xml, document, is_unbounded, role, write_default_experiment, write_items,
    write_log_categories, write_units,
};
use super::{MODEL_IDENTIFIER, Standard};
use crate::declaration::{
    ArrayVariable, Causality, Configuration, Elements, Kind, Quantity, array_variables,
    dependencies, enumerations, guid, initial_dependencies,
};
use crate::simulation::State;
use std::io;

/// The variables and what they are of.
struct Model<'c> {
    configuration: &'c Configuration,
    variables: Vec<ArrayVariable>,
}

impl Model<'_> {
    /// The scalar of a quantity.
    fn scalar(&self, quantity: Quantity) -> &ArrayVariable {
        let elements = Elements::One(quantity);
        let found = self.variables.iter().find(|v| v.elements == elements);
        found.expect("states, rates, inputs and the time are scalars")
    }

    fn reference(&self, quantity: Quantity) -> String {
        self.scalar(quantity).reference.to_string()
    }
}

/// Writes the model description of the FMI 3.0 FMU of a configuration.
///
/// # Panics
/// Never: writing to memory does not fail.
#[must_use]
pub fn model_description_3(configuration: &Configuration) -> String {
    let model = Model {
        configuration,
        variables: array_variables(configuration),
    };
    document(|xml| write(xml, &model))
}

fn write(xml: &mut Xml, model: &Model) -> io::Result<()> {
    let token = guid(model.configuration);
    xml.create_element("fmiModelDescription")
        .with_attributes([
            ("fmiVersion", "3.0"),
            ("modelName", MODEL_IDENTIFIER),
            ("instantiationToken", token.as_str()),
        ])
        .with_attributes(ORIGIN)
        .write_inner_content(|xml| {
            write_interfaces(xml, model.configuration)?;
            write_units(xml)?;
            xml.create_element("TypeDefinitions")
                .write_inner_content(write_enumerations)?;
            write_log_categories(xml, Standard::Fmi3)?;
            write_default_experiment(xml)?;
            xml.create_element("ModelVariables")
                .write_inner_content(|xml| {
                    let mut variables = model.variables.iter();
                    variables.try_for_each(|variable| write_variable(xml, variable, model))
                })?;
            xml.create_element("ModelStructure")
                .write_inner_content(|xml| write_structure(xml, model))?;
            Ok(())
        })?;
    Ok(())
}

/// Co-simulation, and model exchange where that sees all that the model does.
fn write_interfaces(xml: &mut Xml, configuration: &Configuration) -> io::Result<()> {
    let common = [
        ("modelIdentifier", MODEL_IDENTIFIER),
        ("canGetAndSetFMUState", "true"),
        ("canSerializeFMUState", "true"),
        ("providesDirectionalDerivatives", "true"),
        ("providesAdjointDerivatives", "true"),
        ("providesPerElementDependencies", "true"),
    ];
    if configuration.for_co_simulation_alone().is_empty() {
        xml.create_element("ModelExchange")
            .with_attributes(common)
            .write_empty()?;
    }
    xml.create_element("CoSimulation")
        .with_attributes(common)
        .with_attributes([
            ("canHandleVariableCommunicationStepSize", "true"),
            ("maxOutputDerivativeOrder", "1"),
            ("hasEventMode", "true"),
        ])
        .write_empty()?;
    Ok(())
}

fn write_enumerations(xml: &mut Xml) -> io::Result<()> {
    for enumeration in enumerations() {
        // Without a description: fmpy up to 0.3.22 reads no type that has one.
        xml.create_element("EnumerationType")
            .with_attribute(("name", enumeration.name))
            .write_inner_content(|xml| write_items(xml, enumeration))?;
    }
    Ok(())
}

fn write_variable(xml: &mut Xml, variable: &ArrayVariable, model: &Model) -> io::Result<()> {
    let attributes = variable.attributes;
    let (causality, variability, initial) = role(attributes.causality);
    let mut given = vec![
        ("name", variable.name.clone()),
        ("valueReference", variable.reference.to_string()),
        ("description", attributes.description.to_owned()),
        ("causality", causality.to_owned()),
        ("variability", variability.to_owned()),
    ];
    given.extend(initial.map(|initial| ("initial", initial.to_owned())));
    let element = match attributes.kind {
        Kind::Boolean => {
            given.push(("start", "false".to_owned()));
            "Boolean"
        }
        Kind::Enumeration => {
            given.push(("declaredType", "Terrain".to_owned()));
            let selected = model.configuration.selected + 1;
            given.push(("start", selected.to_string()));
            "Enumeration"
        }
        Kind::Real => {
            given.extend(real(variable, model));
            "Float64"
        }
    };
    let given = given.iter().map(|(name, value)| (*name, value.as_str()));
    let element = xml.create_element(element).with_attributes(given);
    match variable.elements.dimension() {
        None => element.write_empty()?,
        Some(size) => element.write_inner_content(|xml| {
            let dimension = xml.create_element("Dimension");
            dimension
                .with_attribute(("start", size.to_string().as_str()))
                .write_empty()
                .map(drop)
        })?,
    };
    Ok(())
}

/// The attributes that only numbers have.
fn real(variable: &ArrayVariable, model: &Model) -> Vec<(&'static str, String)> {
    let attributes = variable.attributes;
    let mut given = Vec::new();
    if !attributes.unit.is_empty() {
        given.push(("unit", attributes.unit.to_owned()));
    }
    let limits = [
        ("min", attributes.min),
        ("max", attributes.max),
        ("nominal", attributes.nominal),
    ];
    let limits = limits
        .into_iter()
        .filter_map(|(name, number)| Some((name, number?.to_string())));
    given.extend(limits);
    if is_unbounded(variable.elements.at(0)) {
        given.push(("unbounded", "true".to_owned()));
    }
    let quantities = variable.elements.quantities();
    let starts: Vec<String> = quantities
        .filter_map(|quantity| model.configuration.parameter(quantity).or(attributes.start))
        .map(|start| start.to_string())
        .collect();
    if !starts.is_empty() {
        given.push(("start", starts.join(" ")));
    }
    if let Elements::One(Quantity::Rate(index)) = variable.elements {
        given.push(("derivative", model.reference(Quantity::State(index))));
    }
    given
}

fn write_structure(xml: &mut Xml, model: &Model) -> io::Result<()> {
    let outputs = || {
        let all = model.variables.iter();
        all.filter(|v| v.attributes.causality == Causality::Output)
    };
    let rates = || (0..State::COUNT).map(|index| model.scalar(Quantity::Rate(index)));
    for output in outputs() {
        write_unknown(xml, "Output", output, model)?;
    }
    for rate in rates() {
        write_unknown(xml, "ContinuousStateDerivative", rate, model)?;
    }
    // To leave the list away would say the same, but CasADi 3.8 wants it.
    for initial in outputs().chain(rates()) {
        let known = initial_dependencies(initial.elements.at(0), model.configuration).into_iter();
        let known: Vec<String> = known.map(|v| v.reference.to_string()).collect();
        let known = known.join(" ");
        let reference = initial.reference.to_string();
        xml.create_element("InitialUnknown")
            .with_attributes([
                ("valueReference", reference.as_str()),
                ("dependencies", known.as_str()),
            ])
            .write_empty()?;
    }
    Ok(())
}

fn write_unknown(
    xml: &mut Xml,
    element: &str,
    variable: &ArrayVariable,
    model: &Model,
) -> io::Result<()> {
    // All elements of an array depend on the same.
    let (known, kind) = dependencies(variable.elements.at(0), model.configuration);
    let kinds = vec![kind.name(); known.len()].join(" ");
    let known: Vec<String> = known.into_iter().map(|q| model.reference(q)).collect();
    xml.create_element(element)
        .with_attributes([
            ("valueReference", variable.reference.to_string().as_str()),
            ("dependencies", known.join(" ").as_str()),
            ("dependenciesKind", kinds.as_str()),
        ])
        .write_empty()
        .map(drop)
}
