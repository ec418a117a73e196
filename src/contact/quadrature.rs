//! Quadrature rules over the contact patch.
//!
//! The stress goes to zero like (theta_1 - theta)^n at the entry and like theta^n at
//! the lowest point, with n as small as 0.13: plain Gauss–Legendre converges slowly
//! there. Nodes graded like s^2 towards the lowest point and like s^(5/2) towards the entry,
//! where the shear displacement sets in besides, turn the power n into 2 n + 1 or more,
//! smooth enough for Gauss–Legendre in s to converge in a handful of points.

use crate::parameter::{Bounds, ParameterError};
use std::sync::{Arc, LazyLock};

/// How finely the contact patch is integrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Resolution {
    /// Nodes along the contact arc.
    pub arc: usize,
    /// Nodes across the wheel's width, at most 8; half as many more where the slip velocity
    /// changes its sign inside the contact, four times as many where it does so abruptly.
    pub width: usize,
    /// Nodes in each third of an arc in which the slip velocity changes its sign.
    pub reversal: usize,
    /// The same where the shear turns round within a small part of the arc.
    pub sharp_reversal: usize,
}

impl Default for Resolution {
    fn default() -> Self {
        Self {
            arc: 16,
            width: 4,
            reversal: 10,
            sharp_reversal: 24,
        }
    }
}

/// Most nodes across a width that is split.
pub(crate) const MOST_ROWS: usize = 32;

/// Nodes are evaluated so many at a time.
pub(crate) const LANES: usize = 8;

impl Resolution {
    /// Refuses numbers of nodes that make no rule.
    pub(crate) fn validate(&self) -> Result<(), ParameterError> {
        let check =
            |name, most, count| Bounds::closed(name, "nodes", 1.0, most).check(count as f64);
        check("arc", 1024.0, self.arc)?;
        check("width", 8.0, self.width)?;
        check("reversal", 1024.0, self.reversal)?;
        // From some 700 on the last of its crowded nodes is the arc's end.
        check("sharp_reversal", 512.0, self.sharp_reversal)
    }

    /// Half the nodes in each direction.
    #[must_use]
    pub fn halved(self) -> Self {
        Self {
            arc: self.arc.div_ceil(2),
            width: self.width.div_ceil(2),
            reversal: self.reversal.div_ceil(2),
            sharp_reversal: self.sharp_reversal.div_ceil(2),
        }
    }
}

/// Eight nodes of a rule on (0, 1) and their weights.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nodes {
    pub at: [f64; LANES],
    pub weight: [f64; LANES],
    /// 1 for nodes beyond the middle, else 0.
    pub front: [f64; LANES],
}

/// Eight nodes of a rule on an arc in three parts, 0 to p, p to q and q to theta_1: shares of
/// p, q and theta_1 in their angles and in their weights.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SplitNodes {
    pub at: [[f64; LANES]; 3],
    pub weight: [[f64; LANES]; 3],
    /// 1 for nodes beyond the middle, else 0.
    pub front: [f64; LANES],
}

/// The rules that a contact evaluation uses, computed once.
#[derive(Debug, Clone)]
pub(crate) struct Quadrature {
    /// Along the arc: theta / theta_1, graded towards both ends.
    pub arc: Vec<Nodes>,
    /// Along an arc that is split besides at the angle where the slip velocity changes its
    /// sign: below the middle of the arc, and above it.
    pub turning: [Vec<SplitNodes>; 2],
    /// The same where the shear turns round within a small part of the arc.
    pub sharp: [Vec<SplitNodes>; 2],
    /// On (0, 1), for the parts of an arc behind and ahead of the greatest stress where effects move
    /// it: graded as in `arc`.
    pub rear: Vec<Nodes>,
    pub front: Vec<Nodes>,
    /// On (0, 1) with nodes that crowd at both ends, for each piece of an arc that effects alter.
    pub piece: Vec<Nodes>,
    /// On (0, 1), for each side of a line that splits the width.
    pub width_split: Vec<(f64, f64)>,
    /// Across the width: offset y / b in (-1/2, 1/2) and weight.
    pub width: Vec<(f64, f64)>,
    /// The same with half as many more, for a wheel in which the slip velocity changes its sign.
    pub width_reversed: Vec<(f64, f64)>,
}

impl Quadrature {
    /// The rules of a resolution; those of the default one and of half its nodes are kept.
    pub(crate) fn shared(resolution: Resolution) -> Arc<Self> {
        static KEPT: LazyLock<[(Resolution, Arc<Quadrature>); 2]> = LazyLock::new(|| {
            let full = Resolution::default();
            [full, full.halved()].map(|kept| (kept, Arc::new(Quadrature::new(kept))))
        });
        match KEPT.iter().find(|(kept, _)| *kept == resolution) {
            Some((_, rules)) => Arc::clone(rules),
            None => Arc::new(Self::new(resolution)),
        }
    }

    pub(crate) fn new(resolution: Resolution) -> Self {
        // 2 theta / theta_1 = s^2 in the rear half; its mirror image s^(5/2) in the front half.
        let half = || gauss_legendre(resolution.arc.div_ceil(2)).into_iter();
        let arc = half().flat_map(|(s, w)| {
            let root = s.sqrt();
            let rear = (0.5 * s * s, w * s);
            let front = (1.0 - 0.5 * s * s * root, w * 1.25 * s * root);
            [rear, front]
        });
        let arc = packed(arc.collect());
        let rear = half().map(|(s, w)| (s * s, 2.0 * w * s));
        let front = half().map(|(s, w)| {
            let root = s.sqrt();
            (1.0 - s * s * root, w * 2.5 * s * root)
        });
        let across = |count| -> Vec<(f64, f64)> {
            let rule = gauss_legendre(count).into_iter();
            rule.map(|(x, w)| (x - 0.5, w)).collect()
        };
        Self {
            arc,
            turning: [false, true].map(|late| reversed(resolution.reversal, late, false)),
            sharp: [false, true].map(|late| reversed(resolution.sharp_reversal, late, true)),
            rear: packed(rear.collect()),
            front: packed(front.collect()),
            piece: packed(
                gauss_legendre(resolution.sharp_reversal)
                    .into_iter()
                    .map(crowded)
                    .collect(),
            ),
            width_split: gauss_legendre(2 * resolution.width),
            width: across(resolution.width),
            width_reversed: across((3 * resolution.width).div_ceil(2)),
        }
    }
}

/// The rule of an arc with a sign change, with `count` nodes in each part. The parts meet at
/// the middle and at the sign change, which comes second where it is `late`. Where the turn is
/// `sharp`, the nodes crowd at both ends of each part (like s^3); else they are graded like s^2
/// towards theta = 0, towards theta_1, and in the second part towards the sign change.
fn reversed(count: usize, late: bool, sharp: bool) -> Vec<SplitNodes> {
    let mut nodes = Vec::new();
    for part in 0..3 {
        let front = part == 2 || (part == 1 && late);
        let to_its_end = front;
        for (s, w) in gauss_legendre(count) {
            let (at, weight) = if sharp {
                crowded((s, w))
            } else if to_its_end {
                (s * (2.0 - s), w * 2.0 * (1.0 - s))
            } else {
                (s * s, w * 2.0 * s)
            };
            let (mut shares, mut weights) = ([0.0; 3], [0.0; 3]);
            (shares[part], weights[part]) = (at, weight);
            if part > 0 {
                (shares[part - 1], weights[part - 1]) = (1.0 - at, -weight);
            }
            nodes.push((shares, weights, f64::from(u8::from(front))));
        }
    }
    nodes.resize(
        nodes.len().next_multiple_of(LANES),
        ([0.0, 0.0, 0.9], [0.0; 3], 1.0),
    );
    let eight = |chunk: &[([f64; 3], [f64; 3], f64)]| SplitNodes {
        at: [0, 1, 2].map(|end| std::array::from_fn(|k| chunk[k].0[end])),
        weight: [0, 1, 2].map(|end| std::array::from_fn(|k| chunk[k].1[end])),
        front: std::array::from_fn(|k| chunk[k].2),
    };
    nodes.chunks_exact(LANES).map(eight).collect()
}

/// A node and its weight, moved so that they crowd at both ends (like s^3).
fn crowded((s, w): (f64, f64)) -> (f64, f64) {
    let rest = 1.0 - s;
    let at = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    (at, w * 30.0 * s * s * rest * rest)
}

/// Packs nodes eight at a time; what is missing to the last eight has no weight.
fn packed(mut nodes: Vec<(f64, f64)>) -> Vec<Nodes> {
    nodes.resize(nodes.len().next_multiple_of(LANES), (0.5, 0.0));
    let eight = |chunk: &[(f64, f64)]| Nodes {
        at: std::array::from_fn(|k| chunk[k].0),
        weight: std::array::from_fn(|k| chunk[k].1),
        front: std::array::from_fn(|k| f64::from(u8::from(chunk[k].0 > 0.5))),
    };
    nodes.chunks_exact(LANES).map(eight).collect()
}

/// Nodes and weights of the `count`-point Gauss–Legendre rule on (0, 1), by Newton's
/// method on the Legendre polynomial from Tricomi's first guess.
fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let node = |index: usize| {
        let mut x = (std::f64::consts::PI * (index as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 0.0;
        // Converges quadratically from about 1e-3; four steps reach the last digit.
        for _ in 0..6 {
            let (mut previous, mut current) = (1.0, x);
            for degree in 2..=count {
                let d = degree as f64;
                let next = ((2.0 * d - 1.0) * x * current - (d - 1.0) * previous) / d;
                (previous, current) = (current, next);
            }
            slope = n * (x * current - previous) / (x * x - 1.0);
            x -= current / slope;
        }
        ((1.0 - x) / 2.0, 1.0 / ((1.0 - x * x) * slope * slope))
    };
    match count {
        1 => vec![(0.5, 1.0)],
        _ => (0..count).map(node).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of some ten products of order 1.
    const ROUNDING: f64 = 1e-14;

    #[test]
    fn gauss_legendre_integrates_polynomials_of_degree_2n_minus_1() {
        for count in 1..=16 {
            let rule = gauss_legendre(count);
            for power in 0..2 * count {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(power as i32)).sum();
                let exact = 1.0 / (power as f64 + 1.0);
                assert!((sum - exact).abs() < ROUNDING, "{count} nodes, x^{power}");
            }
        }
    }

    #[test]
    fn arc_resolves_the_weakest_singularity_of_the_terrains() {
        // Dry clay has n = 0.13; plain Gauss-Legendre with 16 nodes errs by 1e-3 here.
        let rule = Quadrature::new(Resolution::default());
        for end in [|x: f64| x, |x: f64| 1.0 - x] {
            let sum: f64 = rule
                .arc
                .iter()
                .flat_map(|nodes| nodes.at.into_iter().zip(nodes.weight))
                .map(|(x, w)| w * end(x).powf(0.13))
                .sum();
            assert!((sum - 1.0 / 1.13).abs() < 1e-5, "{sum}");
        }
    }

    #[test]
    fn split_arcs_integrate_polynomials_over_the_whole_arc() {
        // Ends p, q and theta_1: the parts add up to the integral from 0 to theta_1; five nodes
        // are exact up to degree 9 in s, that is x^4 with x = s^2.
        let (p, q, entry) = (0.21, 0.3, 0.6);
        for late in [false, true] {
            for power in 0..5 {
                let sum: f64 = reversed(5, late, false)
                    .iter()
                    .flat_map(|nodes| {
                        (0..LANES).map(|k| {
                            let mix =
                                |t: [[f64; LANES]; 3]| p * t[0][k] + q * t[1][k] + entry * t[2][k];
                            mix(nodes.weight) * mix(nodes.at).powi(power)
                        })
                    })
                    .sum();
                let exact = entry.powi(power + 1) / f64::from(power + 1);
                assert!((sum - exact).abs() < ROUNDING, "{late}, x^{power}");
            }
        }
    }
}
