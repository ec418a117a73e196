//! Separation of two hypotheses by a future recording.
//!
//! It would be diagnosed with those at hand, so that the normal equations add up, H = H_at_hand + H_to_come. The soil
//! and effects that act everywhere are shared; a slope or a sensor fault is separate for each recording. If a is
//! true, the signal J_a d_a is in the data; b and the soil, X together, are refitted to imitate it, and the remainder
//! is
//!
//! ```text
//! d^2 = min_x |S^1/2 (J_a d_a - J_X x)|^2 + x^T P x
//!     = d_a^T (H_aa - H_aX (H_XX + P)^-1 H_Xa) d_a
//! ```
//!
//! with the noise's inverse covariance S and the priors' precision P; the starts are eliminated beforehand. d is the
//! expected separation in standard deviations, the root of the likelihood ratio's noncentrality. It is the criterion
//! of T-optimal design (A. C. Atkinson & V. V. Fedorov, "The design of experiments for discriminating between two
//! rival models", Biometrika 62 (1975), 57–70), linearised around the refitted model, with priors. As in the screen,
//! d^2 is divided by the segments' overdispersion phi. d_a is the estimate. If b is "nothing", X is the soil alone.

use super::rehearsal::{AtHand, Rehearsed};
use crate::diagnosis::screening::system::System;
use nalgebra::{DMatrix, DVector};

/// An unknown of the recordings at hand and of the one to come.
#[derive(Debug, Clone, Copy)]
struct Unknown {
    at_hand: Option<usize>,
    to_come: Option<usize>,
    /// Precision of its prior.
    precision: f64,
    /// Its size, if it belongs to the signal.
    size: f64,
}

/// A signal in the data, and the coefficients that could imitate it besides the soil.
#[derive(Debug, Clone)]
pub struct Contrast {
    /// Coefficients with their sizes for each recording at hand, then for the one to come.
    pub coefficients: Vec<(usize, Vec<f64>)>,
    /// Coefficients that could imitate it.
    pub rivals: Vec<usize>,
    /// Whether the recordings at hand contain information about the coefficients.
    pub seen_at_hand: bool,
    /// Overdispersion of the segments.
    pub scatter: f64,
}

impl Contrast {
    /// Its separation by a manoeuvre's recording and those at hand. `None` if numbers are not finite.
    #[must_use]
    pub fn separation(&self, at_hand: &AtHand, rehearsed: &Rehearsed, one: usize) -> Option<f64> {
        let to_come = &rehearsed.system;
        let mut unknowns: Vec<Unknown> = at_hand
            .system
            .soil()
            .map(|soil| Unknown {
                at_hand: Some(soil),
                to_come: Some(soil),
                precision: at_hand.system.precision[soil],
                size: 0.0,
            })
            .collect();
        let none = vec![0.0; at_hand.problem.recordings.len() + 1];
        for coefficient in &self.rivals {
            unknowns.extend(self.unknowns(at_hand, to_come, one, *coefficient, &none));
        }
        let imitators = unknowns.len();
        for (coefficient, sizes) in &self.coefficients {
            unknowns.extend(self.unknowns(at_hand, to_come, one, *coefficient, sizes));
        }
        let mut matrix = sum(at_hand.system, &unknowns, |u| u.at_hand, None);
        matrix += sum(to_come, &unknowns, |u| u.to_come, Some(one));
        let signals = unknowns.len() - imitators;
        let mut own = matrix.view((0, 0), (imitators, imitators)).into_owned();
        for (k, unknown) in unknowns[..imitators].iter().enumerate() {
            own[(k, k)] += unknown.precision;
        }
        let cross = matrix
            .view((0, imitators), (imitators, signals))
            .into_owned();
        let raw = matrix.view((imitators, imitators), (signals, signals));
        let remainder = raw - cross.tr_mul(&own.cholesky()?.solve(&cross));
        let sizes = unknowns[imitators..].iter().map(|unknown| unknown.size);
        let size = DVector::from_iterator(signals, sizes);
        let square = size.dot(&(remainder * &size)) / self.scatter;
        square.is_finite().then(|| square.max(0.0).sqrt())
    }

    /// The unknowns of a coefficient: one, or one for each recording with information.
    fn unknowns(
        &self,
        at_hand: &AtHand,
        to_come: &System,
        one: usize,
        coefficient: usize,
        sizes: &[f64],
    ) -> Vec<Unknown> {
        let about = &at_hand.problem.candidates[coefficient];
        let column = at_hand.system.layout.soil + coefficient;
        let unknown = |at_hand, to_come, size| Unknown {
            at_hand,
            to_come,
            precision: about.parameter.prior.deviation.powi(-2),
            size,
        };
        let next = to_come.places[one][column];
        let size = sizes[sizes.len() - 1];
        let places = at_hand.system.places.iter().map(|places| places[column]);
        if !about.own {
            let same = places.flatten().next().filter(|_| self.seen_at_hand);
            return vec![unknown(same, next, size)];
        }
        let known = places
            .zip(sizes)
            .filter(|(place, _)| self.seen_at_hand && place.is_some());
        let mut all: Vec<Unknown> = known
            .map(|(place, size)| unknown(place, None, *size))
            .collect();
        all.extend(next.map(|next| unknown(None, Some(next), size)));
        all
    }
}

/// A system's equations in these unknowns, of one recording or all; zero for those it lacks.
fn sum(
    system: &System,
    unknowns: &[Unknown],
    place: impl Fn(&Unknown) -> Option<usize>,
    recording: Option<usize>,
) -> DMatrix<f64> {
    let here: Vec<(usize, usize)> = unknowns
        .iter()
        .enumerate()
        .filter_map(|(k, unknown)| Some((k, place(unknown)?)))
        .collect();
    let own: Vec<usize> = here.iter().map(|(_, place)| *place).collect();
    let segments = system.segments.iter();
    let chosen = segments.filter(|s| recording.is_none_or(|recording| s.recording == recording));
    let (part, _) = system.sum(&own, chosen);
    let mut matrix = DMatrix::zeros(unknowns.len(), unknowns.len());
    for (i, (row, _)) in here.iter().enumerate() {
        for (j, (column, _)) in here.iter().enumerate() {
            matrix[(*row, *column)] = part[(i, j)];
        }
    }
    matrix
}
