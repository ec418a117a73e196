//! What is remembered, as it is where the motion has lasted for a while: for drives that start in the
//! midst of another.

use super::memory::memory_directions;
use super::{Simulation, SimulationError, finite};
use crate::vehicle::{Directions, Remembered};
use nalgebra::DMatrix;

/// Newton's steps at most, and below which step \[m, m/rad\] it is there.
const STEPS: usize = 12;
const THERE: f64 = 1e-10;
/// Shear that takes longer to build up \[1/s\] than a moment stays as it is: wheels that hardly turn
/// hold what they hold.
const SLOWEST: f64 = 0.5;

/// Which of the remembered numbers settle, and the matrix of their rates by themselves.
pub(super) struct Settling {
    /// Their places.
    pub places: Vec<usize>,
    /// d rate / d number.
    pub matrix: DMatrix<f64>,
}

impl Settling {
    /// Of all remembered numbers' rates by themselves those that settle.
    pub fn new(simulation: &Simulation, whole: &DMatrix<f64>) -> Self {
        let model = &simulation.model;
        let settles = |index: &usize| match model.remembers(*index) {
            Some(Remembered::Rut) => true,
            Some(Remembered::Shear) => whole[(*index, *index)] < -SLOWEST,
            _ => false,
        };
        let places: Vec<usize> = (0..whole.nrows()).filter(settles).collect();
        let matrix = whole.select_rows(&places).select_columns(&places);
        Self { places, matrix }
    }

    /// Solves for the numbers that settle; `None` where there are none, or not in one way.
    pub fn solve(&self, rates: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let some = !self.places.is_empty();
        some.then(|| self.matrix.clone().lu().solve(rates))
            .flatten()
    }
}

/// Refuses poses that are not finite.
pub(super) fn check_course(course: &[[f64; 3]]) -> Result<(), SimulationError> {
    const NAMES: [&str; 3] = ["pose ahead", "pose to the left", "pose turned"];
    course.iter().try_for_each(|pose| finite(&NAMES, pose))
}

impl Simulation {
    /// Sets what the vehicle and its ground remember to where it stays in the present motion: ruts as deep
    /// as the rows ahead press them, shear as in steady motion (14). The distance stays, and so
    /// does the shear of wheels that hardly turn.
    ///
    /// # Errors
    /// As [`Simulation::wrench`].
    pub fn settle(&mut self) -> Result<(), SimulationError> {
        self.settle_after(&[])
    }

    /// As [`Simulation::settle`], with the tracks of a vehicle that came here over a course: poses, the oldest first, as
    /// [`seen_from`](crate::vehicle::seen_from) gives them relative to the present one, ahead, to the left \[m\] and turned
    /// \[rad\]. The wheels are taken to have stood as deep there as now, and to have driven straight up to its first pose.
    /// Without any pose the present motion is taken to have lasted.
    ///
    /// # Errors
    /// A pose that is not finite; then nothing has changed. Else as [`Simulation::wrench`].
    pub fn settle_after(&mut self, course: &[[f64; 3]]) -> Result<(), SimulationError> {
        check_course(course)?;
        if self.memory.is_empty() {
            return Ok(());
        }
        let settled = self.settle_arriving(course);
        match settled {
            Ok(()) => self.left.came_here(&self.state, &self.now.wrench),
            Err(_) => self.left.clear(),
        }
        settled
    }

    /// As [`Simulation::settle_after`], but the tracks go on to be those that it came with, whatever its motion is.
    pub(super) fn settle_arriving(&mut self, course: &[[f64; 3]]) -> Result<(), SimulationError> {
        self.left.arrive(course);
        self.leave();
        let list = memory_directions(self.memory.len());
        let mut directions = Directions::new(&self.model, list);
        let mut results = Vec::new();
        for _ in 0..STEPS {
            self.evaluate()?;
            self.differentiate(&mut directions, &mut results);
            let count = self.memory.len();
            let whole = DMatrix::from_fn(count, count, |i, j| results[j].memory_rates[i]);
            let settling = Settling::new(self, &whole);
            let rates = settling.places.iter().map(|k| self.now.memory_rates[*k]);
            let rates = DMatrix::from_iterator(settling.places.len(), 1, rates);
            let Some(step) = settling.solve(&rates) else {
                break;
            };
            for (place, step) in settling.places.iter().zip(step.iter()) {
                self.memory[*place] -= step;
            }
            self.leave();
            if step.amax() < THERE {
                break;
            }
        }
        self.evaluate()
    }
}
