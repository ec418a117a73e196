//! Everything that can end the tool early, with its exit status and remedy.

use crate::diagnosis::DiagnosisError;
use crate::display::{visible, visible_line};
use crate::fit::FitError;
use crate::identification::IdentificationError;
use crate::import::ImportError;
use crate::json::JsonError;
use crate::parameter::ParameterError;
use crate::recording::{CsvError, RecordingError, SameName};
use crate::simulation::SimulationError;
use crate::vehicle::BalanceError;
use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};

/// Exit status for wrong arguments or files.
const BAD_INPUT: u8 = 2;
/// Exit status for work that fails.
const FAILED: u8 = 1;

/// Why the tool stops.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Arguments that do not parse.
    #[error(transparent)]
    Usage(clap::Error),
    /// Arguments that do not fit together.
    #[error("{reason}")]
    Argument {
        reason: String,
        remedy: Option<String>,
    },
    /// A file that cannot be read.
    #[error("cannot read {}", path.display())]
    Read { path: PathBuf, source: io::Error },
    /// A file that does not describe a vehicle, a terrain, effects or a model.
    #[error("{}: {source}", path.display())]
    Json { path: PathBuf, source: JsonError },
    /// A file that is not a recording.
    #[error(transparent)]
    Recording(#[from] CsvError),
    /// Two recordings of one name.
    #[error(transparent)]
    SameName(#[from] SameName),
    /// Recordings that do not allow a fit.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// Recordings that do not allow a diagnosis.
    #[error(transparent)]
    Diagnosis(#[from] DiagnosisError),
    /// A robot's log without a usable recording.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// A recording that does not allow a comparison of models.
    #[error(transparent)]
    Identification(#[from] IdentificationError),
    /// Vehicle and terrain that do not fit together.
    #[error(transparent)]
    Model(#[from] ParameterError),
    /// A vehicle that cannot drive on; times are those of the recording.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A file that cannot be written.
    #[error("cannot write {target}")]
    Write { target: String, source: io::Error },
}

impl Failure {
    /// Arguments that do not fit together, without a remedy.
    pub fn argument(reason: impl Into<String>) -> Self {
        Self::Argument {
            reason: reason.into(),
            remedy: None,
        }
    }

    /// Adds what to do to arguments that do not fit together.
    pub fn with_remedy(self, text: impl Into<String>) -> Self {
        match self {
            Self::Argument { reason, .. } => Self::Argument {
                reason,
                remedy: Some(text.into()),
            },
            other => other,
        }
    }

    /// A file that cannot be read.
    pub fn read(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        |source| Self::Read { path, source }
    }

    /// The exit status.
    pub fn status(&self) -> u8 {
        match self {
            Self::Simulation(SimulationError::NotFinite { .. }) => BAD_INPUT,
            Self::Fit(FitError::NotFinite)
            | Self::Diagnosis(DiagnosisError::NotFinite)
            | Self::Simulation(_)
            | Self::Write { .. } => FAILED,
            _ => BAD_INPUT,
        }
    }

    /// Whether the input is at fault.
    pub fn is_bad_input(&self) -> bool {
        self.status() == BAD_INPUT
    }

    /// The error with all its causes on one line, and the remedy below it. What a terminal obeys is escaped.
    pub fn report(&self) -> String {
        if let Self::Usage(error) = self {
            // It has its own hints; without any argument it is the help.
            let text = error.render().to_string();
            let prefix = if text.starts_with("error:") {
                "ugv: "
            } else {
                ""
            };
            return format!("{prefix}{}", visible(&text));
        }
        let mut message = self.to_string();
        let mut cause = self.source();
        while let Some(error) = cause {
            let text = error.to_string();
            // Some errors have the text of their cause in their own.
            if !message.ends_with(&text) {
                message = format!("{message}: {text}");
            }
            cause = error.source();
        }
        let mut report = format!("ugv: error: {}\n", visible_line(&message));
        if let Some(remedy) = self.remedy() {
            report += &format!("ugv: hint: {}\n", visible_line(&remedy));
        }
        report
    }

    fn remedy(&self) -> Option<String> {
        let remedy = match self {
            Self::Argument { remedy, .. } => return remedy.clone(),
            Self::Import(error) => return error.remedy(),
            Self::Json {
                source: JsonError::SeveralTerrains { names },
                ..
            } => {
                return Some(format!(
                    "keep one of the objects in the file, or name a preset: --terrain {}",
                    names.first()?
                ));
            }
            Self::Diagnosis(DiagnosisError::NothingMeasured { .. })
            | Self::Fit(FitError::NothingMeasured { .. }) => {
                "record a pose (x, y, heading) or at least the yaw rate beside the wheel speeds"
            }
            Self::Fit(FitError::AtRest | FitError::TooShort { .. }) => {
                "give recordings with wheel speeds and a pose, with half a minute of driving or more in total"
            }
            Self::Identification(IdentificationError::NoPose { .. }) => {
                "record a pose (x, y, heading) beside the wheel speeds"
            }
            Self::Identification(
                IdentificationError::TooShort { .. } | IdentificationError::NoWindows { .. },
            ) => "`ugv score --horizon 2` predicts a shorter time; `ugv inspect` shows gaps",
            Self::Read { source, .. } if source.kind() == io::ErrorKind::InvalidData => {
                "save the file as UTF-8"
            }
            Self::SameName(_) => {
                "name each file once, and rename one of two: results refer to recordings by name"
            }
            Self::Diagnosis(DiagnosisError::Undrivable(_)) => {
                "check the vehicle's mass, wheel radius and track (--vehicle), and the initial terrain (--terrain)"
            }
            Self::Json { .. } => {
                "`ugv vehicle`, `ugv terrains NAME`, `ugv effects NAME` and `ugv model` print valid files"
            }
            Self::Write { source, .. } if is_place(source) => {
                "name a place in a folder that exists and is writable"
            }
            Self::Simulation(SimulationError::Balance {
                source: BalanceError::Bogged { load, bearing, .. },
                ..
            }) if bearing > load => {
                "reduce the wheels' slip there (brake or turn more gently), or take a soil with less cohesion or a \
                 larger frictional_modulus; nothing was written"
            }
            Self::Simulation(SimulationError::Balance {
                source: BalanceError::Bogged { .. },
                ..
            }) => {
                "take a firmer terrain (a larger frictional_modulus), a lighter vehicle, or larger or wider wheels; \
                 nothing was written"
            }
            Self::Simulation(
                SimulationError::StepTooSmall {
                    suspect: Some(_), ..
                }
                | SimulationError::TooStiff {
                    suspect: Some(_), ..
                },
            ) => "take a usual value for that parameter; nothing was written",
            Self::Simulation(
                SimulationError::Balance { .. }
                | SimulationError::StepTooSmall { .. }
                | SimulationError::TooStiff { .. },
            ) => {
                "look for a jump or an outlier in the wheel speeds at that time; nothing was written"
            }
            _ => return None,
        };
        Some(remedy.into())
    }
}

/// Whether the place cannot be written, rather than the content.
fn is_place(error: &io::Error) -> bool {
    use io::ErrorKind::{
        IsADirectory, NotADirectory, NotFound, PermissionDenied, ReadOnlyFilesystem,
    };
    matches!(
        error.kind(),
        IsADirectory | NotADirectory | NotFound | PermissionDenied | ReadOnlyFilesystem
    )
}

impl From<RecordingError> for Failure {
    fn from(error: RecordingError) -> Self {
        match error {
            RecordingError::Csv(error) => Self::Recording(error),
            RecordingError::About {
                file,
                error: source,
            } => Self::Json {
                path: file.into(),
                source,
            },
        }
    }
}
