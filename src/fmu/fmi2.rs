//! The 44 functions of FMI 2.0.
#![allow(
    non_snake_case,
    non_upper_case_globals,
    reason = "the standard's names"
)]
#![allow(clippy::too_many_arguments, reason = "the standard's signatures")]

use super::calls::Interface;
use super::creation::{Package, create, set_logging, text};
use super::exports::exports;
use super::guard::{free, out, read, write};
use super::instance::{Failure, Instance, Outcome, Purpose, refuse};
use super::logger::Logger;
use super::saved;
use super::values::{no_event_indicators, none_of};
use crate::declaration::Naming;
use fmi_sys::fmi2::{fmi2Component as Handle, fmi2Status as Status, *};
use std::ffi::c_char;

const _: fmi2GetTypesPlatformTYPE = Some(fmi2GetTypesPlatform);
const _: fmi2GetVersionTYPE = Some(fmi2GetVersion);
const _: fmi2InstantiateTYPE = Some(fmi2Instantiate);
const _: fmi2FreeInstanceTYPE = Some(fmi2FreeInstance);

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

/// Creates an instance. On failure it logs the reason and returns null.
///
/// # Safety
/// As the standard requires: strings that end in zero, callbacks that outlive the instance.
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
    let package = Package {
        identity_name: "guid",
        identity: fmu_guid,
        resources: fmu_resource_location,
    };
    // SAFETY: the caller keeps the standard's promises; a null pointer is no reference.
    unsafe {
        let name = text(instance_name).unwrap_or(c"ugv");
        let logger = Logger::fmi2(functions.as_ref(), name, logging_on != 0);
        create("fmi2Instantiate", logger, purpose, &package)
    }
}

/// Frees an instance. Null is allowed.
///
/// # Safety
/// `component` is null or a live component. It is invalid after the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(component: fmi2Component) {
    // SAFETY: the caller keeps the standard's promises.
    unsafe { free(component) }
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

exports! {
    /// Switches the logging of events and discarded calls on and off. Errors and warnings are always logged.
    fmi2SetDebugLogging: fmi2SetDebugLoggingTYPE = SetDebugLogging
    (logging_on: fmi2Boolean, n_categories: usize, categories: *const fmi2String)
    |instance| set_logging(instance, logging_on != 0, read(categories, n_categories)?);

    /// Sets start and stop time.
    fmi2SetupExperiment: fmi2SetupExperimentTYPE = SetupExperiment
    (
        _tolerance_defined: fmi2Boolean,
        _tolerance: fmi2Real,
        start_time: fmi2Real,
        stop_time_defined: fmi2Boolean,
        stop_time: fmi2Real,
    )
    |instance| instance.setup_experiment(start_time, (stop_time_defined != 0).then_some(stop_time));

    /// Enters initialization mode.
    fmi2EnterInitializationMode: fmi2EnterInitializationModeTYPE = EnterInitializationMode
    () |instance| instance.enter_initialization();

    /// Exits initialization mode. From here on the parameters are fixed.
    fmi2ExitInitializationMode: fmi2ExitInitializationModeTYPE = ExitInitializationMode
    () |instance| instance.exit_initialization();

    /// Ends the simulation. Values can still be read.
    fmi2Terminate: fmi2TerminateTYPE = Terminate
    () |instance| instance.terminate();

    /// Returns to the state after the instantiation.
    fmi2Reset: fmi2ResetTYPE = Reset
    () |instance| instance.reset();

    /// Reads variables of type Real.
    fmi2GetReal: fmi2GetRealTYPE = Get
    (references: *const fmi2ValueReference, count: usize, values: *mut fmi2Real)
    |instance| instance.get_reals(read(references, count)?, write(values, count)?);

    /// Sets variables of type Real.
    fmi2SetReal: fmi2SetRealTYPE = Set
    (references: *const fmi2ValueReference, count: usize, values: *const fmi2Real)
    |instance| instance.set_reals(read(references, count)?, read(values, count)?);

    /// Reads variables of type Integer or of an enumeration.
    fmi2GetInteger: fmi2GetIntegerTYPE = Get
    (references: *const fmi2ValueReference, count: usize, values: *mut fmi2Integer)
    |instance| instance.get_enumerations(read(references, count)?, write(values, count)?);

    /// Sets variables of type Integer or of an enumeration.
    fmi2SetInteger: fmi2SetIntegerTYPE = Set
    (references: *const fmi2ValueReference, count: usize, values: *const fmi2Integer)
    |instance| instance.set_enumerations(read(references, count)?, read(values, count)?);

    /// Reads variables of type Boolean.
    fmi2GetBoolean: fmi2GetBooleanTYPE = Get
    (references: *const fmi2ValueReference, count: usize, values: *mut fmi2Boolean)
    |instance| instance.get_booleans(read(references, count)?, write(values, count)?);

    /// Sets variables of type Boolean.
    fmi2SetBoolean: fmi2SetBooleanTYPE = Set
    (references: *const fmi2ValueReference, count: usize, values: *const fmi2Boolean)
    |instance| instance.set_booleans(read(references, count)?, read(values, count)?, |value| value != 0);

    /// Reads variables of type String: there are none.
    fmi2GetString: fmi2GetStringTYPE = Get
    (references: *const fmi2ValueReference, count: usize, _values: *mut fmi2String)
    |_| none_of("String", read(references, count)?);

    /// Sets variables of type String: there are none.
    fmi2SetString: fmi2SetStringTYPE = Set
    (references: *const fmi2ValueReference, count: usize, _values: *const fmi2String)
    |_| none_of("String", read(references, count)?);

    /// Saves the state of the instance.
    fmi2GetFMUstate: fmi2GetFMUstateTYPE = GetState
    (state: *mut fmi2FMUstate)
    |instance| saved::get(instance, state);

    /// Returns to a saved state.
    fmi2SetFMUstate: fmi2SetFMUstateTYPE = SetState
    (state: fmi2FMUstate)
    |instance| saved::set(instance, state);

    /// Frees a saved state. Null is allowed.
    fmi2FreeFMUstate: fmi2FreeFMUstateTYPE = GetState
    (state: *mut fmi2FMUstate)
    |_| saved::free(state);

    /// The number of bytes that `fmi2SerializeFMUstate` writes.
    fmi2SerializedFMUstateSize: fmi2SerializedFMUstateSizeTYPE = Serialize
    (state: fmi2FMUstate, size: *mut usize)
    |instance| saved::size(instance, state, size);

    /// Writes a saved state as bytes.
    fmi2SerializeFMUstate: fmi2SerializeFMUstateTYPE = Serialize
    (state: fmi2FMUstate, serialized: *mut fmi2Byte, size: usize)
    |instance| saved::serialize(instance, state, serialized.cast(), size);

    /// Makes a state from bytes.
    fmi2DeSerializeFMUstate: fmi2DeSerializeFMUstateTYPE = Serialize
    (serialized: *const fmi2Byte, size: usize, state: *mut fmi2FMUstate)
    |instance| saved::deserialize(instance, serialized.cast(), size, state);

    /// Derivatives of outputs and state derivatives in a direction of inputs and states.
    fmi2GetDirectionalDerivative: fmi2GetDirectionalDerivativeTYPE = Differentiate
    (
        unknown_references: *const fmi2ValueReference,
        n_unknown: usize,
        known_references: *const fmi2ValueReference,
        n_known: usize,
        known_seeds: *const fmi2Real,
        unknown_values: *mut fmi2Real,
    )
    |instance| {
        // A copy, as the result may lie in the same place.
        let seeds = read(known_seeds, n_known)?.to_vec();
        let (unknowns, knowns) = (read(unknown_references, n_unknown)?, read(known_references, n_known)?);
        instance.directional_derivative(unknowns, knowns, &seeds, write(unknown_values, n_unknown)?)
    };

    // Co-simulation.

    /// Sets the rates at which the wheel speeds change during the next step.
    fmi2SetRealInputDerivatives: fmi2SetRealInputDerivativesTYPE = SetInputDerivatives
    (
        references: *const fmi2ValueReference,
        count: usize,
        orders: *const fmi2Integer,
        values: *const fmi2Real,
    )
    |instance| {
        let (orders, values) = (read(orders, count)?, read(values, count)?);
        instance.set_input_rates(read(references, count)?, orders, values)
    };

    /// The first derivatives of outputs in time.
    fmi2GetRealOutputDerivatives: fmi2GetRealOutputDerivativesTYPE = GetOutputDerivatives
    (
        references: *const fmi2ValueReference,
        count: usize,
        orders: *const fmi2Integer,
        values: *mut fmi2Real,
    )
    |instance| {
        let (orders, values) = (read(orders, count)?, write(values, count)?);
        instance.output_derivatives(read(references, count)?, orders, values)
    };

    /// Simulates one communication step.
    fmi2DoStep: fmi2DoStepTYPE = DoStep
    (
        current_communication_point: fmi2Real,
        communication_step_size: fmi2Real,
        _no_set_fmu_state_prior_to_current_point: fmi2Boolean,
    )
    |instance| instance.step(current_communication_point, communication_step_size);

    /// Not available: steps are never asynchronous.
    fmi2CancelStep: fmi2CancelStepTYPE = CancelStep
    () |_| Ok(());

    /// Not available: steps are never asynchronous.
    fmi2GetStatus: fmi2GetStatusTYPE = GetStatus
    (kind: fmi2StatusKind, _value: *mut fmi2Status)
    |_| unavailable(kind);

    /// The time that the last step reached.
    fmi2GetRealStatus: fmi2GetRealStatusTYPE = GetStatus
    (kind: fmi2StatusKind, value: *mut fmi2Real)
    |instance| {
        if kind != fmi2StatusKind_fmi2LastSuccessfulTime {
            return unavailable(kind);
        }
        *out(value)? = instance.core.time;
        Ok(())
    };

    /// Not available: there is no such status.
    fmi2GetIntegerStatus: fmi2GetIntegerStatusTYPE = GetStatus
    (kind: fmi2StatusKind, _value: *mut fmi2Integer)
    |_| unavailable(kind);

    /// Whether the FMU asks to end the simulation: it never does.
    fmi2GetBooleanStatus: fmi2GetBooleanStatusTYPE = GetStatus
    (kind: fmi2StatusKind, value: *mut fmi2Boolean)
    |_| {
        if kind != fmi2StatusKind_fmi2Terminated {
            return unavailable(kind);
        }
        *out(value)? = 0;
        Ok(())
    };

    /// Not available: steps are never asynchronous.
    fmi2GetStringStatus: fmi2GetStringStatusTYPE = GetStatus
    (kind: fmi2StatusKind, _value: *mut fmi2String)
    |_| unavailable(kind);

    // Model exchange: the importer integrates the six states.

    /// Enters event mode.
    fmi2EnterEventMode: fmi2EnterEventModeTYPE = EnterEventMode
    () |instance| instance.enter_event_mode();

    /// Handles an event. Effects with a time window switch here; the result holds the next such time.
    fmi2NewDiscreteStates: fmi2NewDiscreteStatesTYPE = NewDiscreteStates
    (event_info: *mut fmi2EventInfo)
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
    };

    /// Enters continuous-time mode.
    fmi2EnterContinuousTimeMode: fmi2EnterContinuousTimeModeTYPE = EnterContinuousTimeMode
    () |instance| instance.enter_continuous_time_mode();

    /// Completes an integrator step. The model never asks for an event.
    fmi2CompletedIntegratorStep: fmi2CompletedIntegratorStepTYPE = CompletedIntegratorStep
    (
        _no_set_fmu_state_prior_to_current_point: fmi2Boolean,
        enter_event_mode: *mut fmi2Boolean,
        terminate_simulation: *mut fmi2Boolean,
    )
    |_| {
        *out(enter_event_mode)? = 0;
        *out(terminate_simulation)? = 0;
        Ok(())
    };

    /// Sets the time. Only effects depend on it.
    fmi2SetTime: fmi2SetTimeTYPE = SetTime
    (time: fmi2Real)
    |instance| instance.set_time(time);

    /// Sets the states.
    fmi2SetContinuousStates: fmi2SetContinuousStatesTYPE = SetContinuousStates
    (states: *const fmi2Real, count: usize)
    |instance| instance.set_states(read(states, count)?);

    /// The derivatives of the states.
    fmi2GetDerivatives: fmi2GetDerivativesTYPE = GetDerivatives
    (derivatives: *mut fmi2Real, count: usize)
    |instance| instance.get_rates(write(derivatives, count)?);

    /// Event indicators: there are none.
    fmi2GetEventIndicators: fmi2GetEventIndicatorsTYPE = GetContinuousStates
    (_indicators: *mut fmi2Real, count: usize)
    |_| no_event_indicators(count);

    /// The states.
    fmi2GetContinuousStates: fmi2GetContinuousStatesTYPE = GetContinuousStates
    (states: *mut fmi2Real, count: usize)
    |instance| instance.get_states(write(states, count)?);

    /// Orders of magnitude of the states.
    fmi2GetNominalsOfContinuousStates: fmi2GetNominalsOfContinuousStatesTYPE = GetNominals
    (nominals: *mut fmi2Real, count: usize)
    |_| Instance::get_nominals(write(nominals, count)?);
}
