//! Sequences of calls of FMI 2.0.

use crate::calls::{
    Array, Buffer, Category, DISCARD, MOST_CALLS, Modes, Null, Number, OK, Place, Reference,
    messages, mode, take_note,
};
use arbitrary::Arbitrary;
use fmi_sys::fmi2::*;
use std::ffi::{CString, c_char, c_void};
use std::ptr::{null, null_mut};

/// Functions of the library under their own names, with the standard's types.
macro_rules! functions {
    ($($name:ident: $of:ident;)*) => {
        mod symbols {
            #[allow(non_snake_case)]
            unsafe extern "C" { $(pub fn $name();)* }
        }
        $(#[allow(non_snake_case)]
        fn $name() -> <$of as IntoIterator>::Item {
            // SAFETY: the library checks at compile time that the function has this type.
            let function: $of = unsafe { std::mem::transmute(symbols::$name as *const ()) };
            function.expect("a function is no null pointer")
        })*
    };
}
pub(crate) use functions;

functions! {
    fmi2GetTypesPlatform: fmi2GetTypesPlatformTYPE;
    fmi2GetVersion: fmi2GetVersionTYPE;
    fmi2SetDebugLogging: fmi2SetDebugLoggingTYPE;
    fmi2Instantiate: fmi2InstantiateTYPE;
    fmi2FreeInstance: fmi2FreeInstanceTYPE;
    fmi2SetupExperiment: fmi2SetupExperimentTYPE;
    fmi2EnterInitializationMode: fmi2EnterInitializationModeTYPE;
    fmi2ExitInitializationMode: fmi2ExitInitializationModeTYPE;
    fmi2Terminate: fmi2TerminateTYPE;
    fmi2Reset: fmi2ResetTYPE;
    fmi2GetReal: fmi2GetRealTYPE;
    fmi2GetInteger: fmi2GetIntegerTYPE;
    fmi2GetBoolean: fmi2GetBooleanTYPE;
    fmi2GetString: fmi2GetStringTYPE;
    fmi2SetReal: fmi2SetRealTYPE;
    fmi2SetInteger: fmi2SetIntegerTYPE;
    fmi2SetBoolean: fmi2SetBooleanTYPE;
    fmi2SetString: fmi2SetStringTYPE;
    fmi2GetFMUstate: fmi2GetFMUstateTYPE;
    fmi2SetFMUstate: fmi2SetFMUstateTYPE;
    fmi2FreeFMUstate: fmi2FreeFMUstateTYPE;
    fmi2SerializedFMUstateSize: fmi2SerializedFMUstateSizeTYPE;
    fmi2SerializeFMUstate: fmi2SerializeFMUstateTYPE;
    fmi2DeSerializeFMUstate: fmi2DeSerializeFMUstateTYPE;
    fmi2GetDirectionalDerivative: fmi2GetDirectionalDerivativeTYPE;
    fmi2EnterEventMode: fmi2EnterEventModeTYPE;
    fmi2NewDiscreteStates: fmi2NewDiscreteStatesTYPE;
    fmi2EnterContinuousTimeMode: fmi2EnterContinuousTimeModeTYPE;
    fmi2CompletedIntegratorStep: fmi2CompletedIntegratorStepTYPE;
    fmi2SetTime: fmi2SetTimeTYPE;
    fmi2SetContinuousStates: fmi2SetContinuousStatesTYPE;
    fmi2GetDerivatives: fmi2GetDerivativesTYPE;
    fmi2GetEventIndicators: fmi2GetEventIndicatorsTYPE;
    fmi2GetContinuousStates: fmi2GetContinuousStatesTYPE;
    fmi2GetNominalsOfContinuousStates: fmi2GetNominalsOfContinuousStatesTYPE;
    fmi2SetRealInputDerivatives: fmi2SetRealInputDerivativesTYPE;
    fmi2GetRealOutputDerivatives: fmi2GetRealOutputDerivativesTYPE;
    fmi2DoStep: fmi2DoStepTYPE;
    fmi2CancelStep: fmi2CancelStepTYPE;
    fmi2GetStatus: fmi2GetStatusTYPE;
    fmi2GetRealStatus: fmi2GetRealStatusTYPE;
    fmi2GetIntegerStatus: fmi2GetIntegerStatusTYPE;
    fmi2GetBooleanStatus: fmi2GetBooleanStatusTYPE;
    fmi2GetStringStatus: fmi2GetStringStatusTYPE;
}

/// A call with its arguments; of two instances, and of four saved states.
#[derive(Arbitrary, Debug, Clone)]
pub enum Call {
    /// Up to where steps can be made, or derivatives be read.
    Start,
    Instantiate {
        exchange: bool,
        strange_type: Null,
        name: Null,
        wrong_guid: Null,
        place: Place,
        functions: Null,
        logging: bool,
    },
    FreeInstance,
    SetDebugLogging(bool, Array<Category>),
    SetupExperiment {
        start: Number,
        stop: Option<Number>,
        tolerance: Option<Number>,
    },
    EnterInitializationMode,
    ExitInitializationMode,
    Terminate,
    Reset,
    GetReal(Array<Reference>, Null),
    SetReal(Array<(Reference, Number)>, Null),
    SetInputs(Number, Number),
    GetInteger(Array<Reference>, Null),
    GetTerrain(bool),
    SetInteger(Array<(Reference, i32)>, Null),
    SetTerrain(i8),
    GetBoolean(Array<Reference>, Null),
    SetBoolean(Array<(Reference, i32)>, Null),
    Strings {
        set: bool,
        references: Array<Reference>,
    },
    GetState(u8, Null),
    SetState(u8),
    FreeState(u8, Null),
    Serialize {
        state: u8,
        missing: u8,
    },
    DeSerialize {
        state: u8,
        missing: u8,
        damage: Option<(u16, u8)>,
    },
    Differentiate {
        unknowns: Array<Reference>,
        knowns: Array<(Reference, Number)>,
        values: Null,
    },
    EnterEventMode,
    NewDiscreteStates(Null),
    EnterContinuousTimeMode,
    CompletedIntegratorStep(Null, Null),
    SetTime(Number),
    SetStates([Number; 6]),
    SetContinuousStates(Array<Number>),
    Six {
        which: u8,
        count: Option<u8>,
        null: Null,
    },
    SetInputDerivatives(Array<(Reference, Number, bool)>, Null),
    GetOutputDerivatives(Array<(Reference, bool)>, Null),
    DoStep {
        size: Number,
        off: Option<Number>,
    },
    CancelStep,
    Status {
        which: u8,
        kind: u8,
        null: Null,
    },
    Versions,
}

unsafe extern "C" fn log(
    _environment: *mut c_void,
    name: *const c_char,
    status: fmi2Status,
    category: *const c_char,
    message: *const c_char,
) {
    assert!(!name.is_null() && status <= fmi2Status_fmi2Fatal);
    // SAFETY: the library's strings end in zero.
    unsafe { take_note(category, message) };
}

/// An instance, or none.
struct Slot {
    component: fmi2Component,
    modes: Modes,
    exchange: bool,
    listens: bool,
}

/// Everything that is live.
pub struct Host {
    guid: CString,
    functions: fmi2CallbackFunctions,
    slots: [Slot; 2],
    states: [(fmi2FMUstate, Modes); 4],
    bytes: Option<(Vec<c_char>, Modes)>,
}

impl Host {
    pub fn new() -> Self {
        let guid =
            ugv_terrain::declaration::guid(&ugv_terrain::declaration::Configuration::default());
        // SAFETY: the fixed arguments of a variadic function are passed like any others.
        let logger: fmi2CallbackLogger = unsafe { std::mem::transmute(log as *const ()) };
        let slot = |_| Slot {
            component: null_mut(),
            modes: Modes(0),
            exchange: false,
            listens: false,
        };
        Self {
            guid: CString::new(guid).unwrap(),
            functions: fmi2CallbackFunctions {
                logger,
                allocateMemory: None,
                freeMemory: None,
                stepFinished: None,
                componentEnvironment: null_mut(),
            },
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

    fn finish(mut self) {
        // SAFETY: each instance and each state is live or null, and not used after this.
        unsafe {
            let c = fmi2Instantiate()(
                null(),
                fmi2Type_fmi2CoSimulation,
                self.guid.as_ptr(),
                null(),
                null(),
                0,
                0,
            );
            for (state, _) in &mut self.states {
                assert_eq!(fmi2FreeFMUstate()(c, state), OK);
                assert!(state.is_null());
            }
            for slot in &self.slots {
                fmi2FreeInstance()(slot.component);
            }
            fmi2FreeInstance()(c);
        }
    }

    /// One call; its status has to fit the modes that the instance may be in.
    ///
    /// # Panics
    /// Where it does not fit.
    fn call(&mut self, which: usize, call: &Call) {
        use mode::*;
        let before = messages();
        let slot = &mut self.slots[which];
        let c = slot.component;
        // The name of the call, its status, the modes that it is allowed in, and the one it leads to.
        // SAFETY: the instances and states are live or null; arrays have the length that is told.
        let (name, status, allowed, next) = unsafe {
            match call {
                Call::Versions => {
                    assert!(!fmi2GetTypesPlatform()().is_null() && !fmi2GetVersion()().is_null());
                    return;
                }
                Call::Instantiate {
                    exchange,
                    strange_type,
                    name,
                    wrong_guid,
                    place,
                    functions,
                    logging,
                } => {
                    fmi2FreeInstance()(c);
                    let kind = if strange_type.holds() {
                        77
                    } else {
                        u32::from(!exchange)
                    };
                    let name = if name.holds() {
                        null()
                    } else {
                        c"fuzz".as_ptr()
                    };
                    let guid = if wrong_guid.holds() {
                        c"%s#0#".as_ptr()
                    } else {
                        self.guid.as_ptr()
                    };
                    let callbacks = if functions.holds() {
                        null()
                    } else {
                        &raw const self.functions
                    };
                    let logging = i32::from(*logging);
                    let component =
                        fmi2Instantiate()(name, kind, guid, place.pointer(), callbacks, 0, logging);
                    let live = !component.is_null();
                    assert!(!live || !(strange_type.holds() || wrong_guid.holds()));
                    assert!(
                        live || functions.holds() || messages() > before,
                        "a refusal without a word"
                    );
                    *slot = Slot {
                        component,
                        modes: Modes(if live { INSTANTIATED } else { 0 }),
                        exchange: *exchange,
                        listens: !functions.holds(),
                    };
                    return;
                }
                Call::FreeInstance => {
                    fmi2FreeInstance()(c);
                    (slot.component, slot.modes) = (null_mut(), Modes(0));
                    return;
                }
                Call::Start => {
                    self.start(which);
                    return;
                }
                Call::SetDebugLogging(on, categories) => {
                    let categories = categories.values(Category::pointer);
                    let status = fmi2SetDebugLogging()(
                        c,
                        i32::from(*on),
                        categories.len(),
                        categories.pointer(),
                    );
                    ("SetDebugLogging", status, ANY, None)
                }
                Call::SetupExperiment {
                    start,
                    stop,
                    tolerance,
                } => {
                    let [tolerance_given, stop_given] =
                        [tolerance, stop].map(|number| i32::from(number.is_some()));
                    let [tolerance, stop] =
                        [tolerance, stop].map(|number| number.map_or(0.0, Number::value));
                    let status = fmi2SetupExperiment()(
                        c,
                        tolerance_given,
                        tolerance,
                        start.value(),
                        stop_given,
                        stop,
                    );
                    ("SetupExperiment", status, INSTANTIATED, None)
                }
                Call::EnterInitializationMode => (
                    "EnterInitializationMode",
                    fmi2EnterInitializationMode()(c),
                    INSTANTIATED,
                    Some(INITIALIZATION),
                ),
                Call::ExitInitializationMode => {
                    let next = if slot.exchange { EVENT } else { STEP };
                    (
                        "ExitInitializationMode",
                        fmi2ExitInitializationMode()(c),
                        INITIALIZATION,
                        Some(next),
                    )
                }
                Call::Terminate => ("Terminate", fmi2Terminate()(c), RUNNING, Some(TERMINATED)),
                Call::Reset => ("Reset", fmi2Reset()(c), ANY, Some(INSTANTIATED)),
                Call::GetReal(references, null) => {
                    let references = references.values(|r| r.value());
                    let mut values = Buffer::room(references.len(), *null, 0.0);
                    let status =
                        fmi2GetReal()(c, references.pointer(), references.len(), values.place());
                    values.check("GetReal", status);
                    ("GetReal", status, READABLE, None)
                }
                Call::SetReal(pairs, null) => {
                    let references = pairs.values(|(r, _)| r.value());
                    let mut values = Buffer::room(references.len(), *null, 0.0);
                    let numbers = pairs.values(|(_, number)| number.value());
                    if !values.place().is_null() {
                        values = numbers;
                    }
                    let status =
                        fmi2SetReal()(c, references.pointer(), references.len(), values.pointer());
                    ("SetReal", status, EARLY | RUNNING, None)
                }
                Call::SetInputs(left, right) => {
                    let values = [left.value(), right.value()];
                    (
                        "SetReal",
                        fmi2SetReal()(c, [0, 1].as_ptr(), 2, values.as_ptr()),
                        EARLY | RUNNING,
                        None,
                    )
                }
                Call::GetInteger(references, null) | Call::GetBoolean(references, null) => {
                    let references = references.values(|r| r.value());
                    let mut values = Buffer::room(references.len(), *null, 0);
                    let get = if matches!(call, Call::GetInteger(..)) {
                        fmi2GetInteger()
                    } else {
                        fmi2GetBoolean()
                    };
                    let status = get(c, references.pointer(), references.len(), values.place());
                    ("GetInteger or GetBoolean", status, READABLE, None)
                }
                Call::GetTerrain(other) => {
                    let (reference, mut value) = (19 + 20 * u32::from(*other), 0);
                    let get = if *other {
                        fmi2GetBoolean()
                    } else {
                        fmi2GetInteger()
                    };
                    let status = get(c, &reference, 1, &mut value);
                    assert!(status != OK || *other && value <= 1 || (1..=5).contains(&value));
                    ("GetInteger or GetBoolean", status, READABLE, None)
                }
                Call::SetInteger(pairs, null) | Call::SetBoolean(pairs, null) => {
                    let references = pairs.values(|(r, _)| r.value());
                    let mut values = Buffer::room(references.len(), *null, 0);
                    let numbers = pairs.values(|(_, number)| *number);
                    if !values.place().is_null() {
                        values = numbers;
                    }
                    let set = if matches!(call, Call::SetInteger(..)) {
                        fmi2SetInteger()
                    } else {
                        fmi2SetBoolean()
                    };
                    let status = set(c, references.pointer(), references.len(), values.pointer());
                    ("SetInteger or SetBoolean", status, EARLY | RUNNING, None)
                }
                Call::SetTerrain(terrain) => {
                    let status = fmi2SetInteger()(c, &19, 1, &i32::from(*terrain));
                    assert!(status != OK || (1..=5).contains(terrain));
                    ("SetInteger", status, EARLY, None)
                }
                Call::Strings { set, references } => {
                    let references = references.values(|r| r.value());
                    let mut values = vec![null(); references.len()];
                    let (place, count) = (references.pointer(), references.len());
                    let status = match set {
                        true => fmi2SetString()(c, place, count, values.as_ptr()),
                        false => fmi2GetString()(c, place, count, values.as_mut_ptr()),
                    };
                    ("SetString or GetString", status, ANY, None)
                }
                Call::GetState(kept, null) => {
                    let modes = slot.modes;
                    let (state, kept) = &mut self.states[usize::from(*kept) % 4];
                    let status = fmi2GetFMUstate()(c, null.or(state));
                    if status == OK {
                        *kept = modes;
                    }
                    ("GetFMUstate", status, ANY, None)
                }
                Call::SetState(kept) => {
                    let (state, kept) = self.states[usize::from(*kept) % 4];
                    (
                        "SetFMUstate",
                        fmi2SetFMUstate()(c, state),
                        ANY,
                        Some(kept.0),
                    )
                }
                Call::FreeState(kept, null) => {
                    let state = &mut self.states[usize::from(*kept) % 4].0;
                    (
                        "FreeFMUstate",
                        fmi2FreeFMUstate()(c, null.or(state)),
                        ANY,
                        None,
                    )
                }
                Call::Serialize { state, missing } => {
                    let (state, modes) = self.states[usize::from(*state) % 4];
                    let mut size = 0;
                    let status = fmi2SerializedFMUstateSize()(c, state, &mut size);
                    if status == OK {
                        let short = usize::from(*missing).saturating_sub(200);
                        let mut bytes = vec![0; size - short];
                        let status =
                            fmi2SerializeFMUstate()(c, state, bytes.as_mut_ptr(), bytes.len());
                        assert_eq!(status == OK, short == 0);
                        if status == OK {
                            self.bytes = Some((bytes, modes));
                        }
                    }
                    ("SerializedFMUstateSize", status, ANY, None)
                }
                Call::DeSerialize {
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
                        bytes[place] ^= *change as c_char;
                        same &= *change == 0;
                    }
                    let (place, kept) = &mut self.states[usize::from(*state) % 4];
                    let status = fmi2DeSerializeFMUstate()(c, bytes.as_ptr(), bytes.len(), place);
                    assert!(
                        status != OK || same,
                        "a part of a state was taken for a whole one"
                    );
                    if status == OK {
                        *kept = modes;
                    }
                    ("DeSerializeFMUstate", status, ANY, None)
                }
                Call::Differentiate {
                    unknowns,
                    knowns,
                    values,
                } => {
                    let unknowns = unknowns.values(|r| r.value());
                    let seeds = knowns.values(|(_, number)| number.value());
                    let knowns = knowns.values(|(r, _)| r.value());
                    let mut values = Buffer::room(unknowns.len(), *values, 0.0);
                    let status = fmi2GetDirectionalDerivative()(
                        c,
                        unknowns.pointer(),
                        unknowns.len(),
                        knowns.pointer(),
                        knowns.len(),
                        seeds.pointer(),
                        values.place(),
                    );
                    values.check("GetDirectionalDerivative", status);
                    ("GetDirectionalDerivative", status, READABLE, None)
                }
                Call::EnterEventMode => (
                    "EnterEventMode",
                    fmi2EnterEventMode()(c),
                    EXCHANGE,
                    Some(EVENT),
                ),
                Call::NewDiscreteStates(null) => {
                    let mut info: fmi2EventInfo = std::mem::zeroed();
                    let status = fmi2NewDiscreteStates()(c, null.or(&mut info));
                    ("NewDiscreteStates", status, EVENT, None)
                }
                Call::EnterContinuousTimeMode => (
                    "EnterContinuousTimeMode",
                    fmi2EnterContinuousTimeMode()(c),
                    EVENT,
                    Some(CONTINUOUS),
                ),
                Call::CompletedIntegratorStep(event, end) => {
                    let mut flags = [0; 2];
                    let [first, second] = &mut flags;
                    let status =
                        fmi2CompletedIntegratorStep()(c, 1, event.or(first), end.or(second));
                    ("CompletedIntegratorStep", status, CONTINUOUS, None)
                }
                Call::SetTime(time) => ("SetTime", fmi2SetTime()(c, time.value()), EXCHANGE, None),
                Call::SetStates(states) => {
                    let states = states.map(Number::value);
                    (
                        "SetContinuousStates",
                        fmi2SetContinuousStates()(c, states.as_ptr(), 6),
                        CONTINUOUS,
                        None,
                    )
                }
                Call::SetContinuousStates(states) => {
                    let states = states.values(|number| number.value());
                    let status = fmi2SetContinuousStates()(c, states.pointer(), states.len());
                    ("SetContinuousStates", status, CONTINUOUS, None)
                }
                Call::Six { which, count, null } => {
                    let count = count.map_or(6, |count| usize::from(count) % 9);
                    let mut values = Buffer::room(count, *null, 0.0);
                    let model = EXCHANGE | OVER;
                    let (name, get, allowed) = match which % 4 {
                        0 => ("GetDerivatives", fmi2GetDerivatives(), model),
                        1 => ("GetEventIndicators", fmi2GetEventIndicators(), ANY),
                        2 => (
                            "GetContinuousStates",
                            fmi2GetContinuousStates(),
                            model | INITIALIZATION,
                        ),
                        _ => (
                            "GetNominals",
                            fmi2GetNominalsOfContinuousStates(),
                            model | EARLY,
                        ),
                    };
                    let status = get(c, values.place(), count);
                    values.check(name, status);
                    (name, status, allowed, None)
                }
                Call::SetInputDerivatives(rows, null) => {
                    let references = rows.values(|(r, ..)| r.value());
                    let values = rows.values(|(_, number, _)| number.value());
                    let mut orders = Buffer::room(references.len(), *null, 1);
                    let given = rows.values(|(.., strange)| if *strange { 0 } else { 1 });
                    if !orders.place().is_null() {
                        orders = given;
                    }
                    let (place, count) = (references.pointer(), references.len());
                    let status = fmi2SetRealInputDerivatives()(
                        c,
                        place,
                        count,
                        orders.pointer(),
                        values.pointer(),
                    );
                    ("SetRealInputDerivatives", status, EARLY | STEP, None)
                }
                Call::GetOutputDerivatives(rows, null) => {
                    let references = rows.values(|(r, _)| r.value());
                    let orders = rows.values(|(_, strange)| if *strange { 2 } else { 1 });
                    let mut values = Buffer::room(references.len(), *null, 0.0);
                    let (place, count) = (references.pointer(), references.len());
                    let status = fmi2GetRealOutputDerivatives()(
                        c,
                        place,
                        count,
                        orders.pointer(),
                        values.place(),
                    );
                    values.check("GetRealOutputDerivatives", status);
                    ("GetRealOutputDerivatives", status, STEP | OVER, None)
                }
                Call::DoStep { size, off } => {
                    let mut time = 0.0;
                    let known =
                        fmi2GetRealStatus()(c, fmi2StatusKind_fmi2LastSuccessfulTime, &mut time);
                    slot.modes.learn("GetRealStatus", known, STEP | OVER, None);
                    let point = off.map_or(time, |off| time + off.value());
                    ("DoStep", fmi2DoStep()(c, point, size.step(), 1), STEP, None)
                }
                Call::CancelStep => ("CancelStep", fmi2CancelStep()(c), 0, None),
                Call::Status { which, kind, null } => {
                    let kind = u32::from(*kind) % 6;
                    let (mut status, mut time, mut number, mut text) =
                        (0, 0.0, 0, std::ptr::null());
                    let status = match which % 5 {
                        0 => fmi2GetStatus()(c, kind, null.or(&mut status)),
                        1 => fmi2GetRealStatus()(c, kind, null.or(&mut time)),
                        2 => fmi2GetIntegerStatus()(c, kind, null.or(&mut number)),
                        3 => fmi2GetBooleanStatus()(c, kind, null.or(&mut number)),
                        _ => fmi2GetStringStatus()(c, kind, null.or(&mut text)),
                    };
                    ("a status", status, STEP | OVER, None)
                }
            }
        };
        let slot = &mut self.slots[which];
        let listened = slot.listens && !slot.component.is_null();
        // What a solver tries in vain is told to those alone who asked for events.
        assert!(
            [OK, DISCARD].contains(&status) || !listened || messages() > before,
            "{name} failed without a word"
        );
        slot.modes.learn(name, status, allowed, next);
    }

    /// A fresh start, wherever the instance stands.
    fn start(&mut self, which: usize) {
        let slot = &self.slots[which];
        if slot.component.is_null() {
            let exchange = which == 1;
            let kind = if exchange {
                fmi2Type_fmi2ModelExchange
            } else {
                fmi2Type_fmi2CoSimulation
            };
            // SAFETY: strings end in zero, and the callbacks live as long as the host.
            let component = unsafe {
                fmi2Instantiate()(
                    null(),
                    kind,
                    self.guid.as_ptr(),
                    null(),
                    &self.functions,
                    0,
                    0,
                )
            };
            assert!(!component.is_null());
            self.slots[which] = Slot {
                component,
                modes: Modes(mode::INSTANTIATED),
                exchange,
                listens: true,
            };
        }
        for call in [
            Call::Reset,
            Call::EnterInitializationMode,
            Call::ExitInitializationMode,
        ] {
            self.call(which, &call);
        }
        if self.slots[which].exchange {
            self.call(which, &Call::EnterContinuousTimeMode);
        }
    }
}
