//! The variables of the FMU: one row each.
//!
//! A row holds name, unit, description and, for forces and parameters, the function that gives the
//! value. Model description, documentation, C header, CSV and the C interface follow from these
//! rows. The order of the rows gives the value references. The parameters of effects have their
//! rows in [`crate::effects::CATALOGUE`].

use super::configuration::CUSTOM;
use super::row::{
    Causality, Field, Kind, Output, Row, Unit, force, initial, input, local, output, parameter,
    row, unit, wheel,
};
use crate::vehicle::{WheelOutputs, Wrench};

macro_rules! field {
    ($($path:tt)+) => {
        Field {
            get: |configuration| configuration.$($path)+,
            set: |configuration, value| configuration.$($path)+ = value,
        }
    };
}

/// Wheel speeds, left before right.
#[rustfmt::skip]
pub(super) static INPUTS: [Row; 2] = [
    input("omega_left", "rad/s", "Angular speed of the left wheels, positive rolls forward").range(-1000.0, 1000.0).nominal(10.0).start(0.0),
    input("omega_right", "rad/s", "Angular speed of the right wheels, positive rolls forward").range(-1000.0, 1000.0).nominal(10.0).start(0.0),
];

/// The states, in the order of [`crate::simulation::State::to_array`].
#[rustfmt::skip]
pub(super) static STATES: [Row; 6] = [
    output("x", "m", "Position of the centre of mass, east").nominal(1.0),
    output("y", "m", "Position of the centre of mass, north").nominal(1.0),
    output("heading", "rad", "Heading, counter-clockwise from east").nominal(1.0),
    output("v_x", "m/s", "Velocity of the centre of mass along the body's X axis, ahead").nominal(1.0),
    output("v_y", "m/s", "Velocity of the centre of mass along the body's Y axis, to the left").nominal(0.1),
    output("yaw_rate", "rad/s", "Yaw rate, counter-clockwise").nominal(0.5),
];

/// Accelerations, forces and moments of the whole vehicle.
#[rustfmt::skip]
pub(super) static FORCES: [Output<Wrench>; 5] = [
    force("a_x", "m/s2", "Acceleration of the centre of mass along X: sum of F_X / m (19), and what effects add", |all| all.a_x),
    force("a_y", "m/s2", "Acceleration of the centre of mass along Y: sum of F_Y / m (20), and what effects add", |all| all.a_y),
    force("rolling_resistance", "N", "Rolling resistance R_r: horizontal force of the normal stress against the travel (21)", |all| all.rolling_resistance).nominal(1000.0),
    force("turning_resistance_moment", "N.m", "Moment of turning resistance M_r, positive where it resists a counter-clockwise turn (25)", |all| all.turning_resistance_moment).nominal(1000.0),
    force("turning_moment", "N.m", "Moment of the thrust, the first term of (24); less M_r it is I_Z dOmega/dt where no effect acts", |all| all.turning_moment).nominal(1000.0),
];

/// The rates of the states, in the same order.
#[rustfmt::skip]
pub(super) static RATES: [Row; 6] = [
    local("der(x)", "m/s", "Velocity east"),
    local("der(y)", "m/s", "Velocity north"),
    local("der(heading)", "rad/s", "Rate of the heading"),
    local("der(v_x)", "m/s2", "Rate of v_x: a_x + v_y yaw_rate"),
    local("der(v_y)", "m/s2", "Rate of v_y: a_y - v_x yaw_rate"),
    local("der(yaw_rate)", "rad/s2", "Yaw acceleration (24)"),
];

/// The number of the terrain.
pub(super) static TERRAIN_NUMBER: [Row; 1] = [row(
    Causality::Parameter,
    "terrain",
    "",
    "Soil under the wheels: one of the paper's, or custom for the parameters soil.*, which act with it alone",
)
.of_kind(Kind::Enumeration)];

/// The custom soil.
#[rustfmt::skip]
pub(super) static SOIL: [Row<Field>; 6] = [
    parameter("soil.cohesion", "Pa", "Cohesion c of the custom soil", field!(terrains[CUSTOM].cohesion)).range(0.0, 1e8),
    parameter("soil.friction_angle_deg", "deg", "Angle of internal friction phi of the custom soil", field!(terrains[CUSTOM].friction_angle)).range(0.0, 60.0),
    parameter("soil.cohesive_modulus", "N/m^(n+1)", "Cohesive modulus k_c of the custom soil's pressure-sinkage law", field!(terrains[CUSTOM].cohesive_modulus)).range(-1e9, 1e12),
    parameter("soil.frictional_modulus", "N/m^(n+2)", "Frictional modulus k_phi of the custom soil's pressure-sinkage law", field!(terrains[CUSTOM].frictional_modulus)).range(0.0, 1e12),
    parameter("soil.sinkage_exponent", "1", "Sinkage exponent n of the custom soil, above 0", field!(terrains[CUSTOM].sinkage_exponent)).range(0.0, 3.0),
    parameter("soil.shear_modulus", "m", "Shear deformation modulus K of the custom soil, above 0", field!(terrains[CUSTOM].shear_modulus)).range(0.0, 1.0),
];

/// The vehicle without its rows of wheels.
#[rustfmt::skip]
pub(super) static VEHICLE: [Row<Field>; 7] = [
    parameter("vehicle.mass", "kg", "Mass m, above 0", field!(vehicle.mass)).range(0.0, 1e7),
    parameter("vehicle.yaw_inertia", "kg.m2", "Yaw moment of inertia I_Z about the centre of mass, above 0", field!(vehicle.yaw_inertia)).range(0.0, 1e9),
    parameter("vehicle.wheel_radius", "m", "Wheel radius r, above 0", field!(vehicle.wheel_radius)).range(0.0, 10.0),
    parameter("vehicle.wheel_width", "m", "Wheel width b, above 0 and at most twice the half track", field!(vehicle.wheel_width)).range(0.0, 40.0),
    parameter("vehicle.half_track", "m", "Half the track B, above 0", field!(vehicle.half_track)).range(0.0, 20.0),
    parameter("vehicle.com_offset", "m", "Offset d of the centre of mass ahead of the centroid, between the first and the last row", field!(vehicle.com_offset)).range(-50.0, 50.0),
    parameter("vehicle.com_height", "m", "Height h of the centre of mass above the ground", field!(vehicle.com_height)).range(0.0, 20.0),
];

/// The initial states, in the order of the states.
#[rustfmt::skip]
pub(super) static INITIAL: [Row; 6] = [
    initial("initial.x", "m", "Initial position, east").start(0.0),
    initial("initial.y", "m", "Initial position, north").start(0.0),
    initial("initial.heading", "rad", "Initial heading, counter-clockwise from east").start(0.0),
    initial("initial.v_x", "m/s", "Initial velocity ahead; not used with initial.no_slip").start(0.0),
    initial("initial.v_y", "m/s", "Initial velocity to the left; not used with initial.no_slip").start(0.0),
    initial("initial.yaw_rate", "rad/s", "Initial yaw rate; not used with initial.no_slip").start(0.0),
];

/// Whether the wheels roll without slip at the start.
pub(super) static NO_SLIP: [Row; 1] = [row(
    Causality::Parameter,
    "initial.no_slip",
    "",
    "Start at the velocities of rolling without slip at the first wheel speeds",
)
.of_kind(Kind::Boolean)];

/// Each row of wheels.
pub(super) static ROW: Row = row(
    Causality::Parameter,
    "vehicle.row_positions",
    "m",
    "Offset of a wheel row ahead of the centroid, front row first",
)
.range(-50.0, 50.0);

/// Each wheel.
#[rustfmt::skip]
pub(super) static WHEEL: [Output<WheelOutputs>; 7] = [
    wheel("longitudinal_slip", "1", "Longitudinal slip S_X at the wheel's lowest point, positive when driving (13)", |wheel| wheel.longitudinal_slip),
    wheel("lateral_slip", "1", "Lateral slip S_Y at the wheel's lowest point (13)", |wheel| wheel.lateral_slip),
    wheel("load", "N", "Vertical load (28)", |wheel| wheel.load).nominal(1000.0),
    wheel("sinkage", "m", "Sinkage (2)", |wheel| wheel.sinkage).nominal(0.01),
    wheel("entry_angle", "rad", "Entry angle theta_1", |wheel| wheel.entry_angle),
    wheel("force_x", "N", "Force of the ground along the body's X axis (18)", |wheel| wheel.force_x).nominal(100.0),
    wheel("force_y", "N", "Force of the ground along the body's Y axis (18)", |wheel| wheel.force_y).nominal(100.0),
];

/// The time, a variable in FMI 3.0 only.
pub(super) static TIME: Row = row(Causality::Independent, "time", "s", "Simulated time");

/// The units of the variables with the exponents of their base units in alphabetical order.
#[rustfmt::skip]
pub static UNITS: [Unit; 19] = [
    unit("s", &[("s", 1)]),
    unit("m", &[("m", 1)]),
    unit("kg", &[("kg", 1)]),
    unit("kg.m2", &[("kg", 1), ("m", 2)]),
    unit("rad", &[("rad", 1)]),
    Unit { name: "deg", base: Some(&[("rad", 1)]), factor: Some(0.017453292519943295) },
    unit("m/s", &[("m", 1), ("s", -1)]),
    unit("m/s2", &[("m", 1), ("s", -2)]),
    unit("rad/s", &[("rad", 1), ("s", -1)]),
    unit("rad/s2", &[("rad", 1), ("s", -2)]),
    unit("N", &[("kg", 1), ("m", 1), ("s", -2)]),
    unit("N.s/m", &[("kg", 1), ("s", -1)]),
    unit("N.s2/m2", &[("kg", 1), ("m", -1)]),
    unit("N/m3", &[("kg", 1), ("m", -2), ("s", -2)]),
    unit("N.m", &[("kg", 1), ("m", 2), ("s", -2)]),
    unit("Pa", &[("kg", 1), ("m", -1), ("s", -2)]),
    Unit { name: "N/m^(n+1)", base: None, factor: None },
    Unit { name: "N/m^(n+2)", base: None, factor: None },
    unit("1", &[]),
];
