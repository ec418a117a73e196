//! What a diagnosis found: plain data for reports, nothing computed here.

use super::Caution;
use crate::effects::{CATALOGUE, EffectKind};
use crate::fit::{Estimate, NoiseEstimate};
use crate::vehicle::Specification;

/// What the recordings say of the model, all in all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The re-tuned model explains the recordings.
    NothingMissing,
    /// Physics of the catalogue is missing.
    MissingPhysics,
    /// The recording's sensors are at fault, not the model.
    Sensor,
    /// One of several effects, which these recordings do not tell apart.
    Ambiguous,
    /// Something is missing that the catalogue does not have.
    UnknownPhysics,
    /// Nothing can be said; [`Diagnosis::insufficient`] has the reason.
    InsufficientData,
}

impl Verdict {
    /// The name in `diagnosis.json`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NothingMissing => "nothing_missing",
            Self::MissingPhysics => "missing_physics",
            Self::Sensor => "sensor",
            Self::Ambiguous => "ambiguous",
            Self::UnknownPhysics => "unknown_physics",
            Self::InsufficientData => "insufficient_data",
        }
    }
}

/// Why there is no verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Insufficient {
    /// Too little was recorded.
    TooLittle,
    /// Time was up before every candidate had been tried.
    TimeUp,
    /// Neither that something is missing nor that nothing is missing is likely enough.
    Undecided,
}

impl Insufficient {
    /// The name in `diagnosis.json`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::TooLittle => "too_little",
            Self::TimeUp => "time_up",
            Self::Undecided => "undecided",
        }
    }
}

/// What a finding or a candidate is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Subject {
    /// An effect, by its place in [`CATALOGUE`].
    Effect(usize),
    /// Something that the catalogue does not have.
    Unknown,
    /// The re-tuned model alone.
    Nothing,
}

impl Subject {
    /// The name in `diagnosis.json`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Effect(index) => CATALOGUE[index].name,
            Self::Unknown => "unknown",
            Self::Nothing => "nothing_missing",
        }
    }

    /// Whether it is a matter of the sensors.
    #[must_use]
    pub fn is_sensor(self) -> bool {
        matches!(self, Self::Effect(index) if CATALOGUE[index].kind == EffectKind::Measurement)
    }
}

/// A value with its 90 % interval.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Name within its effect, as `slope_east`, or of a sensor's, as `pose`.
    pub name: String,
    /// The recording that it belongs to, where each has its own.
    pub recording: Option<String>,
    /// Best value.
    pub value: f64,
    /// Lower end of the 90 % interval.
    pub low: f64,
    /// Upper end of the 90 % interval.
    pub high: f64,
    /// Unit.
    pub unit: &'static str,
}

/// What residuals point to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// A force along the vehicle, dF_X.
    Longitudinal,
    /// A force across the vehicle, dF_Y.
    Lateral,
    /// A moment about the vertical, dM_Z.
    Yaw,
    /// No force: the measurement.
    Measurement,
}

impl Channel {
    /// The name in `diagnosis.json`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Longitudinal => "longitudinal",
            Self::Lateral => "lateral",
            Self::Yaw => "yaw",
            Self::Measurement => "measurement",
        }
    }
}

/// A stretch of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Interval {
    /// Name of the recording.
    pub recording: String,
    /// Which of its runs, from 0.
    pub run: usize,
    /// What the run is called where the recording has several; else empty.
    pub label: String,
    /// Beginning \[s\], by the run's clock.
    pub start: f64,
    /// End \[s\].
    pub end: f64,
    /// Where it shows most.
    pub channel: Channel,
    /// When it shows most, as `heading 60..120 deg` or `speed over 1.2 m/s`; empty for no matter.
    pub regime: String,
    /// The patch on the map, where it is bound to one: centre (east, north) and radius \[m\].
    pub patch: Option<[f64; 3]>,
}

/// A term of a law for what has no name.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// What it pushes.
    pub channel: Channel,
    /// Name of the parameter in the model file, as `residual_yaw.speed_turning`.
    pub parameter: String,
    /// The dimensionless group in symbols, as `|u| q`; a leading minus belongs to it.
    pub group: String,
    /// Its coefficient.
    pub coefficient: Quantity,
    /// Share of the resampled data in which it was chosen.
    pub stability: f64,
}

/// One thing that is missing.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What it is.
    pub subject: Subject,
    /// Its probability.
    pub probability: f64,
    /// Others that these recordings do not tell from it.
    pub ambiguous_with: Vec<Subject>,
    /// Log Bayes factor against the model without it.
    pub evidence: f64,
    /// Log odds, prior counted, of all that was fitted in its place and of itself, the likeliest first.
    pub rivals: Vec<(Subject, f64)>,
    /// Its parameters.
    pub parameters: Vec<Quantity>,
    /// Where it shows, the strongest first.
    pub places: Vec<Interval>,
    /// Whether it acts in these places alone.
    pub local: bool,
    /// The terms of the law where it is unknown.
    pub law: Vec<Term>,
    /// One plain sentence.
    pub statement: String,
}

/// What was made of an effect that was asked about.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// What it is.
    pub subject: Subject,
    /// Its probability.
    pub probability: f64,
    /// Share of its signal that re-tuning the soil takes up.
    pub absorbed: f64,
    /// Block-robust t of the projected score, over what chance alone gives the largest of all.
    pub significance: f64,
    /// The smallest value of its leading parameter that these recordings would have shown, with
    /// the parameter's name and unit; infinite where none would.
    pub smallest_detectable: f64,
    /// Name of that parameter.
    pub parameter: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// One-step estimate of that parameter.
    pub estimate: f64,
    /// Its 90 % interval.
    pub interval: [f64; 2],
    /// Gain of the held-out log score per sample over the re-tuned model, with its standard error;
    /// `None` where it was not refitted.
    pub held_out_gain: Option<(f64, f64)>,
    /// Candidates whose projected signals point the same way, with the cosine.
    pub alike: Vec<(Subject, f64)>,
}

/// How well a model predicts what it was not fitted to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Root mean square of the position's error \[m\]; NaN without positions.
    pub position: f64,
    /// Root mean square of the heading's error \[rad\]; NaN without headings.
    pub heading: f64,
    /// Root mean square of the yaw rate's error \[rad/s\]; NaN without a gyro.
    pub yaw_rate: f64,
    /// Mean log predictive density per sample (white noise of the residuals' units).
    pub log_score: f64,
}

impl Errors {
    /// Of a model that cannot drive.
    pub(super) const NONE: Self = Self {
        position: f64::NAN,
        heading: f64::NAN,
        yaw_rate: f64::NAN,
        log_score: f64::NAN,
    };
}

/// Held-out errors of the models.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOut {
    /// The model as given; NaN where it cannot drive.
    pub nominal: Errors,
    /// The soil re-tuned.
    pub refitted: Errors,
    /// With what was found.
    pub augmented: Errors,
    /// How much better with what was found than re-tuned: log score per sample, and standard error.
    pub gain: (f64, f64),
    /// Seconds ahead that are predicted.
    pub horizon: f64,
    /// Number of stretches predicted.
    pub stretches: usize,
}

/// What to drive next.
#[derive(Debug, Clone, PartialEq)]
pub struct Manoeuvre {
    /// Its name, as `slalom`.
    pub name: &'static str,
    /// What to do, in a sentence with numbers.
    pub description: String,
    /// The two that it separates.
    pub separates: [Subject; 2],
    /// Expected separation, in standard deviations.
    pub separation: f64,
    /// Separation of the manoeuvres that were compared, the best first.
    pub compared: Vec<(&'static str, f64)>,
}

/// A channel's residuals over time, as measured less predicted.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualTrace {
    /// Name of the channel, as `heading`.
    pub channel: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Times \[s\].
    pub time: Vec<f64>,
    /// Under the re-tuned model.
    pub before: Vec<f64>,
    /// With what was found.
    pub after: Vec<f64>,
}

/// A wrench that the model lacks, over time.
#[derive(Debug, Clone, PartialEq)]
pub struct WrenchTrace {
    /// Times \[s\].
    pub time: Vec<f64>,
    /// dF_X, dF_Y \[N\], dM_Z \[N m\].
    pub value: Vec<[f64; 3]>,
    /// Their standard deviations.
    pub deviation: Vec<[f64; 3]>,
}

/// One run, for plots.
#[derive(Debug, Clone, PartialEq)]
pub struct RunTrace {
    /// Name of the recording.
    pub recording: String,
    /// Which of its runs, from 0.
    pub run: usize,
    /// What the run is called where the recording has several; else empty.
    pub label: String,
    /// Times of the path's points \[s\].
    pub time: Vec<f64>,
    /// Measured positions, east and north \[m\]; empty where no position was recorded.
    pub path: Vec<[f64; 2]>,
    /// How much the re-tuned model misses there, in standard deviations of the noise.
    pub mismatch: Vec<f64>,
    /// Residuals by channel.
    pub residuals: Vec<ResidualTrace>,
    /// The wrench left over under the re-tuned model.
    pub wrench: Option<WrenchTrace>,
}

/// How it was done.
#[derive(Debug, Clone, PartialEq)]
pub struct Account {
    /// Seed of everything random.
    pub seed: u64,
    /// Number of segments, and seconds that they cover.
    pub segments: usize,
    /// Seconds that they cover.
    pub seconds: f64,
    /// Seconds left out (rest, gaps, what the model cannot drive).
    pub left_out: f64,
    /// Noise of every channel.
    pub noise: Vec<NoiseEstimate>,
    /// How many times larger the segments' pulls scatter than the noise explains.
    pub overdispersion: f64,
    /// The threshold of the screen, from simulated nulls.
    pub threshold: f64,
    /// Log odds of what was fitted last and not taken, the likeliest first.
    pub refused: Vec<(Subject, f64)>,
    /// Seconds that each step took, with its name.
    pub steps: Vec<(&'static str, f64)>,
    /// What a reader should know, in plain sentences.
    pub notes: Vec<String>,
}

/// A finished diagnosis.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnosis {
    /// All in all.
    pub verdict: Verdict,
    /// Why there is no verdict, where there is none.
    pub insufficient: Option<Insufficient>,
    /// The verdict in one or two plain sentences.
    pub statement: String,
    /// What limits the verdict: time that was up, a vehicle that was assumed.
    pub cautions: Vec<Caution>,
    /// Names of the recordings.
    pub recordings: Vec<String>,
    /// What is missing, in the order of what each explains beside the others; first what has no name where that is the
    /// main thing.
    pub findings: Vec<Finding>,
    /// Place of the finding that the verdict is about.
    pub leading: Option<usize>,
    /// Everything that was asked about, nothing and unknown among them; probabilities sum to 1.
    pub candidates: Vec<Candidate>,
    /// Held-out errors; `None` where there was too little to hold out.
    pub held_out: Option<HeldOut>,
    /// The soil as given, re-tuned (first) and with what was found (second).
    pub soil: Vec<(Estimate, Estimate)>,
    /// What to drive next.
    pub next: Option<Manoeuvre>,
    /// The runs, for plots.
    pub runs: Vec<RunTrace>,
    /// How it was done.
    pub account: Account,
    /// The given model.
    pub nominal: Specification,
    /// The model with the re-tuned soil and what was found.
    pub model: Specification,
}
