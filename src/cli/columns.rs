//! Columns of CSV files that the user names.

use ugv_terrain::recording::ColumnRequest;

/// Columns of another name or unit.
#[derive(clap::Args)]
pub struct ColumnArgs {
    /// A column of another name or unit, such as omega_left=wl:rpm or heading=yaw:deg; repeatable.
    /// A mean of columns: omega_left=fl+rl. The third column of a file without header: x=#3
    #[arg(long = "column", value_name = "NAME=COLUMN[:UNIT]")]
    pub columns: Vec<ColumnRequest>,
}
