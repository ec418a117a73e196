//! Co-simulation.

use super::conforms;
use crate::fmu::calls::Call;
use crate::fmu::guard::{call, out, read, write};
use crate::fmu::instance::{Failure, Outcome, refuse};
use fmi_sys::fmi2::*;

conforms! {
    fmi2SetRealInputDerivativesTYPE = fmi2SetRealInputDerivatives;
    fmi2GetRealOutputDerivativesTYPE = fmi2GetRealOutputDerivatives;
    fmi2DoStepTYPE = fmi2DoStep;
    fmi2CancelStepTYPE = fmi2CancelStep;
    fmi2GetStatusTYPE = fmi2GetStatus;
    fmi2GetRealStatusTYPE = fmi2GetRealStatus;
    fmi2GetIntegerStatusTYPE = fmi2GetIntegerStatus;
    fmi2GetBooleanStatusTYPE = fmi2GetBooleanStatus;
    fmi2GetStringStatusTYPE = fmi2GetStringStatus;
}

/// Sets the rates at which the wheel speeds change during the next step.
///
/// # Safety
/// A live component; arrays of the given length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    orders: *const fmi2Integer,
    values: *const fmi2Real,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::SetInputDerivatives,
            "fmi2SetRealInputDerivatives",
            |instance| {
                let (orders, values) = (read(orders, count)?, read(values, count)?);
                instance.set_input_rates(read(references, count)?, orders, values)
            },
        )
    }
}

/// The outputs' first derivatives in time.
///
/// # Safety
/// A live component; arrays of the given length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    orders: *const fmi2Integer,
    values: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::GetOutputDerivatives,
            "fmi2GetRealOutputDerivatives",
            |instance| {
                let (orders, values) = (read(orders, count)?, write(values, count)?);
                instance.output_derivatives(read(references, count)?, orders, values)
            },
        )
    }
}

/// Drives on by one communication step.
///
/// # Safety
/// `component` is null or a live component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(
    component: fmi2Component,
    current_communication_point: fmi2Real,
    communication_step_size: fmi2Real,
    _no_set_fmu_state_prior_to_current_point: fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::DoStep, "fmi2DoStep", |instance| {
            instance.step(current_communication_point, communication_step_size)
        })
    }
}

/// Steps are never asynchronous: there is nothing to cancel.
///
/// # Safety
/// `component` is null or a live component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CancelStep(component: fmi2Component) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe { call(component, Call::CancelStep, "fmi2CancelStep", |_| Ok(())) }
}

/// A status that this FMU does not have.
fn unavailable(kind: fmi2StatusKind) -> Outcome {
    let name = match kind {
        fmi2StatusKind_fmi2DoStepStatus => "fmi2DoStepStatus",
        fmi2StatusKind_fmi2PendingStatus => "fmi2PendingStatus",
        fmi2StatusKind_fmi2LastSuccessfulTime => "fmi2LastSuccessfulTime",
        fmi2StatusKind_fmi2Terminated => "fmi2Terminated",
        other => return refuse(format!("there is no status kind {other}")),
    };
    Err(Failure::Unavailable(format!(
        "{name} is not available: no step is ever pending"
    )))
}

/// Not available: steps are never asynchronous.
///
/// # Safety
/// `component` is null or a live component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStatus(
    component: fmi2Component,
    kind: fmi2StatusKind,
    _value: *mut fmi2Status,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::GetStatus, "fmi2GetStatus", |_| {
            unavailable(kind)
        })
    }
}

/// The time that the last step reached.
///
/// # Safety
/// A live component; `value` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(
    component: fmi2Component,
    kind: fmi2StatusKind,
    value: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::GetStatus,
            "fmi2GetRealStatus",
            |instance| {
                if kind != fmi2StatusKind_fmi2LastSuccessfulTime {
                    return unavailable(kind);
                }
                *out(value)? = instance.core.time;
                Ok(())
            },
        )
    }
}

/// Not available: there is no such status.
///
/// # Safety
/// `component` is null or a live component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetIntegerStatus(
    component: fmi2Component,
    kind: fmi2StatusKind,
    _value: *mut fmi2Integer,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::GetStatus, "fmi2GetIntegerStatus", |_| {
            unavailable(kind)
        })
    }
}

/// Whether the FMU wants to end the simulation: it never does.
///
/// # Safety
/// A live component; `value` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(
    component: fmi2Component,
    kind: fmi2StatusKind,
    value: *mut fmi2Boolean,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::GetStatus, "fmi2GetBooleanStatus", |_| {
            if kind != fmi2StatusKind_fmi2Terminated {
                return unavailable(kind);
            }
            *out(value)? = 0;
            Ok(())
        })
    }
}

/// Not available: steps are never asynchronous.
///
/// # Safety
/// `component` is null or a live component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStringStatus(
    component: fmi2Component,
    kind: fmi2StatusKind,
    _value: *mut fmi2String,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::GetStatus, "fmi2GetStringStatus", |_| {
            unavailable(kind)
        })
    }
}
