//! Where and when exactly something acts.
//!
//! The box scan sees places and times through the linearised problem, gate by gate. What acts there hard on and off is felt
//! to a few hundredths of a second, and an edge that is off by a tenth costs all names alike more than what they differ
//! by. So the edges of what came close to the likeliest are moved in the full fit: they are unknowns of a Gauss–Newton step
//! beside all others, their derivatives by differences, for the other unknowns have theirs at hand; then the others follow.

use super::naming::{FittedCandidate, placed};
use super::proposal::{Proposal, ProposalKind};
use super::rerank::{AT_STAKE, close_to};
use crate::diagnosis::hypothesis::Solution;
use crate::diagnosis::hypothesis::held_out::scores;
use crate::diagnosis::hypothesis::likelihood::{
    FittedHypothesis, PARTIAL_FIT, cost, fit_on, fit_until, own_noise,
};
use crate::diagnosis::screening::region::Region;
use crate::fit::normal::{Eliminated, Normal};
use crate::fit::problem::{NoiseModel, Tables};
use nalgebra::{DMatrix, DVector};

/// Edges are counted in shares of the disc's radius or of two seconds. Derivatives are differences over this share ...
const DIFFERENCE: f64 = 0.02;
const SECONDS: f64 = 2.0;
/// ... what is known of them before is this share (one standard deviation), and a step goes no further than that one.
const PRIOR: f64 = 1.0;
const REACH: f64 = 0.25;
/// A step that loses is damped by so much of the diagonal (Marquardt 1963): beside an edge that is off soil and effect lead
/// far along what they hardly tell apart, where nothing is linear any more.
const DAMPINGS: [f64; 4] = [0.0, 1e-3, 1e-2, 0.1];
/// Steps at most, while one gains more than so much of the log evidence; one that gains less than so much is none, for fits
/// end half a unit from where they lead.
const STEPS: usize = 10;
const WORTH: f64 = 1.0;
const LEAST: f64 = 0.5;
/// A disc has a place, two numbers, and a radius; an interval two ends.
const EDGES: usize = 3;
/// An interval stays as long as this \[s\].
const SHORTEST: f64 = 0.1;

/// Moves the edges of what acts at some time or place and came close to the likeliest, whose log odds are `best`.
pub fn settle_edges(fitted: &mut [FittedCandidate], best: f64, by: &NoiseModel) {
    if best < AT_STAKE {
        return;
    }
    let close = |named: &&mut FittedCandidate| {
        named.proposal.kind() == ProposalKind::Local && named.odds() > close_to(best)
    };
    for named in fitted.iter_mut().filter(close) {
        let before = named.fit.negative_log_evidence;
        settle(named, by);
        if named.fit.negative_log_evidence < before {
            named.scores = scores(&named.problem, &named.fit, by);
        }
    }
}

/// The edges of what is taken under the noise that it leaves: that of the model without it holds a part of what its edges
/// are told by. It keeps its odds and scores.
pub fn settle_under_own_noise(named: &mut FittedCandidate, by: &NoiseModel) {
    if named.proposal.kind() != ProposalKind::Local || named.odds() < AT_STAKE {
        return;
    }
    let gain = named.gain;
    let own = own_noise(&named.problem, &named.fit, by);
    named.fit = fit_on(&named.problem, &named.fit, &own, PARTIAL_FIT);
    settle(named, &own);
    named.gain = gain;
}

fn settle(named: &mut FittedCandidate, by: &NoiseModel) {
    for _ in 0..STEPS {
        if stepped(named, by).is_none_or(|gain| gain < WORTH) {
            break;
        }
    }
}

/// One step of the edges and everything else; what it gained. `None` where there is nothing to gain.
fn stepped(named: &mut FittedCandidate, by: &NoiseModel) -> Option<f64> {
    let coefficients = &named.fit.coefficients;
    let way = Way::of(named, by)?;
    let (proposal, problem, begin) = DAMPINGS.into_iter().find_map(|damping| {
        let step = way.step(damping)?;
        let proposal = moved(&named.proposal, &way.edges(&step))?;
        let problem = placed(&named.problem, &proposal)?;
        let begin = way.solution(named, &step);
        let lower = cost(&problem, coefficients, &begin, by) < way.cost;
        lower.then_some((proposal, problem, begin))
    })?;
    let fit = fit_until(&problem, coefficients, &begin, by, PARTIAL_FIT).ok()?;
    let gain = named.fit.negative_log_evidence - fit.negative_log_evidence;
    if gain.is_nan() || gain < LEAST {
        return None;
    }
    named.gain += gain;
    (named.proposal, named.problem, named.fit) = (proposal, problem, fit);
    Some(gain)
}

/// Where the linearised problem leads with the edges among its unknowns.
struct Way {
    /// How many unknowns there are before the edges.
    others: usize,
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
    segments: Vec<(Normal, Eliminated)>,
    /// Half the cost here.
    cost: f64,
}

impl Way {
    fn of(named: &FittedCandidate, by: &NoiseModel) -> Option<Self> {
        let FittedHypothesis {
            coefficients,
            solution,
            tables,
            ..
        } = &named.fit;
        let predictor = named.problem.predictor(coefficients);
        let shooting = named.problem.shooting(&predictor, coefficients);
        let point = named.problem.point(&shooting, coefficients, solution);
        let here = shooting.evaluate_unless_one_fails(&point, false)?;
        let after = (0..EDGES).map_while(|edge| {
            let mut step = DVector::zeros(EDGES);
            step[edge] = DIFFERENCE;
            let problem = placed(&named.problem, &moved(&named.proposal, &step)?)?;
            let predictor = problem.predictor(coefficients);
            let shooting = problem.shooting(&predictor, coefficients);
            shooting.evaluate_unless_one_fails(&point, false)
        });
        let after: Vec<Vec<Tables>> = after.collect();
        let others = shooting.parameters.len();
        let linearised = shooting.linearised(&point);
        let linearised = linearised.with_further(&vec![PRIOR.powi(-2); after.len()]);
        let mut matrix = DMatrix::from_diagonal(&linearised.precision);
        let mut gradient = linearised.pull.clone();
        let mut each = Vec::new();
        for (index, segment) in tables.iter().enumerate() {
            let after: Vec<&Tables> = after.iter().map(|all| &all[index]).collect();
            let felt = with_differences(segment, &here[index], &after);
            let normal = linearised.normal(index, &felt, by);
            let eliminated = Eliminated::new(&normal, 0.0)?;
            matrix += &eliminated.matrix;
            gradient += &eliminated.gradient;
            each.push((normal, eliminated));
        }
        let gain = |matrix: DMatrix<f64>, gradient: DVector<f64>| {
            let step = matrix.cholesky()?.solve(&gradient);
            Some(0.5 * step.dot(&gradient))
        };
        let still = matrix.view((0, 0), (others, others)).into_owned();
        let without = gain(still, gradient.rows(0, others).into_owned())?;
        let with = gain(matrix.clone(), gradient.clone())?;
        if (with - without).is_nan() || with - without < LEAST {
            return None;
        }
        Some(Self {
            others,
            matrix,
            gradient,
            segments: each,
            cost: 0.5 * shooting.cost(&here, &point, by),
        })
    }

    /// The step of all unknowns, damped; edges move no further than their reach.
    fn step(&self, damping: f64) -> Option<DVector<f64>> {
        let mut damped = self.matrix.clone();
        for k in 0..damped.nrows() {
            damped[(k, k)] *= 1.0 + damping;
        }
        let step = damped.cholesky()?.solve(&self.gradient);
        let far = self.edges(&step).amax();
        Some(step * (REACH / far).min(1.0))
    }

    fn edges(&self, step: &DVector<f64>) -> DVector<f64> {
        let count = step.len() - self.others;
        step.rows(self.others, count).into_owned()
    }

    /// The solution a step from where a fit stands.
    fn solution(&self, named: &FittedCandidate, step: &DVector<f64>) -> Solution {
        let FittedCandidate { problem, fit, .. } = named;
        let predictor = problem.predictor(&fit.coefficients);
        let shooting = problem.shooting(&predictor, &fit.coefficients);
        let mut point = problem.point(&shooting, &fit.coefficients, &fit.solution);
        for (k, parameter) in shooting.parameters.iter().enumerate() {
            let (low, high) = parameter.bounds();
            point.coordinates[k] = (point.coordinates[k] + step[k]).clamp(low, high);
        }
        for (start, (normal, eliminated)) in point.starts.iter_mut().zip(&self.segments) {
            let moved = eliminated.start_step(normal, step);
            for (value, moved) in start.iter_mut().zip(moved) {
                *value += moved;
            }
        }
        problem.solution(&shooting, &fit.coefficients, &point, &fit.solution)
    }
}

/// A segment's table with derivatives by the edges after the others: `after` are its residuals with each of them moved.
fn with_differences(segment: &Tables, here: &Tables, after: &[&Tables]) -> Tables {
    let columns = segment.columns + after.len();
    let channels = segment.channels.iter().enumerate();
    let channels = channels.map(|(channel, table)| {
        let mut wider = Vec::with_capacity(table.len() / segment.columns * columns);
        for (row, numbers) in table.chunks_exact(segment.columns).enumerate() {
            let before = here.channels[channel][row];
            let slope = |moved: &&Tables| (before - moved.channels[channel][row]) / DIFFERENCE;
            wider.extend(numbers);
            wider.extend(after.iter().map(slope));
        }
        wider
    });
    Tables {
        channels: channels.collect(),
        columns,
    }
}

/// A proposal with its edges moved by shares of its size; `None` where it has none or would be no more.
fn moved(proposal: &Proposal, by: &DVector<f64>) -> Option<Proposal> {
    Some(Proposal {
        extent: Some(nudged(proposal.extent.as_ref()?, by)?),
        ..proposal.clone()
    })
}

fn nudged(extent: &Region, by: &DVector<f64>) -> Option<Region> {
    let by = |edge: usize| by.get(edge).copied().unwrap_or(0.0);
    match extent {
        Region::Place { disc } => {
            let radius = disc[2];
            let at = |edge: usize| disc[edge] + by(edge) * radius;
            Some(Region::Place {
                disc: [at(0), at(1), at(2)],
            })
        }
        Region::Time(at) if by(2) == 0.0 => {
            let mut at = *at;
            at.start += SECONDS * by(0);
            at.end += SECONDS * by(1);
            (at.end - at.start > SHORTEST).then_some(Region::Time(at))
        }
        Region::Time(_) | Region::Run(_) | Region::Beyond { .. } => None,
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::diagnosis::Subject;
    use crate::diagnosis::manoeuvre::rehearsal::tests::driven;
    use crate::diagnosis::screening::region::RunInterval;
    use crate::diagnosis::search::naming::ANY;
    use crate::diagnosis::search::naming::{finish, partial_fit};
    use crate::diagnosis::search::stage::Stage;
    use crate::diagnosis::search::stage::tests::refitted;
    use crate::effects::{CATALOGUE, Effects};
    use crate::recording::Recording;
    use crate::terrain::Terrain;
    use crate::vehicle::{Specification, Vehicle};

    /// A vehicle and its recording, on which it was slowed from 6.7 s to 12.15 s.
    pub fn slowed() -> (Specification, [Recording; 1]) {
        let soil = Terrain::preset("sandy_loam").unwrap();
        let nominal = Specification::plain(Vehicle::tran2007(), soil);
        let text = r#"{"drag": {"coefficient": 150}, "window": {"effects": ["drag"], "time": [6.7, 12.15]}}"#;
        let slowed = Specification {
            effects: Effects::from_json(text).unwrap(),
            ..nominal.clone()
        };
        let recording = driven(&slowed, "slalom");
        (nominal, [recording])
    }

    /// Drag from 6.9 s to 12.4 s, fitted.
    pub fn drag<'a>(stage: &Stage<'a>, by: &NoiseModel) -> FittedCandidate<'a> {
        let drag = CATALOGUE.iter().position(|e| e.name == "drag").unwrap();
        let subject = Subject::Effect(drag);
        let coefficients: Vec<usize> = stage.problem.candidates.of(subject).collect();
        let proposal = Proposal {
            subject,
            extent: Some(Region::Time(RunInterval {
                recording: 0,
                run: 0,
                start: 6.9,
                end: 12.4,
            })),
            steps: vec![(coefficients[0], DVector::repeat(1, 100.0))],
            evidence: 0.0,
            price: 7.0,
            stability: Vec::new(),
            soil: DVector::zeros(stage.problem.soil.len()),
            hidden: false,
            anew: false,
            coefficients,
        };
        let begun = partial_fit(&stage.problem, &proposal, &stage.fit, by, 1.0, ANY).unwrap();
        finish(begun, &stage.fit, by).unwrap()
    }

    #[test]
    fn edges_move_to_where_something_acts() {
        let (nominal, recordings) = slowed();
        let (stage, by) = refitted(&nominal, &recordings);
        let mut fitted = [drag(&stage, &by)];
        let before = fitted[0].gain;
        settle_edges(&mut fitted, before, &by);
        let Some(Region::Time(at)) = fitted[0].proposal.extent else {
            unreachable!()
        };
        assert!(
            (at.start - 6.7).abs() < 0.05 && (at.end - 12.15).abs() < 0.05,
            "{at:?}"
        );
        assert!(fitted[0].gain > before + 20.0);
    }

    #[test]
    fn each_edge_moves_alone() {
        let disc = Region::Place {
            disc: [1.0, 2.0, 4.0],
        };
        let by = |edge: usize| {
            let mut by = DVector::zeros(EDGES);
            by[edge] = 0.1;
            by
        };
        let moved = |edge| match nudged(&disc, &by(edge)) {
            Some(Region::Place { disc }) => disc,
            _ => unreachable!(),
        };
        assert_eq!(moved(0), [1.4, 2.0, 4.0]);
        assert_eq!(moved(1), [1.0, 2.4, 4.0]);
        assert_eq!(moved(2), [1.0, 2.0, 4.4]);
        let interval = |end| {
            Region::Time(RunInterval {
                recording: 0,
                run: 0,
                start: 1.0,
                end,
            })
        };
        assert_eq!(nudged(&interval(3.0), &by(1)), Some(interval(3.2)));
        // An interval has two ends, and stays one.
        assert_eq!(nudged(&interval(3.0), &by(2)), None);
        assert_eq!(nudged(&interval(1.2), &by(0)), None);
    }
}
