//! The table of parameters: one row per drive, drawn or read.

use super::distribution::{VariedParameter, VariedValues};
use crate::cli::failure::Failure;
use crate::cli::input::read_file;
use crate::display::shortened;
use crate::recording::read_bytes;
use std::collections::HashSet;
use std::io::{self, Write};
use std::path::Path;

/// Column that numbers the rows.
const INDEX: &str = "index";
/// More drives than this do not fit in memory.
const MAX_ROWS: usize = 100_000_000;

/// Parameters of all drives.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterTable {
    /// Names in the FMU of the parameters that differ.
    pub names: Vec<String>,
    /// Their values in each drive.
    pub rows: Vec<ParameterRow>,
}

/// Parameters of one drive.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterRow {
    pub index: u64,
    pub values: Vec<f64>,
}

impl ParameterTable {
    /// Draws a table: samples of the distributions, each with every combination of the listed values
    /// (the last listed parameter changes fastest). A number depends on seed, name and sample only:
    /// one more parameter, or more samples, do not change it.
    ///
    /// # Errors
    /// A parameter that is named twice, or a table that is too large.
    pub fn draw(varied: &[VariedParameter], samples: usize, seed: u64) -> Result<Self, Failure> {
        let names: Vec<String> = varied.iter().map(|v| v.name.clone()).collect();
        check_unique(&names, "--vary")?;
        let combinations = varied
            .iter()
            .try_fold(1_usize, |product, v| match &v.values {
                VariedValues::Listed(values) => product.checked_mul(values.len()),
                VariedValues::Drawn(_) => Some(product),
            });
        let count = combinations.and_then(|combinations| combinations.checked_mul(samples));
        let Some(count) = count.filter(|count| *count <= MAX_ROWS) else {
            let reason = format!("the sweep has more than {MAX_ROWS} drives");
            return Err(Failure::argument(reason)
                .with_remedy("take fewer --samples, or shorter lists and grids"));
        };
        let row = |index: usize| {
            let (sample, mut combination) = (index / (count / samples), index % (count / samples));
            let value = |v: &VariedParameter| match &v.values {
                VariedValues::Drawn(distribution) => {
                    distribution.quantile(share(seed, &v.name, sample as u64))
                }
                VariedValues::Listed(values) => {
                    let value = values[combination % values.len()];
                    combination /= values.len();
                    value
                }
            };
            // From the last to the first, so that the last changes fastest.
            let mut values: Vec<f64> = varied.iter().rev().map(value).collect();
            values.reverse();
            ParameterRow {
                index: index as u64,
                values,
            }
        };
        Ok(Self {
            names,
            rows: (0..count).map(row).collect(),
        })
    }

    /// Reads a table: parameters' names in the header, and optionally the column `index`.
    ///
    /// # Errors
    /// A file that cannot be read, with the line and column of the fault.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let text = String::from_utf8(read_file(path, read_bytes)?).map_err(|error| {
            let source = io::Error::new(io::ErrorKind::InvalidData, error.utf8_error());
            Failure::read(path)(source)
        })?;
        // The reader reports the position between CR and LF as the start of a record.
        let text = text.replace("\r\n", "\n");
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let wrong = |reason: String| {
            Failure::argument(format!("{}{reason}", path.display()))
                .with_remedy("`ugv sweep --vary ... --samples-only` writes valid tables")
        };
        let header = reader
            .headers()
            .map_err(|e| wrong(format!(": {e}")))?
            .clone();
        let header: Vec<String> = header.iter().map(|name| name.trim().to_owned()).collect();
        check_unique(&header, &path.display().to_string())?;
        let index_column = header.iter().position(|name| name == INDEX);
        let mut rows = Vec::new();
        for (number, record) in reader.records().enumerate() {
            let record = record.map_err(|e| wrong(format!(": {e}")))?;
            let start = record.position().map_or(0, |place| place.byte() as usize);
            let mut sample = ParameterRow {
                index: number as u64,
                values: Vec::with_capacity(header.len()),
            };
            for (column, cell) in record.iter().enumerate() {
                let expected = |what: &str| {
                    let (name, cell) = (shortened(&header[column]), shortened(cell));
                    let line = line_from(&text, start);
                    wrong(format!(
                        ", line {line}, {name}: found `{cell}`, expected {what}"
                    ))
                };
                if Some(column) == index_column {
                    let index = cell.trim().parse();
                    sample.index = index.map_err(|_| expected("a whole number"))?;
                    continue;
                }
                match cell.trim().parse() {
                    Ok(value) if f64::is_finite(value) => sample.values.push(value),
                    _ => return Err(expected("a finite number")),
                }
            }
            rows.push(sample);
        }
        if rows.is_empty() {
            return Err(wrong(": there is no row after the header".into()));
        }
        let names = header.into_iter().filter(|name| name != INDEX).collect();
        Ok(Self { names, rows })
    }

    /// The header's cells, the first ones of every table.
    pub fn header(&self) -> String {
        let names = self.names.iter().map(|name| format!(",{name}"));
        INDEX.to_owned() + &names.collect::<String>()
    }

    /// Writes the table without results.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "{}", self.header())?;
        for sample in &self.rows {
            sample.write(out)?;
            writeln!(out)?;
        }
        Ok(())
    }
}

impl ParameterRow {
    /// Writes the cells; the numbers read back to the last bit.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        write!(out, "{}", self.index)?;
        self.values
            .iter()
            .try_for_each(|value| write!(out, ",{:?}", value + 0.0))
    }
}

/// The number, from 1, of the first line from this byte on that is not empty.
fn line_from(text: &str, start: usize) -> usize {
    let (before, rest) = text.split_at(start);
    let skipped = rest.len() - rest.trim_start_matches('\n').len();
    1 + skipped + before.matches('\n').count()
}

fn check_unique(names: &[String], place: &str) -> Result<(), Failure> {
    let mut known = HashSet::new();
    match names.iter().find(|name| !known.insert(*name)) {
        Some(name) => Err(Failure::argument(format!(
            "{place} names {} twice",
            shortened(name)
        ))),
        None => Ok(()),
    }
}

/// Increment of SplitMix64.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// A number between 0 and 1, both excluded, of a named stream: SplitMix64 (Steele, Lea and Flood
/// 2014), whose n-th number is a hash of n.
fn share(seed: u64, name: &str, index: u64) -> f64 {
    // FNV-1a of the name.
    let stream = name.bytes().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    let start = mix(mix(seed) ^ stream);
    let bits = mix(start.wrapping_add(GAMMA.wrapping_mul(index.wrapping_add(1))));
    ((bits >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
}

/// The finaliser of SplitMix64.
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draw(words: &[&str], samples: usize, seed: u64) -> ParameterTable {
        let varied: Vec<VariedParameter> = words.iter().map(|word| word.parse().unwrap()).collect();
        ParameterTable::draw(&varied, samples, seed).unwrap()
    }

    fn column(samples: &ParameterTable, name: &str) -> Vec<f64> {
        let at = samples.names.iter().position(|n| n == name).unwrap();
        samples.rows.iter().map(|row| row.values[at]).collect()
    }

    #[test]
    fn the_stream_is_splitmix64() {
        // Its first numbers from 1234567, of the reference implementation.
        let stream = |n: u64| mix(1_234_567_u64.wrapping_add(GAMMA.wrapping_mul(n)));
        assert_eq!(stream(1), 6_457_827_717_110_365_317);
        assert_eq!(stream(2), 3_203_168_211_198_807_973);
    }

    #[test]
    fn a_number_depends_on_seed_name_and_sample_only() {
        let (a, b) = ("a=uniform:0,1", "b=uniform:0,1");
        let long = column(&draw(&[a], 100, 7), "a");
        assert_eq!(column(&draw(&[b, a], 40, 7), "a"), long[..40]);
        assert_ne!(column(&draw(&[a], 100, 8), "a"), long);
        assert_ne!(column(&draw(&[b], 100, 7), "b"), long);
    }

    #[test]
    fn shares_are_uniform() {
        const COUNT: usize = 100_000;
        let mut drawn = column(&draw(&["a=uniform:0,1"], COUNT, 1), "a");
        drawn.sort_by(f64::total_cmp);
        let distance = drawn
            .iter()
            .enumerate()
            .map(|(rank, value)| (value - (rank as f64 + 0.5) / COUNT as f64).abs());
        // Kolmogorov and Smirnov: less in 99.9 % of all seeds, and this is one of them.
        let limit = 1.95 / (COUNT as f64).sqrt();
        assert!(distance.fold(0.0, f64::max) < limit);
    }

    #[test]
    fn each_sample_meets_each_combination() {
        let samples = draw(&["a=list:1,2", "b=uniform:0,1", "c=grid:0,2,3"], 2, 1);
        assert_eq!(column(&samples, "a"), [1., 1., 1., 2., 2., 2.].repeat(2));
        assert_eq!(column(&samples, "c"), [0.0, 1.0, 2.0].repeat(4));
        let b = column(&samples, "b");
        assert!(b[..6].iter().all(|value| *value == b[0]));
        assert!(b[6..].iter().all(|value| *value == b[6]) && b[0] != b[6]);
    }
}
