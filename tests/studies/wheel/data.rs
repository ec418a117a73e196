//! The measured wheel: trials in sand, and plates pressed into the same sand.

use std::path::PathBuf;

/// Wheel radius and width \[m\], smooth or to the foot of the grousers.
pub const RADIUS: f64 = 0.058;
pub const WIDTH: f64 = 0.050;

/// One trial in steady state.
#[derive(Debug, Clone)]
pub struct Trial {
    /// Whether the wheel has grousers of 5 mm.
    pub grouser: bool,
    /// Slip angle between the wheel's plane and its travel: as set \[deg\], as measured \[rad\].
    pub beta_deg: f64,
    pub beta: f64,
    /// Speed of travel, in all \[m/s\].
    pub speed: f64,
    /// \[rad/s\].
    pub omega: f64,
    /// (r omega - v) / max(r omega, v).
    pub slip: f64,
    /// Force along the wheel, across it, and load \[N\].
    pub traction: f64,
    pub side: f64,
    pub load: f64,
    /// \[m\].
    pub sinkage: f64,
}

/// What was set: whether with grousers, slip angle \[deg\], slip in tenths.
pub type Condition = (bool, i32, i32);

impl Trial {
    pub fn condition(&self) -> Condition {
        (
            self.grouser,
            self.beta_deg as i32,
            (self.slip * 10.0).round() as i32,
        )
    }

    /// Traction and side force \[N\], sinkage \[m\].
    pub fn measured(&self) -> [f64; 3] {
        [self.traction, self.side, self.sinkage]
    }

    /// Speed of the wheel's centre along the wheel and across it \[m/s\].
    pub fn velocity(&self) -> (f64, f64) {
        let (sin, cos) = self.beta.sin_cos();
        (self.speed * cos, self.speed * sin)
    }
}

/// Trials, plates and where they came from.
pub struct Data {
    pub trials: Vec<Trial>,
    pub plates: Vec<Plate>,
}

/// The pressure p = k z^n under a round plate.
#[derive(Debug, Clone, Copy)]
pub struct Plate {
    /// \[m\].
    pub diameter: f64,
    pub exponent: f64,
    /// k \[Pa/m^n\].
    pub modulus: f64,
}

/// Where the measured wheel is: `UGV_DATA`, or beside the project.
fn folder() -> PathBuf {
    let data =
        std::env::var_os("UGV_DATA").map_or_else(|| PathBuf::from("../shared/data"), PathBuf::from);
    data.join("single_wheel")
}

impl Data {
    /// The measured wheel, or why it is not there.
    pub fn read() -> Result<Self, String> {
        let trials = rows("wheel_trials.csv", |row| {
            Ok(Trial {
                grouser: row.text("wheel")? == "grouser",
                beta_deg: row.number("beta_deg")?,
                beta: row.number("angle_meas_deg")?.to_radians(),
                speed: row.number("travel_speed_m_s")?,
                omega: row.number("omega_rad_s")?,
                slip: row.number("slip")?,
                traction: row.number("F_tractive_N")?,
                side: row.number("F_side_N")?,
                load: row.number("F_load_N")?,
                sinkage: row.number("sinkage_m")?,
            })
        })?;
        let plates = rows("plate_fits.csv", |row| {
            let plate = Plate {
                diameter: row.number("diameter_m")?,
                exponent: row.number("n")?,
                modulus: 1e3 * row.number("k_kPa_per_m_n")?,
            };
            Ok((row.text("shape")? == "plate").then_some(plate))
        })?;
        Ok(Self {
            trials,
            plates: plates.into_iter().flatten().collect(),
        })
    }

    /// Whole conditions of the trials, so that no repeat of what is judged was fitted: of slip
    /// angles, slips and wheels in order every other one, like the white fields of a chessboard.
    pub fn half(&self, second: bool) -> Vec<Trial> {
        let mut slips: Vec<i32> = self
            .trials
            .iter()
            .map(|trial| trial.condition().2)
            .collect();
        slips.sort_unstable();
        slips.dedup();
        let is_second = |trial: &Trial| {
            let (grouser, beta, slip) = trial.condition();
            let place = slips.iter().position(|&other| other == slip).unwrap_or(0);
            (place + beta as usize / 15 + usize::from(grouser)) % 2 == 1
        };
        self.trials
            .iter()
            .filter(|trial| is_second(trial) == second)
            .cloned()
            .collect()
    }
}

/// Standard deviation between trials of one condition: traction and side force \[N\], sinkage \[m\].
pub fn scatter(trials: &[Trial]) -> [f64; 3] {
    let mut conditions: Vec<Condition> = trials.iter().map(Trial::condition).collect();
    conditions.sort_unstable();
    conditions.dedup();
    let (mut sums, mut freedom) = ([0.0; 3], 0.0);
    for condition in conditions {
        let alike: Vec<[f64; 3]> = trials
            .iter()
            .filter(|trial| trial.condition() == condition)
            .map(Trial::measured)
            .collect();
        let count = alike.len() as f64;
        freedom += count - 1.0;
        for output in 0..3 {
            let mean = alike.iter().map(|values| values[output]).sum::<f64>() / count;
            sums[output] += alike
                .iter()
                .map(|values| (values[output] - mean).powi(2))
                .sum::<f64>();
        }
    }
    sums.map(|sum| (sum / freedom).sqrt())
}

struct Row<'r> {
    names: &'r csv::StringRecord,
    cells: csv::StringRecord,
    file: &'r str,
}

impl Row<'_> {
    fn text(&self, name: &str) -> Result<&str, String> {
        let column = self.names.iter().position(|other| other == name);
        let cell = column.and_then(|column| self.cells.get(column));
        cell.ok_or_else(|| format!("{}: no column {name}", self.file))
    }

    fn number(&self, name: &str) -> Result<f64, String> {
        let text = self.text(name)?;
        let line = self.cells.position().map_or(0, csv::Position::line);
        text.parse()
            .map_err(|_| format!("{}:{line}: {name} is '{text}', not a number", self.file))
    }
}

fn rows<T>(file: &str, read: impl Fn(&Row) -> Result<T, String>) -> Result<Vec<T>, String> {
    let path = folder().join(file);
    let fail = |error: csv::Error| format!("{}: {error}", path.display());
    let mut reader = csv::Reader::from_path(&path).map_err(fail)?;
    let names = reader.headers().map_err(fail)?.clone();
    reader
        .records()
        .map(|cells| {
            read(&Row {
                names: &names,
                cells: cells.map_err(fail)?,
                file,
            })
        })
        .collect()
}
