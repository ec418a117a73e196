//! Model exchange: the importer integrates the six states. Event mode serves co-simulation as well.

use super::exports;
use crate::fmu::guard::{out, read, write};
use crate::fmu::instance::{Instance, refuse};
use crate::simulation::State;
use fmi_sys::fmi3::*;

exports! {
    /// Not available: there are no discrete states.
    fmi3EvaluateDiscreteStates: fmi3EvaluateDiscreteStatesTYPE = Unsupported
    () |_| refuse("there are no discrete states to evaluate");

    /// Handles an event: effects that act for a while begin or end by themselves, and the next such
    /// moment is told.
    fmi3UpdateDiscreteStates: fmi3UpdateDiscreteStatesTYPE = NewDiscreteStates
    (
        discrete_states_need_update: *mut fmi3Boolean,
        terminate_simulation: *mut fmi3Boolean,
        nominals_changed: *mut fmi3Boolean,
        values_changed: *mut fmi3Boolean,
        next_event_time_defined: *mut fmi3Boolean,
        next_event_time: *mut fmi3Float64,
    )
    |instance| {
        let next = instance.next_event()?;
        *out(discrete_states_need_update)? = false;
        *out(terminate_simulation)? = false;
        *out(nominals_changed)? = false;
        *out(values_changed)? = false;
        *out(next_event_time_defined)? = next.is_some();
        *out(next_event_time)? = next.unwrap_or_default();
        Ok(())
    };

    /// Enters continuous-time mode.
    fmi3EnterContinuousTimeMode: fmi3EnterContinuousTimeModeTYPE = EnterContinuousTimeMode
    () |instance| instance.enter_continuous_time_mode();

    /// Takes note of a completed step; the model never asks for an event.
    fmi3CompletedIntegratorStep: fmi3CompletedIntegratorStepTYPE = CompletedIntegratorStep
    (
        _no_set_fmu_state_prior_to_current_point: fmi3Boolean,
        enter_event_mode: *mut fmi3Boolean,
        terminate_simulation: *mut fmi3Boolean,
    )
    |_| {
        *out(enter_event_mode)? = false;
        *out(terminate_simulation)? = false;
        Ok(())
    };

    /// Sets the time, on which only effects depend.
    fmi3SetTime: fmi3SetTimeTYPE = SetTime
    (time: fmi3Float64) |instance| instance.set_time(time);

    /// Sets the states.
    fmi3SetContinuousStates: fmi3SetContinuousStatesTYPE = SetContinuousStates
    (states: *const fmi3Float64, count: usize)
    |instance| instance.set_states(read(states, count)?);

    /// Rates of change of the states.
    fmi3GetContinuousStateDerivatives: fmi3GetContinuousStateDerivativesTYPE = GetStatesOrRates
    (derivatives: *mut fmi3Float64, count: usize)
    |instance| instance.get_rates(write(derivatives, count)?);

    /// There are no event indicators; reading none of them succeeds.
    fmi3GetEventIndicators: fmi3GetEventIndicatorsTYPE = GetStatesOrRates
    (_indicators: *mut fmi3Float64, count: usize)
    |_| match count {
        0 => Ok(()),
        _ => refuse("there are no event indicators"),
    };

    /// The states.
    fmi3GetContinuousStates: fmi3GetContinuousStatesTYPE = GetStatesOrRates
    (states: *mut fmi3Float64, count: usize)
    |instance| instance.get_states(write(states, count)?);

    /// Orders of magnitude of the states.
    fmi3GetNominalsOfContinuousStates: fmi3GetNominalsOfContinuousStatesTYPE = GetScales
    (nominals: *mut fmi3Float64, count: usize)
    |_| Instance::get_nominals(write(nominals, count)?);

    /// The number of event indicators: none.
    fmi3GetNumberOfEventIndicators: fmi3GetNumberOfEventIndicatorsTYPE = Count
    (count: *mut usize) |_| {
        *out(count)? = 0;
        Ok(())
    };

    /// The number of states.
    fmi3GetNumberOfContinuousStates: fmi3GetNumberOfContinuousStatesTYPE = Count
    (count: *mut usize) |_| {
        *out(count)? = State::COUNT;
        Ok(())
    };
}
