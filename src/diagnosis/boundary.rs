//! Where the boundary of a change of terrain lies.
//!
//! The box scan places it to half a second of driving and 15 degrees, and knows no width. Here the
//! line moves across, turns and widens until the fit is best: one of the three at a time, to either
//! side, then to the vertex of the parabola through the three, with smaller and smaller steps.

use super::hypothesis::{Given, Solution};
use super::likelihood::{SKETCH, Tuned, tune_until};
use super::locate::Extent;
use super::naming::placed;
use super::proposal::Proposal;
use crate::fit::problem::Weighing;

/// First steps: across \[m\], turning \[rad\], and the logarithm of the width.
const STEPS: [f64; 3] = [0.8, 0.2, 0.7];
/// How often all are tried, each time with half the steps.
const ROUNDS: usize = 3;
/// The vertex of a parabola counts within so many steps.
const REACH: f64 = 2.0;

/// A line by how far it has moved across and turned about the point of it that is next to the middle
/// of the drive.
#[derive(Debug, Clone, Copy)]
struct Line {
    direction: f64,
    position: f64,
    transition: f64,
    middle: [f64; 2],
}

impl Line {
    fn moved(&self, [across, turned, widened]: [f64; 3]) -> Extent {
        let (sin, cos) = self.direction.sin_cos();
        let off = self.position - (self.middle[0] * cos + self.middle[1] * sin);
        let about = [self.middle[0] + off * cos, self.middle[1] + off * sin];
        let direction = self.direction + turned;
        Extent::Beyond {
            direction,
            position: about[0] * direction.cos() + about[1] * direction.sin() + across,
            transition: self.transition * widened.exp(),
        }
    }
}

/// The middle of the drive, by where its segments start.
fn middle(at: &Solution) -> [f64; 2] {
    let count = at.starts.len().max(1) as f64;
    [0, 1].map(|axis| at.starts.iter().map(|start| start[axis]).sum::<f64>() / count)
}

/// Moves the boundary of a proposal that has one to where the fit is best.
#[must_use]
pub fn settle<'a>(
    proposal: Proposal,
    given: Given<'a>,
    tuned: Tuned,
    by: &Weighing,
) -> (Proposal, Given<'a>, Tuned) {
    let Some(Extent::Beyond {
        direction,
        position,
        transition,
    }) = proposal.extent
    else {
        return (proposal, given, tuned);
    };
    let line = Line {
        direction,
        position,
        transition,
        middle: middle(&tuned.solution),
    };
    let fit = |at: [f64; 3], from: &Tuned| {
        let moved = Proposal {
            extent: Some(line.moved(at)),
            ..proposal.clone()
        };
        let given = placed(&given, &moved)?;
        let tuned = tune_until(&given, &from.knobs, &from.solution, by, SKETCH).ok()?;
        let finite = tuned.surprise.is_finite();
        finite.then_some((moved, given, tuned))
    };
    let mut place = [0.0; 3];
    let mut best = (proposal.clone(), given.clone(), tuned);
    for round in 0..ROUNDS {
        for axis in 0..STEPS.len() {
            let step = STEPS[axis] * 0.5_f64.powi(round as i32);
            let (origin, level) = (place, best.2.surprise);
            let mut offer = |away: f64| {
                let mut there = origin;
                there[axis] += away;
                let found = fit(there, &best.2)?;
                let surprise = found.2.surprise;
                if surprise < best.2.surprise {
                    (place, best) = (there, found);
                }
                Some(surprise - level)
            };
            let Some((ahead, back)) = offer(step).zip(offer(-step)) else {
                continue;
            };
            if ahead + back > 0.0 {
                let vertex = 0.5 * step * (back - ahead) / (ahead + back);
                offer(vertex.clamp(-REACH * step, REACH * step));
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_turns_about_its_point_next_to_the_middle() {
        // North of y = 2, the drive around (3, 1): the point is (3, 2).
        let line = Line {
            direction: std::f64::consts::FRAC_PI_2,
            position: 2.0,
            transition: 0.5,
            middle: [3.0, 1.0],
        };
        for [across, turned] in [[0.0, 0.0], [0.5, 0.0], [0.0, 0.3], [-0.2, -0.4]] {
            let Extent::Beyond {
                direction,
                position,
                transition,
            } = line.moved([across, turned, 0.0])
            else {
                panic!("not a line");
            };
            let at_point = 3.0 * direction.cos() + 2.0 * direction.sin();
            assert!((position - at_point - across).abs() < 1e-12 && transition == 0.5);
            assert!((direction - std::f64::consts::FRAC_PI_2 - turned).abs() < 1e-12);
        }
    }
}
