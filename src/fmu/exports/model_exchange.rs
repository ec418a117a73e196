//! Model exchange: the importer integrates the six states.

use super::conforms;
use crate::fmu::calls::Call;
use crate::fmu::guard::{call, out, read, write};
use crate::fmu::instance::{Instance, refuse};
use fmi_sys::fmi2::*;

conforms! {
    fmi2EnterEventModeTYPE = fmi2EnterEventMode;
    fmi2NewDiscreteStatesTYPE = fmi2NewDiscreteStates;
    fmi2EnterContinuousTimeModeTYPE = fmi2EnterContinuousTimeMode;
    fmi2CompletedIntegratorStepTYPE = fmi2CompletedIntegratorStep;
    fmi2SetTimeTYPE = fmi2SetTime;
    fmi2SetContinuousStatesTYPE = fmi2SetContinuousStates;
    fmi2GetDerivativesTYPE = fmi2GetDerivatives;
    fmi2GetEventIndicatorsTYPE = fmi2GetEventIndicators;
    fmi2GetContinuousStatesTYPE = fmi2GetContinuousStates;
    fmi2GetNominalsOfContinuousStatesTYPE = fmi2GetNominalsOfContinuousStates;
}

/// Enters event mode.
///
/// # Safety
/// `component` is null or a live component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterEventMode(component: fmi2Component) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::EnterEventMode,
            "fmi2EnterEventMode",
            |instance| instance.enter_event_mode(),
        )
    }
}

/// Handles an event: effects that act for a while begin or end by themselves, and the next such moment
/// is told.
///
/// # Safety
/// A live component; `event_info` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2NewDiscreteStates(
    component: fmi2Component,
    event_info: *mut fmi2EventInfo,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::NewDiscreteStates,
            "fmi2NewDiscreteStates",
            |instance| {
                let next = instance.next_event()?;
                *out(event_info)? = fmi2EventInfo {
                    newDiscreteStatesNeeded: 0,
                    terminateSimulation: 0,
                    nominalsOfContinuousStatesChanged: 0,
                    valuesOfContinuousStatesChanged: 0,
                    nextEventTimeDefined: fmi2Boolean::from(next.is_some()),
                    nextEventTime: next.unwrap_or_default(),
                };
                Ok(())
            },
        )
    }
}

/// Enters continuous-time mode.
///
/// # Safety
/// `component` is null or a live component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterContinuousTimeMode(component: fmi2Component) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::EnterContinuousTimeMode,
            "fmi2EnterContinuousTimeMode",
            |instance| instance.enter_continuous_time_mode(),
        )
    }
}

/// Takes note of a completed step; the model never asks for an event.
///
/// # Safety
/// A live component; the two results can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CompletedIntegratorStep(
    component: fmi2Component,
    _no_set_fmu_state_prior_to_current_point: fmi2Boolean,
    enter_event_mode: *mut fmi2Boolean,
    terminate_simulation: *mut fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::CompletedIntegratorStep,
            "fmi2CompletedIntegratorStep",
            |_| {
                *out(enter_event_mode)? = 0;
                *out(terminate_simulation)? = 0;
                Ok(())
            },
        )
    }
}

/// Sets the time, on which only effects depend.
///
/// # Safety
/// `component` is null or a live component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetTime(component: fmi2Component, time: fmi2Real) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::SetTime, "fmi2SetTime", |instance| {
            instance.set_time(time)
        })
    }
}

/// Sets the states.
///
/// # Safety
/// A live component; an array of the given length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetContinuousStates(
    component: fmi2Component,
    states: *const fmi2Real,
    count: usize,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::SetContinuousStates,
            "fmi2SetContinuousStates",
            |instance| instance.set_states(read(states, count)?),
        )
    }
}

/// Rates of change of the states.
///
/// # Safety
/// A live component; an array of the given length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDerivatives(
    component: fmi2Component,
    derivatives: *mut fmi2Real,
    count: usize,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::GetDerivatives,
            "fmi2GetDerivatives",
            |instance| instance.get_rates(write(derivatives, count)?),
        )
    }
}

/// There are no event indicators; reading none of them succeeds.
///
/// # Safety
/// `component` is null or a live component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetEventIndicators(
    component: fmi2Component,
    _indicators: *mut fmi2Real,
    count: usize,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::GetContinuousStates,
            "fmi2GetEventIndicators",
            |_| match count {
                0 => Ok(()),
                _ => refuse("there are no event indicators"),
            },
        )
    }
}

/// The states.
///
/// # Safety
/// A live component; an array of the given length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetContinuousStates(
    component: fmi2Component,
    states: *mut fmi2Real,
    count: usize,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::GetContinuousStates,
            "fmi2GetContinuousStates",
            |instance| instance.get_states(write(states, count)?),
        )
    }
}

/// Orders of magnitude of the states.
///
/// # Safety
/// A live component; an array of the given length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetNominalsOfContinuousStates(
    component: fmi2Component,
    nominals: *mut fmi2Real,
    count: usize,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::GetNominals,
            "fmi2GetNominalsOfContinuousStates",
            |_| Instance::get_nominals(write(nominals, count)?),
        )
    }
}
