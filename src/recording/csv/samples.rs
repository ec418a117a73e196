//! All channels of a file as they stand there, run by run, each sample with its line.

use super::RUN;
use super::error::{Cell, CsvError, malformed};
use super::table::{Column, Header, Row, read_table};
use crate::recording::Channel;
use std::collections::HashMap;

const TIME: usize = 0;
const CHANNELS: usize = 1;
const RUN_INDEX: usize = CHANNELS + Channel::ALL.len();

/// Time, every channel, and the run.
const COLUMNS: [Column; RUN_INDEX + 1] = {
    let mut columns = [Column {
        name: "time",
        unit: "s",
        is_required: true,
    }; RUN_INDEX + 1];
    let mut index = 0;
    while index < Channel::ALL.len() {
        let channel = Channel::ALL[index];
        columns[CHANNELS + index] = Column {
            name: channel.name(),
            unit: channel.unit(),
            is_required: channel.is_required(),
        };
        index += 1;
    }
    columns[RUN_INDEX] = Column {
        name: RUN,
        unit: "-",
        is_required: false,
    };
    columns
};

/// Words that programs write for a number that they do not have.
const MISSING: [&str; 6] = ["nan", "-nan", "null", "none", "na", "n/a"];

/// A measured value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Line of the file, from 1.
    pub line: usize,
    pub time: f64,
    pub value: f64,
}

/// A clock that goes back under the same label restarts where it lands within this share of
/// the time since the run's start, which has this many rows at least.
const RESTART: (f64, usize) = (0.1, 10);

/// The samples of a run in the file's order.
#[derive(Debug, Clone, Default)]
pub struct RawRun {
    pub label: String,
    pub channels: [Vec<Sample>; Channel::ALL.len()],
    /// Time of the first row.
    start: f64,
    /// The latest time so far.
    latest: f64,
    rows: usize,
}

impl RawRun {
    fn new(label: &[u8], time: f64) -> Self {
        Self {
            label: String::from_utf8_lossy(label).into_owned(),
            start: time,
            latest: time,
            ..Self::default()
        }
    }

    /// Whether a row at this time is the first one of another run.
    fn is_restarted_by(&self, time: f64) -> bool {
        let (share, rows) = RESTART;
        self.rows >= rows && time - self.start < share * (self.latest - self.start)
    }
}

/// A whole file.
#[derive(Debug, Clone)]
pub struct Samples {
    /// The runs in the order of their first rows; at least one.
    pub runs: Vec<RawRun>,
    /// For each channel, number of cells with a word for "missing", and the first one's line.
    pub words: [Option<(usize, usize)>; Channel::ALL.len()],
    /// Columns that were not read, with the channels that they seem to be meant for.
    pub misnamed: Vec<(Channel, String)>,
    /// Number of clocks that restarted under the same label, and the first one's line.
    pub restarts: Option<(usize, usize)>,
    /// The header's cells, to name places.
    places: [Cell; CHANNELS + Channel::ALL.len()],
}

impl Samples {
    /// The cell of a channel in some line.
    pub fn cell(&self, line: usize, channel: Channel) -> Cell {
        Cell {
            line,
            ..self.places[CHANNELS + channel.index()].clone()
        }
    }

    /// The cell of the time in some line.
    pub fn time_cell(&self, line: usize) -> Cell {
        Cell {
            line,
            ..self.places[TIME].clone()
        }
    }

    /// All samples of a channel, run by run.
    pub fn of(&self, channel: Channel) -> impl Iterator<Item = &Sample> {
        self.runs
            .iter()
            .flat_map(move |run| &run.channels[channel.index()])
    }
}

/// Reads all samples of a file. `file` names it in errors.
///
/// # Errors
/// The first thing that makes the text no recording, with its line and column.
pub fn read_samples(file: &str, bytes: &[u8]) -> Result<Samples, CsvError> {
    let mut runs: Vec<RawRun> = Vec::new();
    let mut known: HashMap<Vec<u8>, usize> = HashMap::new();
    let mut words = [None; Channel::ALL.len()];
    let mut restarts = None;
    let header = read_table(file, bytes, &COLUMNS, |row| {
        let label = row.bytes(RUN_INDEX);
        let has_runs = row.header().has(RUN);
        if label.is_empty() && has_runs {
            let expected = "the run's number or name";
            return Err(malformed(row.cell(RUN_INDEX), "an empty cell", expected));
        }
        let time = row.required_number(TIME)?;
        let run = match known.get(label) {
            Some(&run) if !(has_runs && runs[run].is_restarted_by(time)) => run,
            before => {
                if before.is_some() {
                    restarts.get_or_insert((0, row.line)).0 += 1;
                }
                runs.push(RawRun::new(label, time));
                known.insert(label.to_vec(), runs.len() - 1);
                runs.len() - 1
            }
        };
        push(&mut runs[run], time, &mut words, row)
    })?;
    if runs.is_empty() {
        return Err(header.no_rows(TIME));
    }
    let samples = Samples {
        runs,
        words,
        misnamed: misnamed(&header),
        restarts,
        places: std::array::from_fn(|index| header.cell(1, index)),
    };
    for channel in Channel::ALL {
        if channel.is_required() && samples.of(channel).next().is_none() {
            return Err(header.no_numbers(CHANNELS + channel.index()));
        }
    }
    Ok(samples)
}

fn misnamed(header: &Header) -> Vec<(Channel, String)> {
    let meant = |channel: Channel| {
        let name = header.meant(CHANNELS + channel.index())?;
        Some((channel, name.to_owned()))
    };
    Channel::ALL.into_iter().filter_map(meant).collect()
}

fn push(
    run: &mut RawRun,
    time: f64,
    words: &mut [Option<(usize, usize)>],
    row: &Row,
) -> Result<(), CsvError> {
    let line = row.line;
    run.latest = run.latest.max(time);
    run.rows += 1;
    for (index, samples) in run.channels.iter_mut().enumerate() {
        let is_word = |word: &str| {
            row.bytes(CHANNELS + index)
                .eq_ignore_ascii_case(word.as_bytes())
        };
        if MISSING.iter().any(|word| is_word(word)) {
            words[index].get_or_insert((0, line)).0 += 1;
        } else if let Some(value) = row.number(CHANNELS + index)? {
            samples.push(Sample { line, time, value });
        }
    }
    Ok(())
}
