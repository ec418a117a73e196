//! How much of what is left out shows in a recording, and how much after the soil is re-tuned.

use super::manoeuvres::STEP;
use super::random::Random;
use super::sensors::{Row, Sensors};
use super::world::Track;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use ugv_terrain::effects::Effects;
use ugv_terrain::simulation::{Simulation, State, WheelSpeeds};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Vehicle, VehicleModel};

/// Distance of the paper's model from the drive in standard deviations of the noise, over windows
/// with free starts: the root of the sum of squares of the whitened differences. 8 is eight
/// times what one degree of freedom of the noise amounts to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Signal {
    /// With the true soil.
    pub raw: f64,
    /// With the soil that comes closest, in linear approximation under its prior.
    pub left: f64,
}

/// Commands in a window: 5 s.
const WINDOW: usize = 100;
/// Poses in a window.
const POSES: usize = WINDOW / 2;
/// Rows of a window: x, y, heading, and twice as many yaw rates.
const ROWS: usize = 3 * POSES + WINDOW;
/// What is believed of the soil: standard deviations of logarithms, of the angle in radians.
const PRIOR: [f64; Terrain::COUNT] = [0.5, 0.08, 0.5, 0.5, 0.15, 0.5];
/// Step of differences, in those.
const DIFFERENCE: f64 = 0.02;

/// The signal in a drive on which the sensors have these faults.
pub fn signal(
    vehicle: &Vehicle,
    terrain: Terrain,
    track: &Track,
    sensors: &Sensors,
    faults: &Effects,
) -> Signal {
    let quiet = Sensors::quiet().record(track, faults, &mut Random::new(0, "quiet"));
    let models: Vec<VehicleModel> = (0..=Terrain::COUNT)
        .filter_map(|which| VehicleModel::new(vehicle.clone(), tuned(terrain, which)).ok())
        .collect();
    let whitening = Whitening::new(sensors);
    let mut sums = Sums::default();
    for first in (0..quiet.len().saturating_sub(WINDOW)).step_by(WINDOW) {
        let rows = &quiet[first..first + WINDOW];
        let start = track.at(first as f64 * STEP);
        let paths: Option<Vec<Vec<State>>> = models
            .iter()
            .map(|model| path(model, start, rows))
            .collect();
        if let Some(paths) = paths {
            sums.add(&whitening, rows, &paths);
        }
    }
    sums.signal()
}

/// The soil with one parameter changed by a share of its deviation; 0 changes none.
fn tuned(terrain: Terrain, which: usize) -> Terrain {
    let mut soil = terrain;
    let change = |k: usize| DIFFERENCE * PRIOR[k];
    match which {
        1 => soil.cohesion *= change(0).exp(),
        2 => soil.friction_angle += change(1),
        3 => soil.cohesive_modulus *= change(2).exp(),
        4 => soil.frictional_modulus *= change(3).exp(),
        5 => soil.sinkage_exponent *= change(4).exp(),
        6 => soil.shear_modulus *= change(5).exp(),
        _ => {}
    }
    soil
}

/// States of a model at the rows of a window.
fn path(model: &VehicleModel, start: State, rows: &[Row]) -> Option<Vec<State>> {
    let mut simulation = Simulation::new(model.clone());
    simulation.set_state(start).ok()?;
    let mut states = Vec::with_capacity(rows.len());
    for (k, row) in rows.iter().enumerate() {
        states.push(simulation.state());
        let next = rows.get(k + 1).unwrap_or(row).wheels;
        let rates = [0, 1].map(|side| (next[side] - row.wheels[side]) / STEP);
        simulation
            .set_wheel_speeds(WheelSpeeds::from(row.wheels))
            .ok()?;
        simulation
            .set_wheel_accelerations(WheelSpeeds::from(rates))
            .ok()?;
        simulation.step(STEP).ok()?;
    }
    Some(states)
}

/// Square roots of the noise's covariances within a window.
struct Whitening {
    position: Cholesky<f64, Dyn>,
    heading: Cholesky<f64, Dyn>,
    yaw_rate: f64,
}

impl Whitening {
    fn new(sensors: &Sensors) -> Self {
        Self {
            position: root(sensors.position),
            heading: root(sensors.heading),
            yaw_rate: sensors.yaw_rate,
        }
    }

    /// Differences of a window's channels in terms of independent noise.
    fn apply(&self, column: &DVector<f64>) -> DVector<f64> {
        let part = |k: usize| column.rows(k * POSES, POSES).into_owned();
        let lower = |root: &Cholesky<f64, Dyn>, part: DVector<f64>| {
            root.l().solve_lower_triangular(&part).unwrap_or(part)
        };
        let mut white = DVector::zeros(ROWS);
        for (k, root) in [&self.position, &self.position, &self.heading]
            .into_iter()
            .enumerate()
        {
            white
                .rows_mut(k * POSES, POSES)
                .copy_from(&lower(root, part(k)));
        }
        let rates = column.rows(3 * POSES, WINDOW) / self.yaw_rate;
        white.rows_mut(3 * POSES, WINDOW).copy_from(&rates);
        white
    }
}

fn root([white, coloured, time]: [f64; 3]) -> Cholesky<f64, Dyn> {
    let covariance = DMatrix::from_fn(POSES, POSES, |i, j| {
        let apart = 2.0 * STEP * i.abs_diff(j) as f64;
        let same = if i == j { white * white } else { 0.0 };
        same + coloured * coloured * (-apart / time).exp()
    });
    covariance.cholesky().expect("white noise is positive")
}

/// A window's channels in a column.
fn column(pick: impl Fn(usize) -> [f64; 4]) -> DVector<f64> {
    let mut column = DVector::zeros(ROWS);
    for k in 0..WINDOW {
        let [x, y, heading, yaw_rate] = pick(k);
        if k.is_multiple_of(2) {
            for (channel, value) in [x, y, heading].into_iter().enumerate() {
                column[channel * POSES + k / 2] = value;
            }
        }
        column[3 * POSES + k] = yaw_rate;
    }
    column
}

fn channels(state: &State) -> [f64; 4] {
    [state.x, state.y, state.heading, state.yaw_rate]
}

/// Normal equations of the soil, starts eliminated.
#[derive(Default)]
struct Sums {
    squares: f64,
    gradient: [f64; Terrain::COUNT],
    matrix: [[f64; Terrain::COUNT]; Terrain::COUNT],
}

impl Sums {
    fn add(&mut self, whitening: &Whitening, rows: &[Row], paths: &[Vec<State>]) {
        let base = &paths[0];
        let measured = |k: usize| {
            let [x, y] = rows[k].position.unwrap_or_default();
            [x, y, rows[k].heading.unwrap_or_default(), rows[k].yaw_rate]
        };
        let minus = |a: [f64; 4], b: [f64; 4]| [0, 1, 2, 3].map(|c| a[c] - b[c]);
        let mut columns = vec![column(|k| minus(measured(k), channels(&base[k])))];
        for path in &paths[1..] {
            let change = |k: usize| minus(channels(&path[k]), channels(&base[k]));
            columns.push(column(|k| change(k).map(|value| value / DIFFERENCE)));
        }
        let turned = |k: usize| [-(base[k].y - base[0].y), base[k].x - base[0].x, 1.0, 0.0];
        // Free of each start: position and heading.
        let free = [
            column(|_| [1.0, 0.0, 0.0, 0.0]),
            column(|_| [0.0, 1.0, 0.0, 0.0]),
            column(turned),
        ];
        let white = free.map(|column| whitening.apply(&column));
        let starts: DMatrix<f64> = DMatrix::from_columns(&white);
        let basis = starts.qr().q();
        let columns: Vec<DVector<f64>> = columns
            .iter()
            .map(|column| {
                let white = whitening.apply(column);
                &white - &basis * (basis.transpose() * &white)
            })
            .collect();
        self.squares += columns[0].norm_squared();
        for (i, one) in columns[1..].iter().enumerate() {
            self.gradient[i] += one.dot(&columns[0]);
            for (j, other) in columns[1..].iter().enumerate() {
                self.matrix[i][j] += one.dot(other);
            }
        }
    }

    fn signal(&self) -> Signal {
        let count = Terrain::COUNT;
        let information = DMatrix::from_fn(count, count, |i, j| {
            self.matrix[i][j] + if i == j { 1.0 } else { 0.0 }
        });
        let gradient = DVector::from_row_slice(&self.gradient);
        let explained = information
            .cholesky()
            .map_or(0.0, |root| gradient.dot(&root.solve(&gradient)));
        Signal {
            raw: self.squares.sqrt(),
            left: (self.squares - explained).max(0.0).sqrt(),
        }
    }
}
