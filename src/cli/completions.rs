//! `ugv completions`: scripts that complete the tool's arguments in a shell.

use super::failure::Failure;
use super::output::write_stdout;
use clap::Command;
use clap_complete::Shell;

const EXAMPLES: &str = "\
Examples:
  ugv completions bash > ~/.local/share/bash-completion/completions/ugv
  ugv completions fish > ~/.config/fish/completions/ugv.fish";

/// Print a script that completes the arguments of `ugv` in a shell.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The shell.
    shell: Shell,
}

pub fn run(args: &Args, mut tool: Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut tool, "ugv", &mut script);
    write_stdout(&String::from_utf8_lossy(&script))
}
