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
//! | equation | where it is evaluated |
//! |---|---|
//! | (1) pressure and sinkage | [`terrain::Terrain::sinkage_modulus`] |
//! | (2) sinkage of a rim point | `contact::patch`, [`vehicle::WheelOutputs::sinkage`] |
//! | (3), (4), (5) normal stress in front and behind | `contact::patch`; (4) in full in `contact::altered` |
//! | (6) shear stress | `contact::patch` |
//! | (7) wheel centres | [`vehicle::Vehicle::wheel_centre`] |
//! | (8) place of a rim point | [`contact::WheelForces::arc_moment`] |
//! | (9) motion of the vehicle | [`vehicle::Motion`] |
//! | (10) velocity of a wheel centre | [`contact::WheelMotion`] |
//! | (11), (12) velocity of a rim point, slip velocity | `contact::patch` |
//! | (13) slips | [`vehicle::WheelOutputs::longitudinal_slip`] |
//! | (14), (15) shear displacement | `contact::patch` |
//! | (16), (17) components of the stresses | `contact::patch` |
//! | (18) forces of a wheel | [`contact::WheelForces`] |
//! | (19), (20) accelerations | [`vehicle::Wrench::a_x`], [`vehicle::Wrench::a_y`] |
//! | (21) rolling resistance | [`vehicle::Wrench::rolling_resistance`] |
//! | (22) load balance of a wheel | [`vehicle::Balance`] |
//! | (23), (26) rolling moments | [`vehicle::LoadPlane`] |
//! | (24), (25) yaw acceleration, turning moments | [`vehicle::Wrench`] |
//! | (27), (28) loads | [`vehicle::LoadPlane`] |
//!
//! # Glossary
//! - *absorbed fraction*: share of an effect's signal that a refit of the soil takes up.
//! - *accepted effect*: an effect that the diagnosis has added to the model.
//! - *balance*: entry angles and accelerations at which every wheel carries its load.
//! - *candidate*: an effect, sensor fault or residual model that may be missing; its *candidate parameters* are free.
//! - *coefficient*: one candidate parameter, in a coordinate that is 0 where its effect is off.
//! - *colocated*: candidates that act at the same place or time.
//! - *effect*: physics that the paper leaves out, or a property of a sensor; all are in [`effects::CATALOGUE`].
//! - *empirical residual model*: a force or moment as a sum of dimensionless features of the motion.
//! - *entry angle* theta_1: where the rim meets the soil, from the wheel's lowest point.
//! - *evidence*: probability of the recordings under a hypothesis, its parameters integrated out.
//! - *first step*: the value by which an effect without a derivative at "off" is differenced.
//! - *fitted hypothesis*: soil, candidate parameters and initial states at the maximum of the posterior.
//! - *held out*: not used for the fit that is judged.
//! - *initial state*: pose and velocities at the start of a segment.
//! - *kinematics*: prediction from wheel speeds without soil, with two or three fitted numbers.
//! - *latent wrench*: unmodelled force and moment as an Ornstein–Uhlenbeck process.
//! - *noise model*: white and AR(1) noise of each channel, and the weight of each sample.
//! - *posterior*: probabilities of the candidates, of nothing missing and of something unknown.
//! - *recording*: aligned columns of wheel speeds and measured motion, in *runs*.
//! - *refitted soil*: the given soil after a fit to the recordings, without effects.
//! - *region*: where an effect acts: a time interval, a run, a disc or a half-plane on the map.
//! - *regularisation*: speeds below which the paper's expressions, undefined at rest, are smoothed.
//! - *residual trace*: measured less predicted, over time.
//! - *rut*: the depth to which earlier wheels have pressed the soil (`multipass`).
//! - *screening*: the one-step test of every candidate on the linearised problem.
//! - *segment*: some seconds of a recording with an initial state of its own (multiple shooting).
//! - *slip*: (13), with the wheel's own velocities.
//! - *time bin*: a short interval in which a candidate acts in the scan for its region.
//! - *wrench*: accelerations, resistances and moments that the ground exerts, and each wheel's share.
//!
//! # Features
//! - `analysis`: reading recordings (CSV), `fit`, `diagnosis` and `report`. Without it: the model, its derivatives,
//!   effects, JSON.
//! - `cli` (default): with that the tool `ugv`, reading robots' logs (`import`), and `package`, which makes the FMU's
//!   archive.
//! - `fmu`: the C interfaces of FMI 2.0 and 3.0; building it needs libclang.

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
