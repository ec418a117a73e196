//! Everything that can end the tool early, with its exit status and remedy.

use std::error::Error;
use std::fmt;
use std::io;
use std::path::PathBuf;
use ugv_terrain::diagnosis::DiagnosisError;
use ugv_terrain::display::{visible, visible_line};
use ugv_terrain::fit::FitError;
use ugv_terrain::identification::IdentificationError;
use ugv_terrain::import::ImportError;
use ugv_terrain::json::JsonError;
use ugv_terrain::parameter::ParameterError;
use ugv_terrain::recording::{CsvError, RecordingError, SameName};
use ugv_terrain::simulation::SimulationError;
use ugv_terrain::vehicle::BalanceError;

/// Exit status where the arguments or the files that they name are wrong.
const BAD_INPUT: u8 = 2;
/// Exit status where the work itself fails.
const FAILED: u8 = 1;

/// Why the tool stops.
#[derive(Debug)]
pub enum Failure {
    /// Arguments that do not parse.
    Usage(clap::Error),
    /// Arguments that do not fit together.
    Argument {
        /// What is wrong.
        reason: String,
        /// What to write instead.
        hint: Option<String>,
    },
    /// A file that cannot be read.
    Read { path: PathBuf, source: io::Error },
    /// A file that describes no vehicle, terrain, effects or model.
    Json { path: PathBuf, source: JsonError },
    /// A file that is no recording.
    Recording(CsvError),
    /// A recording or the file beside it that cannot be read.
    ReadRecording(RecordingError),
    /// Two recordings of one name.
    SameName(SameName),
    /// Recordings that nothing can be fitted to.
    Fit(FitError),
    /// Recordings that nothing can be said of.
    Diagnosis(DiagnosisError),
    /// A robot's log that gives no recording.
    Import(ImportError),
    /// A recording by which nothing can be judged.
    Identification(IdentificationError),
    /// Vehicle and terrain that do not fit together.
    Model(ParameterError),
    /// A vehicle that cannot drive on; times are those of the recording.
    Simulation(SimulationError),
    /// A file that cannot be written.
    Write { target: String, source: io::Error },
}

impl Failure {
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

    /// The error with all its causes on one line, and a remedy below where there is one; what a terminal would obey is
    /// escaped.
    pub fn report(&self) -> String {
        if let Self::Usage(error) = self {
            // It brings its own hints; without any argument it is the help.
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
            // Some errors tell their cause themselves.
            if !message.ends_with(&text) {
                message = format!("{message}: {text}");
            }
            cause = error.source();
        }
        let message = visible_line(&message);
        match self.hint() {
            Some(hint) => format!(
                "ugv: error: {message}\nugv: hint: {}\n",
                visible_line(&hint)
            ),
            None => format!("ugv: error: {message}\n"),
        }
    }

    fn hint(&self) -> Option<String> {
        match self {
            Self::Argument { hint, .. } => hint.clone(),
            Self::Import(error) => error.remedy(),
            Self::Diagnosis(DiagnosisError::NothingMeasured { .. })
            | Self::Fit(FitError::NothingMeasured { .. }) => Some(
                "record a pose (x, y, heading) or at least the yaw rate beside the wheel speeds".into(),
            ),
            Self::Fit(FitError::AtRest | FitError::TooShort { .. }) => Some(
                "give recordings in which the vehicle drives on, with wheel speeds and a pose, for half a minute or more in all".into(),
            ),
            Self::Identification(IdentificationError::NoPose { .. }) => {
                Some("record a pose (x, y, heading) beside the wheel speeds".into())
            }
            Self::Identification(
                IdentificationError::TooShort { .. } | IdentificationError::NoWindows { .. },
            ) => Some("`ugv score` predicts less far ahead with --horizon 2; `ugv inspect` shows gaps".into()),
            Self::Read { source, .. } if source.kind() == io::ErrorKind::InvalidData => {
                Some("save the file as UTF-8".into())
            }
            Self::SameName(_) => Some(
                "name each file once, and rename one of two: what is said of a recording names it".into(),
            ),
            Self::Diagnosis(DiagnosisError::Undrivable(_)) => Some(
                "check the vehicle's mass, wheel radius and track (--vehicle), and the terrain to begin with (--terrain)".into(),
            ),
            Self::Json {
                source: JsonError::SeveralTerrains { names },
                ..
            } => Some(format!(
                "keep one of the objects in the file, or name a preset: --terrain {}",
                names.first()?
            )),
            Self::Json { .. } => Some(
                "`ugv vehicle`, `ugv terrains NAME`, `ugv effects NAME` and `ugv model` print files that are right".into(),
            ),
            Self::Write { source, .. } if is_place(source) => {
                Some("name a place in a folder that is there and can be written".into())
            }
            Self::Simulation(SimulationError::Balance {
                source: BalanceError::Bogged { load, bearing, .. },
                ..
            }) => Some(if bearing > load {
                "let the wheels slip less there (brake or turn more gently), or take a soil with less cohesion or a larger \
                 frictional_modulus; nothing was written".into()
            } else {
                "take a firmer terrain (a larger frictional_modulus), a lighter vehicle, or larger or \
                 wider wheels; nothing was written"
                    .into()
            }),
            Self::Simulation(
                SimulationError::StepTooSmall { suspect: Some(_), .. }
                | SimulationError::TooStiff { suspect: Some(_), .. },
            ) => Some("take a usual value for that parameter; nothing was written".into()),
            Self::Simulation(
                SimulationError::Balance { .. }
                | SimulationError::StepTooSmall { .. }
                | SimulationError::TooStiff { .. },
            ) => Some(
                "look for a jump or an outlier in the wheel speeds at that time; nothing was written".into(),
            ),
            _ => None,
        }
    }
}

/// Whether it is the place that cannot be written, rather than the content.
fn is_place(error: &io::Error) -> bool {
    use io::ErrorKind::{
        IsADirectory, NotADirectory, NotFound, PermissionDenied, ReadOnlyFilesystem,
    };
    let kinds = [
        IsADirectory,
        NotADirectory,
        NotFound,
        PermissionDenied,
        ReadOnlyFilesystem,
    ];
    kinds.contains(&error.kind())
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

impl From<IdentificationError> for Failure {
    fn from(error: IdentificationError) -> Self {
        Self::Identification(error)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Usage(error) => error.fmt(f),
            Self::Argument { reason, .. } => reason.fmt(f),
            Self::Read { path, .. } => write!(f, "cannot read {}", path.display()),
            Self::Json { path, source } => write!(f, "{}: {source}", path.display()),
            Self::Recording(error) => error.fmt(f),
            Self::ReadRecording(error) => error.fmt(f),
            Self::SameName(error) => error.fmt(f),
            Self::Fit(error) => error.fmt(f),
            Self::Diagnosis(error) => error.fmt(f),
            Self::Import(error) => error.fmt(f),
            Self::Identification(error) => error.fmt(f),
            Self::Model(error) => error.fmt(f),
            Self::Simulation(error) => error.fmt(f),
            Self::Write { target, .. } => write!(f, "cannot write {target}"),
        }
    }
}

impl Error for Failure {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Read { source, .. } | Self::Write { source, .. } => Some(source),
            Self::Json { source, .. } => source.source(),
            Self::Recording(error) => error.source(),
            Self::ReadRecording(error) => error.source(),
            Self::Import(error) => error.source(),
            Self::Simulation(error) => error.source(),
            _ => None,
        }
    }
}
