//! Which function may be called when: the state machine of FMI 2.0.5, sections 3.2.3
//! (model exchange) and 4.2.4 (co-simulation), as one table.

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
}

impl Mode {
    const ALL: [Self; 8] = [
        Self::Instantiated,
        Self::Initialization,
        Self::StepComplete,
        Self::Event,
        Self::ContinuousTime,
        Self::Terminated,
        Self::Error,
        Self::Poisoned,
    ];

    pub(super) fn from_code(code: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|mode| *mode as u16 == code)
    }

    fn describe(self) -> &'static str {
        match self {
            Self::Instantiated => "before initialization",
            Self::Initialization => "in initialization mode",
            Self::StepComplete => "between two steps",
            Self::Event => "in event mode",
            Self::ContinuousTime => "in continuous-time mode",
            Self::Terminated => "after fmi2Terminate",
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
}

const INSTANTIATED: u16 = Mode::Instantiated as u16;
const INITIALIZATION: u16 = Mode::Initialization as u16;
const STEP: u16 = Mode::StepComplete as u16;
const EVENT: u16 = Mode::Event as u16;
const CONTINUOUS: u16 = Mode::ContinuousTime as u16;
const TERMINATED: u16 = Mode::Terminated as u16;
const ERROR: u16 = Mode::Error as u16;

const RUNNING: u16 = STEP | EVENT | CONTINUOUS;
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
            Self::EnterEventMode => EVENT | CONTINUOUS,
            Self::NewDiscreteStates | Self::EnterContinuousTimeMode => EVENT,
            Self::CompletedIntegratorStep | Self::SetContinuousStates => CONTINUOUS,
            Self::SetTime => EVENT | CONTINUOUS,
            Self::GetDerivatives => EVENT | CONTINUOUS | TERMINATED | ERROR,
            Self::GetContinuousStates => INITIALIZATION | EVENT | CONTINUOUS | TERMINATED | ERROR,
            Self::GetNominals => {
                INSTANTIATED | INITIALIZATION | EVENT | CONTINUOUS | TERMINATED | ERROR
            }
        }
    }

    /// Refuses a call that is out of order, in words.
    pub(super) fn check(self, function: &str, mode: Mode) -> Result<(), String> {
        if self.allowed() & mode as u16 != 0 {
            return Ok(());
        }
        let allowed: Vec<&str> = Mode::ALL
            .into_iter()
            .filter(|m| self.allowed() & *m as u16 != 0)
            .map(Mode::describe)
            .collect();
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
            let error = call.check("f", Mode::Poisoned).unwrap_err();
            assert!(error.contains("only be freed"));
        }
    }

    #[test]
    fn a_refusal_says_when_the_call_is_allowed() {
        let error = Call::DoStep
            .check("fmi2DoStep", Mode::Instantiated)
            .unwrap_err();
        assert_eq!(
            error,
            "fmi2DoStep is not allowed before initialization, but between two steps"
        );
        assert!(Call::DoStep.check("fmi2DoStep", Mode::StepComplete).is_ok());
    }

    #[test]
    fn modes_survive_their_code() {
        for mode in Mode::ALL {
            assert_eq!(Mode::from_code(mode as u16), Some(mode));
        }
        assert_eq!(Mode::from_code(3), None);
    }
}
