//! The C header of the FMU's library, `modelDescription/ugv.h`: what cbindgen makes of the exported
//! functions, and the value references of the declaration. `UGV_BLESS=1` writes it anew.

use crate::support;
use cbindgen::{Builder, Config, DocumentationStyle, Language};
use std::collections::HashSet;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;
use ugv_terrain::declaration::{
    Configuration, Quantity, TERRAIN_TYPE, TERRAINS, Variable, variables,
};
use ugv_terrain::effects::Effects;

const HEADER: &str = "modelDescription/ugv.h";
const PREAMBLE: &str = "\
/* C interface of the FMU ugv: the functions of FMI 2.0 and the value references of the variables,
   for programs that load the library themselves. */";
const INCLUDES: &str = "
/* The standard's types: https://fmi-standard.org/downloads */
#include \"fmi2TypesPlatform.h\"
#include \"fmi2FunctionTypes.h\"";

fn generated() -> String {
    let config = Config {
        language: Language::C,
        header: Some(PREAMBLE.to_owned()),
        include_guard: Some("UGV_H".to_owned()),
        after_includes: Some(format!("{INCLUDES}\n\n{}", constants())),
        no_includes: true,
        cpp_compat: true,
        usize_is_size_t: true,
        documentation_style: DocumentationStyle::C99,
        ..Config::default()
    };
    let folder = tempfile::tempdir().unwrap();
    let exports = folder.path().join("fmi2.rs");
    std::fs::write(&exports, expanded()).unwrap();
    let builder = Builder::new().with_config(config).with_src(exports);
    let mut text = Vec::new();
    builder.generate().unwrap().write(&mut text);
    String::from_utf8(text).unwrap()
}

/// The exported functions of FMI 2.0 as cbindgen reads them, which expands no macros.
fn expanded() -> String {
    let source = std::fs::read_to_string(support::root().join("src/fmu/fmi2.rs")).unwrap();
    let (functions, entries) = source.split_once("exports! {").unwrap();
    let mut text = functions.to_owned();
    for entry in entries.split(";\n\n") {
        let comments = entry
            .lines()
            .map(str::trim)
            .filter(|l| l.starts_with("///"));
        let (head, rest) = entry.split_once("TYPE = ").unwrap();
        let (_, name) = head.rsplit_once("fmi2").unwrap();
        let (_, rest) = rest.split_once('(').unwrap();
        let (arguments, _) = rest.split_once(')').unwrap();
        let comments: Vec<&str> = comments.collect();
        let comments = comments.join("\n");
        writeln!(
            text,
            "{comments}\n#[no_mangle]\npub extern \"C\" fn fmi2{name}(component: fmi2Component, {arguments}) -> fmi2Status {{}}"
        )
        .unwrap();
    }
    text
}

/// The paper's vehicle with the effects on whose parameters are no variables otherwise.
fn configuration() -> Configuration {
    let effects = Effects::NONE.with("multipass.memory", 1.0);
    let effects = effects.and_then(|e| e.with("transient_shear.relaxation", 1.0));
    Configuration {
        effects: effects.unwrap(),
        ..Configuration::default()
    }
}

/// The value references, those of rows and wheels as functions of their number from 1.
fn constants() -> String {
    let declared = variables(&configuration());
    let of = |wanted: fn(&Variable) -> Option<usize>| -> Vec<(usize, &Variable)> {
        declared
            .iter()
            .filter_map(|variable| Some((wanted(variable)?, variable)))
            .collect()
    };
    let scalars = of(|v| (!v.name.contains('[')).then_some(0));
    let row = of(|v| match v.quantity {
        Quantity::Row(row) => Some(row),
        _ => None,
    });
    let wheel = of(|v| match v.quantity {
        Quantity::Wheel(wheel, _) => Some(wheel),
        _ => None,
    });
    let mut text = "/* Value references */\n".to_owned();
    for (_, variable) in scalars {
        define(&mut text, &macro_name(&variable.name), variable.reference);
    }
    text += "/* Value references of row i and wheel i, counted from 1 */\n";
    for list in [row, wheel] {
        let first = |number: usize| list.iter().filter(move |(index, _)| *index == number);
        for ((_, one), (_, two)) in first(0).zip(first(1)) {
            let step = two.reference - one.reference;
            let name = macro_name(&one.name.replace("[1]", ""));
            let formula = format!("({}u + {step}u * ((i) - 1u))", one.reference);
            writeln!(text, "#define {name}(i) {formula}").unwrap();
            // The formula holds for all of them.
            for (index, variable) in &list {
                if variable.name.replace(&format!("[{}]", index + 1), "[1]") == one.name {
                    assert_eq!(variable.reference, one.reference + step * *index as u32);
                }
            }
        }
    }
    let (name, description) = TERRAIN_TYPE;
    writeln!(text, "/* {description} */").unwrap();
    for ((item, _), value) in TERRAINS.iter().zip(1..) {
        let name = format!("{name}_{item}").to_uppercase();
        writeln!(text, "#define UGV_{name} {value}").unwrap();
    }
    text
}

fn define(text: &mut String, name: &str, reference: u32) {
    writeln!(text, "#define {name} {reference}u").unwrap();
}

/// `soil.cohesion` as `UGV_VR_SOIL_COHESION`, `der(x)` as `UGV_VR_DER_X`.
fn macro_name(variable: &str) -> String {
    let words = variable.split(|c: char| !c.is_ascii_alphanumeric());
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    format!("UGV_VR_{}", words.join("_").to_uppercase())
}

#[test]
fn the_header_is_what_the_exports_and_the_declaration_make() {
    let file = support::root().join(HEADER);
    let expected = generated();
    if std::env::var_os("UGV_BLESS").is_some() {
        std::fs::write(&file, &expected).unwrap();
    }
    let found = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(
        found == expected,
        "{HEADER} is out of date; UGV_BLESS=1 cargo test --test header writes it anew"
    );
}

#[test]
fn every_variable_has_a_name_of_its_own() {
    let text = constants();
    let names: Vec<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("#define "))
        .map(|line| line.split([' ', '(']).next().unwrap())
        .collect();
    let distinct: HashSet<&str> = names.iter().copied().collect();
    assert_eq!(names.len(), distinct.len());
    let variables = variables(&configuration());
    let is_named = |v: &&Variable| !v.name.contains('[') || v.name.contains("[1]");
    let named = variables.iter().filter(is_named).count();
    assert_eq!(names.len(), named + TERRAINS.len());
}

/// Compiles programs with the header; returns what the compiler says.
fn compile(standard: &Path, header: &str, includes: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ugv.h"), header).unwrap();
    let mut program: String = includes
        .iter()
        .map(|name| format!("#include \"{name}\"\n"))
        .collect();
    program += "unsigned references[] = {UGV_VR_OMEGA_LEFT, UGV_VR_WHEEL_LOAD(8)};\n";
    program += "int terrain = UGV_TERRAIN_CUSTOM;\n";
    let source = folder.path().join("program.c");
    std::fs::write(&source, program).unwrap();
    let options = "-std=c99 -Wall -Wextra -Wpedantic -Werror -fsyntax-only -I";
    let compiled = Command::new("gcc")
        .args(options.split(' '))
        .args([standard, Path::new("-I"), folder.path(), &source])
        .output()
        .unwrap();
    let said = String::from_utf8(compiled.stderr).unwrap();
    assert_eq!(compiled.status.success(), said.is_empty(), "{said}");
    said
}

/// A declaration that differs from the standard's is an error of the compiler.
#[test]
fn the_header_agrees_with_the_standards() {
    let Some(standard) = support::standard_headers() else {
        return;
    };
    if !support::has("gcc", "gcc") {
        return;
    }
    let header = std::fs::read_to_string(support::root().join(HEADER)).unwrap();
    for includes in [
        &["ugv.h"][..],
        &["fmi2Functions.h", "ugv.h"],
        &["ugv.h", "fmi2Functions.h"],
    ] {
        assert_eq!(compile(&standard, &header, includes), "");
    }
    for (ours, theirs, function) in [
        (
            "fmi2Real communication_step_size",
            "float communication_step_size",
            "fmi2DoStep",
        ),
        (
            "const fmi2Real *states",
            "fmi2Real *states",
            "fmi2SetContinuousStates",
        ),
        (
            "size_t n_categories",
            "int n_categories",
            "fmi2SetDebugLogging",
        ),
    ] {
        assert_eq!(header.matches(ours).count(), 1, "{ours}");
        let wrong = header.replace(ours, theirs);
        let said = compile(&standard, &wrong, &["fmi2Functions.h", "ugv.h"]);
        assert!(said.contains("conflicting types for"), "{said}");
        assert!(said.contains(function), "{said}");
    }

    let declared = std::fs::read_to_string(standard.join("fmi2Functions.h")).unwrap();
    let names: Vec<&str> = declared
        .lines()
        .filter(|line| line.contains("FMI2_Export fmi2"))
        .map(|line| line.trim_end().trim_end_matches(';'))
        .filter_map(|line| line.split_whitespace().last())
        .collect();
    assert_eq!(names.len(), 44);
    for name in names {
        assert_eq!(header.matches(&format!("{name}(")).count(), 1, "{name}");
    }
}
