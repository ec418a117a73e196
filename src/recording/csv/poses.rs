//! Poses from CSV: the course over which a vehicle came to where a drive begins.

use super::error::CsvError;
use super::table::{Column, read_bytes, read_table};
use std::io::Read;

const COLUMNS: [Column; 3] = [column("x", "m"), column("y", "m"), column("heading", "rad")];

const fn column(name: &'static str, unit: &'static str) -> Column {
    Column {
        name,
        unit,
        is_required: true,
    }
}

/// Reads poses x, y \[m\] and heading \[rad\], a row each. `file` names it in errors.
///
/// # Errors
/// The first thing that makes the text none, with its line and column; a table without any row.
pub fn read_poses(file: &str, input: impl Read) -> Result<Vec<[f64; 3]>, CsvError> {
    let bytes = read_bytes(file, input)?;
    let mut poses = Vec::new();
    let header = read_table(file, &bytes, &COLUMNS, |row| {
        let [x, y, heading] = [0, 1, 2].map(|index| row.required_number(index));
        poses.push([x?, y?, heading?]);
        Ok(())
    })?;
    if poses.is_empty() {
        return Err(header.no_rows(0));
    }
    Ok(poses)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_are_read_or_refused_with_their_place() {
        let read = |text: &str| read_poses("course.csv", text.as_bytes());
        let text = "time,heading,y,x\n0,0.1,2,1\n1,0.2,4,3\n";
        assert_eq!(read(text).unwrap(), [[1.0, 2.0, 0.1], [3.0, 4.0, 0.2]]);
        for (text, expected) in [
            ("x,y\n1,2\n", "heading"),
            (
                "x,y,heading\n1,,0\n",
                "line 2, column 2 (y): found an empty cell",
            ),
            ("x,y,heading\n", "at least one row"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
