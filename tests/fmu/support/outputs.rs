//! What the FMU's variables are in the library.

use ugv_terrain::declaration::{Quantity, Variable};
use ugv_terrain::simulation::Simulation;

/// The values of inputs and outputs, in the order of the variables.
pub fn values(simulation: &mut Simulation, variables: &[Variable]) -> Vec<f64> {
    let (speeds, state) = (simulation.wheel_speeds(), simulation.state().to_array());
    let rates = simulation.derivative().unwrap();
    let wrench = simulation.wrench().unwrap();
    let value = |variable: &Variable| match variable.quantity {
        Quantity::Input(0) => speeds.left,
        Quantity::Input(_) => speeds.right,
        Quantity::State(index) => state[index],
        Quantity::Rate(index) => rates[index],
        Quantity::Total(index) => [
            wrench.a_x,
            wrench.a_y,
            wrench.rolling_resistance,
            wrench.turning_resistance_moment,
            wrench.turning_moment,
        ][index],
        Quantity::Wheel(wheel, field) => {
            let wheel = &wrench.wheels[wheel];
            [
                wheel.longitudinal_slip,
                wheel.lateral_slip,
                wheel.load,
                wheel.sinkage,
                wheel.entry_angle,
                wheel.force_x,
                wheel.force_y,
            ][field]
        }
        other => panic!("{other:?} is not read"),
    };
    variables.iter().map(value).collect()
}
