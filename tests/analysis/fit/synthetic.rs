//! Recordings made with the model itself.

use fastrand::Rng;
use ugv_terrain::fit::catalogue::{describe, find};
use ugv_terrain::fit::exact::ExactPredictor;
use ugv_terrain::fit::sensor::SensorParameter;
use ugv_terrain::fit::{Fit, FitError, Options, fit};
use ugv_terrain::recording::{Channel, Recording, Run, Series};
use ugv_terrain::simulation::{Simulation, WheelSpeeds};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{ModelParameter, Specification, Vehicle, VehicleModel};

/// A four-wheeled vehicle: half the work of the paper's.
pub fn vehicle() -> Vehicle {
    Vehicle {
        mass: 470.0,
        yaw_inertia: 165.0,
        wheel_radius: 0.3,
        row_positions: vec![0.457, -0.457],
        half_track: 0.568,
        com_offset: 0.0,
        com_height: 0.45,
        ..Vehicle::tran2007()
    }
}

pub fn nominal(terrain: &str) -> Specification {
    Specification::plain(vehicle(), Terrain::preset(terrain).unwrap())
}

/// What the sensors do to the truth.
#[derive(Debug, Clone, Copy)]
pub struct Sensors {
    pub seed: u64,
    pub pose_latency: f64,
    pub wheel_latency: f64,
    pub yaw_rate_bias: f64,
    /// Where the pose is told, ahead and to the left of the centre of mass.
    pub lever_arm: [f64; 2],
    /// Standard deviations of white noise: position, heading, yaw rate.
    pub white: [f64; 3],
    /// The same of coloured noise, correlated over 0.5 s.
    pub coloured: [f64; 3],
    /// Share of samples that are off by some ten standard deviations.
    pub outliers: f64,
    /// Share of samples that are missing.
    pub missing: f64,
}

pub const QUIET: Sensors = Sensors {
    seed: 1,
    pose_latency: 0.0,
    wheel_latency: 0.0,
    yaw_rate_bias: 0.0,
    lever_arm: [0.0; 2],
    white: [0.01, 0.003, 0.005],
    coloured: [0.0; 3],
    outliers: 0.0,
    missing: 0.0,
};

const CORRELATION: f64 = 0.5;

/// Speeds that change every 1.5 s: arcs of many radii, pivots and reversing among them.
fn wheel_speeds(seconds: f64) -> Vec<(f64, f64, f64)> {
    const LEGS: [(f64, f64); 10] = [
        (4.0, 4.0),
        (6.0, 3.0),
        (2.0, 6.0),
        (8.0, 8.0),
        (3.0, -2.0),
        (5.0, 7.0),
        (-3.0, -4.0),
        (1.0, 5.0),
        (9.0, 6.0),
        (4.0, 1.0),
    ];
    let count = (seconds / 0.25) as usize;
    let at = |leg: usize| LEGS[leg % LEGS.len()];
    let row = |k: usize| {
        let time = 0.25 * k as f64;
        let leg = (time / 1.5) as usize;
        let share = ((time - 1.5 * leg as f64) / 0.75).min(1.0);
        let (from, to) = (at(leg), at(leg + 1));
        let mix = |a: f64, b: f64| a + share * (b - a);
        (time, mix(from.0, to.0), mix(from.1, to.1))
    };
    (0..=count).map(row).collect()
}

struct Noise {
    rng: Rng,
}

impl Noise {
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.rng.f64()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.rng.f64()).cos()
    }

    /// Samples of a channel, disturbed.
    fn disturb(&mut self, truth: &[(f64, f64)], late: f64, which: usize, by: &Sensors) -> Series {
        let mut coloured = self.normal() * by.coloured[which];
        let mut last = truth[0].0;
        let mut samples = Vec::new();
        for &(time, value) in truth {
            let decay = (-(time - last) / CORRELATION).exp();
            last = time;
            let fresh = self.normal() * by.coloured[which] * (1.0 - decay * decay).sqrt();
            coloured = coloured * decay + fresh;
            let mut white = self.normal() * by.white[which];
            if self.rng.f64() < by.outliers {
                white += 15.0 * by.white[which] * if self.rng.bool() { 1.0 } else { -1.0 };
            }
            if self.rng.f64() >= by.missing {
                samples.push((time + late, value + coloured + white));
            }
        }
        samples.into_iter().collect()
    }
}

/// Drives for some seconds and records: pose at 10 Hz, yaw rate at 20 Hz.
pub fn record(truth: &Specification, seconds: f64, by: &Sensors) -> Recording {
    let model = VehicleModel::from_specification(truth).unwrap();
    let mut simulation = Simulation::new(model);
    let rows = wheel_speeds(seconds);
    let mut poses = [Vec::new(), Vec::new(), Vec::new()];
    let mut yaw_rates = Vec::new();
    for pair in rows.windows(2) {
        let ((t0, l0, r0), (t1, l1, r1)) = (pair[0], pair[1]);
        let rates = WheelSpeeds::from([(l1 - l0) / (t1 - t0), (r1 - r0) / (t1 - t0)]);
        for part in 0..5 {
            let time = t0 + 0.05 * f64::from(part);
            let speeds = WheelSpeeds::from([l0, r0]).after(rates, time - t0);
            simulation.set_wheel_speeds(speeds).unwrap();
            simulation.set_wheel_accelerations(rates).unwrap();
            let state = simulation.state();
            yaw_rates.push((time, state.yaw_rate + by.yaw_rate_bias));
            if yaw_rates.len() % 2 == 1 {
                let (sin, cos) = state.heading.sin_cos();
                let [ahead, left] = by.lever_arm;
                let x = state.x + cos * ahead - sin * left;
                let y = state.y + sin * ahead + cos * left;
                for (list, value) in poses.iter_mut().zip([x, y, state.heading]) {
                    list.push((time, value));
                }
            }
            simulation.step(0.05).unwrap();
        }
    }
    let mut noise = Noise {
        rng: Rng::with_seed(by.seed),
    };
    let wheels = |pick: fn(&(f64, f64, f64)) -> f64| -> Series {
        rows.iter()
            .map(|row| (row.0 + by.wheel_latency, pick(row)))
            .collect()
    };
    let late = by.pose_latency;
    let run = Run::new("")
        .with(Channel::OmegaLeft, wheels(|row| row.1))
        .with(Channel::OmegaRight, wheels(|row| row.2))
        .with(Channel::X, noise.disturb(&poses[0], late, 0, by))
        .with(Channel::Y, noise.disturb(&poses[1], late, 0, by))
        .with(Channel::Heading, noise.disturb(&poses[2], late, 1, by))
        .with(Channel::YawRate, noise.disturb(&yaw_rates, 0.0, 2, by));
    Recording {
        name: "drive".into(),
        runs: vec![run],
        ..Recording::default()
    }
}

/// Fits the named parameters, beginning at a model.
pub fn fitted(
    begin: &Specification,
    free: &[&str],
    recordings: &[Recording],
    options: &Options,
) -> Result<Fit, FitError> {
    let free: Vec<ModelParameter> = free.iter().map(|name| find(name).unwrap()).collect();
    let predictor = ExactPredictor::new(begin.clone(), free.clone());
    let parameters = free.iter().map(|p| describe(*p, begin)).collect();
    let values: Vec<f64> = free.iter().map(|p| p.get(begin)).collect();
    fit(
        &predictor,
        parameters,
        &values,
        recordings,
        options,
        &|_| {},
    )
}

/// Options without random starts.
pub fn plain() -> Options {
    Options {
        starts: 0,
        ..Options::default()
    }
}

/// True values of a fit's parameters.
pub fn truths(fit: &Fit, truth: &Specification, by: &Sensors) -> Vec<f64> {
    let value = |name: &str| {
        let sensor = name.strip_prefix("drive.").map(SensorParameter::parse);
        match sensor {
            Some(Ok(SensorParameter::PoseLatency)) => by.pose_latency,
            Some(Ok(SensorParameter::WheelLatency)) => by.wheel_latency,
            Some(Ok(SensorParameter::YawRateBias)) => by.yaw_rate_bias,
            Some(Ok(SensorParameter::LeverArmX)) => by.lever_arm[0],
            Some(Ok(SensorParameter::LeverArmY)) => by.lever_arm[1],
            Some(_) => 0.0,
            None => find(name).unwrap().get(truth),
        }
    };
    fit.estimates
        .iter()
        .map(|e| value(&e.parameter.name))
        .collect()
}
