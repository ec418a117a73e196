//! What the integrator carries from step to step, and its constants.

use super::evaluation::Evaluation;
use super::memory::MemoryJacobian;
use super::state::{InputMatrix, State, StateMatrix, StateVector, WheelSpeeds};

/// d = 1 / (2 + sqrt 2) and e_32 = 6 + sqrt 2 of the method.
pub(super) const D: f64 = 0.292_893_218_813_452_5;
pub(super) const E32: f64 = 7.414_213_562_373_095;

/// Tolerated error of each state in one step: absolute part, and part of its magnitude.
pub(super) const ABSOLUTE_TOLERANCE: [f64; State::COUNT] = [2e-5, 2e-5, 1e-5, 1e-4, 1e-4, 1e-4];
pub(super) const RELATIVE_TOLERANCE: [f64; State::COUNT] = [0.0, 0.0, 0.0, 1e-4, 1e-4, 1e-4];
/// First step tried \[s\], and the longest.
pub(super) const FIRST_STEP: f64 = 1e-3;
pub(super) const LONGEST_STEP: f64 = 0.5;
/// Longest time \[s\] that one call may ask for, some days: more is a slip of the pen, and
/// would seem to hang.
pub(crate) const LONGEST_CALL: f64 = 1e6;
/// A shorter step means nothing any more \[s\], or one of less than this share of the time: it hardly moves the clock.
pub(super) const SMALLEST_STEP: f64 = 1e-12;
pub(super) const SMALLEST_SHARE: f64 = 16.0 * f64::EPSILON;
/// Steps that a second of driving pays for, rejected ones counted; as many may be owed. A call's first step is free:
/// short calls are the caller's choice. Of 300 drives drawn over vehicles of 20 to 3,000 kg, soils and effects the
/// dearest second took 1,500.
pub(super) const STEPS_PER_SECOND: f64 = 10_000.0;
/// Step control: safety factor, and limits of the change from one step to the next.
pub(super) const SAFETY: f64 = 0.85;
pub(super) const SHRINK: f64 = 0.2;
pub(super) const GROW: f64 = 4.0;
/// A Jacobian serves so many steps, as long as the error stays below this share.
pub(super) const JACOBIAN_STEPS: u32 = 12;
pub(super) const JACOBIAN_ERROR: f64 = 0.6;
/// A step of one evaluation may err by this share of the tolerance for each second of its length. Between 1 and 100 ms
/// the ends of the benchmarks' mixed minute then differ by 1 mm at most on the four soils. With 30 the velocity
/// under held wheel speeds erred by up to 2 mm/s in a transient, for a tenth fewer evaluations.
pub(super) const SHORT_ERROR_RATE: f64 = 10.0;
/// It is tried where it is expected to err by no more than this share of that, a step without any by no more than the
/// second, and asks for a new Jacobian above the third.
pub(super) const SHORT_EXPECTED: f64 = 0.7;
pub(super) const LINEAR_EXPECTED: f64 = 0.35;
pub(super) const SHORT_JACOBIAN: f64 = 0.5;
/// Wheel speed \[rad/s\] below which a step is never taken so: twice that which bounds the contact time.
pub(super) const SHORT_SLOWEST: f64 = 0.1;

/// Longest time \[s\] without an evaluation of the forces: five steps of 10 ms, rounded up.
pub(super) const LONGEST_LINEAR: f64 = 0.0501;
/// Steps go without an evaluation while the wheel speeds lie no farther from where their change between the last two
/// evaluations leads than this \[rad/s\], or this share of that change. A Jacobian that has served for a while is right
/// along the motion, not across it.
pub(super) const LINEAR_REACH: f64 = 0.3;
pub(super) const SMALLEST_REACH: f64 = 0.003;
/// Steps go without an evaluation as long as the change of the forces since the last one has moved the velocities
/// \[m/s, rad/s\] by no more than this. Of 100 random drives in steps of 1 ms (`tests/bench/campaign.rs`) 69 ended within 5 mm
/// and 2 mrad without such a bound, 80 with 1e-3, 88 with 3e-4, 94 with this, and all with it where no side turns round.
pub(super) const LINEAR_BEND: f64 = 1e-4;
/// The same of the velocities \[m/s, rad/s\] of wheels that stand: far below the slip speed at which the shear fades.
pub(super) const STANDING_REACH: f64 = 1e-9;

/// Broyden's update takes changes of the motion as those of a point of the rim \[m/s\] at some 0.25 m, 1 m off the middle,
/// and nothing from a change whose square is less than this: the rounding of a balance would be its slope.
pub(super) const BROYDEN_SCALE: [f64; 5] = [1.0, 1.0, 1.0, 0.25, 0.25];
pub(super) const BROYDEN_SMALLEST: f64 = 1e-8;

/// Steps since the last evaluation that had none.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Linear {
    /// Their length \[s\].
    pub seconds: f64,
    /// How the wheel speeds changed between the last two evaluations \[rad/s^2\].
    pub trend: WheelSpeeds,
}

/// What the integrator carries from step to step.
#[derive(Debug, Clone)]
pub(super) struct Integrator {
    /// Step size \[s\] that the error control would take next.
    pub next_step: f64,
    /// Whether steps may be taken with one evaluation: where nobody looks within them.
    pub may_be_short: bool,
    /// What a step without a middle evaluation errs by, over the square of its length \[1/s^2\].
    pub short_error: f64,
    pub linear: Linear,
    /// Of the rates by the state what the forces give; the kinematics are exact at every step.
    pub by_state: StateMatrix,
    pub by_input: InputMatrix,
    pub memory: MemoryJacobian,
    /// Steps that the Jacobian has served; `JACOBIAN_STEPS` where there is none.
    pub jacobian_age: u32,
    /// How long before the last evaluation the Jacobian is that of the forces \[s\].
    pub jacobian_lag: f64,
    pub counters: Counters,
    /// Steps that were taken beyond those that the driven time pays for ([`STEPS_PER_SECOND`]).
    pub owed: f64,
    /// Steps that a second of driving pays for.
    pub steps_per_second: f64,
    /// Steps, rejected ones among them, after which to give up.
    pub most_steps: u64,
    /// Tolerated errors, in units of the usual ones.
    pub tolerance: f64,
}

/// What the integration of a simulation has cost so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counters {
    /// Steps that met the tolerance.
    pub steps: u64,
    /// Steps that did not, and were repeated shorter.
    pub rejected: u64,
    /// Evaluations of the forces.
    pub evaluations: u64,
    /// Evaluations of the Jacobian.
    pub jacobians: u64,
}

impl Integrator {
    pub(super) fn new(memory_count: usize) -> Self {
        Self {
            next_step: FIRST_STEP,
            may_be_short: false,
            short_error: f64::MAX,
            linear: Linear::default(),
            by_state: StateMatrix::zeros(),
            by_input: InputMatrix::zeros(),
            memory: MemoryJacobian::new(memory_count),
            jacobian_age: JACOBIAN_STEPS,
            jacobian_lag: 0.0,
            counters: Counters::default(),
            owed: 0.0,
            steps_per_second: STEPS_PER_SECOND,
            most_steps: u64::MAX,
            tolerance: 1.0,
        }
    }
}

/// The evaluations within one step.
#[derive(Debug, Clone, Default)]
pub(super) struct Stages {
    pub middle: Evaluation,
    pub end: Evaluation,
    /// What is remembered in the middle and at the end.
    pub middle_memory: Vec<f64>,
    pub memory: Vec<f64>,
    /// The state at the start, and the slopes k_1 and k_2.
    pub from: StateVector,
    pub slopes: [StateVector; 2],
    /// Rates of what is remembered at the start and in the middle, and its slopes l_1, l_2 and l_3.
    pub rates: [Vec<f64>; 2],
    pub memory_slopes: [Vec<f64>; 3],
    /// Rates of the state at the end less those that are linear from the start.
    pub missing: StateVector,
}

impl Stages {
    pub(super) fn new(like: &Evaluation) -> Self {
        let memory = &like.memory_rates;
        Self {
            middle: like.clone(),
            end: like.clone(),
            middle_memory: memory.clone(),
            memory: memory.clone(),
            from: StateVector::zeros(),
            slopes: [StateVector::zeros(); 2],
            rates: std::array::from_fn(|_| memory.clone()),
            memory_slopes: std::array::from_fn(|_| memory.clone()),
            missing: StateVector::zeros(),
        }
    }

    /// The state and its slope after a share of a step of this length \[s\].
    pub(super) fn at(&self, length: f64, share: f64) -> (StateVector, StateVector) {
        let [k1, k2] = self.slopes;
        let whole = 1.0 - 2.0 * D;
        let first = share * (1.0 - share) / whole;
        let second = share * (share - 2.0 * D) / whole;
        let state = self.from + (k1 * first + k2 * second) * length;
        let slope = k1 * ((1.0 - 2.0 * share) / whole) + k2 * (2.0 * (share - D) / whole);
        (state, slope)
    }
}
