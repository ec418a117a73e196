//! Which function may be called when: the state machines of FMI 2.0.5, sections 3.2.3
//! (model exchange) and 4.2.4 (co-simulation), and of FMI 3.0, sections 2.3, 3.2 and 4.2, as one
//! table. Where the two agree a row serves both.

use super::instance::Interface;

/// Where an instance stands.
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
    /// A computation failed: values can still be read, and the instance be reset.
    Error = 64,
    /// A panic was contained: nothing but freeing the instance is left.
    Poisoned = 128,
    /// Co-simulation, at an event that the importer announced.
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

    /// Whether the states are those that the importer's solver tries.
    pub(super) fn has_solver(self) -> bool {
        matches!(self, Self::Event | Self::ContinuousTime)
    }

    /// Whether the initialization is still to be ended.
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

/// The functions that need an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Call {
    SetDebugLogging,
    SetupExperiment,
    EnterInitializationMode,
    ExitInitializationMode,
    Terminate,
    Reset,
    Get,
    Set,
    GetState,
    SetState,
    Serialize,
    Differentiate,
    SetInputDerivatives,
    GetOutputDerivatives,
    DoStep,
    CancelStep,
    GetStatus,
    EnterEventMode,
    NewDiscreteStates,
    EnterContinuousTimeMode,
    CompletedIntegratorStep,
    SetTime,
    SetContinuousStates,
    GetDerivatives,
    GetContinuousStates,
    GetNominals,
    // FMI 3.0 alone: what its table allows otherwise than that of FMI 2.0, and what is new.
    GetOrStart,
    GetStatesOrRates,
    GetScales,
    Count,
    GetDependencies,
    EnterStepMode,
    Unsupported,
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

impl Call {
    /// The table: the modes in which a call is allowed.
    fn allowed(self) -> u16 {
        match self {
            Self::SetDebugLogging
            | Self::Reset
            | Self::GetState
            | Self::SetState
            | Self::Serialize => ANY,
            Self::SetupExperiment | Self::EnterInitializationMode => INSTANTIATED,
            Self::ExitInitializationMode => INITIALIZATION,
            Self::Terminate => RUNNING,
            Self::Get | Self::Differentiate => READABLE,
            Self::Set => INSTANTIATED | INITIALIZATION | RUNNING,
            Self::SetInputDerivatives => INSTANTIATED | INITIALIZATION | STEP,
            Self::GetOutputDerivatives => STEP | TERMINATED | ERROR,
            Self::DoStep => STEP,
            // There is never a step in progress to be cancelled.
            Self::CancelStep => 0,
            Self::GetStatus => STEP | TERMINATED | ERROR,
            Self::EnterEventMode => STEP | EVENT | CONTINUOUS,
            Self::NewDiscreteStates => EVENT | STEP_EVENT,
            Self::EnterContinuousTimeMode => EVENT,
            Self::CompletedIntegratorStep | Self::SetContinuousStates => CONTINUOUS,
            Self::SetTime => EVENT | CONTINUOUS,
            Self::GetDerivatives => EVENT | CONTINUOUS | TERMINATED | ERROR,
            Self::GetContinuousStates => INITIALIZATION | EVENT | CONTINUOUS | TERMINATED | ERROR,
            Self::GetNominals => {
                INSTANTIATED | INITIALIZATION | EVENT | CONTINUOUS | TERMINATED | ERROR
            }
            Self::GetOrStart | Self::Count | Self::GetDependencies | Self::Unsupported => ANY,
            Self::GetStatesOrRates | Self::GetScales => {
                INITIALIZATION | EVENT | CONTINUOUS | TERMINATED | ERROR
            }
            Self::EnterStepMode => STEP_EVENT,
        }
    }

    /// The table's other column: the only interface that has the call, where the modes do not tell.
    fn only(self) -> Option<Interface> {
        match self {
            Self::GetDerivatives
            | Self::GetContinuousStates
            | Self::GetNominals
            | Self::GetStatesOrRates
            | Self::GetScales
            | Self::Count => Some(Interface::ModelExchange),
            Self::SetInputDerivatives | Self::GetOutputDerivatives | Self::GetStatus => {
                Some(Interface::CoSimulation)
            }
            _ => None,
        }
    }

    /// Refuses a call that is out of order, in words.
    pub(super) fn check(
        self,
        function: &str,
        mode: Mode,
        interface: Interface,
    ) -> Result<(), String> {
        let foreign = self.only().is_some_and(|only| only != interface);
        if self.allowed() & mode as u16 != 0 {
            return match foreign {
                false => Ok(()),
                true => Err(format!("{function} belongs to the other interface")),
            };
        }
        let mut allowed: Vec<&str> = Mode::ALL
            .into_iter()
            .filter(|m| self.allowed() & *m as u16 != 0)
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
    fn modes_of_one_name_are_told_once() {
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
