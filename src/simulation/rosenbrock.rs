//! Time integration: the Rosenbrock (2,3) pair of Shampine & Reichelt, "The MATLAB ODE
//! suite", SIAM J. Sci. Comput. 18 (1997), there called ode23s.
//!
//! L-stable, so that the forces near standstill (which grow like 1/omega) do not limit the
//! step; of order 2 with any matrix in place of the Jacobian, so that one Jacobian serves
//! several steps; and its last stage is the next step's first, so that a step costs two
//! evaluations of the forces.

use super::integrator::{
    ABSOLUTE_TOLERANCE, Counters, D, E32, GROW, Integrator, JACOBIAN_ERROR, JACOBIAN_STEPS,
    LONGEST_CALL, LONGEST_STEP, RELATIVE_TOLERANCE, SAFETY, SHRINK, SMALLEST_SHARE, SMALLEST_STEP,
    Stages,
};
use super::memory::{StageSystem, worst_error};
use super::state::{State, StateVector, WheelSpeeds};
use super::{Simulation, SimulationError};

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
        self.step_with(seconds, |_, _| Ok(()))
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
        self.now.valid = false;
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
        self.evaluate()?;
        self.refresh_jacobian();
        let attempt = self.attempt(step, end_speeds, end_time);
        let error = match attempt {
            Ok((_, error)) if error.is_finite() => error,
            _ => f64::INFINITY,
        };
        let integrator = &mut self.integrator;
        let factor = (SAFETY * error.powf(-1.0 / 3.0)).clamp(SHRINK, GROW);
        if let (Ok((state, _)), true) = (&attempt, error <= 1.0) {
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
            self.state = *state;
            self.memory.copy_from_slice(&self.work.stages.memory);
            self.now.copy_from(&self.work.stages.end);
            self.anchor.copy_from(&self.now.balance);
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

    fn refresh_jacobian(&mut self) {
        if self.integrator.jacobian_age < JACOBIAN_STEPS {
            return;
        }
        self.renew_jacobian();
    }

    /// One step: the new state, and the largest error in units of its tolerance.
    fn attempt(
        &mut self,
        h: f64,
        end_speeds: WheelSpeeds,
        end_time: f64,
    ) -> Result<(State, f64), SimulationError> {
        self.integrator.counters.evaluations += 2;
        let Integrator {
            by_state,
            by_input,
            memory: coupling,
            ..
        } = &self.integrator;
        let rates = nalgebra::Vector2::new(self.input_rates.left, self.input_rates.right);
        let by_time = by_input * rates * (h * D);
        let system = StageSystem::new(by_state, coupling, h * D);
        let memory_by_time = coupling.by_time([rates[0], rates[1]], h * D);
        let remembered = |terms: &dyn Fn(usize) -> f64| -> Vec<f64> {
            (0..memory_by_time.len()).map(terms).collect()
        };
        let y = StateVector::from(self.state.to_array());
        let f0 = self.now.derivative;
        let m = &self.memory;
        let tracks = self.left.tracks();
        let g0 = &self.now.memory_rates;
        let mut l1 = remembered(&|i| g0[i] + memory_by_time[i]);
        let k1 = system.solve(f0 + by_time, &mut l1);
        let middle = State::from_array((y + k1 * (0.5 * h)).into());
        let speeds = self.inputs.after(self.input_rates, 0.5 * h);
        let Stages {
            middle: at_middle,
            end: at_end,
            memory: new_memory,
            from,
            slopes,
        } = &mut self.work.stages;
        *from = y;
        let motion = middle.motion(speeds);
        at_middle.guess_from(&self.now, &self.trend, &motion);
        let middle_memory = remembered(&|i| m[i] + 0.5 * h * l1[i]);
        let middle_time = end_time - 0.5 * h;
        at_middle.solve(
            &self.model,
            &middle,
            motion,
            middle_time,
            &middle_memory,
            tracks,
        )?;
        let f1 = at_middle.derivative;
        let g1 = &at_middle.memory_rates;
        let mut l2 = remembered(&|i| g1[i] - l1[i]);
        let k2 = system.solve(f1 - k1, &mut l2) + k1;
        *slopes = [k1, k2];
        for i in 0..l2.len() {
            l2[i] += l1[i];
            new_memory[i] = m[i] + h * l2[i];
        }
        let end = State::from_array((y + k2 * h).into());
        let motion = end.motion(end_speeds);
        at_end.guess_from(at_middle, &self.trend, &motion);
        at_end.solve(&self.model, &end, motion, end_time, new_memory, tracks)?;
        let f2 = at_end.derivative;
        let g2 = &at_end.memory_rates;
        let mut l3 = remembered(&|i| {
            g2[i] - (l2[i] - g1[i]) * E32 - (l1[i] - g0[i]) * 2.0 + memory_by_time[i]
        });
        let k3 = system.solve(f2 - (k2 - f1) * E32 - (k1 - f0) * 2.0 + by_time, &mut l3);
        let error = (k1 - k2 * 2.0 + k3) * (h / 6.0);
        let (old, new) = (self.state.to_array(), end.to_array());
        let ratio = (0..State::COUNT).map(|i| {
            let size = old[i].abs().max(new[i].abs());
            error[i].abs() / (ABSOLUTE_TOLERANCE[i] + RELATIVE_TOLERANCE[i] * size)
        });
        let errors = remembered(&|i| (l1[i] - l2[i] * 2.0 + l3[i]) * (h / 6.0));
        let memory_error = worst_error(m, new_memory, &errors);
        // max() would drop a NaN.
        let worst = ratio.fold(memory_error, |a, b| if b > a || b.is_nan() { b } else { a });
        Ok((end, worst / self.integrator.tolerance))
    }
}
