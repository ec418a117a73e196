//! The way that kinematics make of a window's wheel speeds.

use crate::recording::Drive;

/// Longest step of the integrals \[s\].
const STEP: f64 = 0.02;

/// Integrals of wheel speeds over a window: everything that kinematic models need of it.
#[derive(Debug, Clone)]
pub(super) struct Rolled {
    /// Per step: mean wheel angle rolled in it \[rad\], and the twist in its middle, which is
    /// the angle by which the right wheels have turned further than the left ones \[rad\].
    steps: Vec<(f64, f64)>,
    /// Twist at the end \[rad\].
    pub twist: f64,
}

/// Integrals of the rolled angle along a heading, and their derivatives by the twist's gain.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Way {
    /// Of the cosine and the sine \[rad\].
    pub value: [f64; 2],
    /// Derivatives.
    pub by_gain: [f64; 2],
}

impl Rolled {
    pub fn new(wheels: &Drive) -> Self {
        let mut steps = Vec::new();
        let mut twist = 0.0;
        for row in 0..wheels.len().saturating_sub(1) {
            let seconds = wheels.time[row + 1] - wheels.time[row];
            let (from, rates) = (wheels.wheel_speeds(row), wheels.wheel_accelerations(row));
            let count = (seconds / STEP).ceil().max(1.0);
            let step = seconds / count;
            for k in 0..count as usize {
                let middle = (k as f64 + 0.5) * step;
                let [left, right] = [0, 1].map(|side| from[side] + rates[side] * middle);
                let change = (right - left) * step;
                steps.push((0.5 * (left + right) * step, twist + 0.5 * change));
                twist += change;
            }
        }
        Self { steps, twist }
    }

    /// The way when the heading changes by `gain` times the twist.
    pub fn way(&self, gain: f64) -> Way {
        self.steps
            .iter()
            .fold(Way::default(), |mut way, (rolled, twist)| {
                let (sin, cos) = (gain * twist).sin_cos();
                way.value[0] += rolled * cos;
                way.value[1] += rolled * sin;
                way.by_gain[0] -= rolled * twist * sin;
                way.by_gain[1] += rolled * twist * cos;
                way
            })
    }
}
