//! Creation, initialization, directional derivatives.

use super::conforms;
use crate::declaration::Naming;
use crate::fmu::calls::Call;
use crate::fmu::creation::{Package, create, set_logging, text};
use crate::fmu::guard::{call, free, read, write};
use crate::fmu::instance::{Interface, Purpose};
use crate::fmu::logger::Logger;
use fmi_sys::fmi2::*;
use std::ffi::c_char;

conforms! {
    fmi2GetTypesPlatformTYPE = fmi2GetTypesPlatform;
    fmi2GetVersionTYPE = fmi2GetVersion;
    fmi2SetDebugLoggingTYPE = fmi2SetDebugLogging;
    fmi2InstantiateTYPE = fmi2Instantiate;
    fmi2FreeInstanceTYPE = fmi2FreeInstance;
    fmi2SetupExperimentTYPE = fmi2SetupExperiment;
    fmi2EnterInitializationModeTYPE = fmi2EnterInitializationMode;
    fmi2ExitInitializationModeTYPE = fmi2ExitInitializationMode;
    fmi2TerminateTYPE = fmi2Terminate;
    fmi2ResetTYPE = fmi2Reset;
    fmi2GetDirectionalDerivativeTYPE = fmi2GetDirectionalDerivative;
}

/// The platform's types, `default`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// The version of the standard, `2.0`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// Switches the reporting of events and of discarded calls on and off; errors and warnings are always reported.
///
/// # Safety
/// As the standard says: a live component, `n_categories` strings.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    component: fmi2Component,
    logging_on: fmi2Boolean,
    n_categories: usize,
    categories: *const fmi2String,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::SetDebugLogging,
            "fmi2SetDebugLogging",
            |instance| set_logging(instance, logging_on != 0, read(categories, n_categories)?),
        )
    }
}

/// Creates an instance, or reports why not and returns null.
///
/// # Safety
/// As the standard says: strings that end in zero, callbacks that outlive the instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    instance_name: fmi2String,
    fmu_type: fmi2Type,
    fmu_guid: fmi2String,
    fmu_resource_location: fmi2String,
    functions: *const fmi2CallbackFunctions,
    _visible: fmi2Boolean,
    logging_on: fmi2Boolean,
) -> fmi2Component {
    let interface = match fmu_type {
        fmi2Type_fmi2ModelExchange => Ok(Interface::ModelExchange),
        fmi2Type_fmi2CoSimulation => Ok(Interface::CoSimulation),
        other => Err(format!("there is no FMU type {other}")),
    };
    let purpose = interface.map(|interface| Purpose {
        interface,
        naming: Naming::Scalars,
        has_events: false,
    });
    // SAFETY: the caller keeps the standard's promises; a null pointer is no reference.
    unsafe {
        let name = text(instance_name).unwrap_or(c"ugv");
        let logger = Logger::fmi2(functions.as_ref(), name, logging_on != 0);
        let package = Package {
            identity_name: "guid",
            identity: fmu_guid,
            resources: fmu_resource_location,
        };
        create("fmi2Instantiate", logger, purpose, &package)
    }
}

/// Frees an instance; nothing for null.
///
/// # Safety
/// `component` is null or a live component, which is none after this.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(component: fmi2Component) {
    // SAFETY: the caller keeps the standard's promises.
    unsafe { free(component) }
}

/// Tells start and stop time.
///
/// # Safety
/// `component` is null or a live component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    component: fmi2Component,
    _tolerance_defined: fmi2Boolean,
    _tolerance: fmi2Real,
    start_time: fmi2Real,
    stop_time_defined: fmi2Boolean,
    stop_time: fmi2Real,
) -> fmi2Status {
    let stop_time = (stop_time_defined != 0).then_some(stop_time);
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::SetupExperiment,
            "fmi2SetupExperiment",
            |instance| instance.setup_experiment(start_time, stop_time),
        )
    }
}

/// Begins the initialization.
///
/// # Safety
/// `component` is null or a live component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(component: fmi2Component) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::EnterInitializationMode,
            "fmi2EnterInitializationMode",
            |instance| {
                instance.enter_initialization();
                Ok(())
            },
        )
    }
}

/// Ends the initialization: parameters are fixed from here on.
///
/// # Safety
/// `component` is null or a live component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2ExitInitializationMode(component: fmi2Component) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::ExitInitializationMode,
            "fmi2ExitInitializationMode",
            |instance| instance.exit_initialization(),
        )
    }
}

/// Ends the simulation; values can still be read.
///
/// # Safety
/// `component` is null or a live component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Terminate(component: fmi2Component) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::Terminate, "fmi2Terminate", |instance| {
            instance.terminate()
        })
    }
}

/// Back to how the instance was created.
///
/// # Safety
/// `component` is null or a live component.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(component: fmi2Component) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(component, Call::Reset, "fmi2Reset", |instance| {
            instance.reset();
            Ok(())
        })
    }
}

/// Derivatives of outputs and state derivatives in a direction of inputs and states.
///
/// # Safety
/// A live component; arrays of the given lengths.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    component: fmi2Component,
    unknown_references: *const fmi2ValueReference,
    n_unknown: usize,
    known_references: *const fmi2ValueReference,
    n_known: usize,
    known_seeds: *const fmi2Real,
    unknown_values: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        call(
            component,
            Call::Differentiate,
            "fmi2GetDirectionalDerivative",
            |instance| {
                // A copy, as the result may lie in the same place.
                let seeds = read(known_seeds, n_known)?.to_vec();
                instance.directional_derivative(
                    read(unknown_references, n_unknown)?,
                    read(known_references, n_known)?,
                    &seeds,
                    write(unknown_values, n_unknown)?,
                )
            },
        )
    }
}
