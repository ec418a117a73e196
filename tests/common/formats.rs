//! `docs/reference/formats.md` against the files that are written.

use serde_json::Value;

const PAGE: &str = include_str!("../../docs/reference/formats.md");
/// What these hold has names of its own (parameters) or a section of its own (a model).
const NAMED: [&str; 2] = ["parameters", "values"];
const ELSEWHERE: &str = "model";

/// Every key of a file is told in the section of its format.
pub fn assert_documented(file: &Value) {
    let format = file["format"].as_str().expect("a format");
    let sections = PAGE.split("\n## ");
    let mut own = sections.filter(|section| section.starts_with(&format!("`{format}`")));
    let section = own.next().unwrap_or_else(|| panic!("no section {format}"));
    check(file, section, false);
}

fn check(value: &Value, section: &str, named: bool) {
    match value {
        Value::Array(all) => all.iter().for_each(|one| check(one, section, false)),
        Value::Object(all) => {
            for (key, inner) in all {
                let told = named || key == "format" || section.contains(&format!("`{key}`"));
                // `held_out` and `soil` are told as what they belong to.
                let told = told || section.contains(&format!(".{key}`"));
                assert!(told, "`{key}` is not told in {}", &section[..40]);
                if key != ELSEWHERE || !inner.is_object() {
                    check(inner, section, NAMED.contains(&key.as_str()));
                }
            }
        }
        _ => {}
    }
}
