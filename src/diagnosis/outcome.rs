//! The result of a diagnosis as plain data for reports; nothing is computed here.

use super::Caution;
use crate::effects::{CATALOGUE, EffectKind};
use crate::fit::{Estimate, NoiseEstimate};
use crate::inspection::Doubt;
use crate::vehicle::Specification;

/// The overall result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The model with the refitted soil explains the recordings.
    NothingMissing,
    /// An effect of the catalogue is missing.
    MissingPhysics,
    /// A sensor of the recording is faulty, or its data are not what they claim; the model is not at fault.
    Sensor,
    /// One of several effects that these recordings cannot separate.
    Ambiguous,
    /// Something is missing that the catalogue does not contain.
    UnknownPhysics,
    /// No verdict is possible; [`Diagnosis::insufficient`] has the reason.
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
    /// Time was up before all candidates were fitted.
    TimeUp,
    /// Neither "something is missing" nor "nothing is missing" is likely enough.
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

/// The subject of a finding or a candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Subject {
    /// An effect, by its place in [`CATALOGUE`].
    Effect(usize),
    /// Something that the catalogue does not contain.
    Unknown,
    /// The model with the refitted soil alone.
    Nothing,
    /// The recording is not what it claims: see [`Caution::DoubtfulData`].
    Data,
}

impl Subject {
    /// The name in `diagnosis.json`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Effect(index) => CATALOGUE[index].name,
            Self::Unknown => "unknown",
            Self::Nothing => "nothing_missing",
            Self::Data => "doubtful_data",
        }
    }

    /// Whether it is an error of a sensor, or of the data.
    #[must_use]
    pub fn is_sensor(self) -> bool {
        match self {
            Self::Effect(index) => CATALOGUE[index].kind == EffectKind::Measurement,
            Self::Data => true,
            Self::Unknown | Self::Nothing => false,
        }
    }
}

/// A value with its 90 % interval.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Name within its effect, as `slope_east`; of a sensor fault, as `pose`.
    pub name: String,
    /// The recording that it belongs to, if each has a separate value.
    pub recording: Option<String>,
    /// Best value.
    pub value: f64,
    /// Lower end of the 90 % interval.
    pub low: f64,
    /// Upper end of the 90 % interval.
    pub high: f64,
    /// Where the effect does nothing.
    pub off: f64,
    /// Unit.
    pub unit: &'static str,
}

/// The component of the unmodelled wrench that residuals point to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// A force along the vehicle, dF_X.
    Longitudinal,
    /// A force across the vehicle, dF_Y.
    Lateral,
    /// A moment about the vertical, dM_Z.
    Yaw,
    /// None: the measurement is wrong.
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

/// A time interval of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Interval {
    /// Name of the recording.
    pub recording: String,
    /// Index of the run within the recording.
    pub run: usize,
    /// Label of the run if the recording has several; else empty.
    pub label: String,
    /// Start \[s\], by the run's clock.
    pub start: f64,
    /// End \[s\].
    pub end: f64,
    /// The component in which it shows most.
    pub channel: Channel,
    /// The regime in which it shows most, as `heading 60..120 deg` or `speed over 1.2 m/s`; empty for none.
    pub regime: String,
    /// The disc on the map, if it acts in one: centre (east, north) and radius \[m\].
    pub patch: Option<[f64; 3]>,
}

/// A term of an empirical residual model.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// The component of the wrench that it adds to.
    pub channel: Channel,
    /// Name of the parameter in the model file, as `residual_yaw.speed_turning`.
    pub parameter: String,
    /// The dimensionless group in symbols, as `|u| q`; a leading minus belongs to it.
    pub group: String,
    /// Its coefficient.
    pub coefficient: Quantity,
    /// Share of the bootstrap samples in which it was selected.
    pub stability: f64,
}

/// One missing effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What it is.
    pub subject: Subject,
    /// Its probability.
    pub probability: f64,
    /// Other subjects that these recordings cannot separate from it.
    pub ambiguous_with: Vec<Subject>,
    /// Log Bayes factor against the model without it, by the catalogue's formula or its neighbours.
    pub evidence: f64,
    /// Log odds, prior included, of itself and of everything that was fitted in its place, the likeliest first.
    pub rivals: Vec<(Subject, f64)>,
    /// Its parameters.
    pub parameters: Vec<Quantity>,
    /// Where it shows, the strongest place first.
    pub places: Vec<Interval>,
    /// Whether it acts in these places only.
    pub local: bool,
    /// The terms of the empirical residual model, if it is unknown.
    pub law: Vec<Term>,
    /// Forces that mend its formula, where the catalogue's is not quite that of these recordings.
    pub mended_by: Vec<Term>,
    /// The finding in one sentence.
    pub statement: String,
}

/// How far a claim goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClaimLevel {
    /// What kind of thing differs, and in which direction it acts.
    Where,
    /// Which mechanism it is.
    Mechanism,
    /// By which formula it acts.
    Formula,
}

impl ClaimLevel {
    /// The name in `diagnosis.json`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Where => "where",
            Self::Mechanism => "mechanism",
            Self::Formula => "formula",
        }
    }
}

/// A claim about what is missing. Each of a diagnosis' claims includes the next one, which is less likely.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// How far it goes.
    pub level: ClaimLevel,
    /// Its name, as `resistance_along` or `drag`.
    pub name: &'static str,
    /// The claim in plain words.
    pub statement: String,
    /// Its probability.
    pub probability: f64,
}

/// Results for one candidate.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// What it is.
    pub subject: Subject,
    /// Its probability.
    pub probability: f64,
    /// Share of its signal that a refit of the soil absorbs.
    pub absorbed: f64,
    /// Block-robust t of the projected score, relative to the 95 % quantile of the largest among all
    /// candidates under the null.
    pub significance: f64,
    /// The smallest detectable value of its leading parameter; infinite if there is none.
    pub smallest_detectable: f64,
    /// Name of that parameter.
    pub parameter: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// One-step estimate of that parameter.
    pub estimate: f64,
    /// Its 90 % interval.
    pub interval: [f64; 2],
    /// Gain of the held-out log score per sample over the refitted soil alone, with its standard error;
    /// `None` if the candidate was not fitted.
    pub held_out_gain: Option<(f64, f64)>,
    /// Candidates whose projected signals have nearly the same direction, with the cosine.
    pub alike: Vec<(Subject, f64)>,
}

/// Errors of a model on held-out data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Root mean square error of the position \[m\]; NaN without positions.
    pub position: f64,
    /// Root mean square error of the heading \[rad\]; NaN without headings.
    pub heading: f64,
    /// Root mean square error of the yaw rate \[rad/s\]; NaN without a gyro.
    pub yaw_rate: f64,
    /// Mean log predictive density per sample (densities in the units of the channels).
    pub log_score: f64,
}

impl Errors {
    /// For a model that cannot follow the wheel speeds.
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
    /// The model as given; NaN if it cannot follow the wheel speeds.
    pub nominal: Errors,
    /// The refitted soil alone.
    pub refitted: Errors,
    /// With the findings.
    pub augmented: Errors,
    /// Gain of the augmented over the refitted model: log score per sample, and standard error.
    pub gain: (f64, f64),
    /// Prediction horizon \[s\].
    pub horizon: f64,
    /// Number of predicted segments.
    pub stretches: usize,
}

/// A manoeuvre that is worth driving next.
#[derive(Debug, Clone, PartialEq)]
pub struct Manoeuvre {
    /// Its name, as `slalom`.
    pub name: &'static str,
    /// Instruction in one sentence, with numbers.
    pub description: String,
    /// The two hypotheses that it separates.
    pub separates: [Subject; 2],
    /// Expected separation, in standard deviations.
    pub separation: f64,
    /// Separations of all compared manoeuvres, the best first.
    pub compared: Vec<(&'static str, f64)>,
}

/// The models that a diagnosis compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Compared {
    /// The model as given.
    Given,
    /// With the soil refitted alone.
    Refitted,
    /// With the findings.
    Mended,
}

impl Compared {
    /// All of them, from the simplest.
    pub const ALL: [Self; 3] = [Self::Given, Self::Refitted, Self::Mended];
}

/// A channel's errors over time, as measured less predicted.
///
/// With [`Diagnosis::held_out`] these are errors on held-out data: the start of each segment is fitted to its first
/// second, the rest is predicted with parameters from the other blocks. Without, they are the residuals of the fits.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualTrace {
    /// Name of the channel, as `heading`.
    pub channel: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Times \[s\].
    pub time: Vec<f64>,
    /// For each model of [`Compared::ALL`] as many as times; NaN where the model cannot follow.
    pub errors: [Vec<f64>; 3],
}

/// Measured and predicted path of a segment.
#[derive(Debug, Clone, PartialEq)]
pub struct PredictedPath {
    /// Times \[s\].
    pub time: Vec<f64>,
    /// Measured positions, east and north \[m\].
    pub measured: Vec<[f64; 2]>,
    /// For each model of [`Compared::ALL`] as many as times; empty if the model cannot follow.
    pub predicted: [Vec<[f64; 2]>; 3],
}

/// The unmodelled wrench over time.
#[derive(Debug, Clone, PartialEq)]
pub struct WrenchTrace {
    /// Times \[s\].
    pub time: Vec<f64>,
    /// dF_X, dF_Y \[N\], dM_Z \[N m\].
    pub value: Vec<[f64; 3]>,
    /// Their standard deviations.
    pub deviation: Vec<[f64; 3]>,
}

/// Plot data of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct RunTrace {
    /// Name of the recording.
    pub recording: String,
    /// Index of the run within the recording.
    pub run: usize,
    /// Label of the run if the recording has several; else empty.
    pub label: String,
    /// Times of the path's points \[s\].
    pub time: Vec<f64>,
    /// Measured positions, east and north \[m\]; empty where no position was recorded.
    pub path: Vec<[f64; 2]>,
    /// Root mean square of the whitened residuals there, under the model with the refitted soil.
    pub mismatch: Vec<f64>,
    /// Paths that were predicted on held-out data, segment by segment.
    pub predicted: Vec<PredictedPath>,
    /// Errors by channel.
    pub residuals: Vec<ResidualTrace>,
    /// The unmodelled wrench under the model with the refitted soil.
    pub wrench: Option<WrenchTrace>,
}

/// Settings and intermediate results of the diagnosis.
#[derive(Debug, Clone, PartialEq)]
pub struct Account {
    /// Seed of everything random.
    pub seed: u64,
    /// Number of segments.
    pub segments: usize,
    /// Seconds that the segments cover.
    pub seconds: f64,
    /// Of that, seconds of each recording.
    pub used: Vec<f64>,
    /// Seconds not used (rest, gaps, segments that the model cannot follow).
    pub left_out: f64,
    /// Noise of every channel.
    pub noise: Vec<NoiseEstimate>,
    /// Median over the candidates of the segments' overdispersion.
    pub overdispersion: f64,
    /// Screening threshold of t, from simulations under the null.
    pub threshold: f64,
    /// Log odds of the candidates rejected in the last round, the likeliest first.
    pub refused: Vec<(Subject, f64)>,
    /// Name and duration \[s\] of each step.
    pub steps: Vec<(&'static str, f64)>,
    /// Remarks for the reader.
    pub notes: Vec<String>,
}

/// A finished diagnosis.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnosis {
    /// The overall result.
    pub verdict: Verdict,
    /// Why there is no verdict, if so.
    pub insufficient: Option<Insufficient>,
    /// The verdict in one or two sentences.
    pub statement: String,
    /// Limits of the verdict, such as a time limit.
    pub cautions: Vec<Caution>,
    /// Doubts about data that are used and probably right, the likeliest first.
    pub minor_doubts: Vec<Doubt>,
    /// Names of the recordings.
    pub recordings: Vec<String>,
    /// What is missing, in the order of what each explains beside the others; an unknown main cause comes first.
    pub findings: Vec<Finding>,
    /// Index of the finding that the verdict is about.
    pub leading: Option<usize>,
    /// What can be claimed of that finding, from the safest claim to the boldest one.
    pub claims: Vec<Claim>,
    /// All candidates, with "nothing missing" and "unknown"; their probabilities sum to 1.
    pub candidates: Vec<Candidate>,
    /// Held-out errors; `None` if there was too little data to hold out.
    pub held_out: Option<HeldOut>,
    /// The soil refitted alone (first) and beside the findings (second).
    pub soil: Vec<(Estimate, Estimate)>,
    /// The manoeuvre to drive next.
    pub next: Option<Manoeuvre>,
    /// Plot data of the runs.
    pub runs: Vec<RunTrace>,
    /// Settings and intermediate results.
    pub account: Account,
    /// The given model.
    pub nominal: Specification,
    /// The given model with the refitted soil and the findings.
    pub model: Specification,
}
