//! Co-simulation.

use super::exports;
use crate::fmu::guard::{out, read, write};
use fmi_sys::fmi3::*;

exports! {
    /// Ends the event mode of a co-simulation.
    fmi3EnterStepMode: fmi3EnterStepModeTYPE = EnterStepMode
    () |instance| {
        instance.enter_step_mode();
        Ok(())
    };

    /// The outputs' first derivatives in time.
    fmi3GetOutputDerivatives: fmi3GetOutputDerivativesTYPE = GetOutputDerivatives
    (
        references: *const fmi3ValueReference,
        count: usize,
        orders: *const fmi3Int32,
        values: *mut fmi3Float64,
        n_values: usize,
    )
    |instance| {
        let (orders, values) = (read(orders, count)?, write(values, n_values)?);
        instance.output_derivatives(read(references, count)?, orders, values)
    };

    /// Drives on by one communication step, to its end: it never returns early, and neither needs
    /// an event nor wants to end the simulation.
    fmi3DoStep: fmi3DoStepTYPE = DoStep
    (
        current_communication_point: fmi3Float64,
        communication_step_size: fmi3Float64,
        _no_set_fmu_state_prior_to_current_point: fmi3Boolean,
        event_handling_needed: *mut fmi3Boolean,
        terminate_simulation: *mut fmi3Boolean,
        early_return: *mut fmi3Boolean,
        last_successful_time: *mut fmi3Float64,
    )
    |instance| {
        // What cannot be told is refused before the step.
        *out(event_handling_needed)? = false;
        *out(terminate_simulation)? = false;
        *out(early_return)? = false;
        let reached = out(last_successful_time)?;
        let stepped = instance.step(current_communication_point, communication_step_size);
        *reached = instance.core.time;
        stepped
    };
}
