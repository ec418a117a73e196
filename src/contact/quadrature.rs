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
    /// Nodes across the wheel's width, at most 8: half of them where the slip velocity hardly changes
    /// across it, half as many more where it changes its sign inside the contact, four times as many where it does so
    /// abruptly.
    pub width: usize,
    /// Nodes in each piece of an arc in which the shear turns round within a small part of it.
    pub sharp_reversal: usize,
}

impl Default for Resolution {
    fn default() -> Self {
        Self {
            arc: 16,
            width: 4,
            sharp_reversal: 16,
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
        // From some 700 on the last of its crowded nodes is the arc's end.
        check("sharp_reversal", 512.0, self.sharp_reversal)
    }

    /// Half the nodes in each direction.
    #[must_use]
    pub fn halved(self) -> Self {
        Self {
            arc: self.arc.div_ceil(2),
            width: self.width.div_ceil(2),
            sharp_reversal: self.sharp_reversal.div_ceil(2),
        }
    }
}

/// Eight nodes of a rule on (0, 1) and their weights.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nodes {
    pub at: [f64; LANES],
    pub weight: [f64; LANES],
}

/// The rules that a contact evaluation uses, computed once.
#[derive(Debug, Clone)]
pub(crate) struct Quadrature {
    /// On (0, 1), for the parts of an arc behind and ahead of the greatest stress: graded towards the lowest point, and
    /// towards the entry.
    pub rear: Vec<Nodes>,
    pub front: Vec<Nodes>,
    /// On (0, 1) with nodes that crowd at both ends, for each piece of an arc that is split at the angle where the shear
    /// turns round within a small part of it.
    pub sharp: Vec<Nodes>,
    /// Across the width, offset y / b in (-1/2, 1/2) and weight: the fewer, the less the slip velocity changes across it.
    pub even: Vec<(f64, f64)>,
    pub uneven: Vec<(f64, f64)>,
    /// For a wheel in which the slip velocity changes its sign.
    pub reversed: Vec<(f64, f64)>,
    /// On (0, 1), for each side of a line that splits the width.
    pub split: Vec<(f64, f64)>,
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
        let rule = |count: usize, moved: fn((f64, f64)) -> (f64, f64)| {
            packed(gauss_legendre(count).into_iter().map(moved).collect())
        };
        let half = resolution.arc.div_ceil(2);
        let across = |count: usize| -> Vec<(f64, f64)> {
            let rule = gauss_legendre(count).into_iter();
            rule.map(|(x, w)| (x - 0.5, w)).collect()
        };
        let width = resolution.width;
        Self {
            rear: rule(half, |(s, w)| (s * s, 2.0 * w * s)),
            front: rule(half, |(s, w)| {
                let root = s.sqrt();
                (1.0 - s * s * root, w * 2.5 * s * root)
            }),
            sharp: rule(resolution.sharp_reversal, crowded),
            // One node sees no twist at all.
            even: across(width.div_ceil(2).max(2)),
            uneven: across(width),
            reversed: across((3 * width).div_ceil(2)),
            split: gauss_legendre(2 * width),
        }
    }

    /// 2 int (1 - u^2)^n du from 1/2 to 1: the stress (3) over a flat arc, front and rear.
    pub(crate) fn flat_arc(&self, exponent: f64) -> f64 {
        let nodes = self
            .front
            .iter()
            .flat_map(|nodes| nodes.at.into_iter().zip(nodes.weight));
        nodes
            .map(|(at, weight)| weight * (1.0 - (0.5 + 0.5 * at).powi(2)).powf(exponent))
            .sum()
    }
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

    fn integral(rule: &[Nodes], f: impl Fn(f64) -> f64) -> f64 {
        let nodes = rule
            .iter()
            .flat_map(|nodes| nodes.at.into_iter().zip(nodes.weight));
        nodes.map(|(x, w)| w * f(x)).sum()
    }

    #[test]
    fn graded_rules_resolve_the_weakest_singularity_of_the_terrains() {
        // Dry clay has n = 0.13; plain Gauss-Legendre with 16 nodes errs by 1e-3 here.
        let rules = Quadrature::new(Resolution::default());
        let near = |sum: f64, error: f64| assert!((sum - 1.0 / 1.13).abs() < error, "{sum}");
        near(integral(&rules.rear, |x| x.powf(0.13)), 2e-5);
        near(integral(&rules.front, |x| (1.0 - x).powf(0.13)), 2e-5);
        near(integral(&rules.sharp, |x| x.powf(0.13)), 5e-5);
        near(integral(&rules.sharp, |x| (1.0 - x).powf(0.13)), 5e-5);
    }

    #[test]
    fn every_rule_integrates_a_line() {
        let rules = Quadrature::new(Resolution::default());
        for rule in [&rules.rear, &rules.sharp] {
            assert!((integral(rule, |x| 2.0 * x) - 1.0).abs() < ROUNDING);
        }
        // Its nodes are no polynomial of Gauss's.
        assert!((integral(&rules.front, |x| 2.0 * x) - 1.0).abs() < 1e-5);
        for rule in [&rules.even, &rules.uneven, &rules.reversed] {
            let sum: f64 = rule.iter().map(|(x, w)| w * (1.0 + x)).sum();
            assert!((sum - 1.0).abs() < ROUNDING);
        }
    }
}
