//! Arguments and output; no physics. One file per subcommand.

mod answer;
mod columns;
mod completions;
mod destination;
mod diagnose;
mod doubts;
mod effects;
mod failure;
mod fit;
mod help;
mod import;
mod initial;
mod input;
mod inspect;
mod jobs;
mod log;
mod man;
mod model;
mod nominal;
mod output;
mod package;
mod presets;
mod progress;
mod recordings;
mod score;
mod simulate;
mod sweep;

pub use answer::{Answer, Caller};
pub use failure::Failure;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use output::write_stdout;

const EXAMPLES: &str = "\
Examples:
  ugv simulate --input drive.csv --terrain dry_sand --output motion.csv --plot motion.svg
  ugv sweep --input drive.csv --vary soil.cohesion=uniform:500,2000 --samples 1000 --output ends.csv
  ugv import drive.mcap --output drive.csv
  ugv inspect field.csv --report field.html
  ugv score drive.csv --vehicle mine.json       # how well do models predict the recording?
  ugv diagnose drive.csv --vehicle mine.json    # which physics does the model leave out?
  ugv vehicle > mine.json      # edit it, then: ugv simulate --vehicle mine.json ...
  ugv terrains dry_sand > soil.json
  ugv effects                  # physics beyond the paper, to switch on
  ugv model --terrain soil.json --effects effects.json > model.json

Results:      -o names the main product, --json all results for programs, --report a page for people.
              `-` is standard output. A file that exists is replaced by --force alone.

Exit status:  0 success; 1 the simulation or a write failed; 2 wrong arguments or input.";

/// Version and platform, for reports of faults.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("UGV_TARGET"), ")");

/// Wheel-terrain model of a skid-steer UGV (Tran et al. 2007).
#[derive(Parser)]
#[command(name = "ugv", version, long_version = VERSION, after_help = EXAMPLES, max_term_width = help::MAX_WIDTH)]
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
    Man(man::Args),
}

/// Parses the arguments and runs the command.
pub fn run() -> Result<(), Failure> {
    let tool = || help::fitted(Cli::command(), help::width());
    let parsed = tool().try_get_matches();
    let cli = match parsed.and_then(|matches| Cli::from_arg_matches(&matches)) {
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
        Command::Completions(args) => completions::run(&args, Cli::command()),
        Command::Man(args) => man::run(&args, Cli::command()),
    }
}

/// What a command finds with these arguments, the name of the command first: `diagnose`, `fit` or `score`. No file is
/// written, and nothing printed.
///
/// # Errors
/// As the command.
pub fn answer(arguments: &[String], caller: &Caller) -> Result<Answer, Failure> {
    let all = std::iter::once("ugv").chain(arguments.iter().map(String::as_str));
    match Cli::try_parse_from(all).map_err(Failure::Usage)?.command {
        Command::Diagnose(args) => diagnose::answer(&args, caller),
        Command::Fit(args) => fit::answer(&args, caller),
        Command::Score(args) => score::answer(&args, caller),
        _ => Err(Failure::argument("no command that is asked without files")),
    }
}
