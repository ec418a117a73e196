//! What the FMU's variables are in the library.

use ugv_terrain::declaration::{Quantity, Variable};
use ugv_terrain::simulation::Simulation;

/// The values of inputs, outputs and rates, in the order of the variables.
pub fn values(simulation: &mut Simulation, variables: &[Variable]) -> Vec<f64> {
    let (speeds, state) = (simulation.wheel_speeds(), simulation.state());
    let rates = simulation.derivative().unwrap();
    let wrench = simulation.wrench().unwrap();
    let value = |variable: &Variable| match variable.quantity {
        Quantity::Rate(index) => rates[index],
        other => other.output(speeds, state, wrench).unwrap(),
    };
    variables.iter().map(value).collect()
}
