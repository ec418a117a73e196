//! Where the fits of a proposal begin.
//!
//! As seen by the linearised problem, as large as the catalogue expects it, as comparing the curves tells, or at the
//! end of a walk from off: fits from a place too far away end elsewhere.

use super::proposal::Proposal;
use crate::diagnosis::hypothesis::candidate::Target;
use crate::diagnosis::hypothesis::likelihood::{SKETCH, Tuned, cost, tune_until};
use crate::diagnosis::hypothesis::part::Part;
use crate::diagnosis::hypothesis::{Given, Solution};
use crate::diagnosis::screening::locate::Extent;
use crate::fit::optimiser::Stop;
use crate::fit::problem::Weighing;

/// A fit that is so much worse than without the proposal, whose price for more numbers is less, has
/// lost its way.
pub const LOST: f64 = 5.0;
/// A hidden effect that begins so much worse, in units of the log likelihood, leads nowhere.
const HOPELESS: f64 = 1000.0;
/// Shares of a proposal's steps that its fit may begin with: the cheapest is taken.
const SHARES: [f64; 3] = [1.0, 0.4, 0.15];
/// Wheel speeds may be so much later or earlier than what they move \[s\], and so may be what acts with them.
const REACH: f64 = 1.5;
/// Steps on the way from off to the typical size, and how far the soil follows at each.
const WALK: u32 = 5;
const STROLL: Stop = Stop::after(3, 1.0).without_renewals();

/// Where a proposal's fit begins: the cheapest of some shares of its steps. `None` where a hidden effect
/// leads nowhere.
#[must_use]
pub fn cheapest(
    given: &Given,
    proposal: &Proposal,
    knobs: &[usize],
    before: &Solution,
    by: &Weighing,
) -> Option<Solution> {
    let touched = touched(given, proposal);
    let some = touched
        .as_ref()
        .map(|part| (part, part.given(given), part.weighing(by)));
    let cost = |at: &Solution| match &some {
        Some((part, given, by)) => cost(given, knobs, &part.solution(at), by),
        None => cost(given, knobs, at, by),
    };
    let at = |share: f64| {
        let begin = begin(given, proposal, before, share);
        (cost(&begin), begin)
    };
    let cheaper = |a: &(f64, Solution), b: &(f64, Solution)| a.0.total_cmp(&b.0);
    if !proposal.hidden {
        return SHARES
            .map(at)
            .into_iter()
            .min_by(cheaper)
            .map(|best| best.1);
    }
    // What is hidden tells its sign no more than its size. Small steps come first: where those lead
    // nowhere, larger ones are hardly to be driven, which takes long.
    let hopeless = cost(before) + HOPELESS;
    let mut found = Vec::new();
    for sign in [1.0, -1.0] {
        for share in SHARES.iter().rev() {
            let begin = at(sign * share);
            if begin.0 > hopeless {
                break;
            }
            found.push(begin);
        }
    }
    found.into_iter().min_by(cheaper).map(|best| best.1)
}

/// The stretches that what acts for some seconds reaches, where nothing else of the proposal changes the others.
fn touched(given: &Given, proposal: &Proposal) -> Option<Part> {
    let (Some(Extent::Time(at) | Extent::Run(at)), true) = (
        &proposal.extent,
        proposal.soil.iter().all(|step| *step == 0.0),
    ) else {
        return None;
    };
    let span = [at.start - REACH, at.end + REACH];
    Part::within(given, (at.recording, at.run), span)
}

/// A share of a proposal's steps away from what was before.
#[must_use]
pub fn begin(given: &Given, proposal: &Proposal, before: &Solution, share: f64) -> Solution {
    let mut begin = before.clone();
    let soil = begin.soil.iter_mut().zip(given.soil_parameters());
    for ((value, parameter), step) in soil.zip(proposal.soil.iter()) {
        let (low, high) = parameter.bounds();
        *value = (*value + share * step).clamp(low, high);
    }
    for (knob, steps) in &proposal.steps {
        let parameter = &given.candidates.knobs[*knob].parameter;
        let (low, high) = parameter.bounds();
        for (recording, knobs) in begin.knobs.iter_mut().enumerate() {
            let step = steps
                .get(recording)
                .or(steps.get(0))
                .copied()
                .unwrap_or(0.0);
            knobs[*knob] = (knobs[*knob] + share * step).clamp(low, high);
        }
    }
    begin
}

/// Where effects are proposed that have no derivative while they are off, as large as the catalogue expects
/// them, and what one run of several has, as large as it was seen: the soil fitted beside that from the given one.
/// The soil that re-tuning ended with imitates them; beside it, or freed at once, they would be turned off and stay
/// there.
#[must_use]
pub fn settled(
    given: &Given,
    proposal: &Proposal,
    before: &Tuned,
    by: &Weighing,
) -> Option<Solution> {
    let of_a_run = matches!(proposal.extent, Some(Extent::Run(_)));
    if !of_a_run && !is_unseen(given, proposal) {
        return None;
    }
    let begin = Solution {
        knobs: begin(given, proposal, &before.solution, 1.0).knobs,
        ..given.begin()
    };
    let stop = SKETCH.without_renewals();
    Some(beside(given, proposal, begin, before, by, stop)?.solution)
}

/// Where effects are proposed that have no derivative while they are off: the likeliest place on the way from off
/// to as large as the catalogue expects them, the soil following a little at each step. Re-tuning may have gone far to
/// imitate them (a rigid wheel on soil of three times the stiffness for a tyre): then one step is too long, and so is
/// the way from the given soil. `None` where the way leads up.
#[must_use]
pub fn walked(
    given: &Given,
    proposal: &Proposal,
    before: &Tuned,
    by: &Weighing,
) -> Option<Solution> {
    let mut at = before.solution.clone();
    let mut best: Option<Tuned> = None;
    for step in 1..=WALK {
        let share = f64::from(step) / f64::from(WALK);
        at.knobs = begin(given, proposal, &before.solution, share).knobs;
        let Some(here) = beside(given, proposal, at, before, by, STROLL) else {
            break;
        };
        if here.surprise - here.promised > before.surprise + LOST {
            break;
        }
        at = here.solution.clone();
        if best
            .as_ref()
            .is_none_or(|best| here.surprise < best.surprise)
        {
            best = Some(here);
        }
    }
    best.map(|best| best.solution)
}

/// Whether it is hidden and has no derivative while it is off.
#[must_use]
pub fn is_unseen(given: &Given, proposal: &Proposal) -> bool {
    let mut own = proposal.knobs.iter();
    proposal.hidden && own.any(|knob| given.candidates.knobs[*knob].secant.is_some())
}

/// The fit of everything else beside a proposal whose knobs are held where they begin. `None` where that cannot be
/// driven.
fn beside(
    given: &Given,
    proposal: &Proposal,
    begin: Solution,
    before: &Tuned,
    by: &Weighing,
    stop: Stop,
) -> Option<Tuned> {
    let knobs = &given.candidates.knobs;
    let mut held = given.clone();
    for knob in &proposal.knobs {
        if let Target::Model(parameter) = knobs[*knob].target {
            let value = knobs[*knob].parameter.value(begin.knobs[0][*knob]);
            parameter.set(&mut held.nominal, value).ok()?;
        }
    }
    let fitted = tune_until(&held, &before.knobs, &begin, by, stop);
    fitted.ok().filter(|fitted| fitted.surprise.is_finite())
}

/// Where latencies are proposed: they are what comparing the curves tells. A search from zero may
/// end where motions are matched with their neighbours.
#[must_use]
pub fn compared(given: &Given, proposal: &Proposal, before: &Solution) -> Option<Solution> {
    let mut begin = before.clone();
    let mut told = false;
    for knob in &proposal.knobs {
        let Target::Sensor(sensor) = given.candidates.knobs[*knob].target else {
            continue;
        };
        let each = begin.knobs.iter_mut().zip(&given.late);
        for ((values, late), recording) in each.zip(given.recordings) {
            if !sensor.is_told_by(recording) {
                continue;
            }
            values[*knob] += late[sensor.index()];
            told |= late[sensor.index()] != 0.0;
        }
    }
    told.then_some(begin)
}

#[cfg(test)]
mod tests {
    use super::super::naming::{ANY, placed, sketch};
    use super::super::stage::Stage;
    use super::super::stage::tests::retuned;
    use super::*;
    use crate::diagnosis::hypothesis::likelihood::LONG_SKETCH;
    use crate::diagnosis::manoeuvre::rehearsal::tests::driven;
    use crate::effects::{Effects, ParameterName};
    use crate::terrain::Terrain;
    use crate::vehicle::{Specification, Vehicle};

    #[test]
    fn what_acts_for_some_seconds_changes_the_cost_of_the_stretches_there_alone() {
        let soil = Terrain::preset("sandy_loam").unwrap();
        let nominal = Specification::plain(Vehicle::tran2007(), soil);
        let text = r#"{"drawbar": {"force": 400}, "window": {"effects": ["drawbar"], "time": [8.3, 11.9]}}"#;
        let towing = Specification {
            effects: Effects::from_json(text).unwrap(),
            ..nominal.clone()
        };
        let recordings = [driven(&towing, "slalom")];
        let (stage, by) = retuned(&nominal, &recordings);
        let for_some_seconds = |one: &&Proposal| matches!(one.extent, Some(Extent::Time(_)));
        let proposal = stage.proposals.iter().find(for_some_seconds).unwrap();
        let given = placed(&stage.given, proposal).unwrap();
        let part = touched(&given, proposal).unwrap();
        assert!(part.places().len() < given.segments.len());
        let (some, own, knobs) = (part.given(&given), part.weighing(&by), &proposal.knobs);
        let elsewhere = SHARES.map(|share| {
            let at = begin(&given, proposal, &stage.tuned.solution, share);
            cost(&given, knobs, &at, &by) - cost(&some, knobs, &part.solution(&at), &own)
        });
        let differs = |one: &f64| (one - elsewhere[0]).abs() > 1e-6 * elsewhere[0].abs();
        assert!(!elsewhere.iter().any(differs), "{elsewhere:?}");
    }

    /// Share of what the best way gains.
    const MOST: f64 = 0.9;

    #[test]
    fn tyres_are_walked_to_where_re_tuning_went_far_to_imitate_them() {
        // A light vehicle on hard clay: re-tuned, rigid wheels stand on soil of several times the stiffness.
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
        let (stage, by) = retuned(&nominal, &recordings);
        let tyres = |one: &&Proposal| one.hidden && one.subject.name() == "tyre_compliance";
        let proposal = stage.proposals.iter().find(tyres).unwrap();
        let Stage { given, tuned, .. } = &stage;
        let found = sketch(given, proposal, tuned, &by, 1.0, ANY).unwrap();
        assert!(found.tuned.surprise < tuned.surprise - 1000.0);
        let begin = walked(given, proposal, tuned, &by).unwrap();
        let walked = tune_until(given, &proposal.knobs, &begin, &by, LONG_SKETCH).unwrap();
        let gained = (tuned.surprise - walked.surprise) / (tuned.surprise - found.tuned.surprise);
        assert!(gained > MOST, "{gained}");
    }
}
