//! The allowed order of calls: the state machines of FMI 2.0.5, sections 3.2.3 (model exchange) and
//! 4.2.4 (co-simulation), and of FMI 3.0, sections 2.3, 3.2 and 4.2, as one table. Where both agree,
//! they share a row.

/// The interface of an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Interface {
    ModelExchange,
    CoSimulation,
}

/// The state of an instance in the standard's state machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u16)]
pub(super) enum Mode {
    Instantiated = 1,
    Initialization = 2,
    /// Co-simulation, between steps.
    StepComplete = 4,
    /// Model exchange, at an event.
    Event = 8,
    /// Model exchange, between events.
    ContinuousTime = 16,
    Terminated = 32,
    /// A computation failed. Values can still be read, and the instance can be reset.
    Error = 64,
    /// A panic was contained. The instance can only be freed.
    Poisoned = 128,
    /// Co-simulation, in event mode.
    StepEvent = 256,
}

impl Mode {
    const ALL: [Self; 9] = [
        Self::Instantiated,
        Self::Initialization,
        Self::StepComplete,
        Self::Event,
        Self::StepEvent,
        Self::ContinuousTime,
        Self::Terminated,
        Self::Error,
        Self::Poisoned,
    ];

    /// Whether the importer's solver sets the states.
    pub(super) fn has_solver(self) -> bool {
        matches!(self, Self::Event | Self::ContinuousTime)
    }

    /// Whether the initialization has not ended.
    pub(super) fn is_early(self) -> bool {
        matches!(self, Self::Instantiated | Self::Initialization)
    }

    pub(super) fn from_code(code: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|mode| *mode as u16 == code)
    }

    fn describe(self) -> &'static str {
        match self {
            Self::Instantiated => "before initialization",
            Self::Initialization => "in initialization mode",
            Self::StepComplete => "between two steps",
            Self::Event | Self::StepEvent => "in event mode",
            Self::ContinuousTime => "in continuous-time mode",
            Self::Terminated => "after the termination",
            Self::Error => "after an error",
            Self::Poisoned => "after an internal failure",
        }
    }
}

const INSTANTIATED: u16 = Mode::Instantiated as u16;
const INITIALIZATION: u16 = Mode::Initialization as u16;
const STEP: u16 = Mode::StepComplete as u16;
const EVENT: u16 = Mode::Event as u16;
const CONTINUOUS: u16 = Mode::ContinuousTime as u16;
const TERMINATED: u16 = Mode::Terminated as u16;
const ERROR: u16 = Mode::Error as u16;
const STEP_EVENT: u16 = Mode::StepEvent as u16;

const RUNNING: u16 = STEP | STEP_EVENT | EVENT | CONTINUOUS;
const READABLE: u16 = INITIALIZATION | RUNNING | TERMINATED | ERROR;
const ANY: u16 = INSTANTIATED | READABLE;
const NEVER: u16 = 0;

/// A kind of call that needs an instance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Call {
    /// The modes in which it is allowed.
    modes: u16,
    /// The interface to which it is restricted, where the modes do not restrict it.
    only: Option<Interface>,
}

macro_rules! calls {
    ($($name:ident: $modes:expr $(, $interface:ident)?;)*) => {
        #[allow(non_upper_case_globals, reason = "rows of a table")]
        impl Call {$(
            pub const $name: Self = Self { modes: $modes, only: calls!(@ $($interface)?) };
        )*}
    };
    (@) => { None };
    (@ $interface:ident) => { Some(Interface::$interface) };
}

calls! {
    SetDebugLogging: ANY;
    SetupExperiment: INSTANTIATED;
    EnterInitializationMode: INSTANTIATED;
    ExitInitializationMode: INITIALIZATION;
    Terminate: RUNNING;
    Reset: ANY;
    Get: READABLE;
    Set: INSTANTIATED | INITIALIZATION | RUNNING;
    GetState: ANY;
    SetState: ANY;
    Serialize: ANY;
    Differentiate: READABLE;
    SetInputDerivatives: INSTANTIATED | INITIALIZATION | STEP, CoSimulation;
    GetOutputDerivatives: STEP | TERMINATED | ERROR, CoSimulation;
    DoStep: STEP;
    // No step is ever in progress.
    CancelStep: NEVER;
    GetStatus: STEP | TERMINATED | ERROR, CoSimulation;
    EnterEventMode: STEP | EVENT | CONTINUOUS;
    NewDiscreteStates: EVENT | STEP_EVENT;
    EnterContinuousTimeMode: EVENT;
    CompletedIntegratorStep: CONTINUOUS;
    SetTime: EVENT | CONTINUOUS;
    SetContinuousStates: CONTINUOUS;
    GetDerivatives: EVENT | CONTINUOUS | TERMINATED | ERROR, ModelExchange;
    GetContinuousStates: INITIALIZATION | EVENT | CONTINUOUS | TERMINATED | ERROR, ModelExchange;
    GetNominals: INSTANTIATED | INITIALIZATION | EVENT | CONTINUOUS | TERMINATED | ERROR, ModelExchange;
    // FMI 3.0 only: calls with other modes than in FMI 2.0, and new calls.
    GetOrStart: ANY;
    Count: ANY, ModelExchange;
    GetDependencies: ANY;
    EnterStepMode: STEP_EVENT;
    Unsupported: ANY;
}

impl Call {
    /// Refuses a call that is out of order, with the reason.
    pub(super) fn check(
        self,
        function: &str,
        mode: Mode,
        interface: Interface,
    ) -> Result<(), String> {
        let foreign = self.only.is_some_and(|only| only != interface);
        if self.modes & mode as u16 != 0 {
            return match foreign {
                false => Ok(()),
                true => Err(format!("{function} belongs to the other interface")),
            };
        }
        let mut allowed: Vec<&str> = Mode::ALL
            .into_iter()
            .filter(|m| self.modes & *m as u16 != 0)
            .map(Mode::describe)
            .collect();
        allowed.dedup();
        let now = mode.describe();
        Err(match (mode, allowed.is_empty()) {
            (Mode::Poisoned, _) => {
                format!("{function}: this instance failed internally and can only be freed")
            }
            (_, true) => format!("{function} has nothing to act on"),
            (_, false) => {
                format!(
                    "{function} is not allowed {now}, but {}",
                    allowed.join(", ")
                )
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_poisoned_instance_allows_nothing() {
        for call in [Call::Get, Call::Reset, Call::SetDebugLogging, Call::DoStep] {
            let check = |interface| call.check("f", Mode::Poisoned, interface);
            let error = check(Interface::CoSimulation).unwrap_err();
            assert!(error.contains("only be freed"));
        }
    }

    #[test]
    fn a_refusal_says_when_the_call_is_allowed() {
        let check = |mode| Call::DoStep.check("fmi2DoStep", mode, Interface::CoSimulation);
        let error = check(Mode::Instantiated).unwrap_err();
        assert_eq!(
            error,
            "fmi2DoStep is not allowed before initialization, but between two steps"
        );
        assert!(check(Mode::StepComplete).is_ok());
    }

    #[test]
    fn modes_of_one_name_are_listed_once() {
        let refused = Call::Terminate.check("f", Mode::Initialization, Interface::CoSimulation);
        assert_eq!(
            refused.unwrap_err(),
            "f is not allowed in initialization mode, but between two steps, in event mode, in continuous-time mode"
        );
    }

    #[test]
    fn a_call_of_one_interface_is_refused_to_the_other() {
        let check = |interface| Call::Count.check("f", Mode::Initialization, interface);
        assert!(check(Interface::ModelExchange).is_ok());
        let error = check(Interface::CoSimulation).unwrap_err();
        assert_eq!(error, "f belongs to the other interface");
    }

    #[test]
    fn modes_survive_their_code() {
        for mode in Mode::ALL {
            assert_eq!(Mode::from_code(mode as u16), Some(mode));
        }
        assert_eq!(Mode::from_code(3), None);
    }
}
