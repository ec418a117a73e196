//! The page of the command line is what `--help` prints, in lines of 100 columns.

use crate::{Bench, generated::assert_current};

const PAGE: &str = "docs/reference/cli.md";
const COMMAND: &str = "cargo test --test cli page";
const HEAD: &str = "\
# Command line

<!-- Written by `UGV_BLESS=1 cargo test --test cli page` from the help of each command. -->

`ugv completions bash` prints shell completions; other shells likewise.
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
