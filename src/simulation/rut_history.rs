//! The tracks that the wheels leave while a simulation goes on.

use super::state::State;
use crate::vehicle::{
    ApproachPath, TRACK_SAMPLES, Tracks, VehicleModel, Wrench, sample_size, spacing, wheel_places,
    wheel_travel,
};

/// The samples of the tracks that are kept, a sample for each of so many metres driven.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct RutHistory {
    /// Numbers of [`Tracks::left`]; none where tracks are not kept.
    numbers: Vec<f64>,
    /// Where the wheels were, sample by sample, east and north \[m\].
    points: Vec<[f64; 2]>,
    /// Number of samples since the last restart.
    begun: u64,
    /// How the vehicle came here, as long as all is still as it was meanwhile.
    approach_path: Option<ApproachPath>,
    /// Where the wheels are on the vehicle; none where tracks are not kept.
    places: Vec<[f64; 2]>,
}

impl RutHistory {
    /// No track yet.
    pub fn new(model: &VehicleModel) -> Self {
        let vehicle = model.vehicle();
        let wheels = 0..vehicle.wheel_count();
        let places = wheels
            .map(|index| vehicle.wheel_centre(index).into())
            .filter(|_| model.has_ruts());
        Self {
            places: places.collect(),
            ..Self::default()
        }
    }

    /// As models see them.
    pub fn tracks(&self) -> Tracks<'_> {
        match &self.approach_path {
            Some(approach_path) => approach_path.tracks(),
            None => Tracks::left(&self.numbers, &self.points),
        }
    }

    /// Number of samples since the last restart.
    pub fn begun(&self) -> u64 {
        self.begun
    }

    /// Begins anew on untouched ground.
    pub fn clear(&mut self) {
        self.numbers.clear();
        self.points.clear();
        self.begun = 0;
        self.approach_path = None;
    }

    /// From here on, or until [`RutHistory::came_here`], tracks are as if the vehicle had come here over these poses, seen
    /// from the present one, each wheel as deep as now; without any, in its present motion.
    pub fn arrive(&mut self, course: &[[f64; 3]]) {
        self.clear();
        if !self.places.is_empty() {
            self.approach_path = Some(if course.is_empty() {
                ApproachPath::Steadily
            } else {
                ApproachPath::along(&self.places, course)
            });
        }
    }

    /// Leaves the tracks of a vehicle that came here so, the wheels as deep as now.
    pub fn came_here(&mut self, state: &State, wrench: &Wrench) {
        if let Some(approach_path) = self.approach_path.take() {
            for pose in approach_path.poses(&self.places, state.to_array()) {
                self.push(pose, wrench);
            }
        }
    }

    /// Derivatives by the state of the poses in which [`RutHistory::came_here`] would leave samples.
    pub fn came_slopes(&self, state: &State) -> Vec<[[f64; State::COUNT]; 3]> {
        let approach_path = self.approach_path.as_ref();
        approach_path.map_or_else(Vec::new, |approach_path| {
            approach_path.slopes(&self.places, state.to_array())
        })
    }

    /// Leaves a sample.
    fn push(&mut self, pose: [f64; 3], wrench: &Wrench) {
        let size = sample_size(self.places.len());
        if self.numbers.len() >= TRACK_SAMPLES * size {
            self.numbers.drain(..size);
            self.points.drain(..self.places.len());
        }
        self.numbers.extend(pose);
        let depths = wrench.wheels.iter().map(|wheel| wheel.sinkage);
        self.numbers.extend(depths);
        self.points.extend(wheel_places(pose, &self.places));
        self.begun += 1;
    }

    /// Leaves a sample, if some wheel has come far enough from the last one.
    pub fn follow(&mut self, state: &State, wrench: &Wrench) {
        let wheels = self.places.len();
        if wheels == 0 {
            return;
        }
        let pose = [state.x, state.y, state.heading];
        let far = spacing(&self.places);
        let last = self.points.rchunks_exact(wheels).next();
        if last.is_none_or(|last| wheel_travel(last, pose, &self.places) >= far) {
            self.push(pose, wrench);
        }
    }

    /// Visits every number, for a snapshot: as many whatever has been driven.
    pub fn visit(&mut self, visit: &mut impl FnMut(&mut f64)) {
        let wheels = self.places.len();
        if wheels == 0 {
            return;
        }
        let size = sample_size(wheels);
        let mut count = (self.numbers.len() / size) as f64;
        visit(&mut count);
        let mut begun = self.begun as f64;
        visit(&mut begun);
        self.begun = begun as u64;
        self.numbers.resize(TRACK_SAMPLES * size, 0.0);
        self.numbers.iter_mut().for_each(visit);
        let count = (count as usize).min(TRACK_SAMPLES);
        self.numbers.truncate(count * size);
        self.points.clear();
        for sample in self.numbers.chunks_exact(size) {
            let pose = [sample[0], sample[1], sample[2]];
            self.points.extend(wheel_places(pose, &self.places));
        }
    }
}
