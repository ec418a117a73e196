//! Wheel speeds of drives as people make them.

use super::random::Random;
use std::f64::consts::TAU;
use ugv_terrain::vehicle::Vehicle;

/// Seconds between two commands.
pub const STEP: f64 = 0.05;

/// What a drive consists of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Everything.
    Rich,
    /// One straight line at one speed.
    Straight,
    /// One gentle curve at one speed.
    GentleCurve,
    /// Curves of many kinds, at one speed.
    Steady,
    /// Straight lines, with speeds that change.
    StraightVaried,
    /// Curves that are all gentle, with speeds that change.
    Gentle,
}

impl Style {
    pub fn name(self) -> &'static str {
        match self {
            Self::Rich => "rich",
            Self::Straight => "straight",
            Self::GentleCurve => "gentle_curve",
            Self::Steady => "steady",
            Self::StraightVaried => "straight_varied",
            Self::Gentle => "gentle",
        }
    }

    /// The legs, each as often as it comes up in one round.
    fn legs(self) -> &'static [Leg] {
        match self {
            Self::Rich => &[
                Leg::Straight,
                Leg::Straight,
                Leg::Ramp,
                Leg::Ramp,
                Leg::Ramp,
                Leg::Stop,
                Leg::Gentle,
                Leg::Gentle,
                Leg::Tight,
                Leg::Tight,
                Leg::Tight,
                Leg::Slalom,
                Leg::Spiral,
                Leg::Pivot,
                Leg::Reverse,
            ],
            Self::Straight => &[Leg::Straight],
            Self::GentleCurve => &[Leg::Gentle],
            Self::Steady => &[Leg::Straight, Leg::Gentle, Leg::Tight],
            Self::StraightVaried => &[Leg::Straight, Leg::Ramp, Leg::Ramp, Leg::Ramp, Leg::Stop],
            Self::Gentle => &[Leg::Straight, Leg::Ramp, Leg::Gentle, Leg::Gentle],
        }
    }

    /// Whether speed and curve stay what they are once the vehicle is under way.
    fn is_one_leg(self) -> bool {
        matches!(self, Self::Straight | Self::GentleCurve)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Leg {
    Straight,
    Ramp,
    Stop,
    Gentle,
    Tight,
    Slalom,
    Spiral,
    Pivot,
    Reverse,
}

/// Wheel speeds (left, right) \[rad/s\] at each command.
#[derive(Debug, Clone, PartialEq)]
pub struct Commands {
    pub wheels: Vec<[f64; 2]>,
}

/// No driver asks for more \[m/s\].
const FASTEST: f64 = 3.2;

/// Who drives what, and how fast.
#[derive(Debug, Clone, Copy)]
pub struct Driver<'a> {
    pub vehicle: &'a Vehicle,
    /// How much more difference between the sides it takes to turn than without slip.
    pub oversteer: f64,
    /// Greatest mean speed that is asked for \[m/s\].
    pub top_speed: f64,
}

/// Commands of a drive of so many seconds.
pub fn commands(driver: Driver, style: Style, seconds: f64, random: &mut Random) -> Commands {
    let top_speed = driver.top_speed;
    let count = (seconds / STEP).round() as usize + 1;
    let mut targets = Vec::with_capacity(count + 400);
    let pause = (random.between(0.3, 1.2) / STEP) as usize;
    targets.resize(pause, [0.0; 2]);
    let cruise = random.between(0.5, 0.9) * top_speed;
    let mut speed = cruise;
    let mut legs = Legs {
        driver,
        random,
        is_one_leg: style.is_one_leg(),
    };
    if style.is_one_leg() {
        let leg = style.legs()[0];
        legs.add(leg, seconds, cruise, cruise, &mut targets);
    }
    let mut round = Vec::new();
    while targets.len() < count {
        if round.is_empty() {
            round = style.legs().to_vec();
            legs.random.shuffle(&mut round);
        }
        let leg = round.pop().expect("a round has legs");
        let next = match (style, leg) {
            (Style::Steady, _) => cruise,
            (_, Leg::Ramp) => legs.random.between(0.3, 1.0) * top_speed,
            _ => speed,
        };
        let length = legs.random.between(2.0, 6.5);
        legs.add(leg, length, speed, next, &mut targets);
        speed = next.max(0.25 * top_speed);
    }
    targets.truncate(count);
    let acceleration = random.scaled(0.4, 1.5);
    let lag = random.between(0.1, 0.25);
    let wheels = smooth(&targets, acceleration, lag)
        .into_iter()
        .map(|sides| sides.map(|side| side / driver.vehicle.wheel_radius))
        .collect();
    Commands { wheels }
}

/// A bend of so many half tracks' radius, to find out how the vehicle turns.
pub fn trial_bend(vehicle: &Vehicle, oversteer: f64) -> (Commands, f64) {
    const RADIUS: f64 = 7.0;
    let speed = 0.7;
    let yaw_rate = speed / (RADIUS * vehicle.half_track);
    let turn = oversteer * yaw_rate * vehicle.half_track;
    let targets = vec![[speed - turn, speed + turn]; (8.0 / STEP) as usize];
    let wheels = smooth(&targets, 1.0, 0.2).into_iter();
    let wheels = wheels.map(|sides| sides.map(|side| side / vehicle.wheel_radius));
    let commands = Commands {
        wheels: wheels.collect(),
    };
    (commands, yaw_rate)
}

/// Legs of a drive as they come.
struct Legs<'a> {
    driver: Driver<'a>,
    random: &'a mut Random,
    is_one_leg: bool,
}

impl Legs<'_> {
    /// Adds the targets of a leg: speeds \[m/s\] of both sides.
    fn add(&mut self, leg: Leg, length: f64, from: f64, to: f64, targets: &mut Vec<[f64; 2]>) {
        let half = self.driver.vehicle.half_track;
        let side = self.random.sign();
        let gentle = half * self.random.scaled(12.0, 40.0);
        let tight = half * self.random.scaled(2.5, 8.0);
        let period = self.random.between(3.0, 6.0);
        // Nobody takes a bend at full speed: lateral acceleration up to 1.5 m/s^2.
        let bend = |speed: f64, radius: f64| speed.min((1.5 * radius).sqrt());
        let pivot = self.random.between(0.2, 0.45) * self.driver.top_speed.min(1.5);
        let back = -self.random.between(0.3, 0.6) * self.driver.top_speed.min(1.6);
        let bow = if self.random.chance(0.5) { 1.0 } else { 0.0 };
        let length = match leg {
            Leg::Gentle | Leg::Tight if !self.is_one_leg => {
                let radius = if leg == Leg::Tight { tight } else { gentle };
                let angle = self.random.between(0.5, 2.5);
                (angle * radius / bend(to, radius).max(0.1)).clamp(length, 2.0 * length)
            }
            _ => length,
        };
        let difference =
            |speed: f64, radius: f64| self.driver.oversteer * side * speed * half / radius;
        for k in 0..(length / STEP) as usize {
            let time = k as f64 * STEP;
            let share = time / length;
            let (speed, turn) = match leg {
                Leg::Straight => (from, 0.0),
                Leg::Ramp => (to, 0.0),
                Leg::Stop => (0.0, 0.0),
                Leg::Gentle => (bend(to, gentle), difference(bend(to, gentle), gentle)),
                Leg::Tight => (bend(to, tight), difference(bend(to, tight), tight)),
                Leg::Slalom => {
                    let speed = bend(from, 2.0 * tight);
                    let swing = (TAU * time / period).sin();
                    (speed, swing * difference(speed, 1.5 * tight))
                }
                Leg::Spiral => {
                    let radius = gentle * (tight / gentle).powf(share);
                    let speed = bend(from, radius);
                    (speed, difference(speed, radius))
                }
                Leg::Pivot => (0.0, side * pivot),
                Leg::Reverse => (back, bow * difference(back, gentle)),
            };
            targets.push([speed - turn, speed + turn].map(|v| v.clamp(-FASTEST, FASTEST)));
        }
    }
}

/// What motors make of the targets: bounded accelerations \[m/s^2\], without kinks.
fn smooth(targets: &[[f64; 2]], acceleration: f64, lag: f64) -> Vec<[f64; 2]> {
    let share = 1.0 - (-STEP / lag).exp();
    let mut stages = [[0.0; 3]; 2];
    targets
        .iter()
        .map(|target| {
            let mut sides = [0.0; 2];
            for (side, stages) in stages.iter_mut().enumerate() {
                let most = acceleration * STEP;
                stages[0] += (target[side] - stages[0]).clamp(-most, most);
                stages[1] += share * (stages[0] - stages[1]);
                stages[2] += share * (stages[1] - stages[2]);
                sides[side] = stages[2];
            }
            sides
        })
        .collect()
}
