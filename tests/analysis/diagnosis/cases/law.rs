//! Forces that no effect of the catalogue describes.

use super::manoeuvres::STEP;
use super::random::Random;
use ugv_terrain::simulation::State;
use ugv_terrain::vehicle::{GRAVITY, Vehicle};

/// What pushes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LawKind {
    /// Wind from somewhere on the map, in gusts.
    Wind,
    /// Something that drags on one side now and then.
    SideDrag,
    /// A rut that turns the vehicle along itself.
    Rut,
    /// A liquid load that swings to and fro.
    Sloshing,
    /// A lateral force that grows with the speed times the yaw rate's magnitude.
    SpeedTimesTurning,
    /// Somebody pushes, for a few seconds.
    Push,
}

impl LawKind {
    /// Those that act throughout a drive.
    pub const LASTING: [Self; 5] = [
        Self::Wind,
        Self::SideDrag,
        Self::Rut,
        Self::Sloshing,
        Self::SpeedTimesTurning,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Wind => "wind",
            Self::SideDrag => "side_drag",
            Self::Rut => "rut",
            Self::Sloshing => "sloshing",
            Self::SpeedTimesTurning => "speed_times_turning",
            Self::Push => "push",
        }
    }
}

/// A force and moment along a drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    pub kind: LawKind,
    /// Names and values, for the truth.
    pub parameters: Vec<(&'static str, f64)>,
    /// What varies by chance along the drive, one value per command.
    course: Vec<f64>,
}

/// Speed below which nothing drags \[m/s\].
const CREEP: f64 = 0.1;

impl Law {
    /// A law of this strength: 1 is plain to see, 0.3 hardly.
    pub fn draw(kind: LawKind, strength: f64, vehicle: &Vehicle, random: &mut Random) -> Self {
        let weight = vehicle.mass * GRAVITY;
        let length =
            vehicle.row_positions[0] - vehicle.row_positions[vehicle.row_positions.len() - 1];
        let turn = random.between(-3.1, 3.1);
        let side = random.sign();
        let parameters = match kind {
            LawKind::Wind => vec![
                ("mean_N", 0.015 * strength * weight),
                ("gusts_N", 0.05 * strength * weight),
                ("towards_rad", turn),
                ("correlation_s", random.between(1.5, 5.0)),
            ],
            LawKind::SideDrag => vec![
                ("force_N", 0.1 * strength * weight),
                ("left_m", side * vehicle.half_track),
            ],
            LawKind::Rut => vec![
                ("moment_Nm", 0.06 * strength * weight * length),
                ("heading_rad", turn),
            ],
            LawKind::Sloshing => vec![
                ("forward_N", 0.06 * strength * weight),
                ("lateral_N", 0.02 * strength * weight),
                ("frequency_Hz", random.scaled(0.25, 0.8)),
                ("phase_rad", turn),
            ],
            LawKind::SpeedTimesTurning => {
                // At 1 m/s and 0.5 rad/s a tenth of the weight.
                vec![("coefficient_kg_per_rad", side * 0.2 * strength * weight)]
            }
            LawKind::Push => vec![
                ("forward_N", 0.12 * strength * weight * turn.cos()),
                ("lateral_N", 0.12 * strength * weight * turn.sin()),
                (
                    "moment_Nm",
                    0.03 * strength * weight * length * random.normal(),
                ),
            ],
        };
        let mut law = Self {
            kind,
            parameters,
            course: Vec::new(),
        };
        law.redraw(random);
        law
    }

    /// The same law on another day: other gusts, other moments.
    pub fn redraw(&mut self, random: &mut Random) {
        const COUNT: usize = 4000;
        self.course = match self.kind {
            LawKind::Wind => random.coloured(COUNT, STEP, self.value(3)),
            LawKind::SideDrag => switched(COUNT, random),
            _ => Vec::new(),
        };
    }

    fn value(&self, index: usize) -> f64 {
        self.parameters[index].1
    }

    fn course(&self, time: f64) -> f64 {
        let place = (time / STEP).max(0.0);
        let at = |k: usize| self.course[k.min(self.course.len() - 1)];
        let (k, share) = (place as usize, place.fract());
        at(k) + share * (at(k + 1) - at(k))
    }

    /// Forces ahead and to the left \[N\], moment \[N m\].
    pub fn wrench(&self, time: f64, state: &State) -> [f64; 3] {
        let speed = state.v_x.hypot(state.v_y);
        let moving = speed / speed.hypot(CREEP);
        match self.kind {
            LawKind::Wind => {
                let force = self.value(0) + self.value(1) * self.course(time);
                let towards = self.value(2) - state.heading;
                [force * towards.cos(), force * towards.sin(), 0.0]
            }
            LawKind::SideDrag => {
                let ahead = state.v_x - state.yaw_rate * self.value(1);
                let force = -self.value(0) * self.course(time) * ahead / ahead.hypot(CREEP);
                [force, 0.0, -self.value(1) * force]
            }
            LawKind::Rut => {
                let moment = self.value(0) * (self.value(1) - state.heading).sin();
                [0.0, 0.0, moving * moment]
            }
            LawKind::Sloshing => {
                let phase = std::f64::consts::TAU * self.value(2) * time + self.value(3);
                [
                    self.value(0) * phase.sin(),
                    self.value(1) * phase.cos(),
                    0.0,
                ]
            }
            LawKind::SpeedTimesTurning => {
                [0.0, self.value(0) * state.v_x * state.yaw_rate.abs(), 0.0]
            }
            LawKind::Push => [self.value(0), self.value(1), self.value(2)],
        }
    }
}

/// 1 for 1 to 4 s now and then, else 0.
fn switched(count: usize, random: &mut Random) -> Vec<f64> {
    let mut course = Vec::with_capacity(count + 200);
    while course.len() < count {
        let (off, on) = (random.between(3.0, 9.0), random.between(1.0, 4.0));
        course.resize(course.len() + (off / STEP) as usize, 0.0);
        course.resize(course.len() + (on / STEP) as usize, 1.0);
    }
    course
}
