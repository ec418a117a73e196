//! How much of what is left out shows in a recording, and how much after the soil is re-tuned.

use super::manoeuvres::STEP;
use super::random::Random;
use super::sensors::{Row, Sensors};
use super::world::Track;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SMatrix, SVector};
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
    /// With the soil that comes closest under its prior.
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

/// Steps to the soil that comes closest, at most; and when these have arrived.
const STEPS: usize = 8;
const ENOUGH: f64 = 0.02;
/// Shares of a step that are tried.
const SHARES: [f64; 4] = [1.0, 0.5, 0.25, 0.1];

/// A drive as sensors without noise see it.
pub struct Seen<'a> {
    vehicle: &'a Vehicle,
    terrain: Terrain,
    track: &'a Track,
    rows: Vec<Row>,
    whitening: Whitening,
}

impl<'a> Seen<'a> {
    /// A drive of a vehicle on its true soil, on which the sensors have these faults.
    pub fn new(
        vehicle: &'a Vehicle,
        terrain: Terrain,
        track: &'a Track,
        sensors: &Sensors,
        faults: &Effects,
    ) -> Self {
        Self {
            rows: Sensors::quiet().record(track, faults, &mut Random::new(0, "quiet")),
            whitening: Whitening::new(sensors),
            vehicle,
            terrain,
            track,
        }
    }

    /// The signal, by one step to the soil that comes closest.
    pub fn signal(&self) -> Signal {
        self.sums(&Offsets::zeros()).signal(&Offsets::zeros())
    }

    /// What is left of a signal by as many steps as it takes: soils are not linear, and a signal of
    /// hundreds may vanish all but wholly.
    pub fn left(&self) -> f64 {
        let mut at = Offsets::zeros();
        let mut sums = self.sums(&at);
        let cost = |sums: &Sums, at: &Offsets| sums.squares + at.norm_squared();
        for _ in 0..STEPS {
            let before = cost(&sums, &at);
            let step = sums.step(&at);
            let shorter = SHARES.into_iter().map(|share| at + step * share);
            let mut tried = shorter.map(|there| (self.sums(&there), there));
            // A soil on which some windows cannot be driven comes close to the others only.
            let better =
                tried.find(|(new, there)| new.windows >= sums.windows && cost(new, there) < before);
            let Some((new, there)) = better else { break };
            (sums, at) = (new, there);
            if cost(&sums, &at) > (1.0 - ENOUGH) * before {
                break;
            }
        }
        sums.signal(&at).left
    }

    /// Normal equations around a soil.
    fn sums(&self, at: &Offsets) -> Sums {
        let models: Vec<VehicleModel> = (0..=Terrain::COUNT)
            .filter_map(|which| {
                let mut offsets = *at;
                if which > 0 {
                    offsets[which - 1] += DIFFERENCE;
                }
                VehicleModel::new(self.vehicle.clone(), fit(self.terrain, &offsets)).ok()
            })
            .collect();
        let mut sums = Sums::default();
        if models.len() <= Terrain::COUNT {
            return sums;
        }
        for first in (0..self.rows.len().saturating_sub(WINDOW)).step_by(WINDOW) {
            let rows = &self.rows[first..first + WINDOW];
            let start = self.track.at(first as f64 * STEP);
            let paths: Option<Vec<Vec<State>>> = models
                .iter()
                .map(|model| path(model, start, rows))
                .collect();
            if let Some(paths) = paths {
                sums.add(&self.whitening, rows, &paths);
            }
        }
        sums
    }
}

/// How far a soil is from the true one, in [`PRIOR`]s.
type Offsets = SVector<f64, { Terrain::COUNT }>;

/// The soil at some offsets.
fn fit(terrain: Terrain, offsets: &Offsets) -> Terrain {
    let change = |k: usize| offsets[k] * PRIOR[k];
    Terrain {
        cohesion: terrain.cohesion * change(0).exp(),
        friction_angle: terrain.friction_angle + change(1),
        cohesive_modulus: terrain.cohesive_modulus * change(2).exp(),
        frictional_modulus: terrain.frictional_modulus * change(3).exp(),
        sinkage_exponent: terrain.sinkage_exponent * change(4).exp(),
        shear_modulus: terrain.shear_modulus * change(5).exp(),
    }
}

/// Steps of the integrator in a window; on a soil on which the vehicle can hardly drive there is no end of them.
const MOST_STEPS: u64 = 1500;

/// States of a model at the rows of a window.
fn path(model: &VehicleModel, start: State, rows: &[Row]) -> Option<Vec<State>> {
    let mut simulation = Simulation::new(model.clone());
    simulation.limit_steps(MOST_STEPS);
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
    windows: usize,
    squares: f64,
    gradient: Offsets,
    matrix: SMatrix<f64, { Terrain::COUNT }, { Terrain::COUNT }>,
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
        self.windows += 1;
        self.squares += columns[0].norm_squared();
        for (i, one) in columns[1..].iter().enumerate() {
            self.gradient[i] += one.dot(&columns[0]);
            for (j, other) in columns[1..].iter().enumerate() {
                self.matrix[(i, j)] += one.dot(other);
            }
        }
    }

    /// Towards the soil that comes closest under its prior, in linear approximation.
    fn step(&self, at: &Offsets) -> Offsets {
        let information = self.matrix + SMatrix::identity();
        let root = information.cholesky();
        root.map_or(Offsets::zeros(), |root| root.solve(&(self.gradient - at)))
    }

    fn signal(&self, at: &Offsets) -> Signal {
        let explained = (self.gradient - at).dot(&self.step(at));
        let left = self.squares + at.norm_squared() - explained;
        Signal {
            raw: self.squares.sqrt(),
            left: left.max(0.0).sqrt(),
        }
    }
}
