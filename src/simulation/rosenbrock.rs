//! Time integration: the Rosenbrock (2,3) pair of Shampine & Reichelt, "The MATLAB ODE
//! suite", SIAM J. Sci. Comput. 18 (1997), there called ode23s.
//!
//! L-stable, so that the forces near standstill (which grow like 1/omega) do not limit the
//! step; of order 2 with any matrix in place of the Jacobian, so that one Jacobian serves
//! several steps; and its last stage is the next step's first, so that a step costs two
//! evaluations of the forces. Where the step is so short that the forces are linear over it, its middle stage is taken
//! from the Jacobian, and the evaluation at the end checks it. Where they are linear over several such steps, the last
//! of them checks all.

use super::evaluation::Evaluation;
use super::integrator::{
    ABSOLUTE_TOLERANCE, BROYDEN_SCALE, BROYDEN_SMALLEST, Counters, D, E32, GROW, Integrator,
    JACOBIAN_ERROR, JACOBIAN_STEPS, LINEAR_BEND, LINEAR_EXPECTED, LINEAR_REACH, LONGEST_CALL,
    LONGEST_LINEAR, LONGEST_STEP, Linear, RELATIVE_TOLERANCE, SAFETY, SHORT_ERROR_RATE,
    SHORT_EXPECTED, SHORT_JACOBIAN, SHORT_SLOWEST, SHRINK, SMALLEST_REACH, SMALLEST_SHARE,
    SMALLEST_STEP, STANDING_REACH, Stages,
};
use super::memory::{StageSystem, worst_error};
use super::state::{State, StateVector, WheelSpeeds};
use super::{Simulation, SimulationError};
use crate::vehicle::{Motion, Wrench};

impl Simulation {
    /// What the integration has cost so far.
    #[must_use]
    pub fn counters(&self) -> Counters {
        self.integrator.counters
    }

    /// Gives up with [`SimulationError::StepBudget`] once more steps than this are done from the start,
    /// rejected ones counted: for a search among models of which some are hardly drivable.
    pub fn limit_steps(&mut self, most: u64) {
        self.integrator.most_steps = most;
    }

    /// Gives up with [`SimulationError::TooStiff`] once a second of driving takes more steps than this, rejected ones
    /// counted: 10,000 unless it is set.
    pub fn limit_work(&mut self, steps_per_second: f64) {
        self.integrator.steps_per_second = steps_per_second;
    }

    /// Tolerates errors in a step that are so many times the usual ones (some hundredths of a millimetre): for fits to
    /// sensors whose noise is a hundred times that.
    #[cfg(feature = "analysis")]
    pub(crate) fn tolerate(&mut self, times: f64) {
        self.integrator.tolerance = times;
    }

    /// Drives on for `seconds`, the wheel speeds changing linearly at their rates.
    ///
    /// Within the step the integrator takes as many steps of its own as the accuracy needs.
    ///
    /// # Errors
    /// A step that is negative, not finite or longer than 1e6 s, forces that do not exist (a bogged vehicle), or a motion
    /// that takes more than 10,000 steps for each second of driving ([`SimulationError::TooStiff`]). Then the simulation stands at the last point that it reached.
    pub fn step(&mut self, seconds: f64) -> Result<(), SimulationError> {
        self.integrator.may_be_short = true;
        let outcome = self.step_with(seconds, |_, _| Ok(()));
        self.integrator.may_be_short = false;
        outcome
    }

    /// As [`Simulation::step`], with a visit after each step that the integrator takes, of the
    /// simulation and the step's length \[s\], and another of no length behind each event.
    pub(super) fn step_with(
        &mut self,
        seconds: f64,
        mut visit: impl FnMut(&mut Self, f64) -> Result<(), SimulationError>,
    ) -> Result<(), SimulationError> {
        if !(0.0..=LONGEST_CALL).contains(&seconds) {
            return Err(SimulationError::StepSize(seconds));
        }
        let (start, speeds) = (self.time, self.inputs);
        let mut done = 0.0;
        // Of the first step.
        self.integrator.owed -= 1.0;
        while done < seconds {
            self.integrator.owed += 1.0;
            if self.integrator.owed > self.integrator.steps_per_second {
                // The next call starts afresh.
                self.integrator.owed = 0.0;
                return Err(SimulationError::TooStiff {
                    time: self.time,
                    suspect: self.model.most_unusual(),
                });
            }
            if self.integrator.counters.steps > self.integrator.most_steps {
                return Err(SimulationError::StepBudget { time: self.time });
            }
            let due = self.model.next_event(self.time);
            let event = due.filter(|event| *event <= start + seconds);
            let due = event.map_or(seconds, |event| (event - start).clamp(done, seconds));
            let within = |knot: &f64| (done..due).contains(&(knot - start)) && knot - start > done;
            let knot = self.model.next_knot(self.time).filter(within);
            let goal = knot.map_or(due, |knot| knot - start);
            let rest = goal - done;
            let wanted = self.integrator.next_step.min(self.longest_step());
            // Rather two even steps than a long one and a stub.
            let step = if rest <= wanted * 1.05 {
                rest
            } else if rest < 2.0 * wanted {
                0.5 * rest
            } else {
                wanted
            };
            let last = step == rest;
            let reached = if last { goal } else { done + step };
            let end_speeds = speeds.after(self.input_rates, reached);
            let passed = event.filter(|_| last && knot.is_none());
            // Up to the event holds what held before it; a knot is met as it is given, so that none is met twice.
            let end_time = match (passed, knot.filter(|_| last)) {
                (Some(event), _) => event.next_down(),
                (None, Some(knot)) => knot,
                (None, None) => start + reached,
            };
            if self.try_step(step, end_speeds, end_time)? {
                done = reached;
                let integrator = &mut self.integrator;
                integrator.owed = (integrator.owed - step * integrator.steps_per_second).max(0.0);
                self.time = end_time;
                self.inputs = end_speeds;
                visit(self, step)?;
                self.leave_tracks();
                if let Some(event) = passed {
                    self.pass(event)?;
                    visit(self, 0.0)?;
                }
            }
        }
        Ok(())
    }

    /// The longest step \[s\] that steps over nothing that lies in the way, whose evaluations are half a step apart.
    fn longest_step(&self) -> f64 {
        let speed = self.state.v_x.hypot(self.state.v_y);
        let grain = self.model.min_feature_length();
        grain.map_or(f64::INFINITY, |grain| grain / speed)
    }

    /// Goes on behind an event, where other effects are on.
    fn pass(&mut self, event: f64) -> Result<(), SimulationError> {
        self.time = event;
        self.leave();
        self.integrator.jacobian_age = JACOBIAN_STEPS;
        self.evaluate()
    }

    /// Takes one step if its error is tolerable, and chooses the next step's size.
    fn try_step(
        &mut self,
        step: f64,
        end_speeds: WheelSpeeds,
        end_time: f64,
    ) -> Result<bool, SimulationError> {
        let rolls = self.rolls(end_speeds);
        if self.may_be_short(step)
            && (self.try_linear(step, end_speeds, rolls)
                || rolls && self.try_short(step, end_speeds, end_time))
        {
            return Ok(true);
        }
        self.evaluate()?;
        self.integrator.linear.seconds = 0.0;
        self.refresh_jacobian();
        let attempt = self.attempt(step, end_speeds, end_time, false);
        let error = match attempt {
            Ok((_, error, _)) if error.is_finite() => error,
            _ => f64::INFINITY,
        };
        if let Ok((_, _, nonlinear)) = attempt {
            self.integrator.short_error = expected(nonlinear, step);
        }
        let integrator = &mut self.integrator;
        let factor = (SAFETY * error.powf(-1.0 / 3.0)).clamp(SHRINK, GROW);
        if let (Ok((state, ..)), true) = (&attempt, error <= 1.0) {
            integrator.counters.steps += 1;
            integrator.jacobian_age += 1;
            if error > JACOBIAN_ERROR {
                integrator.jacobian_age = JACOBIAN_STEPS;
            }
            // A step cut short by the caller is no argument against longer ones.
            let proposed = (step * factor).min(LONGEST_STEP);
            integrator.next_step = if step < integrator.next_step {
                proposed.max(integrator.next_step)
            } else {
                proposed
            };
            let state = *state;
            self.integrator.jacobian_lag += step;
            self.accept(state, self.now.motion, step);
            return Ok(true);
        }
        integrator.counters.rejected += 1;
        if integrator.jacobian_age > 0 {
            // The Jacobian may be what was wrong.
            integrator.jacobian_age = JACOBIAN_STEPS;
        }
        integrator.next_step = step * factor.min(0.7);
        let done = integrator.counters.steps + integrator.counters.rejected;
        let smallest = SMALLEST_STEP.max(SMALLEST_SHARE * self.time.abs());
        if integrator.next_step < smallest {
            let too_small = SimulationError::StepTooSmall {
                time: self.time,
                suspect: self.model.most_unusual(),
            };
            return Err(attempt.err().unwrap_or(too_small));
        }
        if done > integrator.most_steps {
            let spent = SimulationError::StepBudget { time: self.time };
            return Err(attempt.err().unwrap_or(spent));
        }
        Ok(false)
    }

    /// Goes on from the end of steps since the forces were evaluated so many seconds ago, in another motion.
    fn accept(&mut self, state: State, from: Motion, elapsed: f64) {
        let [from, to] = [&from, &self.work.stages.end.motion].map(WheelSpeeds::of);
        self.integrator.linear = Linear {
            seconds: 0.0,
            trend: WheelSpeeds {
                left: (to.left - from.left) / elapsed,
                right: (to.right - from.right) / elapsed,
            },
        };
        self.state = state;
        self.memory.copy_from_slice(&self.work.stages.memory);
        self.now.copy_from(&self.work.stages.end);
        self.anchor.copy_from(&self.now);
    }

    /// Whether the wheels roll on in a step: next to standstill the forces turn round within it.
    fn rolls(&self, end_speeds: WheelSpeeds) -> bool {
        let slowest = end_speeds.left.abs().min(end_speeds.right.abs());
        slowest > SHORT_SLOWEST
            && self.inputs.left * end_speeds.left > 0.0
            && self.inputs.right * end_speeds.right > 0.0
    }

    /// Whether the forces may be linear over a step: nobody looks within it, and the last step's end and Jacobian hold.
    fn may_be_short(&self, step: f64) -> bool {
        let integrator = &self.integrator;
        let elapsed = integrator.linear.seconds + step;
        integrator.may_be_short
            && integrator.short_error * elapsed * elapsed < SHORT_EXPECTED * allowed(elapsed)
            && self.anchor.valid
            && integrator.jacobian_age < JACOBIAN_STEPS
    }

    /// Takes a step without any evaluation, if the forces are linear over this and the next.
    ///
    /// # Algorithm
    /// 1. Nothing acts that is not in the Jacobian: what is remembered, what changes in time or lies in the way.
    /// 2. The wheel speeds go on as between the last two evaluations, or stand; and by what the last evaluation found, the
    ///    forces are linear for so long.
    /// 3. The step of [`Simulation::attempt`] with f_0 and f_1 from the Jacobian, from the last evaluation on.
    /// 4. It is left where a side of the vehicle turns round, or the forces' change since that evaluation has moved the
    ///    velocities by more than their tolerance: a kink of the forces may lie within.
    ///
    /// A later step's evaluation finds what the forces missed since, and puts it right.
    fn try_linear(&mut self, step: f64, end_speeds: WheelSpeeds, rolls: bool) -> bool {
        let integrator = &self.integrator;
        let Linear { seconds, trend } = integrator.linear;
        // 1.
        let is_steady = self.memory.is_empty()
            && self.model.min_feature_length().is_none()
            && self.model.next_event(self.time).is_none()
            && self.model.next_knot(self.time).is_none();
        // 2. With the next step, which may be the one that is evaluated.
        let elapsed = seconds + 2.0 * step;
        let next_speeds = end_speeds.after(self.input_rates, step);
        let from = WheelSpeeds::of(&self.anchor.motion);
        let expected = from.after(trend, elapsed);
        let reach = if rolls {
            LINEAR_REACH * expected.apart(from) + SMALLEST_REACH
        } else {
            0.0
        };
        if !is_steady
            || elapsed > LONGEST_LINEAR
            || integrator.short_error * elapsed * elapsed > LINEAR_EXPECTED * allowed(elapsed)
            || next_speeds.apart(expected) > reach
        {
            return false;
        }
        // 3.
        let a = self.state.kinematic_jacobian().by_state + integrator.by_state;
        let rates = [self.input_rates.left, self.input_rates.right];
        let by_time = integrator.by_input * nalgebra::Vector2::from(rates);
        let system = StageSystem::new(&a, &integrator.memory, step * D);
        let f0 = self.linear_rates(&self.anchor);
        let k1 = system.solve(f0 + by_time * (step * D), &mut []);
        let f1 = f0 + (a * k1 + by_time) * (0.5 * step);
        let moved = (system.solve(f1 - k1, &mut []) + k1) * step;
        // 4.
        let beside = self.anchor.beside + moved;
        let largest = |change: StateVector| change.fixed_rows::<3>(3).amax();
        let bend = largest(beside - self.anchor.derivative * (seconds + step));
        let goes_on = if rolls {
            bend < LINEAR_BEND && !self.turns_round(&beside)
        } else {
            largest(beside) < STANDING_REACH
        };
        if !goes_on || !moved.iter().all(|change| change.is_finite()) {
            return false;
        }
        self.state = State::from_array((StateVector::from(self.state.to_array()) + moved).into());
        self.anchor.beside = beside;
        self.now.valid = false;
        self.integrator.linear.seconds += step;
        self.integrator.counters.steps += 1;
        true
    }

    /// Whether a side of the vehicle is slow, or travels the other way, so far from the last evaluation: there the side
    /// of the wheels changes that compacts soil.
    fn turns_round(&self, beside: &StateVector) -> bool {
        let (motion, half_track) = (&self.anchor.motion, self.model.vehicle().half_track);
        let slowest = 2.0 * self.model.contact().regularisation().travel_speed;
        [-half_track, half_track].into_iter().any(|lever| {
            let before = motion.v_x + lever * motion.yaw_rate;
            let after = before + beside[3] + lever * beside[5];
            before * after <= 0.0 || before.abs().min(after.abs()) < slowest
        })
    }

    /// Rates of the state by the forces of an evaluation, linear in what has changed since.
    fn linear_rates(&self, from: &Evaluation) -> StateVector {
        let (motion, integrator) = (&from.motion, &self.integrator);
        let jump = [
            self.inputs.left - motion.omega_left,
            self.inputs.right - motion.omega_right,
        ];
        let changed =
            integrator.by_state * from.beside + integrator.by_input * nalgebra::Vector2::from(jump);
        let rates = &from.derivative;
        let wrench = Wrench {
            a_x: rates[3] - motion.v_y * motion.yaw_rate + changed[3],
            a_y: rates[4] + motion.v_x * motion.yaw_rate + changed[4],
            yaw_acceleration: rates[5] + changed[5],
            ..Wrench::default()
        };
        self.state.derivative(&wrench).into()
    }

    /// Takes a step with one evaluation, if the forces are linear over it and those before it that had none.
    fn try_short(&mut self, step: f64, end_speeds: WheelSpeeds, end_time: f64) -> bool {
        let elapsed = self.integrator.linear.seconds + step;
        let allowed = allowed(elapsed);
        let attempt = self.attempt(step, end_speeds, end_time, true);
        let integrator = &mut self.integrator;
        let Ok((state, error, nonlinear)) = attempt else {
            integrator.short_error = f64::MAX;
            return false;
        };
        integrator.short_error = expected(nonlinear, elapsed);
        let error = error + nonlinear;
        if error.is_nan() || error > allowed {
            return false;
        }
        if nonlinear > SHORT_JACOBIAN * allowed {
            integrator.jacobian_age = JACOBIAN_STEPS;
        }
        integrator.counters.steps += 1;
        self.update_jacobian(elapsed);
        self.accept(state, self.anchor.motion, elapsed);
        true
    }

    /// Broyden's update, of the smallest change with which the forces of the last two evaluations lie on a line.
    /// (What is remembered has no part in it, and then nothing is updated.)
    fn update_jacobian(&mut self, elapsed: f64) {
        let (end, missing) = (&self.work.stages.end, &self.work.stages.missing);
        let (from, to) = (self.anchor.motion.to_array(), end.motion.to_array());
        let change: [f64; 5] = std::array::from_fn(|k| (to[k] - from[k]) * BROYDEN_SCALE[k]);
        let square: f64 = change.iter().map(|x| x * x).sum();
        let integrator = &mut self.integrator;
        if !self.memory.is_empty() || square < BROYDEN_SMALLEST {
            integrator.jacobian_lag += elapsed;
            return;
        }
        for row in 3..State::COUNT {
            for (k, change) in change.into_iter().enumerate() {
                let update = missing[row] * change * BROYDEN_SCALE[k] / square;
                match k {
                    0..3 => integrator.by_state[(row, 3 + k)] += update,
                    _ => integrator.by_input[(row, k - 3)] += update,
                }
            }
        }
        integrator.jacobian_lag = 0.5 * elapsed;
    }

    fn refresh_jacobian(&mut self) {
        if self.integrator.jacobian_age < JACOBIAN_STEPS {
            return;
        }
        self.renew_jacobian();
    }

    /// One step: the new state, the largest error in units of its tolerance, and that of forces that are taken as linear.
    ///
    /// # Algorithm
    /// With W = I - h d A, A = df/dy (of any accuracy), T = df/dt, d and e_32 of the method:
    /// 1. f_0 at the start. The forces may be those of a state nearby: A times the distance is added. A `short` step takes
    ///    them from the last step's end, and adds the change of the wheel speeds since.
    /// 2. W k_1 = f_0 + h d T.
    /// 3. f_1 = f(t + h/2, y + h/2 k_1); of a short step f_0 + h/2 (A k_1 + T).
    /// 4. W (k_2 - k_1) = f_1 - k_1, and the new state is y + h k_2.
    /// 5. f_2 = f(t + h, y + h k_2), the next step's f_0.
    /// 6. W k_3 = f_2 - e_32 (k_2 - f_1) - 2 (k_1 - f_0) + h d T; the error is h/6 (k_1 - 2 k_2 + k_3).
    /// 7. Forces taken as linear miss u = f_2 - f_0 - h (A k_2 + T) at the end of the time g since the last evaluation.
    ///    If A is exact a time l before that, u grows like l t + t^2 / 2, and the state misses w W^-1 u with
    ///    w = g (l/2 + g/6) / (l + g/2) and W = I - g d A. A short step adds that.
    fn attempt(
        &mut self,
        h: f64,
        end_speeds: WheelSpeeds,
        end_time: f64,
        short: bool,
    ) -> Result<(State, f64, f64), SimulationError> {
        let mut stages = std::mem::take(&mut self.work.stages);
        let outcome = self.attempt_in(&mut stages, h, end_speeds, end_time, short);
        self.work.stages = stages;
        outcome
    }

    #[allow(
        clippy::needless_range_loop,
        reason = "several lists of what is remembered at once"
    )]
    fn attempt_in(
        &mut self,
        stages: &mut Stages,
        h: f64,
        end_speeds: WheelSpeeds,
        end_time: f64,
        short: bool,
    ) -> Result<(State, f64, f64), SimulationError> {
        self.integrator.counters.evaluations += if short { 1 } else { 2 };
        let start = if short { &self.anchor } else { &self.now };
        let Stages {
            middle: at_middle,
            end: at_end,
            middle_memory,
            memory: new_memory,
            from,
            slopes,
            rates: [g0, g1],
            memory_slopes: [l1, l2, l3],
            missing: kept,
        } = stages;
        let Integrator {
            by_state,
            by_input,
            memory: coupling,
            ..
        } = &self.integrator;
        let a = self.state.kinematic_jacobian().by_state + by_state;
        let rates = [self.input_rates.left, self.input_rates.right];
        let by_time = by_input * nalgebra::Vector2::from(rates);
        let system = StageSystem::new(&a, coupling, h * D);
        let m = &self.memory;
        let count = m.len();
        let y = StateVector::from(self.state.to_array());
        // 1.
        let jump = [
            self.inputs.left - start.motion.omega_left,
            self.inputs.right - start.motion.omega_right,
        ];
        let jumped = if short { jump } else { [0.0; 2] };
        let (beside, memory_beside) = (&start.beside, &start.memory_beside);
        let mut f0 = self.linear_rates(start);
        coupling.add_accelerations(memory_beside.iter().copied(), &mut f0);
        for i in 0..count {
            g0[i] = start.memory_rates[i]
                + coupling.by_motion(i, beside, memory_beside[i])
                + coupling.by_input(i, jumped);
        }
        // 2.
        for i in 0..count {
            l1[i] = g0[i] + h * D * coupling.by_input(i, rates);
        }
        let k1 = system.solve(f0 + by_time * (h * D), l1);
        // 3. What the linear forces are at a displacement from the start, after a time.
        let linear = |moved: StateVector, remembered: &[f64], time: f64| {
            let mut f = f0 + a * moved + by_time * time;
            coupling.add_accelerations(remembered.iter().map(|slope| time * slope), &mut f);
            f
        };
        let f1 = if short {
            let moved = k1 * (0.5 * h);
            for i in 0..count {
                g1[i] = g0[i]
                    + coupling.by_motion(i, &moved, 0.5 * h * l1[i])
                    + 0.5 * h * coupling.by_input(i, rates);
            }
            linear(moved, l1, 0.5 * h)
        } else {
            let middle = State::from_array((y + k1 * (0.5 * h)).into());
            let motion = middle.motion(self.inputs.after(self.input_rates, 0.5 * h));
            at_middle.guess_from(start, &self.trend, &motion);
            for i in 0..count {
                middle_memory[i] = m[i] + 0.5 * h * l1[i];
            }
            let (tracks, time) = (self.left.tracks(), end_time - 0.5 * h);
            at_middle.solve(&self.model, &middle, motion, time, middle_memory, tracks)?;
            g1.copy_from_slice(&at_middle.memory_rates);
            at_middle.derivative
        };
        // 4.
        for i in 0..count {
            l2[i] = g1[i] - l1[i];
        }
        let k2 = system.solve(f1 - k1, l2) + k1;
        *from = y;
        *slopes = [k1, k2];
        for i in 0..count {
            l2[i] += l1[i];
            new_memory[i] = m[i] + h * l2[i];
        }
        // 5.
        let end = State::from_array((y + k2 * h).into());
        let motion = end.motion(end_speeds);
        at_end.guess_from(if short { start } else { at_middle }, &self.trend, &motion);
        let tracks = self.left.tracks();
        at_end.solve(&self.model, &end, motion, end_time, new_memory, tracks)?;
        let (f2, g2) = (at_end.derivative, &at_end.memory_rates);
        // 6.
        for i in 0..count {
            l3[i] = g2[i] - (l2[i] - g1[i]) * E32 - (l1[i] - g0[i]) * 2.0
                + h * D * coupling.by_input(i, rates);
        }
        let third = f2 - (k2 - f1) * E32 - (k1 - f0) * 2.0 + by_time * (h * D);
        let k3 = system.solve(third, l3);
        let error = (k1 - k2 * 2.0 + k3) * (h / 6.0);
        let errors = (0..count).map(|i| (l1[i] - l2[i] * 2.0 + l3[i]) * (h / 6.0));
        let tolerance = self.integrator.tolerance;
        let sizes = [self.state.to_array(), end.to_array()];
        let worst = worst(&error, &sizes, worst_error(m, new_memory, errors));
        // 7.
        let moved = k2 * h;
        let missing = f2 - linear(moved, l2, h);
        *kept = missing;
        for i in 0..count {
            l3[i] = g2[i]
                - g0[i]
                - coupling.by_motion(i, &moved, h * l2[i])
                - h * coupling.by_input(i, rates);
        }
        let since = h + if short {
            self.integrator.linear.seconds
        } else {
            0.0
        };
        let lag = self.integrator.jacobian_lag;
        let mean = since * (lag / 2.0 + since / 6.0) / (lag + since / 2.0);
        let missed = if since > h {
            StageSystem::new(&a, coupling, since * D).solve(missing, l3)
        } else {
            system.solve(missing, l3)
        } * mean;
        let errors = l3.iter().map(|missed| missed * mean);
        let nonlinear = self::worst(&missed, &sizes, worst_error(m, new_memory, errors));
        if !short {
            return Ok((end, worst / tolerance, nonlinear / tolerance));
        }
        slopes[1] += missed / h;
        at_end.beside = missed;
        for i in 0..count {
            at_end.memory_beside[i] = l3[i] * mean;
            new_memory[i] += at_end.memory_beside[i];
        }
        let end = State::from_array((y + k2 * h + missed).into());
        Ok((end, worst / tolerance, nonlinear / tolerance))
    }
}

/// The largest error of the state in units of its tolerance, or `other` if that is larger.
fn worst(error: &StateVector, sizes: &[[f64; State::COUNT]; 2], other: f64) -> f64 {
    let ratio = (0..State::COUNT).map(|i| {
        let size = sizes[0][i].abs().max(sizes[1][i].abs());
        error[i].abs() / (ABSOLUTE_TOLERANCE[i] + RELATIVE_TOLERANCE[i] * size)
    });
    // max() would drop a NaN.
    ratio.fold(other, |a, b| if b > a || b.is_nan() { b } else { a })
}

/// What steps without a middle evaluation may err by over so many seconds, in units of the tolerance.
fn allowed(seconds: f64) -> f64 {
    (SHORT_ERROR_RATE * seconds).min(1.0)
}

/// What a step without a middle evaluation errs by over the square of its length, from one of this length.
fn expected(nonlinear: f64, step: f64) -> f64 {
    if nonlinear.is_nan() {
        f64::MAX
    } else {
        nonlinear / (step * step)
    }
}
