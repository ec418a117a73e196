//! The layers: which module may use which, and where unsafe code may be.

use std::fs;
use std::path::{Path, PathBuf};

/// Each module with the modules that it may use.
const EDGES: &[(&str, &[&str])] = &[
    ("display", &[]),
    ("parameter", &["display"]),
    ("spelling", &[]),
    ("scalar", &[]),
    ("terrain", &["parameter"]),
    ("effects", &["display", "parameter", "scalar", "terrain"]),
    ("contact", &["effects", "parameter", "scalar", "terrain"]),
    (
        "vehicle",
        &[
            "contact",
            "display",
            "effects",
            "parameter",
            "scalar",
            "terrain",
        ],
    ),
    ("simulation", &["parameter", "vehicle"]),
    (
        "json",
        &[
            "display",
            "effects",
            "parameter",
            "spelling",
            "terrain",
            "vehicle",
        ],
    ),
    ("import", &["display", "recording", "spelling"]),
    (
        "recording",
        &["display", "json", "spelling", "terrain", "vehicle"],
    ),
    (
        "identification",
        &["display", "recording", "simulation", "vehicle"],
    ),
    ("inspection", &["recording"]),
    (
        "report",
        &[
            "diagnosis",
            "display",
            "effects",
            "fit",
            "inspection",
            "recording",
            "vehicle",
        ],
    ),
    (
        "diagnosis",
        &[
            "effects",
            "fit",
            "identification",
            "parameter",
            "recording",
            "simulation",
            "terrain",
            "vehicle",
        ],
    ),
    (
        "declaration",
        &["effects", "json", "parameter", "terrain", "vehicle"],
    ),
    (
        "fmu",
        &["declaration", "parameter", "simulation", "vehicle"],
    ),
    (
        "fit",
        &[
            "effects",
            "identification",
            "parameter",
            "recording",
            "simulation",
            "spelling",
            "terrain",
            "vehicle",
        ],
    ),
    (
        "package",
        &["declaration", "display", "effects", "simulation"],
    ),
    ("lib", &[]),
    ("main", &["cli"]),
];

/// Parts of the diagnosis: each may use those before it, and what is beside them (`outcome`, `error`, `progress`).
const PARTS: &[&str] = &["hypothesis", "screening", "search", "answer", "manoeuvre"];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Every source file with the name of its top-level module and its text.
fn all() -> Vec<(PathBuf, String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    sources(&root, &mut found);
    assert!(found.len() > 30);
    let describe = |path: PathBuf| {
        let inside = path.strip_prefix(&root).unwrap().to_path_buf();
        let first = inside.iter().next().unwrap().to_str().unwrap().to_owned();
        let text = fs::read_to_string(&path).unwrap();
        (inside, first.trim_end_matches(".rs").to_owned(), text)
    };
    found.into_iter().map(describe).collect()
}

/// The part of a file before its unit tests, which may use anything.
fn product(text: &str) -> &str {
    let modules = ["mod ", "pub mod ", "pub(super) mod "];
    let tests = modules.map(|begin| text.find(&format!("#[cfg(test)]\n{begin}")));
    &text[..tests.into_iter().flatten().min().unwrap_or(text.len())]
}

#[test]
fn dependencies_point_one_way() {
    let mut seen = 0;
    for (path, module, text) in all() {
        // The tool's own modules are in another crate.
        if module == "cli" {
            continue;
        }
        let allowed = EDGES.iter().find(|(name, _)| *name == module);
        let (_, allowed) = allowed.unwrap_or_else(|| panic!("module {module} has no edges"));
        for (number, line) in product(&text).lines().enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            for used in code.split("crate::").skip(1) {
                let used: String = used
                    .chars()
                    .take_while(|c| c.is_alphanumeric() || *c == '_')
                    .collect();
                seen += 1;
                assert!(
                    used == module || allowed.contains(&used.as_str()),
                    "src/{}:{}: {module} must not use {used}",
                    path.display(),
                    number + 1
                );
            }
        }
    }
    assert!(seen > 50, "the search finds nothing: {seen}");
}

#[test]
fn parts_of_the_diagnosis_depend_one_way() {
    let mut seen = 0;
    for (path, module, text) in all() {
        let parts: Vec<&str> = path.iter().filter_map(|part| part.to_str()).collect();
        if module != "diagnosis" || parts.len() < 3 {
            continue;
        }
        let rank = |name: &str| PARTS.iter().position(|part| *part == name);
        let own = rank(parts[1]).unwrap_or_else(|| panic!("{} has no rank", parts[1]));
        for used in product(&text).split("crate::diagnosis::").skip(1) {
            let braces = used
                .strip_prefix('{')
                .and_then(|rest| rest.split('}').next());
            let group = braces.unwrap_or_default();
            let hidden = PARTS
                .iter()
                .find(|part| group.contains(&format!("{part}::")));
            assert_eq!(hidden, None, "src/{}: {group}", path.display());
            let used = used.split(|c: char| !(c.is_alphanumeric() || c == '_'));
            let other = used.into_iter().next().and_then(rank);
            seen += usize::from(other.is_some());
            assert!(other <= Some(own), "src/{} uses {other:?}", path.display());
        }
    }
    assert!(seen > 30, "the search finds nothing: {seen}");
}

#[test]
fn only_the_c_interface_is_unsafe() {
    for (path, module, text) in all() {
        let unsafe_code = text.lines().any(|line| {
            let code = line.split("//").next().unwrap_or_default();
            code.contains("unsafe ") || code.contains("unsafe{")
        });
        assert!(!unsafe_code || module == "fmu", "src/{}", path.display());
        if module == "fmu" {
            let own = product(&text);
            let blocks = own.matches("unsafe {").count();
            let reasons = own.matches("// SAFETY:").count();
            assert!(
                blocks <= reasons,
                "src/{}: {blocks} and {reasons}",
                path.display()
            );
        }
    }
}
