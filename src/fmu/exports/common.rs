//! Creation, initialization, directional derivatives.

use super::conforms;
use crate::declaration::{Configuration, guid};
use crate::fmu::calls::{Call, Mode};
use crate::fmu::guard::{call, free, into_component, panic_message, read, write};
use crate::fmu::instance::{Instance, Interface, Outcome, refuse};
use crate::fmu::logger::{CATEGORIES, Logger};
use crate::fmu::resources;
use fmi_sys::fmi2::*;
use std::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

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

/// Switches the reporting of events on and off; errors and warnings are always reported.
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
            |instance| {
                for &category in read(categories, n_categories)? {
                    let known = text(category)?;
                    if !CATEGORIES.contains(&known) {
                        let known: Vec<_> =
                            CATEGORIES.iter().map(|c| c.to_string_lossy()).collect();
                        return refuse(format!("the log categories are {}", known.join(", ")));
                    }
                }
                instance.logger.verbose = logging_on != 0;
                Ok(())
            },
        )
    }
}

/// A string that C hands over.
///
/// # Safety
/// `string` is null or ends in a zero byte and lives as long as the result is used.
unsafe fn text<'a>(string: fmi2String) -> Outcome<&'a CStr> {
    if string.is_null() {
        return refuse("a string is a null pointer");
    }
    // SAFETY: not null; the caller promises the rest.
    Ok(unsafe { CStr::from_ptr(string) })
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
    // SAFETY: the caller keeps the standard's promises; a null pointer is no reference.
    let (functions, name) = unsafe { (functions.as_ref(), text(instance_name)) };
    let name = name.unwrap_or(c"ugv");
    let logger = Logger::new(functions, name, logging_on != 0);
    let created = catch_unwind(AssertUnwindSafe(|| {
        // SAFETY: as above.
        let (guid, location) = unsafe { (text(fmu_guid), text(fmu_resource_location)) };
        let Ok(guid) = guid else {
            return Err("the guid is a null pointer".to_owned());
        };
        configure(&logger, fmu_type, guid, location.unwrap_or(c""))
    }));
    let message = match created {
        Ok(Ok((interface, configuration))) => {
            return into_component(Instance::new(logger, interface, configuration));
        }
        Ok(Err(message)) => message,
        Err(panic) => panic_message(panic.as_ref()).to_owned(),
    };
    logger.error(&format!("fmi2Instantiate: {message}"));
    std::ptr::null_mut()
}

/// What the instance is to be, from what the importer says and the resources hold.
fn configure(
    logger: &Logger,
    fmu_type: fmi2Type,
    expected_guid: &CStr,
    location: &CStr,
) -> Result<(Interface, Configuration), String> {
    let interface = match fmu_type {
        fmi2Type_fmi2ModelExchange => Interface::ModelExchange,
        fmi2Type_fmi2CoSimulation => Interface::CoSimulation,
        other => return Err(format!("there is no FMU type {other}")),
    };
    let location = location
        .to_str()
        .map_err(|_| "the resource location is not UTF-8".to_owned())?;
    let folder = resources::folder(location)?;
    let configuration = match &folder {
        Some(folder) if folder.is_dir() => {
            Configuration::from_resources(|file| resources::read(folder, file))
                .map_err(|error| error.to_string())?
        }
        Some(folder) => {
            let folder = folder.display();
            logger.warning(&format!(
                "{folder} is no folder; the built-in vehicle and terrains serve"
            ));
            Configuration::default()
        }
        None => Configuration::default(),
    };
    let actual = guid(&configuration);
    let expected = expected_guid.to_string_lossy();
    if expected.trim_matches(['{', '}']) != actual {
        return Err(format!(
            "the model description's guid {expected} is not {actual}, the one of this library with these resources; \
             package the FMU anew with \"ugv package\""
        ));
    }
    let remembering = configuration.remembering();
    if interface == Interface::ModelExchange && !remembering.is_empty() {
        return Err(format!(
            "this FMU is for co-simulation alone: with {} its model has states that model exchange does not see",
            remembering.join(", ")
        ));
    }
    Ok((interface, configuration))
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
                instance.core.mode = Mode::Initialization;
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
            instance.core.mode = Mode::Terminated;
            let cost = instance.core.simulation()?.counters();
            instance.logger.event(&format!("integration: {cost:?}"));
            Ok(())
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
                instance.directional_derivative(
                    read(unknown_references, n_unknown)?,
                    read(known_references, n_known)?,
                    read(known_seeds, n_known)?,
                    write(unknown_values, n_unknown)?,
                )
            },
        )
    }
}
