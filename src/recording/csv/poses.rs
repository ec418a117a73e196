//! Poses from CSV: the path that a vehicle has driven before the start of a drive.

use super::error::CsvError;
use super::request::TableOptions;
use super::table::{ColumnSpec, read_bytes, read_table};
use super::unit::Quantity;
use std::io::Read;

const COLUMNS: [ColumnSpec; 3] = [
    ColumnSpec::required("x", "m", Quantity::Length),
    ColumnSpec::required("y", "m", Quantity::Length),
    ColumnSpec::required("heading", "rad", Quantity::Angle),
];

/// Reads poses x, y \[m\] and heading \[rad\], a row each. `file` names it in errors.
///
/// # Errors
/// The first malformed cell with its line and column, and a table without rows.
pub fn read_poses(file: &str, input: impl Read) -> Result<Vec<[f64; 3]>, CsvError> {
    let bytes = read_bytes(file, input)?;
    let mut poses = Vec::new();
    let header = read_table(file, &bytes, &COLUMNS, &TableOptions::default(), |row| {
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
