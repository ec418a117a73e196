//! Turns `modelDescription/variables.json`, the one declaration of the FMU's variables,
//! into the Rust tables that `src/declaration/mod.rs` includes.

use serde_json::Value;
use std::fmt::Write as _;
use std::{env, fs, path::Path};

const SOURCE: &str = "modelDescription/variables.json";

fn main() {
    println!("cargo:rerun-if-changed={SOURCE}");
    let text = fs::read_to_string(SOURCE).unwrap_or_else(|e| panic!("{SOURCE}: {e}"));
    let declared: Value = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{SOURCE}: {e}"));
    let mut out = String::new();
    table(
        &mut out,
        "SCALARS",
        "Declared",
        &declared["variables"],
        variable,
    );
    table(
        &mut out,
        "ROW",
        "DeclaredEach",
        &declared["row_variables"],
        each,
    );
    table(
        &mut out,
        "WHEEL",
        "DeclaredEach",
        &declared["wheel_variables"],
        each,
    );
    table(&mut out, "UNITS", "Unit", &declared["units"], unit);
    table(
        &mut out,
        "ENUMERATIONS",
        "Enumeration",
        &declared["enumerations"],
        enumeration,
    );
    let file = Path::new(&env::var("OUT_DIR").expect("cargo sets OUT_DIR")).join("declared.rs");
    fs::write(file, out).expect("OUT_DIR can be written");
}

fn table(out: &mut String, name: &str, kind: &str, list: &Value, item: fn(&Value) -> String) {
    let items: Vec<String> = array(list).iter().map(item).collect();
    writeln!(
        out,
        "static {name}: [{kind}; {}] = [{}];",
        items.len(),
        items.join(", ")
    )
    .unwrap();
}

fn array(list: &Value) -> &[Value] {
    list.as_array()
        .unwrap_or_else(|| panic!("{SOURCE}: a list is expected"))
}

fn text<'v>(item: &'v Value, key: &str) -> &'v str {
    item[key]
        .as_str()
        .unwrap_or_else(|| panic!("{SOURCE}: {key} is missing in {item}"))
}

fn number(item: &Value, key: &str) -> String {
    item[key]
        .as_f64()
        .map_or("None".to_owned(), |number| format!("Some({number:?})"))
}

fn declared(item: &Value) -> String {
    let causality = match text(item, "causality") {
        "input" => "Input",
        "output" => "Output",
        "local" => "Local",
        "parameter" => "Parameter",
        other => panic!("{SOURCE}: causality {other}"),
    };
    let kind = match item["type"].as_str() {
        None => "Real",
        Some("Boolean") => "Boolean",
        Some(_) => "Enumeration",
    };
    format!(
        "Attributes {{ causality: Causality::{causality}, kind: Kind::{kind}, unit: {:?}, start: {}, min: {}, \
         max: {}, nominal: {}, description: {:?} }}",
        item["unit"].as_str().unwrap_or(""),
        number(item, "start"),
        number(item, "min"),
        number(item, "max"),
        number(item, "nominal"),
        text(item, "description"),
    )
}

fn variable(item: &Value) -> String {
    let (name, quantity) = (text(item, "name"), text(item, "is"));
    format!(
        "Declared {{ name: {name:?}, quantity: Quantity::{quantity}, attributes: {} }}",
        declared(item)
    )
}

fn each(item: &Value) -> String {
    format!(
        "DeclaredEach {{ name: {:?}, attributes: {} }}",
        text(item, "name"),
        declared(item)
    )
}

fn unit(item: &Value) -> String {
    let base = item["base"].as_object().map(|base| {
        let exponents: Vec<String> = base
            .iter()
            .map(|(name, power)| format!("({name:?}, {power})"))
            .collect();
        format!("&[{}]", exponents.join(", "))
    });
    let base = base.map_or("None".to_owned(), |b| format!("Some({b})"));
    format!(
        "Unit {{ name: {:?}, base: {base}, factor: {} }}",
        text(item, "name"),
        number(item, "factor")
    )
}

fn enumeration(item: &Value) -> String {
    let items: Vec<String> = array(&item["items"])
        .iter()
        .map(|i| {
            format!(
                "({:?}, {}, {:?})",
                text(i, "name"),
                i["value"],
                text(i, "description")
            )
        })
        .collect();
    format!(
        "Enumeration {{ name: {:?}, description: {:?}, items: &[{}] }}",
        text(item, "name"),
        text(item, "description"),
        items.join(", ")
    )
}
