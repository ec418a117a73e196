//! `modelDescription.xml`, written from the declaration of the variables.

use super::standard::{MODEL_IDENTIFIER, Standard};
use crate::declaration::{
    ArrayVariable, Causality, Configuration, Elements, Kind, LOG_CATEGORIES, Quantity,
    TERRAIN_TYPE, TERRAINS, UNITS, Unit, dependencies, guid, initial_dependencies, initial_pose,
};
use crate::simulation::State;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, Event};
use std::io;

type Xml = Writer<Vec<u8>>;
/// Names and values of an element's attributes.
type Attributes = Vec<(&'static str, String)>;

/// A fixed time, so that the same source gives the same bytes.
const GENERATION_TIME: &str = "2026-11-21T00:00:00Z";

/// Attributes about the origin of the FMU.
const ORIGIN: [(&str, &str); 7] = [
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

/// Writes the model description of the FMU of a configuration.
///
/// # Panics
/// Never: writing to memory does not fail.
#[must_use]
pub fn model_description(standard: Standard, configuration: &Configuration) -> String {
    let model = Model {
        standard,
        configuration,
        variables: standard.naming().variables(configuration),
    };
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    let declaration = Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None));
    xml.write_event(declaration)
        .and_then(|()| model.write(&mut xml))
        .expect("writing to memory does not fail");
    xml.get_mut().push(b'\n');
    String::from_utf8(xml.into_inner()).expect("the writer passes UTF-8 on")
}

/// An element without content.
fn write_empty<'a>(
    xml: &mut Xml,
    name: &str,
    attributes: impl IntoIterator<Item = (&'a str, &'a str)>,
) -> io::Result<()> {
    let element = xml.create_element(name).with_attributes(attributes);
    element.write_empty().map(drop)
}

fn borrowed(attributes: &Attributes) -> impl Iterator<Item = (&str, &str)> {
    attributes
        .iter()
        .map(|(name, value)| (*name, value.as_str()))
}

/// The model that is described, in the form of a version of the standard.
struct Model<'c> {
    standard: Standard,
    configuration: &'c Configuration,
    variables: Vec<ArrayVariable>,
}

impl Model<'_> {
    /// A value for FMI 2.0 or the one for FMI 3.0.
    fn either<T>(&self, fmi2: T, fmi3: T) -> T {
        match self.standard {
            Standard::Fmi2 => fmi2,
            Standard::Fmi3 => fmi3,
        }
    }

    /// How the model structure refers to a variable: in FMI 2.0 by its position from 1, in FMI 3.0 by
    /// its value reference.
    fn identify(&self, variable: &ArrayVariable) -> u32 {
        let position = || self.variables.iter().zip(1..).find(|(v, _)| *v == variable);
        self.either(
            position().map_or(0, |(_, position)| position),
            variable.reference,
        )
    }

    /// The variable of a scalar quantity.
    fn scalar(&self, quantity: Quantity) -> &ArrayVariable {
        let elements = Elements::One(quantity);
        let found = self.variables.iter().find(|v| v.elements == elements);
        found.expect("states, rates, inputs and initial values are scalars")
    }

    fn write(&self, xml: &mut Xml) -> io::Result<()> {
        let identity = guid(self.configuration);
        let element = xml
            .create_element("fmiModelDescription")
            .with_attributes([
                ("fmiVersion", self.either("2.0", "3.0")),
                ("modelName", MODEL_IDENTIFIER),
                (self.either("guid", "instantiationToken"), identity.as_str()),
            ])
            .with_attributes(ORIGIN)
            .with_attributes(self.either(Some(("numberOfEventIndicators", "0")), None));
        element.write_inner_content(|xml| {
            self.write_interfaces(xml)?;
            xml.create_element("UnitDefinitions")
                .write_inner_content(|xml| UNITS.iter().try_for_each(|u| write_unit(xml, u)))?;
            xml.create_element("TypeDefinitions")
                .write_inner_content(|xml| self.write_terrain_type(xml))?;
            xml.create_element("LogCategories")
                .write_inner_content(|xml| self.write_log_categories(xml))?;
            let times = [("startTime", "0"), ("stopTime", "10"), ("stepSize", "0.01")];
            write_empty(xml, "DefaultExperiment", times)?;
            xml.create_element("ModelVariables")
                .write_inner_content(|xml| {
                    let mut variables = self.variables.iter();
                    variables.try_for_each(|variable| self.write_variable(xml, variable))
                })?;
            xml.create_element("ModelStructure")
                .write_inner_content(|xml| self.write_structure(xml))
                .map(drop)
        })?;
        Ok(())
    }

    /// Co-simulation, and model exchange where that supports the whole model.
    fn write_interfaces(&self, xml: &mut Xml) -> io::Result<()> {
        let common: &[_] = self.either(
            &[
                ("modelIdentifier", MODEL_IDENTIFIER),
                ("canNotUseMemoryManagementFunctions", "true"),
                ("canGetAndSetFMUstate", "true"),
                ("canSerializeFMUstate", "true"),
                ("providesDirectionalDerivative", "true"),
            ],
            &[
                ("modelIdentifier", MODEL_IDENTIFIER),
                ("canGetAndSetFMUState", "true"),
                ("canSerializeFMUState", "true"),
                ("providesDirectionalDerivatives", "true"),
                ("providesAdjointDerivatives", "true"),
                ("providesPerElementDependencies", "true"),
            ],
        );
        if self.configuration.for_co_simulation_alone().is_empty() {
            let more = self.either(Some(("completedIntegratorStepNotNeeded", "true")), None);
            write_empty(xml, "ModelExchange", common.iter().copied().chain(more))?;
        }
        let more = self.either(
            [
                ("canHandleVariableCommunicationStepSize", "true"),
                ("canInterpolateInputs", "true"),
                ("maxOutputDerivativeOrder", "1"),
            ],
            [
                ("canHandleVariableCommunicationStepSize", "true"),
                ("maxOutputDerivativeOrder", "1"),
                ("hasEventMode", "true"),
            ],
        );
        write_empty(xml, "CoSimulation", common.iter().copied().chain(more))
    }

    fn write_terrain_type(&self, xml: &mut Xml) -> io::Result<()> {
        let (name, description) = TERRAIN_TYPE;
        let items = |xml: &mut Xml| {
            TERRAINS
                .iter()
                .zip(1..)
                .try_for_each(|((name, description), value)| {
                    let value = value.to_string();
                    let attributes = [
                        ("name", *name),
                        ("value", value.as_str()),
                        ("description", *description),
                    ];
                    write_empty(xml, "Item", attributes)
                })
        };
        match self.standard {
            Standard::Fmi2 => {
                xml.create_element("SimpleType")
                    .with_attributes([("name", name), ("description", description)])
                    .write_inner_content(|xml| {
                        xml.create_element("Enumeration")
                            .write_inner_content(items)
                            .map(drop)
                    })?;
            }
            // Without a description: fmpy up to 0.3.22 reads no type that has one.
            Standard::Fmi3 => {
                xml.create_element("EnumerationType")
                    .with_attribute(("name", name))
                    .write_inner_content(items)?;
            }
        }
        Ok(())
    }

    fn write_log_categories(&self, xml: &mut Xml) -> io::Result<()> {
        LOG_CATEGORIES.iter().try_for_each(|category| {
            let name = category.name.to_string_lossy();
            let is_always = self.either(category.always_in_fmi2, category.always_in_fmi3);
            let ending = if is_always { "; always reported" } else { "" };
            let description = format!("{}{ending}", category.description);
            let attributes = [("name", &*name), ("description", description.as_str())];
            write_empty(xml, "Category", attributes)
        })
    }

    fn write_variable(&self, xml: &mut Xml, variable: &ArrayVariable) -> io::Result<()> {
        let attributes = variable.attributes;
        let (causality, variability, initial) = match attributes.causality {
            Causality::Input => ("input", "continuous", None),
            Causality::Output => ("output", "continuous", Some("calculated")),
            Causality::Local => ("local", "continuous", Some("calculated")),
            Causality::Parameter => ("parameter", "fixed", Some("exact")),
            Causality::Independent => ("independent", "continuous", None),
        };
        let mut common: Attributes = vec![
            ("name", variable.name.clone()),
            ("valueReference", variable.reference.to_string()),
            ("description", attributes.description.to_owned()),
            ("causality", causality.to_owned()),
            ("variability", variability.to_owned()),
        ];
        common.extend(initial.map(|initial| ("initial", initial.to_owned())));
        let (element, specific) = match attributes.kind {
            Kind::Boolean => ("Boolean", vec![("start", "false".to_owned())]),
            Kind::Enumeration => {
                let number = self.configuration.selected + 1;
                let specific = vec![
                    ("declaredType", TERRAIN_TYPE.0.to_owned()),
                    ("start", number.to_string()),
                ];
                ("Enumeration", specific)
            }
            Kind::Real => (self.either("Real", "Float64"), self.numeric(variable)),
        };
        if self.standard == Standard::Fmi2 {
            xml.create_element("ScalarVariable")
                .with_attributes(borrowed(&common))
                .write_inner_content(|xml| write_empty(xml, element, borrowed(&specific)))?;
            return Ok(());
        }
        let element = xml
            .create_element(element)
            .with_attributes(borrowed(&common).chain(borrowed(&specific)));
        match variable.elements.dimension() {
            None => element.write_empty()?,
            Some(size) => element.write_inner_content(|xml| {
                write_empty(xml, "Dimension", [("start", size.to_string().as_str())])
            })?,
        };
        Ok(())
    }

    /// The attributes of numbers.
    fn numeric(&self, variable: &ArrayVariable) -> Attributes {
        let attributes = variable.attributes;
        let mut all = Attributes::new();
        if !attributes.unit.is_empty() {
            all.push(("unit", attributes.unit.to_owned()));
        }
        let limits = [
            ("min", attributes.min),
            ("max", attributes.max),
            ("nominal", attributes.nominal),
        ];
        let limits = limits.into_iter();
        all.extend(limits.filter_map(|(name, number)| Some((name, number?.to_string()))));
        // The pose grows without limit, so that its size is no measure for a solver's tolerance.
        if let Elements::One(Quantity::State(0..=2)) = variable.elements {
            all.push(("unbounded", "true".to_owned()));
        }
        let starts = variable.starts(self.configuration);
        if !starts.is_empty() {
            all.push(("start", starts));
        }
        if let Elements::One(Quantity::Rate(index)) = variable.elements {
            let state = self.scalar(Quantity::State(index));
            all.push(("derivative", self.identify(state).to_string()));
        }
        all
    }

    fn write_structure(&self, xml: &mut Xml) -> io::Result<()> {
        let all = self.variables.iter();
        let outputs = all.filter(|v| v.attributes.causality == Causality::Output);
        let outputs: Vec<&ArrayVariable> = outputs.collect();
        let rates = (0..State::COUNT).map(|index| self.scalar(Quantity::Rate(index)));
        let rates: Vec<&ArrayVariable> = rates.collect();
        let mut initial = [outputs.as_slice(), &rates].concat();
        if self.standard == Standard::Fmi2 {
            initial.sort_by_key(|variable| self.identify(variable));
        }
        self.write_unknowns(xml, ["Outputs", "Output"], &outputs, Self::dependencies)?;
        let names = ["Derivatives", "ContinuousStateDerivative"];
        self.write_unknowns(xml, names, &rates, Self::dependencies)?;
        let names = ["InitialUnknowns", "InitialUnknown"];
        self.write_unknowns(xml, names, &initial, Self::initial_dependencies)
    }

    /// A list of unknowns with what they depend on: in FMI 2.0 below an element of the first name, in
    /// FMI 3.0 as elements of the second.
    fn write_unknowns(
        &self,
        xml: &mut Xml,
        [list, item]: [&str; 2],
        unknowns: &[&ArrayVariable],
        dependencies: fn(&Self, &ArrayVariable) -> Attributes,
    ) -> io::Result<()> {
        let item = self.either("Unknown", item);
        let write = |xml: &mut Xml| {
            unknowns.iter().try_for_each(|unknown| {
                let identity = self.identify(unknown).to_string();
                let identity = (self.either("index", "valueReference"), identity.as_str());
                let more = dependencies(self, unknown);
                write_empty(xml, item, [identity].into_iter().chain(borrowed(&more)))
            })
        };
        match self.standard {
            Standard::Fmi2 => xml
                .create_element(list)
                .write_inner_content(write)
                .map(drop),
            Standard::Fmi3 => write(xml),
        }
    }

    /// All elements of an array have the same dependencies.
    fn dependencies(&self, variable: &ArrayVariable) -> Attributes {
        let (known, kind) = dependencies(variable.elements.at(0), self.configuration);
        let known = known.into_iter();
        // The time is a variable in FMI 3.0 only.
        let known = known.filter(|q| self.standard == Standard::Fmi3 || *q != Quantity::Time);
        let mut known: Vec<u32> = known.map(|q| self.identify(self.scalar(q))).collect();
        if self.standard == Standard::Fmi2 {
            known.sort_unstable();
        }
        let kinds = vec![kind.name(); known.len()].join(" ");
        vec![("dependencies", listed(known)), ("dependenciesKind", kinds)]
    }

    fn initial_dependencies(&self, variable: &ArrayVariable) -> Attributes {
        let quantity = variable.elements.at(0);
        let known: Vec<u32> = match self.standard {
            // Without a list an unknown may depend on everything that can be set.
            Standard::Fmi2 => match initial_pose(quantity) {
                Some(pose) => vec![self.identify(self.scalar(pose))],
                None => return Attributes::new(),
            },
            // The same holds here, but CasADi 3.8 needs the list.
            Standard::Fmi3 => {
                let known = initial_dependencies(quantity, self.configuration);
                known.iter().map(|v| v.reference).collect()
            }
        };
        vec![("dependencies", listed(known))]
    }
}

fn listed(numbers: Vec<u32>) -> String {
    let numbers: Vec<String> = numbers.iter().map(u32::to_string).collect();
    numbers.join(" ")
}

fn write_unit(xml: &mut Xml, unit: &Unit) -> io::Result<()> {
    // Exponents that depend on the soil have no base unit.
    let Some(base) = unit.base else {
        return write_empty(xml, "Unit", [("name", unit.name)]);
    };
    let exponents = base.iter().map(|(name, power)| (*name, power.to_string()));
    let factor = unit.factor.map(|factor| ("factor", factor.to_string()));
    let attributes: Attributes = exponents.chain(factor).collect();
    xml.create_element("Unit")
        .with_attribute(("name", unit.name))
        .write_inner_content(|xml| write_empty(xml, "BaseUnit", borrowed(&attributes)))
        .map(drop)
}
