//! The arguments that say where results go. Each means the same in every command.

use super::failure::Failure;
use super::output::{Output, is_stream, write_product};
use crate::import::LOG_ENDINGS;
use std::path::{Path, PathBuf};

/// Whether files that exist are replaced.
#[derive(clap::Args)]
pub struct ForceArgs {
    /// Replace files that exist
    #[arg(long)]
    pub force: bool,
}

/// Where the machine-readable results go.
#[derive(clap::Args)]
pub struct JsonArgs {
    /// Write all results as JSON to this file; without FILE, or for -, to standard output, which
    /// then has no text
    #[arg(
        long,
        value_name = "FILE.json",
        num_args = 0..=1,
        default_missing_value = "-",
        value_parser = json_place
    )]
    json: Option<PathBuf>,
}

/// Endings of what people record, besides those of logs: such a file behind `--json` is an input that lost its place.
const RECORDED: [&str; 3] = ["csv", "tsv", "zstd"];

fn json_place(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let mut recorded = RECORDED.iter().chain(&LOG_ENDINGS);
    if recorded.any(|known| ending == *known) {
        return Err("a recording takes no results; write --json=- or put --json last".into());
    }
    Ok(path)
}

impl JsonArgs {
    /// The place, if JSON is asked for.
    pub fn place(&self) -> Option<&Path> {
        self.json.as_deref()
    }

    /// Whether standard output has the JSON.
    pub fn is_stdout(&self) -> bool {
        self.place().is_some_and(is_stream)
    }

    /// The place as an output.
    ///
    /// # Errors
    /// As [`Output::from_inputs`].
    pub fn output<'a>(
        &self,
        inputs: impl IntoIterator<Item = &'a PathBuf>,
        force: bool,
    ) -> Result<Option<Output>, Failure> {
        let place = self.place();
        place
            .map(|path| Output::from_inputs(Some(path), inputs, force))
            .transpose()
    }

    /// Where a table goes: to its file, to standard output if it has none, or nowhere if the JSON is there.
    ///
    /// # Errors
    /// As [`Output::from_inputs`], and one destination for both.
    pub fn table<'a>(
        &self,
        path: Option<&Path>,
        inputs: impl IntoIterator<Item = &'a PathBuf>,
        force: bool,
        json: Option<&Output>,
    ) -> Result<Option<Output>, Failure> {
        if path.is_none() && self.is_stdout() {
            return Ok(None);
        }
        let table = Output::from_inputs(path, inputs, force)?;
        if let Some(json) = json {
            json.check_distinct(&table, "--json and --output")?;
        }
        Ok(Some(table))
    }
}

/// Where a printed file goes.
#[derive(clap::Args)]
pub struct PrintArgs {
    /// File to write; - or nothing writes to standard output
    #[arg(long, short, value_name = "FILE.json")]
    output: Option<PathBuf>,

    #[command(flatten)]
    replace: ForceArgs,
}

impl PrintArgs {
    /// Writes a text there.
    ///
    /// # Errors
    /// Whatever the file system refuses, and a file that exists.
    pub fn write(&self, text: &str) -> Result<(), Failure> {
        write_product(self.output.as_deref(), self.replace.force, text)
    }
}
