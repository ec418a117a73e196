//! The entry point: from recordings to a diagnosis.

use super::answer::account::{account, doubts, read};
use super::answer::augmented::model;
use super::answer::candidates::{candidates, empty, others};
use super::answer::claims::claims;
use super::answer::errors::{Comparison, compare};
use super::answer::findings::findings;
use super::answer::traces::traces;
use super::answer::verdict::judge;
use super::doubts::Doubts;
use super::hypothesis::Problem;
use super::hypothesis::likelihood::FittedHypothesis;
use super::hypothesis::prepare::prepare;
use super::manoeuvre::next;
use super::outcome::{Account, Candidate, Diagnosis, Finding, Insufficient, Subject, Verdict};
use super::search::{SearchResult, search};
use super::{Caution, DiagnosisError, Options, Progress};
use crate::fit::Estimate;
use crate::fit::error::LENGTHS;
use crate::fit::parameter::NORMAL_95;
use crate::fit::signal::Signal;
use crate::identification::with_true_gyro;
use crate::recording::{Recording, different_names};
use crate::vehicle::Specification;

/// Finds the physics that a model leaves out, from recordings: where it acts, its probability, and a model with it.
///
/// Units are SI and radians. [`Diagnosis::model`] is the given model with its soil refitted and the findings on.
/// A diagnosis takes half a minute to some minutes on rayon's current pool.
///
/// # Algorithm
/// 0. *Doubts.* The data themselves are questioned first ([`crate::inspection::doubts`]): a wrong gear, a pose from the
///    wheels, a frozen encoder. Frozen samples are left out. From a probability of 0.5 on the likeliest doubt is the
///    verdict, and all other probabilities shrink by the rest. A gyro whose scale clearly differs from the heading's is put
///    right ([`crate::identification::GyroScale`]).
/// 1. *Segments.* Recordings are cut into segments of some seconds (multiple shooting). Every segment has a free
///    initial state with a Gaussian prior around the measured one, so errors do not accumulate over a drive.
///    Rest, gaps and segments that the model cannot follow are dropped.
/// 2. *Prior.* Soil parameters have the log-normal or normal priors of the catalogue. Every candidate parameter a has
///    a Gaussian prior around "off" in its coordinate, as wide as the catalogue finds plausible. All effects have
///    the same prior probability; a local effect, a term of an empirical residual model and the absence of an effect
///    have fixed log odds to that.
/// 3. *Likelihood.* Residuals r of each channel are white plus AR(1) noise, whitened by a Kalman filter, with
///    Student's t weights against outliers. Noise variances and the AR(1) time maximise the restricted likelihood
///    (REML): soil, initial states and all candidates are integrated out, so a missing effect does not count as noise.
/// 4. *Soil.* Levenberg–Marquardt minimises cost = r^T S r + (x - x_0)^T P (x - x_0) over soil and initial states,
///    in turns with the noise. Reconstructions of the wheel speeds between samples compete by the evidence of step 7.
/// 5. *Screening.* The problem is linearised at the refitted soil; initial states are eliminated segment by segment.
///    Soil N is projected out of each candidate C: H~ = H_CC - H_CN (H_NN + P_N)^-1 H_NC, likewise the score g~.
///    log B = g~^T (H~ + P_C)^-1 g~ / 2 - ln det(1 + P_C^-1 H~) / 2. The reported t values divide by the segments'
///    overdispersion, and by the 95 % quantile of the largest candidate under simulated nulls.
/// 6. *Regions.* Effects are also resolved in time bins of half a second. Every time interval, run and disc of the map
///    is scanned for each candidate and for an unmodelled wrench; the best one pays ln(number of regions) of log B.
///    Forward selection by log B proposes an empirical residual model of up to three terms.
/// 7. *Evidence.* The best proposals are fitted in full, from several initial guesses. Integrating soil, initial
///    states and effects by Laplace's method, -2 ln E = cost + ln det H - ln det P, H = J^T S J + P. Close
///    candidates are ranked by the restricted likelihood of step 3, each under its own noise, as is the model without
///    them.
/// 8. *Held-out score.* Blocks of neighbouring segments are left out; each is scored by its log predictive density under
///    the posterior of the others. A candidate that scores worse by more than a standard error is not accepted.
/// 9. *Selection.* The candidate with the largest log odds is accepted, if these exceed those of "nothing" by a
///    margin. Steps 5 to 8 repeat beside it, up to four times. Then accepted effects that the others explain are
///    removed, and other mechanisms are fitted in the place of each that is left, beside all others.
/// 10. *Posterior.* The rivals of each accepted effect and "nothing" share its probability by their log odds l. For
///     those that were ranked, l / sqrt(1 + pi s^2 / 8), with the standard error s of their distance from blocks of
///     time; for the others, l divided by a temperature for the scatter of evidence between recordings. "Unknown" takes
///     a fixed share, and more if residual models or a latent Ornstein–Uhlenbeck wrench explain part of the misfit. The
///     verdict is a single name from 0.75 on, else the smallest set with 0.95 of the probability of all rivals.
/// 11. *Check.* The given, the refitted and the augmented model are compared once more with parameters fitted anew
///     without each block. If the augmented model is worse by a standard error, its findings are withdrawn,
///     unless all of them are local: what acts in a region is not known without it.
/// 12. *Next manoeuvre.* Manoeuvres are simulated; the one that best separates the rivals (T-optimality) is proposed.
///
/// ```no_run
/// use ugv_terrain::diagnosis::{Options, Progress, diagnose};
/// use ugv_terrain::recording::read_recording;
/// use ugv_terrain::terrain::Terrain;
/// use ugv_terrain::vehicle::{Specification, Vehicle};
///
/// let recordings = [read_recording("there.csv".as_ref())?, read_recording("back.csv".as_ref())?];
/// let loam = Terrain::preset("sandy_loam").expect("one of the paper's terrains");
/// let nominal = Specification::plain(Vehicle::tran2007(), loam);
/// let progress = Progress::new(&|step| eprintln!("{step}"));
/// let found = diagnose(&recordings, &nominal, &Options::default(), &progress)?;
/// println!("{}", found.statement);
/// for finding in &found.findings {
///     println!("{} with probability {:.2}", finding.subject.name(), finding.probability);
/// }
/// std::fs::write("model.json", found.model.to_json())?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Without a recording, for recordings without a measured motion or enough driving, and for two recordings of one name.
/// For a model that cannot follow the recordings, or whose effects depend on when a drive started. If the caller stopped
/// it ([`Progress::stopped_by`]), or the time limit ([`Progress::within`]) is too short for the first screening.
/// [`insufficient`] turns [`DiagnosisError::AtRest`], [`DiagnosisError::TooShort`] and [`DiagnosisError::OutOfTime`]
/// into a diagnosis.
pub fn diagnose(
    recordings: &[Recording],
    nominal: &Specification,
    options: &Options,
    progress: &Progress,
) -> Result<Diagnosis, DiagnosisError> {
    progress.step("preparing the recordings")?;
    if recordings.is_empty() {
        return Err(DiagnosisError::NoRecording);
    }
    if !LENGTHS.contains(&options.segment) {
        return Err(DiagnosisError::SegmentLength(options.segment));
    }
    if nominal.effects.depend_on_beginning() {
        return Err(DiagnosisError::DependsOnBeginning);
    }
    different_names(recordings.iter().map(|one| one.name.as_str()))
        .map_err(DiagnosisError::SameName)?;
    for recording in recordings {
        recording.check().map_err(DiagnosisError::Recording)?;
        if !Signal::ALL
            .iter()
            .any(|signal| recording.has(signal.channel()))
        {
            return Err(DiagnosisError::NothingMeasured {
                recording: recording.name.clone(),
            });
        }
    }
    let deadline = progress.answer_deadline();
    progress.in_time(deadline)?;
    progress.step("doubts about the data")?;
    let doubted = Doubts::of(recordings, &nominal.vehicle, progress);
    let remaining = doubted.remaining(recordings);
    let recordings = remaining.as_deref().unwrap_or(recordings);
    let scaled = recordings
        .iter()
        .map(|one| with_true_gyro(one).unwrap_or_else(|| one.clone()));
    let recordings: &[Recording] = &scaled.collect::<Vec<_>>();
    progress.in_time(deadline)?;
    let mut problem = Problem::until(nominal, recordings, deadline);
    progress.in_time(deadline)?;
    let (prepared, noise) = prepare(&mut problem, options, progress)?;
    let mut searched = search(&problem, noise, options, progress)?;
    progress.step("held-out comparison")?;
    let compared = |searched: &_| compare(searched).filter(|_| !deadline.is_over());
    let mut held = compared(&searched);
    let is_worse = |held: &Comparison| held.errors.gain.0 < -held.errors.gain.1;
    // What acts in a region alone is not known without it.
    if !searched.is_local() && held.as_ref().is_some_and(is_worse) {
        searched.withdraw();
        held = compared(&searched);
    }
    let mut cautions = Vec::new();
    if held.is_none() && deadline.is_over() {
        cautions.push(Caution::NotHeldOut);
    }
    progress.step("posterior and verdict")?;
    let mut candidates = candidates(&searched)?;
    let hidden = candidates.iter().filter(|c| !c.1);
    let hidden: Vec<Subject> = hidden.map(|c| c.0.subject).collect();
    let seen = 1.0 - hidden.len() as f64 / candidates.len().max(1) as f64;
    let judgement = judge(&searched, seen);
    progress.step("ranking next manoeuvres")?;
    let next = next(&searched, &judgement, &hidden, options).filter(|_| !deadline.is_over());
    progress.step("collecting results")?;
    for (candidate, _) in &mut candidates {
        candidate.probability = judgement.posterior.of(candidate.subject);
    }
    let mut candidates: Vec<Candidate> = candidates.into_iter().map(|(c, _)| c).collect();
    candidates.extend(others(&judgement.posterior, &candidates, nominal));
    candidates.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let found = findings(&searched, &judgement.findings);
    let model = model(&searched, nominal)?;
    if let Some([used, of]) = prepared.part {
        cautions.insert(0, Caution::Part { used, of });
    }
    if progress.was_late() {
        cautions.insert(0, Caution::TimeUp);
    }
    let mut diagnosis = Diagnosis {
        verdict: judgement.verdict,
        insufficient: judgement.insufficient,
        statement: String::new(),
        cautions,
        minor_doubts: Vec::new(),
        recordings: problem.names.clone(),
        leading: judgement.leading,
        claims: claims(&searched, &judgement, &found),
        findings: found,
        candidates,
        held_out: held.as_ref().map(|held| held.errors),
        soil: soil(&searched),
        next,
        runs: traces(&searched, held.as_ref()),
        account: account(&searched, options, prepared.left_out),
        nominal: nominal.clone(),
        model,
    };
    diagnosis.statement = statement(&diagnosis);
    doubted.put_before(&mut diagnosis);
    diagnosis.account.steps = progress.seconds();
    Ok(diagnosis)
}

/// A diagnosis without a verdict, for recordings that contain too little.
#[must_use]
pub fn insufficient(
    recordings: &[Recording],
    nominal: &Specification,
    options: &Options,
    error: &DiagnosisError,
) -> Diagnosis {
    let out_of_time = *error == DiagnosisError::OutOfTime;
    let why = error.to_string();
    let mut rest = why.chars();
    let first: String = rest
        .next()
        .into_iter()
        .flat_map(char::to_uppercase)
        .collect();
    let nothing = |subject, probability| Candidate {
        probability,
        ..empty(subject)
    };
    let mut diagnosis = Diagnosis {
        verdict: Verdict::InsufficientData,
        insufficient: Some(if out_of_time {
            Insufficient::TimeUp
        } else {
            Insufficient::TooLittle
        }),
        statement: format!("{first}{}.", rest.as_str()),
        cautions: out_of_time.then_some(Caution::TimeUp).into_iter().collect(),
        minor_doubts: Vec::new(),
        recordings: recordings.iter().map(|r| r.name.clone()).collect(),
        findings: Vec::new(),
        leading: None,
        claims: Vec::new(),
        candidates: vec![
            nothing(Subject::Nothing, 0.5),
            nothing(Subject::Unknown, 0.5),
        ],
        held_out: None,
        soil: Vec::new(),
        next: None,
        runs: Vec::new(),
        account: Account {
            seed: options.seed,
            segments: 0,
            seconds: 0.0,
            used: vec![0.0; recordings.len()],
            left_out: 0.0,
            noise: Vec::new(),
            overdispersion: 1.0,
            threshold: f64::INFINITY,
            refused: Vec::new(),
            steps: Vec::new(),
            notes: [doubts(&nominal.vehicle), read(recordings)].concat(),
        },
        nominal: nominal.clone(),
        model: nominal.clone(),
    };
    let doubted = if out_of_time {
        Doubts::quick(recordings, &nominal.vehicle)
    } else {
        Doubts::whole(recordings, &nominal.vehicle)
    };
    doubted.put_before(&mut diagnosis);
    diagnosis
}

/// The soil refitted alone, and beside the findings.
fn soil(searched: &SearchResult) -> Vec<(Estimate, Estimate)> {
    let problem = &searched.problem;
    let parameters = problem.soil_parameters();
    let estimate = |fit: &FittedHypothesis, k: usize| {
        let parameter = &parameters[k];
        let at = fit.solution.soil[k];
        let deviation = fit.covariance[(k, k)].max(0.0).sqrt();
        let (low, high) = parameter.interval(at, NORMAL_95 * deviation);
        Estimate {
            parameter: parameter.clone(),
            nominal: problem.soil[k].get(&problem.nominal),
            value: parameter.value(at),
            low,
            high,
            posterior_prior_ratio: deviation / parameter.prior.deviation,
        }
    };
    let each = 0..parameters.len();
    each.map(|k| {
        (
            estimate(&searched.refitted, k),
            estimate(&searched.augmented, k),
        )
    })
    .collect()
}

fn statement(diagnosis: &Diagnosis) -> String {
    let leading = diagnosis.leading.and_then(|k| diagnosis.findings.get(k));
    let what = leading.map_or("", |finding| &finding.statement);
    match diagnosis.verdict {
        Verdict::NothingMissing => {
            "The model with its refitted soil explains these recordings: they show no missing physics."
                .into()
        }
        Verdict::InsufficientData => undecided(diagnosis),
        Verdict::MissingPhysics => format!("The model leaves out {what}."),
        Verdict::Sensor => format!("The fault is in the recording, not in the model: {what}."),
        Verdict::Ambiguous => {
            let names = leading.map_or_else(Vec::new, |finding| {
                let others = finding.ambiguous_with.iter();
                std::iter::once(&finding.subject).chain(others).map(|s| s.name()).collect()
            });
            let best = if is_likeliest(leading, diagnosis) { "Best" } else { "As fitted" };
            format!(
                "Something is missing: {}; these recordings cannot separate them. {best}: {what}.",
                names.join(" or ")
            )
        }
        Verdict::UnknownPhysics => {
            format!("Something is missing that the catalogue does not contain: {what}.")
        }
    }
}

/// Why there is no verdict.
fn undecided(diagnosis: &Diagnosis) -> String {
    match diagnosis.insufficient {
        Some(Insufficient::TimeUp) => {
            "Time was up before all candidates were fitted. Nothing was found by then, and nothing can be ruled out. Allow more time (--within)."
                .into()
        }
        Some(Insufficient::Undecided) => {
            let percent = |one: &Candidate| {
                let name = one.subject.name().replace('_', " ");
                format!("{name} {:.0} %", 100.0 * one.probability)
            };
            let first: Vec<String> = diagnosis.candidates.iter().take(3).map(percent).collect();
            format!(
                "These recordings do not decide whether something is missing: {}.",
                first.join(", ")
            )
        }
        _ => "These recordings contain too little information: most effects of a plausible size would not show in them."
            .into(),
    }
}

/// Whether a finding is at least as likely as each of its rivals.
fn is_likeliest(finding: Option<&Finding>, diagnosis: &Diagnosis) -> bool {
    finding.is_some_and(|finding| {
        let others = &finding.ambiguous_with;
        let mut others = diagnosis
            .candidates
            .iter()
            .filter(|c| others.contains(&c.subject));
        others.all(|other| other.probability <= finding.probability)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Step;
    use crate::diagnosis::testing::{driven, on, with_effects};
    use std::sync::Mutex;
    use std::sync::atomic::{AtomicBool, Ordering};

    #[test]
    fn a_diagnosis_can_be_stopped() {
        let recordings = [driven(&on("sandy_loam"), "spiral")];
        let (stop, seen) = (AtomicBool::new(false), Mutex::new(Vec::new()));
        let tell = |step: Step| {
            seen.lock().unwrap().push(step.work);
            stop.store(step.work == "refitting the soil", Ordering::Relaxed);
        };
        let progress = Progress::new(&tell).stopped_by(&stop);
        let found = diagnose(&recordings, &on("dry_sand"), &Options::default(), &progress);
        assert_eq!(found.unwrap_err(), DiagnosisError::Stopped);
        assert_eq!(seen.lock().unwrap().last(), Some(&"refitting the soil"));
    }

    #[test]
    fn what_cannot_be_diagnosed_is_refused() {
        let nominal = on("sandy_loam");
        let options = Options::default();
        let progress = Progress::new(&|_| ());
        let refused = |recordings: &[Recording], nominal: &Specification, options: &Options| {
            diagnose(recordings, nominal, options, &progress).unwrap_err()
        };
        assert_eq!(
            refused(&[], &nominal, &options),
            DiagnosisError::NoRecording
        );
        let one = [Recording::default()];
        let short = Options {
            segment: -5.0,
            ..options.clone()
        };
        let found = refused(&one, &nominal, &short);
        assert_eq!(found, DiagnosisError::SegmentLength(-5.0));
        let window =
            r#"{"drag": {"coefficient": 9}, "window": {"effects": ["drag"], "time": [1, 2]}}"#;
        let found = refused(&one, &with_effects(&nominal, window), &options);
        assert_eq!(found, DiagnosisError::DependsOnBeginning);
        let found = refused(&one, &nominal, &options);
        assert!(matches!(found, DiagnosisError::NothingMeasured { .. }));
    }
}
