//! Creation, initialization, configuration.

use super::exports;
use crate::declaration::Naming;
use crate::fmu::creation::{Package, create, set_logging, text};
use crate::fmu::guard::{free, read};
use crate::fmu::instance::{Interface, Purpose, refuse};
use crate::fmu::logger::Logger;
use fmi_sys::fmi3::*;
use std::ffi::c_char;

const _: fmi3GetVersionTYPE = Some(fmi3GetVersion);
const _: fmi3InstantiateModelExchangeTYPE = Some(fmi3InstantiateModelExchange);
const _: fmi3InstantiateCoSimulationTYPE = Some(fmi3InstantiateCoSimulation);
const _: fmi3InstantiateScheduledExecutionTYPE = Some(fmi3InstantiateScheduledExecution);
const _: fmi3FreeInstanceTYPE = Some(fmi3FreeInstance);

/// The version of the standard, `3.0`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// Creates an instance for model exchange, or reports why not and returns null.
///
/// # Safety
/// As the standard says: strings that end in zero, a callback that outlives the instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    instance_name: fmi3String,
    instantiation_token: fmi3String,
    resource_path: fmi3String,
    _visible: fmi3Boolean,
    logging_on: fmi3Boolean,
    environment: fmi3InstanceEnvironment,
    log: fmi3LogMessageCallback,
) -> fmi3Instance {
    let logger = Logger::fmi3(log, environment, logging_on);
    let function = "fmi3InstantiateModelExchange";
    let purpose = Ok((Interface::ModelExchange, false));
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        instantiate(
            function,
            logger,
            purpose,
            [instance_name, instantiation_token, resource_path],
        )
    }
}

/// Creates an instance for co-simulation, or reports why not and returns null.
///
/// # Safety
/// As the standard says: strings that end in zero, an array of the given length, callbacks that
/// outlive the instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    instance_name: fmi3String,
    instantiation_token: fmi3String,
    resource_path: fmi3String,
    _visible: fmi3Boolean,
    logging_on: fmi3Boolean,
    event_mode_used: fmi3Boolean,
    _early_return_allowed: fmi3Boolean,
    _required_intermediate_variables: *const fmi3ValueReference,
    n_required_intermediate_variables: usize,
    environment: fmi3InstanceEnvironment,
    log: fmi3LogMessageCallback,
    _intermediate_update: fmi3IntermediateUpdateCallback,
) -> fmi3Instance {
    let logger = Logger::fmi3(log, environment, logging_on);
    let purpose = match n_required_intermediate_variables {
        0 => Ok((Interface::CoSimulation, event_mode_used)),
        _ => Err("there is no intermediate update, and no variable for it".to_owned()),
    };
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        instantiate(
            "fmi3InstantiateCoSimulation",
            logger,
            purpose,
            [instance_name, instantiation_token, resource_path],
        )
    }
}

/// Reports that there is no scheduled execution, and returns null.
///
/// # Safety
/// As the standard says: strings that end in zero, callbacks that can be called.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    instance_name: fmi3String,
    instantiation_token: fmi3String,
    resource_path: fmi3String,
    _visible: fmi3Boolean,
    logging_on: fmi3Boolean,
    environment: fmi3InstanceEnvironment,
    log: fmi3LogMessageCallback,
    _clock_update: fmi3ClockUpdateCallback,
    _lock_preemption: fmi3LockPreemptionCallback,
    _unlock_preemption: fmi3UnlockPreemptionCallback,
) -> fmi3Instance {
    let logger = Logger::fmi3(log, environment, logging_on);
    let purpose = Err("this FMU has no scheduled execution".to_owned());
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        instantiate(
            "fmi3InstantiateScheduledExecution",
            logger,
            purpose,
            [instance_name, instantiation_token, resource_path],
        )
    }
}

/// Creates an instance of an interface, with or without events, from name, token and resources.
///
/// # Safety
/// The strings are null or end in zero.
unsafe fn instantiate(
    function: &str,
    logger: Logger,
    purpose: Result<(Interface, bool), String>,
    [name, identity, resources]: [fmi3String; 3],
) -> fmi3Instance {
    let purpose = purpose.map(|(interface, has_events)| Purpose {
        interface,
        naming: Naming::Arrays,
        has_events,
    });
    let package = Package {
        identity_name: "instantiation token",
        identity,
        resources,
    };
    // SAFETY: the caller's promise.
    unsafe {
        let purpose = purpose.and_then(|purpose| match text(name) {
            Ok(_) => Ok(purpose),
            Err(_) => Err("the instance name is a null pointer".to_owned()),
        });
        create(function, logger, purpose, &package)
    }
}

/// Frees an instance; nothing for null.
///
/// # Safety
/// `instance` is null or a live instance, which is none after this.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: fmi3Instance) {
    // SAFETY: the caller keeps the standard's promises.
    unsafe { free(instance) }
}

exports! {
    /// Switches the reporting on and off, of all categories or of those named.
    fmi3SetDebugLogging: fmi3SetDebugLoggingTYPE = SetDebugLogging
    (logging_on: fmi3Boolean, n_categories: usize, categories: *const fmi3String)
    |instance| set_logging(instance, logging_on, read(categories, n_categories)?);

    /// Begins the initialization, at a start time.
    fmi3EnterInitializationMode: fmi3EnterInitializationModeTYPE = EnterInitializationMode
    (
        _tolerance_defined: fmi3Boolean,
        _tolerance: fmi3Float64,
        start_time: fmi3Float64,
        stop_time_defined: fmi3Boolean,
        stop_time: fmi3Float64,
    )
    |instance| {
        instance.setup_experiment(start_time, stop_time_defined.then_some(stop_time))?;
        instance.enter_initialization();
        Ok(())
    };

    /// Ends the initialization: parameters are fixed from here on.
    fmi3ExitInitializationMode: fmi3ExitInitializationModeTYPE = ExitInitializationMode
    () |instance| instance.exit_initialization();

    /// Ends the simulation; values can still be read.
    fmi3Terminate: fmi3TerminateTYPE = Terminate
    () |instance| instance.terminate();

    /// Back to how the instance was created.
    fmi3Reset: fmi3ResetTYPE = Reset
    () |instance| {
        instance.reset();
        Ok(())
    };

    /// Enters event mode.
    fmi3EnterEventMode: fmi3EnterEventModeTYPE = EnterEventMode
    () |instance| instance.enter_event_mode();

    /// Not available: there are no structural parameters.
    fmi3EnterConfigurationMode: fmi3EnterConfigurationModeTYPE = Unsupported
    () |_| refuse("there are no structural parameters to configure");

    /// Not available: there are no structural parameters.
    fmi3ExitConfigurationMode: fmi3ExitConfigurationModeTYPE = Unsupported
    () |_| refuse("there are no structural parameters to configure");
}
