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
