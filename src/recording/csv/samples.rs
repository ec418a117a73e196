//! All channels of a file before any correction, run by run, each sample with its line.

use super::error::{Cell, CsvError, malformed};
use super::request::TableOptions;
use super::table::{ColumnSpec, RUN, TableHeader, TableRow, read_table};
use super::unit::Quantity;
use crate::recording::channel::Channel;
use crate::recording::note::{Note, NoteKind};
use crate::recording::series::Series;
use std::collections::HashMap;

const TIME: usize = 0;
const CHANNELS: usize = 1;
const RUN_INDEX: usize = CHANNELS + Channel::ALL.len();

/// Time, every channel, and the run.
const COLUMNS: [ColumnSpec; RUN_INDEX + 1] = {
    let mut columns = [ColumnSpec::required("time", "s", Quantity::Time); RUN_INDEX + 1];
    let mut index = 0;
    while index < Channel::ALL.len() {
        let channel = Channel::ALL[index];
        columns[CHANNELS + index] = ColumnSpec {
            name: channel.name(),
            unit: channel.unit(),
            quantity: match channel {
                Channel::OmegaLeft | Channel::OmegaRight => Quantity::WheelSpeed,
                Channel::X | Channel::Y => Quantity::Length,
                Channel::Heading => Quantity::Angle,
                Channel::VX | Channel::VY => Quantity::Velocity,
                Channel::YawRate => Quantity::AngularVelocity,
                Channel::AX | Channel::AY => Quantity::Acceleration,
            },
            is_required: channel.is_required(),
        };
        index += 1;
    }
    columns[RUN_INDEX] = RUN;
    columns
};

/// Words that programs write for a missing number.
const MISSING: [&str; 6] = ["nan", "-nan", "null", "none", "na", "n/a"];

/// A measured value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RawSample {
    /// Line of the file, from 1.
    pub line: usize,
    pub time: f64,
    pub value: f64,
}

/// Number of places in a file, and the line of the first.
#[derive(Debug, Clone, Copy, Default)]
pub struct Occurrences {
    pub count: usize,
    pub line: usize,
}

impl Occurrences {
    pub fn push(&mut self, line: usize) {
        self.line = if self.count == 0 {
            line
        } else {
            self.line.min(line)
        };
        self.count += 1;
    }
}

/// A clock that goes back under the same label has restarted if it lands within this share of the run's time, and the
/// run has at least this many rows.
const RESTART: (f64, usize) = (0.1, 10);

/// The samples of a run in the file's order.
#[derive(Debug, Clone, Default)]
pub struct RawRun {
    pub label: String,
    pub channels: [Vec<RawSample>; Channel::ALL.len()],
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

    /// The samples of a channel.
    pub fn series(&self, channel: Channel) -> Series {
        let samples = self.channels[channel.index()].iter();
        samples.map(|sample| (sample.time, sample.value)).collect()
    }

    /// Whether a row at this time is the first of another run.
    fn is_restarted_by(&self, time: f64) -> bool {
        let (share, rows) = RESTART;
        self.rows >= rows && time - self.start < share * (self.latest - self.start)
    }
}

/// A whole file.
#[derive(Debug, Clone)]
pub struct RawSamples {
    /// The runs in the order of their first rows; at least one.
    pub runs: Vec<RawRun>,
    /// For each channel, the cells with a word for "missing".
    pub words: [Occurrences; Channel::ALL.len()],
    /// Clocks that restarted under the same label.
    pub restarts: Occurrences,
    /// The corrections so far.
    pub notes: Vec<Note>,
    /// The header's cells, to name places.
    places: [Cell; CHANNELS + Channel::ALL.len()],
}

impl RawSamples {
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

    /// All samples of a channel, and the line of the first.
    pub fn all(&self, channel: Channel) -> Occurrences {
        Occurrences {
            count: self.of(channel).count(),
            line: self.of(channel).next().map_or(0, |sample| sample.line),
        }
    }

    /// Notes a correction; nothing if it occurred nowhere.
    pub fn note(
        &mut self,
        kind: NoteKind,
        channel: Option<Channel>,
        Occurrences { count, line }: Occurrences,
        text: impl Into<String>,
    ) {
        if count > 0 {
            self.notes.push(Note {
                kind,
                channel,
                count,
                line,
                text: text.into(),
            });
        }
    }

    /// Replaces every value of a channel.
    pub fn map(&mut self, channel: Channel, value: impl Fn(f64) -> f64) {
        for run in &mut self.runs {
            for sample in &mut run.channels[channel.index()] {
                sample.value = value(sample.value);
            }
        }
    }

    /// All samples of a channel, run by run.
    pub fn of(&self, channel: Channel) -> impl Iterator<Item = &RawSample> {
        self.runs
            .iter()
            .flat_map(move |run| &run.channels[channel.index()])
    }
}

/// Reads all samples of a file. `file` names it in errors.
///
/// # Errors
/// The first malformed cell, with its line and column.
pub fn read_samples(
    file: &str,
    bytes: &[u8],
    options: &TableOptions,
) -> Result<RawSamples, CsvError> {
    let mut runs: Vec<RawRun> = Vec::new();
    let mut known: HashMap<Vec<u8>, usize> = HashMap::new();
    let mut words = [Occurrences::default(); Channel::ALL.len()];
    let mut restarts = Occurrences::default();
    let header = read_table(file, bytes, &COLUMNS, options, |row| {
        let label = row.bytes(RUN_INDEX);
        let has_runs = row.header().has(RUN.name);
        if label.is_empty() && has_runs {
            let expected = "the run's number or name";
            return Err(malformed(row.cell(RUN_INDEX), "an empty cell", expected));
        }
        let time = row.required_number(TIME)?;
        let run = match known.get(label) {
            Some(&run) if !(has_runs && runs[run].is_restarted_by(time)) => run,
            before => {
                if before.is_some() {
                    restarts.push(row.line);
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
    let samples = RawSamples {
        runs,
        words,
        restarts,
        notes: notes(&header),
        places: std::array::from_fn(|index| header.cell(1, index)),
    };
    for channel in Channel::ALL {
        if channel.is_required() && samples.of(channel).next().is_none() {
            return Err(header.no_numbers(CHANNELS + channel.index()));
        }
    }
    Ok(samples)
}

fn notes(header: &TableHeader) -> Vec<Note> {
    let findings = header.findings().iter();
    let notes = findings.map(|finding| Note {
        kind: if finding.is_doubt {
            NoteKind::Suspicion
        } else {
            NoteKind::Column
        },
        channel: finding
            .index
            .checked_sub(CHANNELS)
            .and_then(|index| Channel::ALL.get(index).copied()),
        count: 1,
        line: finding.line,
        text: finding.text.clone(),
    });
    notes.collect()
}

fn push(
    run: &mut RawRun,
    time: f64,
    words: &mut [Occurrences],
    row: &TableRow,
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
            words[index].push(line);
        } else if let Some(value) = row.number(CHANNELS + index)? {
            samples.push(RawSample { line, time, value });
        }
    }
    Ok(())
}
