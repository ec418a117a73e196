//! The layers: which module may use which, that no files import each other in a circle, and where unsafe code may be.

use std::collections::{BTreeMap, BTreeSet};
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
    ("import", &["display", "recording", "spelling", "vehicle"]),
    (
        "recording",
        &["display", "json", "spelling", "terrain", "vehicle"],
    ),
    (
        "identification",
        &["display", "recording", "simulation", "vehicle"],
    ),
    (
        "inspection",
        &["recording", "simulation", "terrain", "vehicle"],
    ),
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
            "inspection",
            "parameter",
            "recording",
            "simulation",
            "terrain",
            "vehicle",
        ],
    ),
    (
        "declaration",
        &[
            "effects",
            "json",
            "parameter",
            "simulation",
            "terrain",
            "vehicle",
        ],
    ),
    (
        "fmu",
        &["declaration", "json", "parameter", "simulation", "vehicle"],
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
    (
        "cli",
        &[
            "declaration",
            "diagnosis",
            "display",
            "effects",
            "fit",
            "identification",
            "import",
            "inspection",
            "json",
            "package",
            "parameter",
            "recording",
            "report",
            "simulation",
            "spelling",
            "terrain",
            "vehicle",
        ],
    ),
    (
        "python",
        &[
            "cli",
            "declaration",
            "effects",
            "json",
            "simulation",
            "terrain",
            "vehicle",
        ],
    ),
    ("lib", &[]),
    ("main", &[]),
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

/// Modules by path, and what they import: `["fit", "model"]` for src/fit/model.rs.
struct Imports {
    modules: BTreeMap<Vec<String>, String>,
}

impl Imports {
    fn new() -> Self {
        let mut modules = BTreeMap::new();
        for (path, _, text) in all() {
            let mut parts: Vec<String> = path
                .with_extension("")
                .iter()
                .map(|part| part.to_str().unwrap().to_owned())
                .collect();
            if ["mod", "lib"].contains(&parts.last().unwrap().as_str()) {
                parts.pop();
            }
            let is_test = parts.iter().any(|part| part.contains("test"));
            // The tool is another crate.
            if !is_test && parts.first().is_none_or(|part| part != "main") {
                let code: String = product(&text)
                    .lines()
                    .map(|line| line.split("//").next().unwrap_or_default().to_owned() + "\n")
                    .collect();
                modules.insert(parts, code);
            }
        }
        Self { modules }
    }

    /// Paths that a module's code names, brace lists spelled out, with whether they are exported again.
    fn paths(&self, module: &[String]) -> Vec<(bool, Vec<String>)> {
        let code = &self.modules[module];
        let mut found = Vec::new();
        let mut rest = code.as_str();
        while let Some(place) = rest.find("use ") {
            let before = rest[..place].rsplit('\n').next().unwrap_or_default();
            let after = &rest[place + 4..];
            let end = after.find(';').unwrap_or(after.len());
            if before.trim().is_empty() || before.trim_start().starts_with("pub") {
                let exported = before.contains("pub");
                spell_out(&after[..end], &mut |path| found.push((exported, path)));
            }
            rest = after;
        }
        let children = self.modules.keys().filter(|other| {
            other.len() == module.len() + 1 && other.starts_with(module) && !module.is_empty()
        });
        let children = children.map(|child| format!("{}::", child[module.len()]));
        for root in children.chain(["crate::", "super::"].map(str::to_owned)) {
            for (place, _) in code.match_indices(&root) {
                let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
                let path: String = code[place..].chars().take_while(|c| is_path(*c)).collect();
                let before = code[..place].rsplit([';', '}']).next().unwrap_or_default();
                let is_whole = code[..place].ends_with(|c: char| !is_path(c))
                    && !code[..place].ends_with("pub(in ")
                    && !before.trim_start().starts_with("pub");
                if is_whole && !path.ends_with(':') {
                    spell_out(&path, &mut |path| found.push((false, path)));
                }
            }
        }
        let absolute = |path: Vec<String>| {
            let mut base = module.to_vec();
            let mut segments = path.into_iter().peekable();
            match segments.peek().map(String::as_str) {
                Some("crate") => {
                    base.clear();
                    segments.next();
                }
                Some("self") => {
                    segments.next();
                }
                Some("super") => {
                    while segments.next_if(|segment| segment == "super").is_some() {
                        base.pop();
                    }
                }
                _ => {}
            }
            base.extend(segments);
            base
        };
        found
            .into_iter()
            .map(|(exported, path)| (exported, absolute(path)))
            .collect()
    }

    /// The module that defines what a path names: re-exports are followed.
    fn definer(&self, path: &[String], depth: usize) -> Option<Vec<String>> {
        let length = (1..=path.len())
            .rev()
            .find(|length| self.modules.contains_key(&path[..*length]))?;
        let module = path[..length].to_vec();
        if let (Some(item), true) = (path.get(length), depth > 0) {
            for (exported, other) in self.paths(&module) {
                if exported && other.last() == Some(item) && other != path {
                    return self.definer(&other, depth - 1);
                }
            }
        }
        Some(module)
    }

    /// The modules that a module imports from.
    fn of(&self, module: &[String]) -> BTreeSet<Vec<String>> {
        let named = self
            .paths(module)
            .into_iter()
            .filter(|(exported, _)| !exported);
        let mut from: BTreeSet<_> = named
            .filter_map(|(_, path)| self.definer(&path, 3))
            .collect();
        from.remove(module);
        from
    }
}

/// `a::{b, c::d}` as `a::b` and `a::c::d`.
fn spell_out(text: &str, visit: &mut impl FnMut(Vec<String>)) {
    fn inner(prefix: &[String], text: &str, visit: &mut dyn FnMut(Vec<String>)) {
        let text = text.trim();
        let (head, list) = match text.split_once('{') {
            Some((head, rest)) => (head, rest.strip_suffix('}')),
            None => (text, None),
        };
        let head = head.split(" as ").next().unwrap_or_default();
        let mut path = prefix.to_vec();
        let segments = head
            .split("::")
            .map(str::trim)
            .filter(|part| !part.is_empty());
        path.extend(
            segments
                .filter(|part| *part != "self" || prefix.is_empty())
                .map(str::to_owned),
        );
        let Some(list) = list else {
            visit(path);
            return;
        };
        let (mut depth, mut start) = (0, 0);
        for (place, letter) in list.char_indices().chain([(list.len(), ',')]) {
            match letter {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    if !list[start..place].trim().is_empty() {
                        inner(&path, &list[start..place], visit);
                    }
                    start = place + 1;
                }
                _ => {}
            }
        }
    }
    inner(&[], text, visit);
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let imports = Imports::new();
    let edges: BTreeMap<_, _> = imports
        .modules
        .keys()
        .map(|module| (module.clone(), imports.of(module)))
        .collect();
    let count: usize = edges.values().map(BTreeSet::len).sum();
    assert!(count > 500, "the search finds nothing: {count}");
    let reach = |from: &Vec<String>| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(module) = open.pop() {
            open.extend(
                edges[module]
                    .iter()
                    .filter(|used| seen.insert((*used).clone())),
            );
        }
        seen
    };
    let reaches: BTreeMap<_, _> = edges.keys().map(|module| (module, reach(module))).collect();
    let name = |module: &Vec<String>| format!("{}.rs", module.join("/"));
    let tied = edges.iter().flat_map(|(module, used)| {
        let back = used.iter().filter(|used| reaches[used].contains(module));
        back.map(move |used| format!("src/{} imports from src/{}", name(module), name(used)))
    });
    let tied: Vec<String> = tied.collect();
    assert!(
        tied.is_empty(),
        "files import each other:\n{}",
        tied.join("\n")
    );
}

#[test]
fn every_equation_of_the_paper_is_found_by_its_number() {
    let index = include_str!("../src/lib.rs");
    let rows: Vec<&str> = index
        .lines()
        .filter(|line| line.starts_with("//! | ("))
        .collect();
    let comments: Vec<String> = all()
        .into_iter()
        .filter(|(_, module, _)| ["terrain", "contact", "vehicle"].contains(&module.as_str()))
        .flat_map(|(_, _, text)| {
            let lines = product(&text).lines();
            let comments = lines.filter_map(|line| Some(line.split_once("//")?.1.to_owned()));
            comments.collect::<Vec<_>>()
        })
        .collect();
    for number in 1..=28 {
        let name = format!("({number})");
        let of_row = |row: &&str| {
            row.split('|')
                .nth(1)
                .is_some_and(|cell| cell.contains(&name))
        };
        assert!(rows.iter().any(of_row), "src/lib.rs has no row for {name}");
        let found = comments.iter().any(|comment| comment.contains(&name));
        assert!(
            found,
            "no comment in terrain, contact or vehicle names {name}"
        );
    }
}
