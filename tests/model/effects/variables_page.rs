//! The page of the FMU's variables is what their declaration says.

use super::generated::assert_current;
use std::fmt::Write as _;
use ugv_terrain::declaration::{
    Causality, Configuration, Kind, TERRAIN_TYPE, TERRAINS, Variable, variables,
};

const PAGE: &str = "docs/reference/fmu_variables.md";
const COMMAND: &str = "cargo test --test model page";
const HEAD: &str = "\
# FMU variables

<!-- Written by `UGV_BLESS=1 cargo test --test model page` from the declaration of the variables. -->

Wheels i count from 1, odd on the left, front row first. Rows count from the front. In FMI 3.0 the quantities of wheels and rows
are arrays without the index ([FMI 3.0](../how-to/fmi3.md)). World, body and signs: [the model](../explanation/model.md#what-it-computes).
`modelDescription/ugv.h` has the value references for C.

Parameters `effects.NAME.PARAMETER` exist for the physics of the [catalogue](effects.md), such as `effects.grade.slope_east`.
Those of effects with memory exist only if the effect is on in the packaged model.
";

/// One row or wheel stands for all of them.
fn is_shown(variable: &Variable) -> bool {
    let index = variable.name.split(['[', ']']).nth(1);
    index.is_none_or(|index| index == "1") && !variable.name.starts_with("effects.")
}

fn unit(variable: &Variable) -> &str {
    match variable.attributes.kind {
        Kind::Real => variable.attributes.unit,
        Kind::Boolean => "Boolean",
        Kind::Enumeration => "Enumeration",
    }
}

fn range(variable: &Variable) -> String {
    match (variable.attributes.min, variable.attributes.max) {
        (Some(min), Some(max)) => format!("{} to {}", short(min), short(max)),
        _ => String::new(),
    }
}

fn short(bound: f64) -> String {
    if bound.abs() < 1e5 {
        bound.to_string()
    } else {
        format!("{bound:e}")
    }
}

#[test]
fn the_page_of_the_fmu_variables_is_current() {
    let declared = variables(&Configuration::default());
    let mut page = HEAD.to_owned();
    for (causality, title) in [
        (Causality::Input, "Inputs"),
        (Causality::Output, "Outputs"),
        (Causality::Parameter, "Parameters"),
        (Causality::Local, "Derivatives of the states"),
    ] {
        writeln!(page, "\n## {title}\n").unwrap();
        writeln!(page, "| name | unit | range | meaning |\n|---|---|---|---|").unwrap();
        let shown = declared
            .iter()
            .filter(|v| v.attributes.causality == causality && is_shown(v));
        for variable in shown {
            writeln!(
                page,
                "| `{}` | {} | {} | {} |",
                variable.name.replace("[1]", "[i]"),
                unit(variable),
                range(variable),
                variable.attributes.description
            )
            .unwrap();
        }
    }
    writeln!(page, "\n## Enumeration {}\n", TERRAIN_TYPE.0).unwrap();
    writeln!(page, "| value | name | meaning |\n|---|---|---|").unwrap();
    for (place, (name, meaning)) in TERRAINS.iter().enumerate() {
        writeln!(page, "| {} | `{name}` | {meaning} |", place + 1).unwrap();
    }
    assert_current(PAGE, COMMAND, &page);
}
