//! The page of the command line is what `--help` prints, in lines of 100 columns.

use crate::{Bench, generated::assert_current};

const PAGE: &str = "docs/reference/cli.md";
const COMMAND: &str = "cargo test --test cli page";
const HEAD: &str = "\
# Command line

<!-- Written by `UGV_BLESS=1 cargo test --test cli page` from the help of each command. -->

`ugv completions bash` prints shell completions; other shells likewise. `ugv man DIR` writes the
manual pages `ugv.1`, `ugv-simulate.1` and so on.

An option means the same in every command:

| option | meaning |
|---|---|
| `-o`, `--output PLACE` | where the main product goes: a table (`simulate`, `sweep`, `import`), a model (`fit`), a folder (`diagnose`), an FMU (`package`), JSON (`terrains`, `vehicle`, `effects`, `model`). `-` is standard output |
| `--json [FILE]` | all results as [JSON](formats.md). Without FILE, or for `-`, they go to standard output. A table that has no `--output` is then not written, and the summary goes to standard error |
| `--report FILE.html` | a page for people (`inspect`; `diagnose` writes one into its folder) |
| `--force` | replace files that exist |
| `-q`, `--quiet` | neither summary nor progress; warnings and errors remain |
| `--vehicle NAME\\|FILE` | `tran2007`, `husky`, `jackal`, `warthog`, `scout`, or a file. `fit`, `score` and `diagnose` need one, from here, from `--model` or from the JSON file beside a recording |

**Files that exist are kept.** A command that would replace a file stops before its work, names the file, and does
nothing; `--force` replaces it. This holds for tables, models, reports, pictures and FMUs alike. `diagnose` refuses a folder
that has one of its three files; other files there do not matter. Devices and pipes need no `--force`, nor does the JSON
file beside the recording of `import`, which keeps its other keys. Input files are never replaced, except by `package --merge`
with `--force`.

Output has no colour, with or without `NO_COLOR`. A progress bar is shown on a
terminal alone. Elsewhere `diagnose` prints a line for each of its seven steps.
";

fn help(bench: &Bench, command: &str) -> String {
    let output = bench
        .ugv(&format!("{command} --help"))
        .env_remove("COLUMNS")
        .output()
        .unwrap();
    String::from_utf8(output.stdout).unwrap()
}

/// The names below `Commands:`, but `help`; lines that continue a description are indented further.
fn commands(overview: &str) -> Vec<&str> {
    let (_, list) = overview.split_once("Commands:\n").unwrap();
    let (list, _) = list.split_once("\n\n").unwrap();
    list.lines()
        .filter_map(|line| line.strip_prefix("  "))
        .filter(|line| !line.starts_with(' '))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect()
}

#[test]
fn the_page_of_the_command_line_is_current() {
    let bench = Bench::new();
    let overview = help(&bench, "");
    let commands = commands(&overview);
    assert!(commands.contains(&"diagnose") && commands.contains(&"completions"));
    let mut page = HEAD.to_owned();
    let sections = std::iter::once(("ugv".to_owned(), overview.clone())).chain(
        commands
            .iter()
            .map(|name| (format!("ugv {name}"), help(&bench, name))),
    );
    for (title, text) in sections {
        let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
        let long = lines.iter().find(|line| line.chars().count() > 100);
        assert_eq!(long, None, "{title}");
        page += &format!("\n## {title}\n\n```text\n{}\n```\n", lines.join("\n"));
    }
    assert_current(PAGE, COMMAND, &page);
}

/// The help of a command on a terminal of this width.
fn help_at(bench: &Bench, command: &str, width: usize) -> String {
    let mut command = bench.ugv(&format!("{command} --help"));
    let output = command.env("COLUMNS", width.to_string()).output().unwrap();
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn help_fits_narrow_terminals() {
    let bench = Bench::new();
    let overview = help(&bench, "");
    for width in [60, 80] {
        for name in std::iter::once("").chain(commands(&overview)) {
            let text = help_at(&bench, name, width);
            // The usage line is one word for a long option with its value.
            let long = text
                .lines()
                .find(|line| line.trim_end().chars().count() > width);
            assert_eq!(long, None, "{name} at {width}");
            // A line that was broken by hand and again by the width leaves a short one in the middle of a paragraph.
            let (_, below) = text.rsplit_once("\nExamples:\n").unwrap_or(("", ""));
            let lines: Vec<&str> = below.lines().collect();
            for pair in lines.windows(2) {
                let indent = |line: &str| line.len() - line.trim_start().len();
                let is_filled = indent(pair[1]) >= 6 && indent(pair[0]) == indent(pair[1]);
                let next = pair[1].split_whitespace().next().unwrap_or_default();
                let room = pair[0].chars().count() + 1 + next.chars().count();
                assert!(
                    !is_filled || room > width - 2 || pair[0].contains("  "),
                    "{name} at {width}: {pair:?}"
                );
            }
        }
    }
}

#[test]
fn every_command_has_a_manual_page() {
    let bench = Bench::new();
    bench.stdout("man pages/man1");
    for name in commands(&help(&bench, "")) {
        let page = bench.read(&format!("pages/man1/ugv-{name}.1"));
        assert!(page.contains(".SH SYNOPSIS"), "{name}: {page}");
    }
    assert_eq!(bench.read("pages/man1/ugv.1"), bench.stdout("man"));
    let message = bench.fails("man pages/man1", 2);
    crate::assert_contains(&message, "ugv.1 exists");
    bench.stdout("man pages/man1 --force");
}

/// `script` runs a command on a terminal.
#[test]
#[cfg(target_os = "linux")]
fn colours_obey_no_color() {
    let bench = Bench::new();
    bench.write("drive.csv", "time,omega_left,omega_right\n0,4,4\n20,4,4\n");
    for arguments in [
        "--help",
        "simulat",
        "simulate --input nowhere.csv",
        "sweep --input drive.csv --vary soil.cohesion=uniform:900,1100 --samples 400 --output /dev/null",
    ] {
        let on_terminal = |variable: &str| {
            let command = format!("{variable} {} {arguments}", crate::UGV);
            let output = assert_cmd::Command::new("script")
                .current_dir(bench.path(""))
                .args(["-qec", &command, "/dev/null"])
                .output();
            // Without `script` nothing is shown.
            output.map_or(String::new(), |output| {
                String::from_utf8_lossy(&output.stdout).into_owned()
            })
        };
        // A colour is an escape sequence that ends with m; a progress line moves the cursor, which is none.
        let coloured = |text: &str| {
            let sequences = text.split("\u{1b}[").skip(1);
            let mut ends =
                sequences.filter_map(|rest| rest.chars().find(|c| c.is_ascii_alphabetic()));
            ends.any(|end| end == 'm')
        };
        assert!(!coloured(&on_terminal("NO_COLOR=1")), "{arguments}");
        let plain = on_terminal("env -u NO_COLOR");
        // Results are read by programs, too: they have no colour in any case.
        assert!(!coloured(&plain), "{arguments}: {plain}");
    }
}
