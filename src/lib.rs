//! Wheel–terrain model of a skid-steer UGV: wheel speeds in; pose, velocities, slips, rolling
//! resistance and turning moment out.
//!
//! After T. H. Tran, N. M. Kwok, S. Scheding, Q. P. Ha, "Dynamic Modelling of Wheel-Terrain
//! Interaction of a UGV", IEEE CASE 2007, whose equations are cited by number: Bekker pressure,
//! Janosi shear integrated over each wheel's contact, load transfer, planar vehicle motion;
//! defined also where the paper is silent: at rest, in reverse, in pivot turns, for lifted wheels.
//!
//! ```
//! use ugv_terrain::simulation::{Simulation, WheelSpeeds};
//! use ugv_terrain::terrain::Terrain;
//! use ugv_terrain::vehicle::{Vehicle, VehicleModel};
//!
//! let sand = Terrain::preset("dry_sand").expect("one of the paper's terrains");
//! let model = VehicleModel::new(Vehicle::tran2007(), sand)?;
//! let mut drive = Simulation::new(model);
//! drive.set_wheel_speeds(WheelSpeeds { left: 8.0, right: 6.0 })?;
//! drive.step(2.0)?;
//! let state = drive.state();
//! assert!(state.x > 1.0 && state.heading < 0.0);
//! println!("rolling resistance {:.0} N", drive.wrench()?.rolling_resistance);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Layers
//! Dependencies point one way: [`terrain`] to [`contact`] (one wheel) to [`vehicle`] (all
//! wheels in balance) to [`simulation`] (motion in time) to the FMU's C interface, which is built
//! with the feature `fmu`. [`effects`] are what the paper leaves out; contact and vehicle use them.
//! [`recording`] stands beside them, and knows of vehicles and terrains only how they are described;
//! `import` makes recordings from robots' logs, [`inspection`] looks at one, `report` shows what
//! it saw, [`identification`] judges models by them, `fit` fits models to them (`fit::fit_model`), and `diagnosis` says
//! what physics a model left out (`diagnosis::diagnose`). Everything inside
//! is SI and radians; frames and signs are stated in [`vehicle`].
//!
//! # Equations of the paper
//! Files are in `src/`.
//!
//! | equation | where it is evaluated |
//! |---|---|
//! | (1) pressure and sinkage | k in [`terrain::Terrain::sinkage_modulus`]; k z^n in `contact/patch.rs`, `column` |
//! | (2) sinkage of a rim point | `contact/patch.rs`, `column`; of the lowest one `vehicle/wrench.rs`, `set_contact` |
//! | (3), (5) normal stress in front and behind | `contact/patch.rs`, `column` |
//! | (4) normal stress behind, exit angle not 0 | `contact/patch.rs` |
//! | (6) shear stress | `contact/patch.rs`: strength in `column`, mobilised share in `accumulate` |
//! | (7) wheel centres | [`vehicle::Vehicle::wheel_centre`] |
//! | (8) place of a rim point | `contact/patch.rs`, `column`; lever in [`contact::WheelForces::arc_moment`] |
//! | (9) motion of the vehicle | a definition: [`vehicle::Motion`] |
//! | (10) velocity of a wheel centre | `vehicle/model.rs`, `wheel_motion` |
//! | (11), (12) velocity of a rim point, slip velocity | `contact/patch.rs`, `accumulate` |
//! | (13) slips | `vehicle/model.rs`, `set_slips` |
//! | (14), (15) shear displacement | `contact/patch.rs`, `accumulate` |
//! | (16), (17) components of the stresses | `contact/patch.rs`, `accumulate` and `integrate` |
//! | (18) forces of a wheel | `contact/wheel.rs`, `forces` of the sums over the patch |
//! | (19), (20), (21), (24), (25) of the vehicle | `vehicle/wrench.rs`, `sum` |
//! | (22) load balance of a wheel | `vehicle/balance.rs`, `advance`; solved in `vehicle/newton.rs` |
//! | (23) rolling moments | replaced by (26), as in the paper |
//! | (26), (27), (28) loads | `vehicle/loads.rs` |
//!
//! # Glossary
//! - *absorbed fraction*: share of the signal power of an effect that a refit of the soil imitates.
//! - *accepted effect*: a candidate that the search keeps in the model.
//! - *balance*: entry angles and accelerations at which every wheel carries its load.
//! - *candidate*: an effect, a sensor fault or an empirical residual model that may be missing.
//! - *candidate parameter*, or *coefficient*: a number of a candidate, in a coordinate that is 0 where it is off.
//! - *colocated*: acting in the same seconds, or in the same place.
//! - *effect*: physics that the paper leaves out, or a sensor fault; all are in [`effects::CATALOGUE`].
//! - *empirical residual model*: a force or moment as a sum of dimensionless features of the motion.
//! - *entry angle* theta_1: angle at which the rim meets the soil, from the wheel's lowest point.
//! - *evidence*: log marginal likelihood, by Laplace's approximation; its negative is minimised.
//! - *first step*: the value by which an effect without a derivative at "off" is differenced.
//! - *fitted hypothesis*: soil, candidate parameters and initial states at the maximum of the posterior density.
//! - *held-out data*: segments that a fit did not use.
//! - *initial state*: pose and velocities at the start of a segment.
//! - *kinematics*: prediction from wheel speeds without soil, with none, two or three fitted numbers.
//! - *latent wrench*: unmodelled force and yaw moment that vary over time (Ornstein-Uhlenbeck process).
//! - *log odds*: log Bayes factor plus log prior, natural logarithm.
//! - *noise model*: white and AR(1) noise of each channel, and the weight of each sample.
//! - *posterior*: probabilities of all candidates, of nothing missing and of something unknown: tempered log odds,
//!   a calibrated heuristic (`diagnosis/answer/posterior.rs`).
//! - *recording*: aligned columns of wheel speeds and measured motion, in *runs*.
//! - *refitted soil*: the given soil after a fit to the recordings, nothing added.
//! - *region*: where an effect acts: a time interval, a run, a disc or a half-plane on the map.
//! - *regularisation*: speeds below which the paper's expressions, undefined at rest, are smoothed.
//! - *residual trace*: measured less predicted, over time.
//! - *rut*: the depth to which earlier wheels have pressed the soil (`multipass`).
//! - *screening*: linearised evidence of every candidate, without a fit.
//! - *segment*: some seconds of a recording with a free initial state (multiple shooting).
//! - *slip*: slip velocity over rim speed at the lowest point of a wheel (13).
//! - *time bin*: a short interval in which a candidate acts in the scan for its region.
//! - *wrench*: what the ground does to the vehicle: accelerations, resistances and moments, and the share of each wheel.
//!
//! # Features
//! - `batch`: many simulations in one call, on all threads (`simulation::batch`).
//! - `analysis`: with that reading recordings (CSV), `fit`, `diagnosis` and `report`. Without it: the model, its derivatives,
//!   effects, JSON.
//! - `cli` (default): with that the tool `ugv`, reading robots' logs (`import`), and `package`, which makes the FMU's
//!   archive.
//! - `python`: with `cli`, the native part of the Python package.
//! - `fmu`: the C interfaces of FMI 2.0 and 3.0; building it needs libclang.

#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
pub mod contact;
pub mod declaration;
#[cfg(feature = "analysis")]
pub mod diagnosis;
pub mod display;
pub mod effects;
#[cfg(feature = "analysis")]
pub mod fit;
#[cfg(feature = "fmu")]
pub mod fmu;
#[cfg(feature = "analysis")]
pub mod identification;
#[cfg(feature = "cli")]
pub mod import;
#[cfg(feature = "analysis")]
pub mod inspection;
pub mod json;
#[cfg(feature = "cli")]
pub mod package;
pub mod parameter;
#[cfg(feature = "python")]
pub mod python;
#[cfg(feature = "analysis")]
pub mod recording;
#[cfg(feature = "analysis")]
pub mod report;
pub mod scalar;
pub mod simulation;
pub mod spelling;
pub mod terrain;
pub mod vehicle;

/// The Rust examples of the README and the book: rustdoc compiles and runs them.
#[cfg(doctest)]
mod pages {
    #[doc = include_str!("../README.md")]
    struct Readme;
    #[doc = include_str!("../docs/how-to/rust.md")]
    struct Rust;
}
