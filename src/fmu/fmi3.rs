//! The functions of FMI 3.0.
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
use super::instance::{Instance, Purpose, refuse};
use super::logger::Logger;
use super::saved;
use super::values::{no_event_indicators, none_of};
use crate::declaration::{DependencyKind, Naming};
use crate::simulation::State;
use fmi_sys::fmi3::{fmi3Instance as Handle, fmi3Status as Status, *};
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

/// Creates an instance for model exchange. On failure it logs the reason and returns null.
///
/// # Safety
/// As the standard requires: strings that end in zero, a callback that outlives the instance.
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
    let strings = [instance_name, instantiation_token, resource_path];
    let purpose = Ok((Interface::ModelExchange, false));
    // SAFETY: the caller keeps the standard's promises.
    unsafe { instantiate("fmi3InstantiateModelExchange", logger, purpose, strings) }
}

/// Creates an instance for co-simulation. On failure it logs the reason and returns null.
///
/// # Safety
/// As the standard requires: strings that end in zero, an array of the given length, callbacks that
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
    let strings = [instance_name, instantiation_token, resource_path];
    let purpose = match n_required_intermediate_variables {
        0 => Ok((Interface::CoSimulation, event_mode_used)),
        _ => Err("there is no intermediate update, and no variable for it".to_owned()),
    };
    // SAFETY: the caller keeps the standard's promises.
    unsafe { instantiate("fmi3InstantiateCoSimulation", logger, purpose, strings) }
}

/// Not available: there is no scheduled execution. Logs that and returns null.
///
/// # Safety
/// As the standard requires: strings that end in zero, callbacks that can be called.
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
    let strings = [instance_name, instantiation_token, resource_path];
    let purpose = Err("this FMU has no scheduled execution".to_owned());
    // SAFETY: the caller keeps the standard's promises.
    unsafe {
        instantiate(
            "fmi3InstantiateScheduledExecution",
            logger,
            purpose,
            strings,
        )
    }
}

/// Creates an instance of an interface, with or without event mode, from name, token and resources.
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

/// Frees an instance. Null is allowed.
///
/// # Safety
/// `instance` is null or a live instance. It is invalid after the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: fmi3Instance) {
    // SAFETY: the caller keeps the standard's promises.
    unsafe { free(instance) }
}

exports! {
    /// Switches the logging on and off, of all categories or of the named ones.
    fmi3SetDebugLogging: fmi3SetDebugLoggingTYPE = SetDebugLogging
    (logging_on: fmi3Boolean, n_categories: usize, categories: *const fmi3String)
    |instance| set_logging(instance, logging_on, read(categories, n_categories)?);

    /// Enters initialization mode at a start time.
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
        instance.enter_initialization()
    };

    /// Exits initialization mode. From here on the parameters are fixed.
    fmi3ExitInitializationMode: fmi3ExitInitializationModeTYPE = ExitInitializationMode
    () |instance| instance.exit_initialization();

    /// Ends the simulation. Values can still be read.
    fmi3Terminate: fmi3TerminateTYPE = Terminate
    () |instance| instance.terminate();

    /// Returns to the state after the instantiation.
    fmi3Reset: fmi3ResetTYPE = Reset
    () |instance| instance.reset();

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

exports! {
    /// Reads variables of type Float64.
    fmi3GetFloat64: fmi3GetFloat64TYPE = GetOrStart
    (references: *const fmi3ValueReference, count: usize, values: *mut fmi3Float64, n_values: usize)
    |instance| instance.get_reals(read(references, count)?, write(values, n_values)?);

    /// Sets variables of type Float64.
    fmi3SetFloat64: fmi3SetFloat64TYPE = Set
    (references: *const fmi3ValueReference, count: usize, values: *const fmi3Float64, n_values: usize)
    |instance| instance.set_reals(read(references, count)?, read(values, n_values)?);

    /// Reads variables of an enumeration.
    fmi3GetInt64: fmi3GetInt64TYPE = GetOrStart
    (references: *const fmi3ValueReference, count: usize, values: *mut fmi3Int64, n_values: usize)
    |instance| instance.get_enumerations(read(references, count)?, write(values, n_values)?);

    /// Sets variables of an enumeration.
    fmi3SetInt64: fmi3SetInt64TYPE = Set
    (references: *const fmi3ValueReference, count: usize, values: *const fmi3Int64, n_values: usize)
    |instance| instance.set_enumerations(read(references, count)?, read(values, n_values)?);

    /// Reads variables of type Boolean.
    fmi3GetBoolean: fmi3GetBooleanTYPE = GetOrStart
    (references: *const fmi3ValueReference, count: usize, values: *mut fmi3Boolean, n_values: usize)
    |instance| instance.get_booleans(read(references, count)?, write(values, n_values)?);

    /// Sets variables of type Boolean.
    fmi3SetBoolean: fmi3SetBooleanTYPE = Set
    (references: *const fmi3ValueReference, count: usize, values: *const fmi3Boolean, n_values: usize)
    |instance| {
        // As bytes: a C program may pass other numbers than 0 and 1, which a Rust bool must not hold.
        let values = read(values.cast::<u8>(), n_values)?;
        instance.set_booleans(read(references, count)?, values, |value| value != 0)
    };
}

/// Functions of types that no variable has. They succeed for an empty list of references.
macro_rules! absent {
    ($($kind:literal: $get:ident $get_type:ident $set:ident $set_type:ident $value:ty;)*) => {
        exports! {$(
            #[doc = concat!("Reads variables of type ", $kind, ": there are none.")]
            $get: $get_type = GetOrStart
            (references: *const fmi3ValueReference, count: usize, _values: *mut $value, _n_values: usize)
            |_| none_of($kind, read(references, count)?);

            #[doc = concat!("Sets variables of type ", $kind, ": there are none.")]
            $set: $set_type = Set
            (references: *const fmi3ValueReference, count: usize, _values: *const $value, _n_values: usize)
            |_| none_of($kind, read(references, count)?);
        )*}
    };
}

absent! {
    "Float32": fmi3GetFloat32 fmi3GetFloat32TYPE fmi3SetFloat32 fmi3SetFloat32TYPE fmi3Float32;
    "Int8": fmi3GetInt8 fmi3GetInt8TYPE fmi3SetInt8 fmi3SetInt8TYPE fmi3Int8;
    "UInt8": fmi3GetUInt8 fmi3GetUInt8TYPE fmi3SetUInt8 fmi3SetUInt8TYPE fmi3UInt8;
    "Int16": fmi3GetInt16 fmi3GetInt16TYPE fmi3SetInt16 fmi3SetInt16TYPE fmi3Int16;
    "UInt16": fmi3GetUInt16 fmi3GetUInt16TYPE fmi3SetUInt16 fmi3SetUInt16TYPE fmi3UInt16;
    "Int32": fmi3GetInt32 fmi3GetInt32TYPE fmi3SetInt32 fmi3SetInt32TYPE fmi3Int32;
    "UInt32": fmi3GetUInt32 fmi3GetUInt32TYPE fmi3SetUInt32 fmi3SetUInt32TYPE fmi3UInt32;
    "UInt64": fmi3GetUInt64 fmi3GetUInt64TYPE fmi3SetUInt64 fmi3SetUInt64TYPE fmi3UInt64;
    "String": fmi3GetString fmi3GetStringTYPE fmi3SetString fmi3SetStringTYPE fmi3String;
}

exports! {
    /// Reads variables of type Binary: there are none.
    fmi3GetBinary: fmi3GetBinaryTYPE = GetOrStart
    (
        references: *const fmi3ValueReference,
        count: usize,
        _sizes: *mut usize,
        _values: *mut fmi3Binary,
        _n_values: usize,
    )
    |_| none_of("Binary", read(references, count)?);

    /// Sets variables of type Binary: there are none.
    fmi3SetBinary: fmi3SetBinaryTYPE = Set
    (
        references: *const fmi3ValueReference,
        count: usize,
        _sizes: *const usize,
        _values: *const fmi3Binary,
        _n_values: usize,
    )
    |_| none_of("Binary", read(references, count)?);
}

exports! {
    /// Saves the state of the instance.
    fmi3GetFMUState: fmi3GetFMUStateTYPE = GetState
    (state: *mut fmi3FMUState)
    |instance| saved::get(instance, state);

    /// Returns to a saved state.
    fmi3SetFMUState: fmi3SetFMUStateTYPE = SetState
    (state: fmi3FMUState)
    |instance| saved::set(instance, state);

    /// Frees a saved state. Null is allowed.
    fmi3FreeFMUState: fmi3FreeFMUStateTYPE = GetState
    (state: *mut fmi3FMUState)
    |_| saved::free(state);

    /// The number of bytes that [`fmi3SerializeFMUState`] writes.
    fmi3SerializedFMUStateSize: fmi3SerializedFMUStateSizeTYPE = Serialize
    (state: fmi3FMUState, size: *mut usize)
    |instance| saved::size(instance, state, size);

    /// Writes a saved state as bytes.
    fmi3SerializeFMUState: fmi3SerializeFMUStateTYPE = Serialize
    (state: fmi3FMUState, serialized: *mut fmi3Byte, size: usize)
    |instance| saved::serialize(instance, state, serialized, size);

    /// Makes a state from bytes.
    fmi3DeserializeFMUState: fmi3DeserializeFMUStateTYPE = Serialize
    (serialized: *const fmi3Byte, size: usize, state: *mut fmi3FMUState)
    |instance| saved::deserialize(instance, serialized, size, state);
}

/// Stands for all elements of a variable in the functions of dependencies.
const ALL_ELEMENTS: usize = 0;

/// Both functions of partial derivatives have the same arguments.
macro_rules! derivatives {
    ($($doc:literal: $function:ident $type:ident = $method:ident;)*) => {
        exports! {$(
            #[doc = $doc]
            $function: $type = Differentiate
            (
                unknowns: *const fmi3ValueReference,
                n_unknowns: usize,
                knowns: *const fmi3ValueReference,
                n_knowns: usize,
                seed: *const fmi3Float64,
                n_seed: usize,
                sensitivity: *mut fmi3Float64,
                n_sensitivity: usize,
            )
            |instance| {
                // A copy, as the result may lie in the same place.
                let seeds = read(seed, n_seed)?.to_vec();
                let (unknowns, knowns) = (read(unknowns, n_unknowns)?, read(knowns, n_knowns)?);
                instance.$method(unknowns, knowns, &seeds, write(sensitivity, n_sensitivity)?)
            };
        )*}
    };
}

derivatives! {
    "Derivatives of outputs and state derivatives in a direction of inputs, states and the time.":
        fmi3GetDirectionalDerivative fmi3GetDirectionalDerivativeTYPE = directional_derivative;
    "Derivatives of a weighted sum of outputs and state derivatives by inputs, states and the time.":
        fmi3GetAdjointDerivative fmi3GetAdjointDerivativeTYPE = adjoint_derivative;
}

exports! {
    /// The number of variables on which an output or a state derivative depends.
    fmi3GetNumberOfVariableDependencies: fmi3GetNumberOfVariableDependenciesTYPE = GetDependencies
    (reference: fmi3ValueReference, count: *mut usize)
    |instance| {
        *out(count)? = instance.dependencies(reference)?.0.len();
        Ok(())
    };

    /// The variables on which an output or a state derivative depends. They are the same for all elements of an array.
    fmi3GetVariableDependencies: fmi3GetVariableDependenciesTYPE = GetDependencies
    (
        dependent: fmi3ValueReference,
        dependent_elements: *mut usize,
        independents: *mut fmi3ValueReference,
        independent_elements: *mut usize,
        kinds: *mut fmi3DependencyKind,
        count: usize,
    )
    |instance| {
        let (references, kind) = instance.dependencies(dependent)?;
        if references.len() != count {
            return refuse(format!("there are {} dependencies, not {count}", references.len()));
        }
        write(dependent_elements, count)?.fill(ALL_ELEMENTS);
        write(independents, count)?.copy_from_slice(&references);
        write(independent_elements, count)?.fill(ALL_ELEMENTS);
        write(kinds, count)?.fill(match kind {
            DependencyKind::Constant => fmi3DependencyKind_fmi3Constant,
            DependencyKind::Dependent => fmi3DependencyKind_fmi3Dependent,
        });
        Ok(())
    };
}

exports! {
    /// Ends the event mode of a co-simulation.
    fmi3EnterStepMode: fmi3EnterStepModeTYPE = EnterStepMode
    () |instance| instance.enter_step_mode();

    /// The first derivatives of outputs in time.
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

    /// Simulates one communication step to its end. It never returns early, needs no event and never asks to
    /// end the simulation.
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
        // A result that cannot be written is refused before the step.
        *out(event_handling_needed)? = false;
        *out(terminate_simulation)? = false;
        *out(early_return)? = false;
        let reached = out(last_successful_time)?;
        let stepped = instance.step(current_communication_point, communication_step_size);
        *reached = instance.core.time;
        stepped
    };
}

exports! {
    /// Not available: there are no discrete states.
    fmi3EvaluateDiscreteStates: fmi3EvaluateDiscreteStatesTYPE = Unsupported
    () |_| refuse("there are no discrete states to evaluate");

    /// Handles an event. Effects with a time window switch here; the result holds the next such time.
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

    /// Completes an integrator step. The model never asks for an event.
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

    /// Sets the time. Only effects depend on it.
    fmi3SetTime: fmi3SetTimeTYPE = SetTime
    (time: fmi3Float64) |instance| instance.set_time(time);

    /// Sets the states.
    fmi3SetContinuousStates: fmi3SetContinuousStatesTYPE = SetContinuousStates
    (states: *const fmi3Float64, count: usize)
    |instance| instance.set_states(read(states, count)?);

    /// The derivatives of the states.
    fmi3GetContinuousStateDerivatives: fmi3GetContinuousStateDerivativesTYPE = GetContinuousStates
    (derivatives: *mut fmi3Float64, count: usize)
    |instance| instance.get_rates(write(derivatives, count)?);

    /// Event indicators: there are none.
    fmi3GetEventIndicators: fmi3GetEventIndicatorsTYPE = GetContinuousStates
    (_indicators: *mut fmi3Float64, count: usize)
    |_| no_event_indicators(count);

    /// The states.
    fmi3GetContinuousStates: fmi3GetContinuousStatesTYPE = GetContinuousStates
    (states: *mut fmi3Float64, count: usize)
    |instance| instance.get_states(write(states, count)?);

    /// Orders of magnitude of the states.
    fmi3GetNominalsOfContinuousStates: fmi3GetNominalsOfContinuousStatesTYPE = GetContinuousStates
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

/// Functions of clocks. They succeed for an empty list of references.
macro_rules! clocks {
    ($($doc:literal: $function:ident $type:ident = $call:ident ($($result:ty),*);)*) => {
        exports! {$(
            #[doc = concat!($doc, ": there are none.")]
            $function: $type = $call
            (references: *const fmi3ValueReference, count: usize, $(_: $result),*)
            |_| none_of("Clock", read(references, count)?);
        )*}
    };
}

clocks! {
    "Reads clocks": fmi3GetClock fmi3GetClockTYPE = GetOrStart (*mut fmi3Clock);
    "Sets clocks": fmi3SetClock fmi3SetClockTYPE = Set (*const fmi3Clock);
    "Intervals of clocks": fmi3GetIntervalDecimal fmi3GetIntervalDecimalTYPE = GetOrStart
        (*mut fmi3Float64, *mut fmi3IntervalQualifier);
    "Intervals of clocks": fmi3GetIntervalFraction fmi3GetIntervalFractionTYPE = GetOrStart
        (*mut fmi3UInt64, *mut fmi3UInt64, *mut fmi3IntervalQualifier);
    "Shifts of clocks": fmi3GetShiftDecimal fmi3GetShiftDecimalTYPE = GetOrStart (*mut fmi3Float64);
    "Shifts of clocks": fmi3GetShiftFraction fmi3GetShiftFractionTYPE = GetOrStart
        (*mut fmi3UInt64, *mut fmi3UInt64);
    "Sets intervals of clocks": fmi3SetIntervalDecimal fmi3SetIntervalDecimalTYPE = Set (*const fmi3Float64);
    "Sets intervals of clocks": fmi3SetIntervalFraction fmi3SetIntervalFractionTYPE = Set
        (*const fmi3UInt64, *const fmi3UInt64);
    "Sets shifts of clocks": fmi3SetShiftDecimal fmi3SetShiftDecimalTYPE = Set (*const fmi3Float64);
    "Sets shifts of clocks": fmi3SetShiftFraction fmi3SetShiftFractionTYPE = Set
        (*const fmi3UInt64, *const fmi3UInt64);
}

exports! {
    /// Not available: there is no scheduled execution.
    fmi3ActivateModelPartition: fmi3ActivateModelPartitionTYPE = Unsupported
    (_clock: fmi3ValueReference, _activation_time: fmi3Float64)
    |_| refuse("this FMU has no scheduled execution");
}
