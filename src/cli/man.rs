//! `ugv man`: manual pages.

use super::destination::ForceArgs;
use super::failure::Failure;
use super::help::fitted;
use super::output::{Output, finish_all, write_stdout};
use clap::Command;
use clap_mangen::Man;
use std::fs;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  ugv man | man -l -
  ugv man ~/.local/share/man/man1    # then: man ugv-diagnose";

/// Columns of the texts that a manual shows as they stand.
const WIDTH: usize = 72;

/// Print the manual page of `ugv`, or write the pages of all commands into a folder.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Folder for ugv.1, ugv-simulate.1 and so on; created if it does not exist
    #[arg(value_name = "DIR")]
    folder: Option<PathBuf>,

    #[command(flatten)]
    replace: ForceArgs,
}

pub fn run(args: &Args, tool: Command) -> Result<(), Failure> {
    let mut tool = fitted(tool.disable_help_subcommand(true), WIDTH);
    // Gives the subcommands their full names.
    tool.build();
    let Some(folder) = &args.folder else {
        return write_stdout(&page(&tool)?);
    };
    fs::create_dir_all(folder).map_err(|source| write_failure(folder, source))?;
    let mut outputs = Vec::new();
    for command in std::iter::once(&tool).chain(tool.get_subcommands()) {
        let man = Man::new(command.clone());
        let path = folder.join(man.get_filename());
        let output = Output::from_inputs(Some(&path), [], args.replace.force)?;
        outputs.push(output.with(&page(command)?)?);
    }
    finish_all(outputs)
}

fn page(command: &Command) -> Result<String, Failure> {
    let mut page = Vec::new();
    let written = Man::new(command.clone()).render(&mut page);
    written.map_err(|source| write_failure(Path::new(command.get_name()), source))?;
    Ok(String::from_utf8_lossy(&page).into_owned())
}

fn write_failure(path: &Path, source: std::io::Error) -> Failure {
    Failure::Write {
        target: path.display().to_string(),
        source,
    }
}
