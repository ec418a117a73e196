//! The variables of the FMU: one row each.
//!
//! A row holds name, unit, description and, for forces and parameters, the function that gives the
//! value. Model description, documentation, C header, CSV and the C interface follow from these
//! rows. The order of the rows gives the value references. The parameters of effects have their
//! rows in [`crate::effects::CATALOGUE`].

use super::configuration::CUSTOM;
use super::row::Causality::{Independent, Input, Local, Output, Parameter};
use super::row::{Computed, Field, Kind, Row, Unit, row, unit};
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
    row(Input, "omega_left", "rad/s", "Angular speed of the left wheels, positive rolls forward").range(-1000.0, 1000.0).nominal(10.0).start(0.0),
    row(Input, "omega_right", "rad/s", "Angular speed of the right wheels, positive rolls forward").range(-1000.0, 1000.0).nominal(10.0).start(0.0),
];

/// The states, in the order of [`crate::simulation::State::to_array`].
#[rustfmt::skip]
pub(super) static STATES: [Row; 6] = [
    row(Output, "x", "m", "Position of the centre of mass, east").nominal(1.0),
    row(Output, "y", "m", "Position of the centre of mass, north").nominal(1.0),
    row(Output, "heading", "rad", "Heading, counter-clockwise from east").nominal(1.0),
    row(Output, "v_x", "m/s", "Velocity of the centre of mass along the body's X axis, ahead").nominal(1.0),
    row(Output, "v_y", "m/s", "Velocity of the centre of mass along the body's Y axis, to the left").nominal(0.1),
    row(Output, "yaw_rate", "rad/s", "Yaw rate, counter-clockwise").nominal(0.5),
];

/// Accelerations, forces, moments and power of the whole vehicle.
#[rustfmt::skip]
pub(super) static FORCES: [Computed<Wrench>; 8] = [
    row(Output, "a_x", "m/s2", "Acceleration of the centre of mass along X: sum of F_X / m (19), and what effects add").force(|all| all.a_x),
    row(Output, "a_y", "m/s2", "Acceleration of the centre of mass along Y: sum of F_Y / m (20), and what effects add").force(|all| all.a_y),
    row(Output, "rolling_resistance", "N", "Rolling resistance R_r: horizontal force of the normal stress against the travel (21)").nominal(1000.0).force(|all| all.rolling_resistance),
    row(Output, "turning_resistance_moment", "N.m", "Moment of turning resistance M_r, positive where it resists a counter-clockwise turn (25)").nominal(1000.0).force(|all| all.turning_resistance_moment),
    row(Output, "turning_moment", "N.m", "Moment of the thrust, the first term of (24); minus M_r it is I_Z dOmega/dt where no effect acts").nominal(1000.0).force(|all| all.turning_moment),
    row(Output, "torque_left", "N.m", "Torque of the left axles on their wheels, positive drives forward").nominal(100.0).force(|all| all.torque_left),
    row(Output, "torque_right", "N.m", "Torque of the right axles on their wheels, positive drives forward").nominal(100.0).force(|all| all.torque_right),
    row(Output, "power", "W", "Power of the axles: sum of torque times angular speed, negative where the wheels brake").nominal(1000.0).force(|all| all.power),
];

/// The rates of the states, in the same order.
#[rustfmt::skip]
pub(super) static RATES: [Row; 6] = [
    row(Local, "der(x)", "m/s", "Velocity east"),
    row(Local, "der(y)", "m/s", "Velocity north"),
    row(Local, "der(heading)", "rad/s", "Rate of the heading"),
    row(Local, "der(v_x)", "m/s2", "Rate of v_x: a_x + v_y yaw_rate"),
    row(Local, "der(v_y)", "m/s2", "Rate of v_y: a_y - v_x yaw_rate"),
    row(Local, "der(yaw_rate)", "rad/s2", "Yaw acceleration (24)"),
];

/// The number of the terrain.
pub(super) static TERRAIN_NUMBER: [Row; 1] = [row(
    Parameter,
    "terrain",
    "",
    "Soil under the wheels: one of the paper's, or custom for the parameters soil.*, which act only with it",
)
.of_kind(Kind::Enumeration)];

/// The custom soil.
#[rustfmt::skip]
pub(super) static SOIL: [Row<Field>; 6] = [
    row(Parameter, "soil.cohesion", "Pa", "Cohesion c of the custom soil").range(0.0, 1e8).field(field!(terrains[CUSTOM].cohesion)),
    row(Parameter, "soil.friction_angle_deg", "deg", "Angle of internal friction phi of the custom soil").range(0.0, 60.0).field(field!(terrains[CUSTOM].friction_angle)),
    row(Parameter, "soil.cohesive_modulus", "N/m^(n+1)", "Cohesive modulus k_c of the custom soil's pressure-sinkage law").range(-1e9, 1e12).field(field!(terrains[CUSTOM].cohesive_modulus)),
    row(Parameter, "soil.frictional_modulus", "N/m^(n+2)", "Frictional modulus k_phi of the custom soil's pressure-sinkage law").range(0.0, 1e12).field(field!(terrains[CUSTOM].frictional_modulus)),
    row(Parameter, "soil.sinkage_exponent", "1", "Sinkage exponent n of the custom soil, above 0").range(0.0, 3.0).field(field!(terrains[CUSTOM].sinkage_exponent)),
    row(Parameter, "soil.shear_modulus", "m", "Shear deformation modulus K of the custom soil, above 0").range(0.0, 1.0).field(field!(terrains[CUSTOM].shear_modulus)),
];

/// The vehicle without its rows of wheels.
#[rustfmt::skip]
pub(super) static VEHICLE: [Row<Field>; 7] = [
    row(Parameter, "vehicle.mass", "kg", "Mass m, above 0").range(0.0, 1e7).field(field!(vehicle.mass)),
    row(Parameter, "vehicle.yaw_inertia", "kg.m2", "Yaw moment of inertia I_Z about the centre of mass, above 0").range(0.0, 1e9).field(field!(vehicle.yaw_inertia)),
    row(Parameter, "vehicle.wheel_radius", "m", "Wheel radius r, above 0").range(0.0, 10.0).field(field!(vehicle.wheel_radius)),
    row(Parameter, "vehicle.wheel_width", "m", "Wheel width b, above 0 and at most twice the half track").range(0.0, 40.0).field(field!(vehicle.wheel_width)),
    row(Parameter, "vehicle.half_track", "m", "Half the track B, above 0").range(0.0, 20.0).field(field!(vehicle.half_track)),
    row(Parameter, "vehicle.com_offset", "m", "Offset d of the centre of mass ahead of the centroid, between the first and the last row").range(-50.0, 50.0).field(field!(vehicle.com_offset)),
    row(Parameter, "vehicle.com_height", "m", "Height h of the centre of mass above the ground").range(0.0, 20.0).field(field!(vehicle.com_height)),
];

/// The initial states, in the order of the states.
#[rustfmt::skip]
pub(super) static INITIAL: [Row; 6] = [
    row(Parameter, "initial.x", "m", "Initial position, east").start(0.0),
    row(Parameter, "initial.y", "m", "Initial position, north").start(0.0),
    row(Parameter, "initial.heading", "rad", "Initial heading, counter-clockwise from east").start(0.0),
    row(Parameter, "initial.v_x", "m/s", "Initial velocity ahead; not used with initial.no_slip").start(0.0),
    row(Parameter, "initial.v_y", "m/s", "Initial velocity to the left; not used with initial.no_slip").start(0.0),
    row(Parameter, "initial.yaw_rate", "rad/s", "Initial yaw rate; not used with initial.no_slip").start(0.0),
];

/// Whether the wheels roll without slip at the start.
pub(super) static NO_SLIP: [Row; 1] = [row(
    Parameter,
    "initial.no_slip",
    "",
    "Start at the velocities of rolling without slip at the first wheel speeds",
)
.of_kind(Kind::Boolean)];

/// Each row of wheels.
pub(super) static ROW: Row = row(
    Parameter,
    "vehicle.row_positions",
    "m",
    "Offset of a wheel row ahead of the centroid, front row first",
)
.range(-50.0, 50.0);

/// Each wheel.
#[rustfmt::skip]
pub(super) static WHEEL: [Computed<WheelOutputs>; 8] = [
    row(Output, "longitudinal_slip", "1", "Longitudinal slip S_X at the wheel's lowest point, positive when driving (13)").wheel(|wheel| wheel.longitudinal_slip),
    row(Output, "lateral_slip", "1", "Lateral slip S_Y at the wheel's lowest point (13)").wheel(|wheel| wheel.lateral_slip),
    row(Output, "load", "N", "Vertical load (28)").nominal(1000.0).wheel(|wheel| wheel.load),
    row(Output, "sinkage", "m", "Sinkage (2)").nominal(0.01).wheel(|wheel| wheel.sinkage),
    row(Output, "entry_angle", "rad", "Entry angle theta_1").wheel(|wheel| wheel.entry_angle),
    row(Output, "force_x", "N", "Force of the ground along the body's X axis (18)").nominal(100.0).wheel(|wheel| wheel.force_x),
    row(Output, "force_y", "N", "Force of the ground along the body's Y axis (18)").nominal(100.0).wheel(|wheel| wheel.force_y),
    row(Output, "torque", "N.m", "Torque of the axle on the wheel, positive drives forward: radius times the shear along the rim").nominal(100.0).wheel(|wheel| wheel.torque),
];

/// The time, a variable in FMI 3.0 only.
pub(super) static TIME: Row = row(Independent, "time", "s", "Simulated time");

/// The units of the variables with the exponents of their base units in alphabetical order.
#[rustfmt::skip]
pub static UNITS: [Unit; 20] = [
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
    unit("W", &[("kg", 1), ("m", 2), ("s", -3)]),
    unit("Pa", &[("kg", 1), ("m", -1), ("s", -2)]),
    Unit { name: "N/m^(n+1)", base: None, factor: None },
    Unit { name: "N/m^(n+2)", base: None, factor: None },
    unit("1", &[]),
];
