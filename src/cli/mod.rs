//! Arguments and output; no physics. One file per subcommand.

mod completions;
mod diagnose;
mod effects;
mod failure;
mod fit;
mod import;
mod initial;
mod inspect;
mod jobs;
mod model;
mod nominal;
mod output;
mod package;
mod plot;
mod presets;
mod progress;
mod score;
mod simulate;
mod sweep;

pub use failure::Failure;

use clap::{Parser, Subcommand};
use output::write_stdout;
use ugv_terrain::display::visible_line;

const EXAMPLES: &str = "\
Examples:
  ugv simulate --input drive.csv --terrain dry_sand --output motion.csv --plot motion.svg
  ugv sweep --input drive.csv --vary soil.cohesion=uniform:500,2000 --samples 1000 --output ends.csv
  ugv import drive.mcap --output drive.csv
  ugv inspect field.csv --page field.html
  ugv score drive.csv          # how well do models predict what was recorded?
  ugv diagnose drive.csv       # what physics did the model leave out?
  ugv vehicle > mine.json      # edit it, then: ugv simulate --vehicle mine.json ...
  ugv terrains dry_sand > soil.json
  ugv effects                  # physics that the paper leaves out, to switch on
  ugv model --terrain soil.json --effects effects.json > model.json

Exit status: 0 done; 1 the simulation or writing failed; 2 wrong arguments or input.";

/// Wheel-terrain model of a skid-steer UGV (Tran et al. 2007).
#[derive(Parser)]
#[command(name = "ugv", version, after_help = EXAMPLES, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Simulate(simulate::Args),
    Sweep(sweep::Args),
    Diagnose(diagnose::Args),
    Fit(fit::Args),
    Import(import::Args),
    Inspect(inspect::Args),
    Score(score::Args),
    Package(package::Args),
    Terrains(presets::TerrainsArgs),
    Vehicle(presets::VehicleArgs),
    Effects(effects::Args),
    Model(presets::WholeModelArgs),
    Completions(completions::Args),
}

/// Parses the arguments and does what they ask for.
pub fn run() -> Result<(), Failure> {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() => return Err(Failure::Usage(error)),
        // --help and --version.
        Err(answer) => return write_stdout(&answer.render().to_string()),
    };
    match cli.command {
        Command::Simulate(args) => simulate::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Diagnose(args) => diagnose::run(&args),
        Command::Fit(args) => fit::run(&args),
        Command::Import(args) => import::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Score(args) => score::run(&args),
        Command::Package(args) => package::run(&args),
        Command::Terrains(args) => presets::terrains(&args),
        Command::Vehicle(args) => presets::vehicle(&args),
        Command::Effects(args) => effects::run(&args),
        Command::Model(args) => presets::model(&args),
        Command::Completions(args) => completions::run(&args),
    }
}

/// Prints a line for the user beside whatever goes to standard output.
fn tell(line: &str) {
    use std::io::Write;
    // A closed standard error is no reason to stop.
    let _ = writeln!(std::io::stderr(), "ugv: {}", visible_line(line));
}
