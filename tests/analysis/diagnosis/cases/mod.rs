//! Cases to develop and test the diagnosis on: drives whose truth is known.

mod draw;
mod family;
mod files;
mod ground;
mod law;
mod manoeuvres;
mod plan;
mod random;
mod sensors;
mod signal;
mod world;

pub use family::Family;
pub use files::write;

use ground::Ground;
use manoeuvres::{Driver, STEP, Style, commands, trial_bend};
use plan::{Place, Plan};
use random::Random;
use sensors::{Row, Sensors};
use signal::{Seen, Signal};
use ugv_terrain::simulation::State;
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::Vehicle;
use world::{Failure, Ingredient, Region, Track, World, effects};

/// A case: recordings, and what is behind them.
pub struct Case {
    family: Family,
    /// Of the draw that could be driven.
    seed: u64,
    plan: Plan,
    vehicle_name: &'static str,
    vehicle: Vehicle,
    ground: Ground,
    sensors: Sensors,
    /// What is to be diagnosed; one or two.
    drives: Vec<Recorded>,
    /// For the score.
    unseen: Recorded,
}

/// Signals that sizes promise.
const PLAIN: [(&str, f64); 3] = [("small", 1.5), ("medium", 4.0), ("large", 8.0)];
/// Less than this may be taken for nothing.
const FAINT: f64 = 6.0;

impl Case {
    /// Signal left in all recordings that are to be diagnosed.
    fn signal_left(&self) -> f64 {
        let squares = self.drives.iter().map(|drive| drive.signal.left.powi(2));
        squares.sum::<f64>().sqrt()
    }

    /// Whether as much shows as the effects' sizes promise.
    fn is_plain_enough(&self) -> bool {
        let all = self.plan.ingredients.iter().chain(&self.plan.faults);
        let predicted_reduction =
            all.filter_map(|one| PLAIN.iter().find(|(size, _)| *size == one.size));
        let least = predicted_reduction
            .map(|(_, least)| *least)
            .fold(0.0, f64::max);
        self.family == Family::Poor || self.signal_left() >= least
    }

    /// With what is left of its signals by as many steps as it takes.
    fn measured(mut self) -> Self {
        let faults = effects(self.plan.faults.iter());
        for drive in &mut self.drives {
            let (soil, track) = (self.ground.truth, &drive.track);
            drive.signal.left =
                Seen::new(&self.vehicle, soil, track, &self.sensors, &faults).left();
        }
        self
    }

    /// Verdicts that are right.
    fn expected(&self) -> Vec<&'static str> {
        let mut expected = self.plan.expected.clone();
        let is_faint = self.signal_left() < FAINT && self.family != Family::Nothing;
        for verdict in ["nothing_missing", "insufficient_data", "ambiguous"] {
            if is_faint && !expected.contains(&verdict) {
                expected.push(verdict);
            }
        }
        expected
    }
}

/// A drive and its recording.
struct Recorded {
    style: Style,
    top_speed: f64,
    track: Track,
    rows: Vec<Row>,
    signal: Signal,
    /// The truth's ingredients, as they were there.
    ingredients: Vec<Ingredient>,
}

/// Draws that bog down are drawn anew, this often.
const ATTEMPTS: usize = 200;

/// Draws in which less shows than the size promises are drawn anew, this often.
const HIDDEN: usize = 4;

/// Seconds that drives usually last, from and to.
const USUAL: [f64; 2] = [40.0, 90.0];

/// The `number`th case of a family; the same seed gives the same case.
///
/// # Errors
/// What is wrong with the last draw, where no draw can be driven.
pub fn generate(family: Family, number: usize, seed: u64) -> Result<Case, String> {
    generate_lasting(USUAL, family, number, seed)
}

/// The same with drives that last from and to so many seconds.
///
/// # Errors
/// What is wrong with the last draw, where no draw can be driven.
pub fn generate_lasting(
    lengths: [f64; 2],
    family: Family,
    number: usize,
    seed: u64,
) -> Result<Case, String> {
    let mut last = String::new();
    let mut hidden = None;
    let mut hidden_count = 0;
    let mut seeds = Random::new(seed.wrapping_add((number as u64) << 32), family.name());
    for _ in 0..ATTEMPTS {
        match attempt(lengths, family, number, seeds.seed()) {
            Ok(case) if case.is_plain_enough() => return Ok(case.measured()),
            // Kept, in case that none is plainer: some effects hide on nearly every ground.
            Ok(case) => {
                hidden = hidden.or(Some(case));
                hidden_count += 1;
                if hidden_count == HIDDEN {
                    break;
                }
            }
            Err(failure) => last = failure.to_string(),
        }
    }
    let hidden = hidden.map(Case::measured);
    hidden.ok_or_else(|| format!("{} {number}: {last}", family.name()))
}

fn attempt(lengths: [f64; 2], family: Family, number: usize, seed: u64) -> Result<Case, Failure> {
    let seconds = |random: &mut Random| {
        let [least, most] = lengths;
        (random.between(least, most) / STEP).round() * STEP
    };
    let of = |purpose: &str| Random::new(seed, purpose);
    let kind = of("kind").pick(&[0, 1, 2, 3, 4]);
    let (vehicle_name, vehicle) = ground::vehicle(kind, &mut of("vehicle"));
    let ground = ground::ground(&mut of("ground"));
    let plan = Plan::draw(family, number, &vehicle, &mut of("plan"));
    let sensors = Sensors::draw(&mut of("sensors"));
    let mut first = of("drive");
    let driver = Driver {
        vehicle: &vehicle,
        oversteer: oversteer(&vehicle, ground.truth)?,
        top_speed: top_speed(&vehicle, &mut first),
    };
    let faster = |factor: f64| Driver {
        top_speed: factor * driver.top_speed,
        ..driver
    };
    let mut start = somewhere(&mut first);
    if plan.rivals == ["drawbar"] && plan.ingredients[0].name == "grade" {
        // Up the slope or down: across it nothing resembles a drawbar's pull.
        start.heading = if first.chance(0.5) {
            0.0
        } else {
            std::f64::consts::PI
        };
    }
    let mut world = World {
        vehicle: vehicle.clone(),
        terrain: ground.truth,
        ingredients: plan.ingredients.clone(),
    };
    let wheels = commands(driver, plan.style, seconds(&mut first), &mut first);
    let without = World {
        ingredients: plan.ingredients.get(1..).unwrap_or_default().to_vec(),
        ..world.clone()
    };
    if plan.place != Place::Everywhere {
        let path = without.drive(start, &wheels)?;
        place(&mut world.ingredients[0], plan.place, &path, &mut first);
    }
    let faults = effects(plan.faults.iter());
    let record = |track, world: &World, style, top_speed, purpose: &str| Recorded {
        rows: sensors.record(&track, &faults, &mut of(purpose)),
        signal: Seen::new(&vehicle, ground.truth, &track, &sensors, &faults).signal(),
        ingredients: world.ingredients.clone(),
        style,
        top_speed,
        track,
    };
    let begin = match plan.place {
        Place::SecondDrive => &without,
        _ => &world,
    };
    let track = begin.drive(start, &wheels)?;
    let mut drives = vec![record(track, begin, plan.style, driver.top_speed, "noise")];
    if let Some(style) = plan.second {
        let mut second = of("second drive");
        let back = State {
            heading: start.heading + std::f64::consts::PI,
            ..start
        };
        let driver = faster(second.between(1.0, 1.3));
        let wheels = commands(driver, style, seconds(&mut second), &mut second);
        let track = world.drive(back, &wheels)?;
        drives.push(record(
            track,
            &world,
            style,
            driver.top_speed,
            "second noise",
        ));
    }
    let mut other = of("unseen drive");
    if [Place::Seconds, Place::SecondDrive].contains(&plan.place) {
        // What happened then does not happen again.
        world.ingredients.remove(0);
    }
    for one in &mut world.ingredients {
        if let Some(law) = &mut one.law {
            law.redraw(&mut other);
        }
    }
    let beyond = State {
        heading: other.between(-3.1, 3.1),
        ..start
    };
    let driver = faster(other.between(0.8, 1.15));
    let wheels = commands(driver, Style::Rich, seconds(&mut other), &mut other);
    let track = world.drive(beyond, &wheels)?;
    let unseen = record(track, &world, Style::Rich, driver.top_speed, "unseen noise");
    Ok(Case {
        family,
        seed,
        plan,
        vehicle_name,
        vehicle,
        ground,
        sensors,
        drives,
        unseen,
    })
}

/// What a driver learns in a few bends: how much more it takes to turn than without slip.
fn oversteer(vehicle: &Vehicle, terrain: Terrain) -> Result<f64, Failure> {
    const MOST: f64 = 4.0;
    let world = World {
        vehicle: vehicle.clone(),
        terrain,
        ingredients: Vec::new(),
    };
    let mut oversteer: f64 = 1.6;
    for _ in 0..3 {
        let (commands, wanted) = trial_bend(vehicle, oversteer);
        let track = world.drive(State::default(), &commands)?;
        let (late, end) = (track.at(track.duration() - 2.0), track.at(track.duration()));
        let turned = (end.heading - late.heading) / 2.0;
        oversteer = (oversteer * wanted / turned.max(0.25 * wanted)).clamp(1.0, MOST);
    }
    Ok(oversteer)
}

fn top_speed(vehicle: &Vehicle, random: &mut Random) -> f64 {
    let most = if vehicle.wheel_radius < 0.2 { 1.5 } else { 2.0 };
    if random.chance(0.2) {
        random.between(most, 1.5 * most)
    } else {
        random.between(0.6, most)
    }
}

fn somewhere(random: &mut Random) -> State {
    State {
        x: random.between(-20.0, 20.0),
        y: random.between(-20.0, 20.0),
        heading: random.between(-3.1, 3.1),
        ..State::default()
    }
}

/// Lets an ingredient act in a part of the drive in which the vehicle moves.
fn place(one: &mut Ingredient, place: Place, path: &Track, random: &mut Random) {
    let moving = |time: f64| {
        let state = path.at(time);
        state.v_x.hypot(state.v_y) > 0.2
    };
    let (from, to) = (0.15 * path.duration(), 0.85 * path.duration());
    let mut at = random.between(from, to);
    for _ in 0..100 {
        if moving(at - 1.0) && moving(at) && moving(at + 1.0) {
            break;
        }
        at = random.between(from, to);
    }
    let here = path.at(at);
    let round = |value: f64| (value * 100.0).round() / 100.0;
    match place {
        Place::Everywhere | Place::SecondDrive => {}
        Place::Seconds => {
            let half = random.between(2.0, 6.0);
            // The world changes at commands.
            let on_command = |time: f64| round((time / STEP).round() * STEP);
            let start = on_command((at - half).max(1.0));
            one.region = Region::Time(start, on_command(start + 2.0 * half));
        }
        Place::Patch => {
            one.region = Region::Disc(
                [round(here.x), round(here.y)],
                round(random.between(1.5, 4.0)),
            );
        }
        Place::Beyond => {
            let direction = round(here.heading + random.between(-0.6, 0.6));
            let direction = (direction + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
                - std::f64::consts::PI;
            let direction = round(direction);
            let position = here.x * direction.cos() + here.y * direction.sin();
            for (name, value) in [
                ("position", round(position)),
                ("direction", direction),
                ("transition", round(random.between(0.2, 1.0))),
            ] {
                one.parameters
                    .push((format!("terrain_change.{name}"), value));
            }
        }
    }
}
