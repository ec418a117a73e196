//! Sequences of calls of FMI 3.0.

use crate::calls::{
    Array, Buffer, Category, DISCARD, MOST_CALLS, Modes, Null, Number, OK, Place, Reference,
    messages, mode, take_note,
};
use crate::fmi2::functions;
use arbitrary::Arbitrary;
use fmi_sys::fmi3::*;
use std::ffi::{CString, c_char, c_void};
use std::ptr::{null, null_mut};

functions! {
    fmi3GetVersion: fmi3GetVersionTYPE;
    fmi3SetDebugLogging: fmi3SetDebugLoggingTYPE;
    fmi3InstantiateModelExchange: fmi3InstantiateModelExchangeTYPE;
    fmi3InstantiateCoSimulation: fmi3InstantiateCoSimulationTYPE;
    fmi3InstantiateScheduledExecution: fmi3InstantiateScheduledExecutionTYPE;
    fmi3FreeInstance: fmi3FreeInstanceTYPE;
    fmi3EnterInitializationMode: fmi3EnterInitializationModeTYPE;
    fmi3ExitInitializationMode: fmi3ExitInitializationModeTYPE;
    fmi3EnterEventMode: fmi3EnterEventModeTYPE;
    fmi3Terminate: fmi3TerminateTYPE;
    fmi3Reset: fmi3ResetTYPE;
    fmi3GetFloat64: fmi3GetFloat64TYPE;
    fmi3GetInt64: fmi3GetInt64TYPE;
    fmi3GetBoolean: fmi3GetBooleanTYPE;
    fmi3GetString: fmi3GetStringTYPE;
    fmi3GetBinary: fmi3GetBinaryTYPE;
    fmi3GetClock: fmi3GetClockTYPE;
    fmi3SetFloat64: fmi3SetFloat64TYPE;
    fmi3SetInt64: fmi3SetInt64TYPE;
    fmi3SetBoolean: fmi3SetBooleanTYPE;
    fmi3SetString: fmi3SetStringTYPE;
    fmi3SetBinary: fmi3SetBinaryTYPE;
    fmi3SetClock: fmi3SetClockTYPE;
    fmi3GetNumberOfVariableDependencies: fmi3GetNumberOfVariableDependenciesTYPE;
    fmi3GetVariableDependencies: fmi3GetVariableDependenciesTYPE;
    fmi3GetFMUState: fmi3GetFMUStateTYPE;
    fmi3SetFMUState: fmi3SetFMUStateTYPE;
    fmi3FreeFMUState: fmi3FreeFMUStateTYPE;
    fmi3SerializedFMUStateSize: fmi3SerializedFMUStateSizeTYPE;
    fmi3SerializeFMUState: fmi3SerializeFMUStateTYPE;
    fmi3DeserializeFMUState: fmi3DeserializeFMUStateTYPE;
    fmi3GetDirectionalDerivative: fmi3GetDirectionalDerivativeTYPE;
    fmi3GetAdjointDerivative: fmi3GetAdjointDerivativeTYPE;
    fmi3EnterConfigurationMode: fmi3EnterConfigurationModeTYPE;
    fmi3ExitConfigurationMode: fmi3ExitConfigurationModeTYPE;
    fmi3EvaluateDiscreteStates: fmi3EvaluateDiscreteStatesTYPE;
    fmi3UpdateDiscreteStates: fmi3UpdateDiscreteStatesTYPE;
    fmi3EnterContinuousTimeMode: fmi3EnterContinuousTimeModeTYPE;
    fmi3CompletedIntegratorStep: fmi3CompletedIntegratorStepTYPE;
    fmi3SetTime: fmi3SetTimeTYPE;
    fmi3SetContinuousStates: fmi3SetContinuousStatesTYPE;
    fmi3GetContinuousStateDerivatives: fmi3GetContinuousStateDerivativesTYPE;
    fmi3GetEventIndicators: fmi3GetEventIndicatorsTYPE;
    fmi3GetContinuousStates: fmi3GetContinuousStatesTYPE;
    fmi3GetNominalsOfContinuousStates: fmi3GetNominalsOfContinuousStatesTYPE;
    fmi3GetNumberOfEventIndicators: fmi3GetNumberOfEventIndicatorsTYPE;
    fmi3GetNumberOfContinuousStates: fmi3GetNumberOfContinuousStatesTYPE;
    fmi3EnterStepMode: fmi3EnterStepModeTYPE;
    fmi3GetOutputDerivatives: fmi3GetOutputDerivativesTYPE;
    fmi3DoStep: fmi3DoStepTYPE;
    fmi3ActivateModelPartition: fmi3ActivateModelPartitionTYPE;
}

/// What an instance is for.
#[derive(Arbitrary, Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    CoSimulation,
    WithEvents,
    Exchange,
    Scheduled,
}

/// A call with its arguments; of two instances, and of four saved states.
#[derive(Arbitrary, Debug, Clone)]
pub enum Call {
    /// Up to where steps can be made, or derivatives be read.
    Start(Kind),
    Instantiate {
        kind: Kind,
        name: Null,
        wrong_token: Null,
        place: Place,
        silent: Null,
        logging: bool,
        intermediate: Null,
    },
    FreeInstance,
    SetDebugLogging(bool, Array<Category>),
    EnterInitializationMode {
        start: Number,
        stop: Option<Number>,
        tolerance: Option<Number>,
    },
    ExitInitializationMode,
    Terminate,
    Reset,
    EnterEventMode,
    EnterStepMode,
    UpdateDiscreteStates(u8),
    EnterContinuousTimeMode,
    CompletedIntegratorStep(Null, Null),
    Unsupported(u8),
    Get {
        references: Array<Reference>,
        values: u8,
        null: Null,
    },
    Set {
        references: Array<Reference>,
        values: Array<Number>,
    },
    SetInputs(Number, Number),
    GetInt64 {
        references: Array<Reference>,
        values: u8,
        null: Null,
    },
    SetInt64 {
        references: Array<Reference>,
        values: Array<i64>,
    },
    SetTerrain(i8),
    GetBoolean {
        references: Array<Reference>,
        values: u8,
        null: Null,
    },
    SetBoolean {
        references: Array<Reference>,
        values: Array<bool>,
    },
    SetNoSlip(bool),
    Absent {
        which: u8,
        references: Array<Reference>,
    },
    GetState(u8, Null),
    SetState(u8),
    FreeState(u8, Null),
    Serialize {
        state: u8,
        missing: u8,
    },
    Deserialize {
        state: u8,
        missing: u8,
        damage: Option<(u16, u8)>,
    },
    Differentiate {
        adjoint: bool,
        unknowns: Array<Reference>,
        knowns: Array<Reference>,
        seed: Array<Number>,
        results: u8,
        null: Null,
    },
    Dependencies {
        of: Reference,
        count: Option<u8>,
        null: Null,
    },
    SetTime(Number),
    SetStates([Number; 6]),
    SetContinuousStates(Array<Number>),
    Six {
        which: u8,
        count: Option<u8>,
        null: Null,
    },
    Count {
        states: bool,
        null: Null,
    },
    GetOutputDerivatives {
        references: Array<(Reference, bool)>,
        results: u8,
        null: Null,
    },
    DoStep {
        size: Number,
        off: Option<Number>,
        null: u8,
    },
    Version,
}

unsafe extern "C" fn log(
    _environment: *mut c_void,
    status: fmi3Status,
    category: *const c_char,
    message: *const c_char,
) {
    assert!(status <= fmi3Status_fmi3Fatal);
    // SAFETY: the library's strings end in zero.
    unsafe { take_note(category, message) };
}

/// An instance, or none.
struct Slot {
    instance: fmi3Instance,
    modes: Modes,
    kind: Kind,
    listens: bool,
}

/// Everything that is live.
pub struct Host {
    token: CString,
    slots: [Slot; 2],
    states: [(fmi3FMUState, Modes); 4],
    bytes: Option<(Vec<u8>, Modes)>,
}

/// The time as a variable.
const TIME: u32 = 400;
const TERRAIN: u32 = 19;
const NO_SLIP: u32 = 39;

impl Host {
    pub fn new() -> Self {
        let token =
            ugv_terrain::declaration::guid(&ugv_terrain::declaration::Configuration::default());
        let slot = |_| Slot {
            instance: null_mut(),
            modes: Modes(0),
            kind: Kind::CoSimulation,
            listens: false,
        };
        Self {
            token: CString::new(token).unwrap(),
            slots: [0, 1].map(slot),
            states: [(null_mut(), Modes(0)); 4],
            bytes: None,
        }
    }

    /// Makes the calls, each with the number of its instance.
    pub fn run(mut self, calls: &[(bool, Call)]) {
        for (which, call) in calls.iter().take(MOST_CALLS) {
            self.call(usize::from(*which), call);
        }
        self.finish();
    }

    fn instantiate(
        &self,
        kind: Kind,
        name: bool,
        token: bool,
        place: *const c_char,
        log: fmi3LogMessageCallback,
        on: bool,
        variables: usize,
    ) -> fmi3Instance {
        let name = if name { c"fuzz".as_ptr() } else { null() };
        let token = if token {
            self.token.as_ptr()
        } else {
            c"%s#0#".as_ptr()
        };
        let (events, variable) = (kind == Kind::WithEvents, 2);
        // SAFETY: strings end in zero or are null, and there are so many variables as is said.
        unsafe {
            match kind {
                Kind::Exchange => {
                    fmi3InstantiateModelExchange()(name, token, place, false, on, null_mut(), log)
                }
                Kind::Scheduled => fmi3InstantiateScheduledExecution()(
                    name,
                    token,
                    place,
                    false,
                    on,
                    null_mut(),
                    log,
                    None,
                    None,
                    None,
                ),
                _ => fmi3InstantiateCoSimulation()(
                    name,
                    token,
                    place,
                    false,
                    on,
                    events,
                    true,
                    &variable,
                    variables,
                    null_mut(),
                    log,
                    None,
                ),
            }
        }
    }

    fn finish(mut self) {
        let instance = self.instantiate(Kind::CoSimulation, true, true, null(), None, false, 0);
        // SAFETY: each instance and each state is live or null, and not used after this.
        unsafe {
            for (state, _) in &mut self.states {
                assert_eq!(fmi3FreeFMUState()(instance, state), OK);
                assert!(state.is_null());
            }
            for slot in &self.slots {
                fmi3FreeInstance()(slot.instance);
            }
            fmi3FreeInstance()(instance);
        }
    }

    /// One call; its status has to fit the modes that the instance may be in.
    ///
    /// # Panics
    /// Where it does not fit.
    fn call(&mut self, which: usize, call: &Call) {
        use mode::*;
        let before = messages();
        let slot = &self.slots[which];
        let (c, kind, modes) = (slot.instance, slot.kind, slot.modes);
        let alone = |modes: u16| if kind == Kind::Exchange { modes } else { 0 };
        // The name of the call, its status, the modes that it is allowed in, and the one it leads to.
        // SAFETY: the instances and states are live or null; arrays have the length that is told.
        let (name, status, allowed, next) = unsafe {
            match call {
                Call::Version => {
                    assert!(!fmi3GetVersion()().is_null());
                    return;
                }
                Call::Instantiate {
                    kind,
                    name,
                    wrong_token,
                    place,
                    silent,
                    logging,
                    intermediate,
                } => {
                    fmi3FreeInstance()(c);
                    let log: fmi3LogMessageCallback = if silent.holds() { None } else { Some(log) };
                    let wrong = name.holds() || wrong_token.holds() || *kind == Kind::Scheduled;
                    let variables = usize::from(intermediate.holds());
                    let place = place.pointer();
                    let instance = self.instantiate(
                        *kind,
                        !name.holds(),
                        !wrong_token.holds(),
                        place,
                        log,
                        *logging,
                        variables,
                    );
                    let live = !instance.is_null();
                    assert!(!(live && wrong));
                    assert!(
                        live || log.is_none() || messages() > before,
                        "a refusal without a word"
                    );
                    let modes = Modes(if live { INSTANTIATED } else { 0 });
                    self.slots[which] = Slot {
                        instance,
                        modes,
                        kind: *kind,
                        listens: log.is_some() && *logging,
                    };
                    return;
                }
                Call::FreeInstance => {
                    fmi3FreeInstance()(c);
                    (self.slots[which].instance, self.slots[which].modes) = (null_mut(), Modes(0));
                    return;
                }
                Call::Start(kind) => {
                    self.start(which, *kind);
                    return;
                }
                Call::SetDebugLogging(on, categories) => {
                    let categories = categories.values(Category::pointer);
                    let status =
                        fmi3SetDebugLogging()(c, *on, categories.len(), categories.pointer());
                    if status == OK {
                        // What is switched on may not be errors.
                        self.slots[which].listens = false;
                    }
                    ("SetDebugLogging", status, ANY, None)
                }
                Call::EnterInitializationMode {
                    start,
                    stop,
                    tolerance,
                } => {
                    let [tolerance_given, stop_given] = [tolerance, stop].map(Option::is_some);
                    let [tolerance, stop] =
                        [tolerance, stop].map(|number| number.map_or(0.0, Number::value));
                    let enter = fmi3EnterInitializationMode();
                    let status = enter(
                        c,
                        tolerance_given,
                        tolerance,
                        start.value(),
                        stop_given,
                        stop,
                    );
                    (
                        "EnterInitializationMode",
                        status,
                        INSTANTIATED,
                        Some(INITIALIZATION),
                    )
                }
                Call::ExitInitializationMode => {
                    let next = match kind {
                        Kind::Exchange => EVENT,
                        Kind::WithEvents => STEP_EVENT,
                        _ => STEP,
                    };
                    (
                        "ExitInitializationMode",
                        fmi3ExitInitializationMode()(c),
                        INITIALIZATION,
                        Some(next),
                    )
                }
                Call::Terminate => ("Terminate", fmi3Terminate()(c), RUNNING, Some(TERMINATED)),
                Call::Reset => ("Reset", fmi3Reset()(c), ANY, Some(INSTANTIATED)),
                Call::EnterEventMode => {
                    let (allowed, next) = match kind {
                        Kind::Exchange => (EXCHANGE, EVENT),
                        Kind::WithEvents => (STEP, STEP_EVENT),
                        _ => (0, 0),
                    };
                    (
                        "EnterEventMode",
                        fmi3EnterEventMode()(c),
                        allowed,
                        Some(next),
                    )
                }
                Call::EnterStepMode => (
                    "EnterStepMode",
                    fmi3EnterStepMode()(c),
                    STEP_EVENT,
                    Some(STEP),
                ),
                Call::UpdateDiscreteStates(missing) => {
                    let (mut flags, mut time) = ([false; 5], 0.0);
                    let places: [_; 5] = std::array::from_fn(|k| {
                        if usize::from(*missing) == k {
                            null_mut()
                        } else {
                            &raw mut flags[k]
                        }
                    });
                    let [a, b, d, e, f] = places;
                    let time = if *missing == 5 {
                        null_mut()
                    } else {
                        &raw mut time
                    };
                    let status = fmi3UpdateDiscreteStates()(c, a, b, d, e, f, time);
                    assert!(status != OK || *missing > 5);
                    ("UpdateDiscreteStates", status, EVENT | STEP_EVENT, None)
                }
                Call::EnterContinuousTimeMode => (
                    "EnterContinuousTimeMode",
                    fmi3EnterContinuousTimeMode()(c),
                    EVENT,
                    Some(CONTINUOUS),
                ),
                Call::CompletedIntegratorStep(event, end) => {
                    let mut flags = [false; 2];
                    let [first, second] = &mut flags;
                    let status =
                        fmi3CompletedIntegratorStep()(c, true, event.or(first), end.or(second));
                    ("CompletedIntegratorStep", status, CONTINUOUS, None)
                }
                Call::Unsupported(which) => {
                    let status = match which % 4 {
                        0 => fmi3EnterConfigurationMode()(c),
                        1 => fmi3ExitConfigurationMode()(c),
                        2 => fmi3EvaluateDiscreteStates()(c),
                        _ => fmi3ActivateModelPartition()(c, 1, 0.0),
                    };
                    assert_ne!(status, OK);
                    ("what is not supported", status, 0, None)
                }
                Call::Get {
                    references,
                    values,
                    null,
                } => {
                    let references = references.values(|r| r.value());
                    let mut values = Buffer::room(usize::from(*values) % 100, *null, 0.0);
                    let (place, count) = (references.pointer(), references.len());
                    let status = fmi3GetFloat64()(c, place, count, values.place(), values.len());
                    values.check("GetFloat64", status);
                    ("GetFloat64", status, ANY, None)
                }
                Call::Set { references, values } => {
                    let (references, values) = (
                        references.values(|r| r.value()),
                        values.values(|number| number.value()),
                    );
                    let (place, count) = (references.pointer(), references.len());
                    let status = fmi3SetFloat64()(c, place, count, values.pointer(), values.len());
                    ("SetFloat64", status, EARLY | RUNNING, None)
                }
                Call::SetInputs(left, right) => {
                    let values = [left.value(), right.value()];
                    let status = fmi3SetFloat64()(c, [0, 1].as_ptr(), 2, values.as_ptr(), 2);
                    ("SetFloat64", status, EARLY | RUNNING, None)
                }
                Call::GetInt64 {
                    references,
                    values,
                    null,
                } => {
                    let references = references.values(|r| r.value());
                    let mut values = Buffer::room(usize::from(*values) % 13, *null, 0);
                    let (place, count) = (references.pointer(), references.len());
                    let status = fmi3GetInt64()(c, place, count, values.place(), values.len());
                    ("GetInt64", status, ANY, None)
                }
                Call::SetInt64 { references, values } => {
                    let (references, values) = (
                        references.values(|r| r.value()),
                        values.values(|number| *number),
                    );
                    let (place, count) = (references.pointer(), references.len());
                    let status = fmi3SetInt64()(c, place, count, values.pointer(), values.len());
                    ("SetInt64", status, EARLY | RUNNING, None)
                }
                Call::SetTerrain(terrain) => {
                    let status = fmi3SetInt64()(c, &TERRAIN, 1, &i64::from(*terrain), 1);
                    assert!(status != OK || (1..=5).contains(terrain));
                    ("SetInt64", status, EARLY, None)
                }
                Call::GetBoolean {
                    references,
                    values,
                    null,
                } => {
                    let references = references.values(|r| r.value());
                    let mut values = Buffer::room(usize::from(*values) % 13, *null, false);
                    let (place, count) = (references.pointer(), references.len());
                    let status = fmi3GetBoolean()(c, place, count, values.place(), values.len());
                    ("GetBoolean", status, ANY, None)
                }
                Call::SetBoolean { references, values } => {
                    let (references, values) = (
                        references.values(|r| r.value()),
                        values.values(|flag| *flag),
                    );
                    let (place, count) = (references.pointer(), references.len());
                    let status = fmi3SetBoolean()(c, place, count, values.pointer(), values.len());
                    ("SetBoolean", status, EARLY | RUNNING, None)
                }
                Call::SetNoSlip(on) => (
                    "SetBoolean",
                    fmi3SetBoolean()(c, &NO_SLIP, 1, on, 1),
                    EARLY,
                    None,
                ),
                Call::Absent { which, references } => {
                    let references = references.values(|r| r.value());
                    let (place, n) = (references.pointer(), references.len());
                    let (status, sets) = match which % 6 {
                        0 => (fmi3GetString()(c, place, n, null_mut(), 0), false),
                        1 => (fmi3SetString()(c, place, n, null(), 0), true),
                        2 => (
                            fmi3GetBinary()(c, place, n, null_mut(), null_mut(), 0),
                            false,
                        ),
                        3 => (fmi3SetBinary()(c, place, n, null(), null(), 0), true),
                        4 => (fmi3GetClock()(c, place, n, null_mut()), false),
                        _ => (fmi3SetClock()(c, place, n, null()), true),
                    };
                    assert!(status != OK || n == 0);
                    (
                        "a type that there is not",
                        status,
                        if sets { EARLY | RUNNING } else { ANY },
                        None,
                    )
                }
                Call::GetState(kept, null) => {
                    let (state, kept) = &mut self.states[usize::from(*kept) % 4];
                    let status = fmi3GetFMUState()(c, null.or(state));
                    if status == OK {
                        *kept = modes;
                    }
                    ("GetFMUState", status, ANY, None)
                }
                Call::SetState(kept) => {
                    let (state, kept) = self.states[usize::from(*kept) % 4];
                    (
                        "SetFMUState",
                        fmi3SetFMUState()(c, state),
                        ANY,
                        Some(kept.0),
                    )
                }
                Call::FreeState(kept, null) => {
                    let state = &mut self.states[usize::from(*kept) % 4].0;
                    (
                        "FreeFMUState",
                        fmi3FreeFMUState()(c, null.or(state)),
                        ANY,
                        None,
                    )
                }
                Call::Serialize { state, missing } => {
                    let (state, modes) = self.states[usize::from(*state) % 4];
                    let mut size = 0;
                    let status = fmi3SerializedFMUStateSize()(c, state, &mut size);
                    if status == OK {
                        let short = usize::from(*missing).saturating_sub(200);
                        let mut bytes = vec![0; size - short];
                        let status =
                            fmi3SerializeFMUState()(c, state, bytes.as_mut_ptr(), bytes.len());
                        assert_eq!(status == OK, short == 0);
                        if status == OK {
                            self.bytes = Some((bytes, modes));
                        }
                    }
                    ("SerializedFMUStateSize", status, ANY, None)
                }
                Call::Deserialize {
                    state,
                    missing,
                    damage,
                } => {
                    let (mut bytes, modes) = self.bytes.clone().unwrap_or((Vec::new(), Modes(0)));
                    let whole = bytes.len();
                    bytes.truncate(whole - usize::from(*missing).saturating_sub(200).min(whole));
                    let mut same = bytes.len() == whole && whole > 0;
                    if let Some((place, change)) = damage
                        && !bytes.is_empty()
                    {
                        let place = usize::from(*place) % bytes.len();
                        bytes[place] ^= change;
                        same &= *change == 0;
                    }
                    let (place, kept) = &mut self.states[usize::from(*state) % 4];
                    let status = fmi3DeserializeFMUState()(c, bytes.as_ptr(), bytes.len(), place);
                    assert!(
                        status != OK || same,
                        "a part of a state was taken for a whole one"
                    );
                    if status == OK {
                        *kept = modes;
                    }
                    ("DeserializeFMUState", status, ANY, None)
                }
                Call::Differentiate {
                    adjoint,
                    unknowns,
                    knowns,
                    seed,
                    results,
                    null,
                } => {
                    let [unknowns, knowns] =
                        [unknowns, knowns].map(|names| names.values(|r| r.value()));
                    let seed = seed.values(|number| number.value());
                    let mut values = Buffer::room(usize::from(*results) % 100, *null, 0.0);
                    let (u, k, room) = (unknowns.len(), knowns.len(), values.len());
                    let differentiate = if *adjoint {
                        fmi3GetAdjointDerivative()
                    } else {
                        fmi3GetDirectionalDerivative()
                    };
                    let place = values.place();
                    let status = differentiate(
                        c,
                        unknowns.pointer(),
                        u,
                        knowns.pointer(),
                        k,
                        seed.pointer(),
                        seed.len(),
                        place,
                        room,
                    );
                    values.check("derivatives", status);
                    ("derivatives", status, READABLE, None)
                }
                Call::Dependencies { of, count, null } => {
                    let mut number = 0;
                    let status = fmi3GetNumberOfVariableDependencies()(c, of.value(), &mut number);
                    let count = count.map_or(number, usize::from);
                    let [mut elements, mut others] =
                        [Buffer::room(count, *null, 0), Buffer::room(count, *null, 0)];
                    let (mut variables, mut kinds) =
                        (Buffer::room(count, *null, 0), Buffer::room(count, *null, 0));
                    let (first, second) = (elements.place(), others.place());
                    let told = fmi3GetVariableDependencies()(
                        c,
                        of.value(),
                        first,
                        variables.place(),
                        second,
                        kinds.place(),
                        count,
                    );
                    assert!(told != OK || status == OK && count == number);
                    ("GetNumberOfVariableDependencies", status, ANY, None)
                }
                Call::SetTime(time) => ("SetTime", fmi3SetTime()(c, time.value()), EXCHANGE, None),
                Call::SetStates(states) => {
                    let states = states.map(Number::value);
                    (
                        "SetContinuousStates",
                        fmi3SetContinuousStates()(c, states.as_ptr(), 6),
                        CONTINUOUS,
                        None,
                    )
                }
                Call::SetContinuousStates(states) => {
                    let states = states.values(|number| number.value());
                    let status = fmi3SetContinuousStates()(c, states.pointer(), states.len());
                    ("SetContinuousStates", status, CONTINUOUS, None)
                }
                Call::Six { which, count, null } => {
                    let count = count.map_or(6, |count| usize::from(count) % 9);
                    let mut values = Buffer::room(count, *null, 0.0);
                    let get = match which % 4 {
                        0 => fmi3GetContinuousStateDerivatives(),
                        1 => fmi3GetEventIndicators(),
                        2 => fmi3GetContinuousStates(),
                        _ => fmi3GetNominalsOfContinuousStates(),
                    };
                    let status = get(c, values.place(), count);
                    values.check("six", status);
                    (
                        "states, rates or indicators",
                        status,
                        alone(INITIALIZATION | EXCHANGE | OVER),
                        None,
                    )
                }
                Call::Count { states, null } => {
                    let mut count = 0;
                    let get = if *states {
                        fmi3GetNumberOfContinuousStates()
                    } else {
                        fmi3GetNumberOfEventIndicators()
                    };
                    (
                        "a number of states or indicators",
                        get(c, null.or(&mut count)),
                        alone(ANY),
                        None,
                    )
                }
                Call::GetOutputDerivatives {
                    references,
                    results,
                    null,
                } => {
                    let orders = references.values(|(_, strange)| if *strange { 2 } else { 1 });
                    let references = references.values(|(r, _)| r.value());
                    let mut values = Buffer::room(usize::from(*results) % 100, *null, 0.0);
                    let (place, count) = (references.pointer(), references.len());
                    let get = fmi3GetOutputDerivatives();
                    let status = get(
                        c,
                        place,
                        count,
                        orders.pointer(),
                        values.place(),
                        values.len(),
                    );
                    values.check("GetOutputDerivatives", status);
                    ("GetOutputDerivatives", status, STEP | OVER, None)
                }
                Call::DoStep { size, off, null } => {
                    let (mut time, mut flags, mut reached) = (0.0, [false; 3], f64::NAN);
                    let known = fmi3GetFloat64()(c, &TIME, 1, &mut time, 1);
                    assert!(known != OK || time.is_finite());
                    let point = off.map_or(time, |off| time + off.value());
                    let places: [_; 3] = std::array::from_fn(|k| {
                        if usize::from(*null) == k {
                            null_mut()
                        } else {
                            &raw mut flags[k]
                        }
                    });
                    let [event, end, early] = places;
                    let last = if *null == 3 {
                        null_mut()
                    } else {
                        &raw mut reached
                    };
                    let status = fmi3DoStep()(c, point, size.step(), true, event, end, early, last);
                    assert!(
                        status != OK || *null > 3 && reached.is_finite() && flags == [false; 3]
                    );
                    ("DoStep", status, STEP, None)
                }
            }
        };
        let slot = &mut self.slots[which];
        let listened = slot.listens && !slot.instance.is_null();
        // What a solver tries in vain is told to those alone who asked for events.
        assert!(
            [OK, DISCARD].contains(&status) || !listened || messages() > before,
            "{name} failed without a word"
        );
        slot.modes.learn(name, status, allowed, next);
    }

    /// A fresh start, wherever the instance stands.
    fn start(&mut self, which: usize, kind: Kind) {
        if self.slots[which].instance.is_null() {
            let kind = if kind == Kind::Scheduled {
                Kind::Exchange
            } else {
                kind
            };
            let instance = self.instantiate(kind, true, true, null(), Some(log), true, 0);
            assert!(!instance.is_null());
            self.slots[which] = Slot {
                instance,
                modes: Modes(mode::INSTANTIATED),
                kind,
                listens: true,
            };
        }
        let enter = Call::EnterInitializationMode {
            start: Number::Some(0),
            stop: None,
            tolerance: None,
        };
        for call in [Call::Reset, enter, Call::ExitInitializationMode] {
            self.call(which, &call);
        }
        match self.slots[which].kind {
            Kind::Exchange => self.call(which, &Call::EnterContinuousTimeMode),
            Kind::WithEvents => self.call(which, &Call::EnterStepMode),
            _ => {}
        }
    }
}
