//! Initial guesses of a proposal's fit.
//!
//! The step of the linearised problem, the size that the catalogue expects, delays from cross-correlation, or the end
//! of a continuation from "off": fits from a distant guess end in other optima.

use super::proposal::Proposal;
use crate::diagnosis::hypothesis::candidate::Target;
use crate::diagnosis::hypothesis::likelihood::{FittedHypothesis, PARTIAL_FIT, cost, fit_until};
use crate::diagnosis::hypothesis::subsample::Subsample;
use crate::diagnosis::hypothesis::{Problem, Solution};
use crate::diagnosis::screening::region::Region;
use crate::fit::optimiser::Stop;
use crate::fit::problem::NoiseModel;

/// A fit that is this much worse than without the proposal, whose price is less, has failed.
pub const LOST: f64 = 5.0;
/// An initial guess of a hidden effect this much worse, in log likelihood, is useless.
const MAX_EXCESS: f64 = 1000.0;
/// Shares of a proposal's step that are tried as initial guess; the cheapest is used.
const SHARES: [f64; 3] = [1.0, 0.4, 0.15];
/// Margin around a time interval for delays of wheel speeds \[s\].
const REACH: f64 = 1.5;
/// Steps of the continuation from "off", and the end of the soil's fit at each.
const CONTINUATION_STEPS: u32 = 5;
const CONTINUATION_FIT: Stop = Stop::after(3, 1.0).without_renewals();

/// The cheapest of some shares of a proposal's step. `None` if a hidden effect has no useful one.
#[must_use]
pub fn cheapest(
    problem: &Problem,
    proposal: &Proposal,
    coefficients: &[usize],
    before: &Solution,
    noise: &NoiseModel,
) -> Option<Solution> {
    let touched = touched(problem, proposal);
    let some = touched
        .as_ref()
        .map(|part| (part, part.problem(problem), part.noise_model(noise)));
    let cost = |at: &Solution| match &some {
        Some((part, problem, noise)) => cost(problem, coefficients, &part.solution(at), noise),
        None => cost(problem, coefficients, at, noise),
    };
    let at = |share: f64| {
        let initial = after_steps(problem, proposal, before, share);
        (cost(&initial), initial)
    };
    let cheaper = |a: &(f64, Solution), b: &(f64, Solution)| a.0.total_cmp(&b.0);
    if !proposal.hidden {
        return SHARES
            .map(at)
            .into_iter()
            .min_by(cheaper)
            .map(|best| best.1);
    }
    // Small steps come first: after useless ones, larger steps hardly succeed and take long.
    let cost_ceiling = cost(before) + MAX_EXCESS;
    let found = SHARES.into_iter().rev().map(at);
    let found = found.take_while(|initial| initial.0 <= cost_ceiling);
    found.min_by(cheaper).map(|best| best.1)
}

/// The segments that a time interval reaches, if the proposal changes no others.
fn touched(problem: &Problem, proposal: &Proposal) -> Option<Subsample> {
    let (Some(Region::Time(at) | Region::Run(at)), true) = (
        &proposal.extent,
        proposal.soil.iter().all(|step| *step == 0.0),
    ) else {
        return None;
    };
    let span = [at.start - REACH, at.end + REACH];
    Subsample::within(problem, (at.recording, at.run), span)
}

/// A solution after a share of a proposal's step.
#[must_use]
pub fn after_steps(
    problem: &Problem,
    proposal: &Proposal,
    before: &Solution,
    share: f64,
) -> Solution {
    let mut initial = before.clone();
    let soil = initial.soil.iter_mut().zip(problem.soil_parameters());
    for ((value, parameter), step) in soil.zip(proposal.soil.iter()) {
        let (low, high) = parameter.bounds();
        *value = (*value + share * step).clamp(low, high);
    }
    for (coefficient, steps) in &proposal.steps {
        let parameter = &problem.candidates[*coefficient].parameter;
        let (low, high) = parameter.bounds();
        for (recording, coefficients) in initial.coefficients.iter_mut().enumerate() {
            let step = steps
                .get(recording)
                .or(steps.get(0))
                .copied()
                .unwrap_or(0.0);
            coefficients[*coefficient] =
                (coefficients[*coefficient] + share * step).clamp(low, high);
        }
    }
    initial
}

/// Initial guess for effects without a derivative at "off" at the expected size, and for effects of one run at their
/// screened size: the soil is fitted beside them from the given one. Beside the refitted soil, which imitates them,
/// or freed at once, they would return to "off".
#[must_use]
pub fn settled(
    problem: &Problem,
    proposal: &Proposal,
    before: &FittedHypothesis,
    noise: &NoiseModel,
) -> Option<Solution> {
    let of_a_run = matches!(proposal.extent, Some(Region::Run(_)));
    if !of_a_run && !proposal.hidden {
        return None;
    }
    let initial = Solution {
        coefficients: after_steps(problem, proposal, &before.solution, 1.0).coefficients,
        ..problem.initial()
    };
    let stop = PARTIAL_FIT.without_renewals();
    Some(beside(problem, proposal, initial, before, noise, stop)?.solution)
}

/// Initial guess for effects without a derivative at "off" by continuation: the likeliest point between "off" and the
/// expected size, the soil following at each step. The refit of the soil may have gone far to imitate them (a rigid
/// wheel on soil of three times the stiffness for a tyre). Then one step is too long, and so is the way from the
/// given soil. `None` if no step gains.
#[must_use]
pub fn continued(
    problem: &Problem,
    proposal: &Proposal,
    before: &FittedHypothesis,
    noise: &NoiseModel,
) -> Option<Solution> {
    let mut at = before.solution.clone();
    let mut best: Option<FittedHypothesis> = None;
    for step in 1..=CONTINUATION_STEPS {
        let share = f64::from(step) / f64::from(CONTINUATION_STEPS);
        at.coefficients = after_steps(problem, proposal, &before.solution, share).coefficients;
        let Some(here) = beside(problem, proposal, at, before, noise, CONTINUATION_FIT) else {
            break;
        };
        if here.negative_log_evidence - here.predicted_reduction
            > before.negative_log_evidence + LOST
        {
            break;
        }
        at = here.solution.clone();
        if best
            .as_ref()
            .is_none_or(|best| here.negative_log_evidence < best.negative_log_evidence)
        {
            best = Some(here);
        }
    }
    best.map(|best| best.solution)
}

/// The fit of everything else beside held coefficients of a proposal. `None` if the model cannot follow it.
fn beside(
    problem: &Problem,
    proposal: &Proposal,
    initial: Solution,
    before: &FittedHypothesis,
    noise: &NoiseModel,
    stop: Stop,
) -> Option<FittedHypothesis> {
    let coefficients = &problem.candidates.coefficients;
    let mut held = problem.clone();
    for coefficient in &proposal.coefficients {
        if let Target::Model(parameter) = coefficients[*coefficient].target {
            let value = coefficients[*coefficient]
                .parameter
                .value(initial.coefficients[0][*coefficient]);
            parameter.set(&mut held.nominal, value).ok()?;
        }
    }
    let fitted = fit_until(&held, &before.coefficients, &initial, noise, stop);
    fitted
        .ok()
        .filter(|fitted| fitted.negative_log_evidence.is_finite())
}

/// Initial guess for latencies: delays from cross-correlation. A search from zero may match motions with their
/// neighbours.
#[must_use]
pub fn compared(problem: &Problem, proposal: &Proposal, before: &Solution) -> Option<Solution> {
    let mut initial = before.clone();
    let mut changed = false;
    for coefficient in &proposal.coefficients {
        let Target::Sensor(sensor) = problem.candidates[*coefficient].target else {
            continue;
        };
        let each = initial.coefficients.iter_mut().zip(&problem.late);
        for ((values, late), recording) in each.zip(problem.recordings) {
            if !sensor.is_told_by(recording) {
                continue;
            }
            values[*coefficient] += late[sensor.index()];
            changed |= late[sensor.index()] != 0.0;
        }
    }
    changed.then_some(initial)
}

#[cfg(test)]
mod tests {
    use super::super::naming::{ANY, partial_fit, placed};
    use super::super::stage::Stage;
    use super::*;
    use crate::diagnosis::hypothesis::likelihood::LONG_PARTIAL_FIT;
    use crate::diagnosis::testing::{driven, on, refitted, with_effects};
    use crate::effects::ParameterName;
    use crate::terrain::Terrain;
    use crate::vehicle::{Specification, Vehicle};

    #[test]
    fn what_acts_for_some_seconds_changes_the_cost_of_the_stretches_there_alone() {
        let nominal = on("sandy_loam");
        let text = r#"{"drawbar": {"force": 400}, "window": {"effects": ["drawbar"], "time": [8.3, 11.9]}}"#;
        let towing = with_effects(&nominal, text);
        let recordings = [driven(&towing, "slalom")];
        let (stage, noise) = refitted(&nominal, &recordings);
        let for_some_seconds = |one: &&Proposal| matches!(one.extent, Some(Region::Time(_)));
        let proposal = stage.proposals.iter().find(for_some_seconds).unwrap();
        let problem = placed(&stage.problem, proposal).unwrap();
        let part = touched(&problem, proposal).unwrap();
        assert!(part.places().len() < problem.segments.len());
        let (some, own, coefficients) = (
            part.problem(&problem),
            part.noise_model(&noise),
            &proposal.coefficients,
        );
        let elsewhere = SHARES.map(|share| {
            let at = after_steps(&problem, proposal, &stage.fit.solution, share);
            cost(&problem, coefficients, &at, &noise)
                - cost(&some, coefficients, &part.solution(&at), &own)
        });
        let differs = |one: &f64| (one - elsewhere[0]).abs() > 1e-6 * elsewhere[0].abs();
        assert!(!elsewhere.iter().any(differs), "{elsewhere:?}");
    }

    /// Minimum share of the best gain.
    const MOST: f64 = 0.9;

    #[test]
    fn tyres_are_walked_to_where_re_tuning_went_far_to_imitate_them() {
        // A light vehicle on hard clay: refitted, rigid wheels need soil of several times the stiffness.
        let vehicle = Vehicle {
            mass: 75.0,
            yaw_inertia: 6.9,
            wheel_radius: 0.165,
            wheel_width: 0.12,
            row_positions: vec![0.25, -0.25],
            half_track: 0.29,
            com_offset: 0.02,
            com_height: 0.2,
        };
        let clay = Terrain::preset("dry_clay").unwrap();
        let nominal = Specification::plain(vehicle, clay);
        let mut truth = nominal.clone();
        let pressure = ParameterName::find("tyre_compliance.pressure").unwrap();
        truth.effects.set(pressure, 3e5).unwrap();
        truth.terrain.cohesion *= 0.7;
        truth.terrain.frictional_modulus /= 0.7;
        truth.terrain.shear_modulus *= 0.7;
        let recordings = ["slalom", "spiral"].map(|name| driven(&truth, name));
        let (stage, noise) = refitted(&nominal, &recordings);
        let tyres = |one: &&Proposal| one.hidden && one.subject.name() == "tyre_compliance";
        let proposal = stage.proposals.iter().find(tyres).unwrap();
        let Stage { problem, fit, .. } = &stage;
        let found = partial_fit(problem, proposal, fit, &noise, 1.0, ANY).unwrap();
        assert!(found.fit.negative_log_evidence < fit.negative_log_evidence - 1000.0);
        let initial = continued(problem, proposal, fit, &noise).unwrap();
        let continued = fit_until(
            problem,
            &proposal.coefficients,
            &initial,
            &noise,
            LONG_PARTIAL_FIT,
        )
        .unwrap();
        let gained = (fit.negative_log_evidence - continued.negative_log_evidence)
            / (fit.negative_log_evidence - found.fit.negative_log_evidence);
        assert!(gained > MOST, "{gained}");
    }
}
