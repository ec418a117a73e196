//! The table of parameters: one row per drive, drawn or read.

use super::distribution::{Values, Varied};
use crate::cli::Failure;
use crate::cli::simulate::read_file;
use std::collections::HashSet;
use std::io::{self, Write};
use std::path::Path;
use ugv_terrain::display::shortened;
use ugv_terrain::recording::read_bytes;

/// Column that numbers the rows.
const INDEX: &str = "index";
/// More drives than this do not fit in memory.
const MOST_ROWS: usize = 100_000_000;

/// Parameters of all drives.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// The FMU's names of the parameters that differ.
    pub names: Vec<String>,
    /// Their values in each drive.
    pub rows: Vec<Sample>,
}

/// Parameters of one drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    pub index: u64,
    pub values: Vec<f64>,
}

impl Samples {
    /// Draws a table: so many samples of what is drawn, each with every combination of what is
    /// listed (the last listed parameter changes fastest). A number depends on seed, name and
    /// sample alone: another parameter more, or more samples, leave it as it is.
    ///
    /// # Errors
    /// A parameter named twice, or a table too large.
    pub fn draw(varied: &[Varied], samples: usize, seed: u64) -> Result<Self, Failure> {
        let names: Vec<String> = varied.iter().map(|v| v.name.clone()).collect();
        check_unique(&names, "--vary")?;
        let combinations = varied
            .iter()
            .try_fold(1_usize, |product, v| match &v.values {
                Values::Listed(values) => product.checked_mul(values.len()),
                Values::Drawn(_) => Some(product),
            });
        let count = combinations.and_then(|combinations| combinations.checked_mul(samples));
        let Some(count) = count.filter(|count| *count <= MOST_ROWS) else {
            return Err(Failure::Argument {
                reason: format!("the sweep would have more than {MOST_ROWS} drives"),
                hint: Some("take fewer --samples, or shorter lists and grids".into()),
            });
        };
        let row = |index: usize| {
            let (sample, mut combination) = (index / (count / samples), index % (count / samples));
            let value = |v: &Varied| match &v.values {
                Values::Drawn(distribution) => {
                    distribution.quantile(share(seed, &v.name, sample as u64))
                }
                Values::Listed(values) => {
                    let value = values[combination % values.len()];
                    combination /= values.len();
                    value
                }
            };
            // From the last to the first, so that the last changes fastest.
            let mut values: Vec<f64> = varied.iter().rev().map(value).collect();
            values.reverse();
            Sample {
                index: index as u64,
                values,
            }
        };
        Ok(Self {
            names,
            rows: (0..count).map(row).collect(),
        })
    }

    /// Reads a table: parameters' names in the header, and perhaps the column `index`.
    ///
    /// # Errors
    /// A file that cannot be read, with the line and column of what is wrong.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let text = String::from_utf8(read_file(path, read_bytes)?).map_err(|error| {
            let source = io::Error::new(io::ErrorKind::InvalidData, error.utf8_error());
            Failure::Read {
                path: path.into(),
                source,
            }
        })?;
        // A record is said to begin before the second half of a CR LF.
        let text = text.replace("\r\n", "\n");
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let wrong = |reason: String| Failure::Argument {
            reason: format!("{}{reason}", path.display()),
            hint: Some("`ugv sweep --vary ... --samples-only` writes tables that are right".into()),
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
            let mut sample = Sample {
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
            return Err(wrong(": there is no row below the header".into()));
        }
        let names = header.into_iter().filter(|name| name != INDEX).collect();
        Ok(Self { names, rows })
    }

    /// The header's cells, as they begin each table.
    pub fn header(&self) -> String {
        let names = self.names.iter().map(|name| format!(",{name}"));
        INDEX.to_owned() + &names.collect::<String>()
    }

    /// Writes the table by itself.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "{}", self.header())?;
        for sample in &self.rows {
            sample.write(out)?;
            writeln!(out)?;
        }
        Ok(())
    }
}

impl Sample {
    /// Writes the cells; the numbers read back to the last bit.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        write!(out, "{}", self.index)?;
        self.values
            .iter()
            .try_for_each(|value| write!(out, ",{:?}", value + 0.0))
    }
}

/// The line, from 1, of the first that is not empty from some byte on.
fn line_from(text: &str, start: usize) -> usize {
    let (before, rest) = text.split_at(start);
    let skipped = rest.len() - rest.trim_start_matches('\n').len();
    1 + skipped + before.matches('\n').count()
}

fn check_unique(names: &[String], place: &str) -> Result<(), Failure> {
    let mut known = HashSet::new();
    match names.iter().find(|name| !known.insert(*name)) {
        Some(name) => Err(Failure::Argument {
            reason: format!("{place} names {} twice", shortened(name)),
            hint: None,
        }),
        None => Ok(()),
    }
}

/// A number between 0 and 1, both excluded, of a stream that is named: SplitMix64 (Steele, Lea and
/// Flood 2014), whose n-th number is a hash of n.
fn share(seed: u64, name: &str, index: u64) -> f64 {
    const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;
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

    fn draw(words: &[&str], samples: usize, seed: u64) -> Samples {
        let varied: Vec<Varied> = words.iter().map(|word| word.parse().unwrap()).collect();
        Samples::draw(&varied, samples, seed).unwrap()
    }

    fn column(samples: &Samples, name: &str) -> Vec<f64> {
        let at = samples.names.iter().position(|n| n == name).unwrap();
        samples.rows.iter().map(|row| row.values[at]).collect()
    }

    #[test]
    fn the_stream_is_splitmix64() {
        // Its first numbers from 1234567, of the reference implementation.
        const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;
        let stream = |n: u64| mix(1_234_567_u64.wrapping_add(GAMMA.wrapping_mul(n)));
        assert_eq!(stream(1), 6_457_827_717_110_365_317);
        assert_eq!(stream(2), 3_203_168_211_198_807_973);
    }

    #[test]
    fn a_number_depends_on_seed_name_and_sample_alone() {
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
