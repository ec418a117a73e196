//! What is left out in a case, and what a right answer is.

use super::draw::{SIZE_COUNT, ingredient, with_switches};
use super::family::Family;
use super::law::{Law, LawKind};
use super::manoeuvres::Style;
use super::random::Random;
use super::world::{Ingredient, Region};
use ugv_terrain::effects::{CATALOGUE, EffectKind as Of};
use ugv_terrain::vehicle::Vehicle;

/// Where the first ingredient acts, to be found once the path is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    Everywhere,
    /// In some seconds of the drive.
    Seconds,
    /// In the second of two drives.
    SecondDrive,
    /// On a patch that the drive passes.
    Patch,
    /// Beyond a line across the path.
    Beyond,
}

/// A case before anything is driven.
#[derive(Debug, Clone)]
pub struct Plan {
    /// More on the family: the look-alikes' names, the drive's style.
    pub variant: String,
    /// Physics, and forces outside of the catalogue.
    pub ingredients: Vec<Ingredient>,
    /// What the sensors do.
    pub faults: Vec<Ingredient>,
    pub place: Place,
    pub style: Style,
    /// Style of a second recording, driven the other way round, to be diagnosed with the first.
    pub second: Option<Style>,
    /// Effects that these data may not tell from the true one.
    pub rivals: Vec<&'static str>,
    /// Verdicts that are right.
    pub expected: Vec<&'static str>,
}

/// Pairs that do not resemble each other, with the switches that are on.
const PAIRS: [[(&str, &str); 2]; 12] = [
    [("drawbar", "force"), ("left_right_soil", "ratio")],
    [("grade", "slope_east"), ("bulldozing", "lateral")],
    [("com_shift", "left"), ("drag", "coefficient")],
    [("slip_sinkage", "sinkage_growth"), ("grade", "slope_north")],
    [("wheel_radius", "left"), ("latency", "pose")],
    [("grade", "slope_north"), ("lever_arm", "ahead")],
    [("shear_anisotropy", "strength_ratio"), ("drawbar", "force")],
    [("left_right_soil", "ratio"), ("latency", "pose")],
    [("rate_dependent_soil", "lateral"), ("grade", "slope_east")],
    [("yaw_rate_bias", "bias"), ("left_right_soil", "ratio")],
    [("tyre_compliance", "pressure"), ("grade", "slope_north")],
    [("multipass", "memory"), ("com_shift", "ahead")],
];

/// An effect with its switch.
type Named = (&'static str, &'static str);

/// The true effect, the one that it resembles, the drive on which it does, and whether the second
/// drive must do more than go the other way round.
const LOOKALIKES: [(Named, Named, Style); 8] = [
    (
        ("drag", "coefficient"),
        ("rate_dependent_soil", "forward"),
        Style::Steady,
    ),
    (
        ("rate_dependent_soil", "forward"),
        ("drag", "coefficient"),
        Style::Steady,
    ),
    (
        ("multipass", "memory"),
        ("drawbar", "force"),
        Style::StraightVaried,
    ),
    (("drawbar", "force"), ("multipass", "memory"), Style::Gentle),
    (
        ("grade", "slope_east"),
        ("drawbar", "force"),
        Style::StraightVaried,
    ),
    (("payload", "mass"), ("com_shift", "ahead"), Style::Gentle),
    (
        ("bulldozing", "lateral"),
        ("shear_anisotropy", "strength_ratio"),
        Style::Gentle,
    ),
    (
        ("latency", "pose"),
        ("lever_arm", "ahead"),
        Style::StraightVaried,
    ),
];

const SENSOR_FAULTS: [Named; 5] = [
    ("latency", "pose"),
    ("lever_arm", ""),
    ("yaw_rate_bias", "bias"),
    ("heading_offset", "offset"),
    ("latency", "wheels"),
];

/// What one drive has and another one has not.
const OF_ONE_DRIVE: [Named; 3] = [
    ("drawbar", "force"),
    ("grade", "slope_east"),
    ("payload", "mass"),
];

const LOCAL: [&str; 5] = ["drawbar", "grade", "push", "left_right_soil", "drag"];

const POOR: [&str; 6] = [
    "grade",
    "bulldozing",
    "drawbar",
    "payload",
    "slip_sinkage",
    "left_right_soil",
];

/// Strengths of laws by size.
const STRENGTHS: [(&str, f64); SIZE_COUNT] = [("small", 0.15), ("medium", 0.5), ("large", 1.4)];

/// The physics of the catalogue that acts throughout and has a name.
fn physics() -> Vec<&'static str> {
    let all = CATALOGUE.iter().filter(|effect| effect.kind == Of::Physics);
    all.map(|effect| effect.name)
        .filter(|name| *name != "terrain_change" && !name.starts_with("residual_"))
        .collect()
}

fn of_law(kind: LawKind, size: usize, vehicle: &Vehicle, random: &mut Random) -> Ingredient {
    let (name, strength) = STRENGTHS[size];
    let strength = strength * random.scaled(0.85, 1.18);
    Ingredient {
        name: kind.name(),
        size: name,
        parameters: Vec::new(),
        law: Some(Law::draw(kind, strength, vehicle, random)),
        region: Region::Always,
    }
}

impl Plan {
    fn plain(expected: &[&'static str]) -> Self {
        Self {
            variant: String::new(),
            ingredients: Vec::new(),
            faults: Vec::new(),
            place: Place::Everywhere,
            style: Style::Rich,
            second: None,
            rivals: Vec::new(),
            expected: expected.to_vec(),
        }
    }

    /// Puts an effect where it belongs: to the physics or the sensors.
    fn add(&mut self, one: Ingredient) {
        let effect = CATALOGUE.iter().find(|effect| effect.name == one.name);
        match effect.map(|effect| effect.kind) {
            Some(Of::Measurement) => self.faults.push(one),
            _ => self.ingredients.push(one),
        }
    }

    /// The `number`th case of a family.
    pub fn draw(family: Family, number: usize, vehicle: &Vehicle, random: &mut Random) -> Self {
        // Every size comes up with every thing.
        let turn = |things: usize| {
            let (which, round) = (number % things, number / things);
            (which, (which + round) % SIZE_COUNT)
        };
        match family {
            Family::Nothing => Self::plain(&["nothing_missing"]),
            Family::Single => {
                let physics = physics();
                let (which, size) = turn(physics.len());
                let mut plan = Self::plain(&["missing_physics"]);
                plan.add(ingredient(physics[which], size, vehicle, random));
                plan
            }
            Family::Sensor => {
                let (which, size) = turn(SENSOR_FAULTS.len());
                let mut plan = Self::plain(&["sensor"]);
                let (name, switch) = SENSOR_FAULTS[which];
                plan.add(if switch.is_empty() {
                    ingredient(name, size, vehicle, random)
                } else {
                    with_switches(name, &[switch], size, vehicle, random)
                });
                plan
            }
            Family::Local => Self::local(number, vehicle, random),
            Family::OneDrive => {
                let mut plan = Self::plain(&["missing_physics"]);
                let (name, switch) = OF_ONE_DRIVE[number % OF_ONE_DRIVE.len()];
                plan.add(with_switches(name, &[switch], 2, vehicle, random));
                plan.second = Some(Style::Rich);
                plan.place = Place::SecondDrive;
                plan
            }
            Family::Pair => {
                let mut plan = Self::plain(&["missing_physics"]);
                for (name, switch) in PAIRS[number % PAIRS.len()] {
                    let size = random.pick(&[1, 2]);
                    plan.add(with_switches(name, &[switch], size, vehicle, random));
                }
                if !plan.faults.is_empty() {
                    plan.expected.push("sensor");
                }
                plan
            }
            Family::Lookalike => Self::lookalike(number, vehicle, random),
            Family::Out => {
                let (which, size) = turn(LawKind::LASTING.len());
                let mut plan = Self::plain(&["unknown_physics"]);
                plan.add(of_law(LawKind::LASTING[which], size, vehicle, random));
                plan
            }
            Family::TerrainChange => {
                let switches = ["cohesion", "friction", "stiffness", "shear_modulus"];
                let on: Vec<String> = switches
                    .iter()
                    .filter(|_| random.chance(0.7))
                    .chain(&switches[1..2])
                    .map(|name| format!("{name}_factor"))
                    .collect();
                let on: Vec<&str> = on.iter().map(String::as_str).collect();
                // A small change seldom shows.
                let size = [1, 2, 1, 2, 0][number % 5];
                let mut plan = Self::plain(&["missing_physics"]);
                plan.place = Place::Beyond;
                plan.add(with_switches("terrain_change", &on, size, vehicle, random));
                plan
            }
            Family::Poor => {
                let mut plan = Self::plain(&["insufficient_data", "ambiguous", "nothing_missing"]);
                plan.style = [Style::Straight, Style::GentleCurve][number / 2 % 2];
                if !number.is_multiple_of(2) {
                    let name = POOR[number / 2 % POOR.len()];
                    plan.add(ingredient(name, 1, vehicle, random));
                }
                plan.variant = plan.style.name().into();
                plan
            }
        }
    }

    fn local(number: usize, vehicle: &Vehicle, random: &mut Random) -> Self {
        let name = LOCAL[number % LOCAL.len()];
        let round = number / LOCAL.len();
        let size = [2, 1, 2, 0][(number + round) % 4];
        let mut plan = Self::plain(&["missing_physics"]);
        // A push is nothing of the map's.
        plan.place = if name != "push" && (number + round).is_multiple_of(3) {
            Place::Patch
        } else {
            Place::Seconds
        };
        plan.variant = match plan.place {
            Place::Patch => "patch".into(),
            _ => "seconds".into(),
        };
        if name == "push" {
            plan.expected = vec!["unknown_physics"];
            plan.add(of_law(LawKind::Push, size, vehicle, random));
        } else {
            plan.add(ingredient(name, size, vehicle, random));
        }
        plan
    }

    fn lookalike(number: usize, vehicle: &Vehicle, random: &mut Random) -> Self {
        let ((name, switch), (rival, _), style) = LOOKALIKES[number / 2 % LOOKALIKES.len()];
        let mut plan = Self::plain(&["ambiguous", "missing_physics", "sensor"]);
        plan.style = style;
        plan.rivals = vec![rival];
        let other = number.is_multiple_of(2) == (number / 16).is_multiple_of(2);
        plan.variant = format!("{name}/{rival}, one recording");
        if other {
            plan.second = Some(Style::Rich);
            plan.variant = format!("{name}/{rival}, two recordings");
            plan.expected.remove(0);
        }
        plan.add(with_switches(name, &[switch], 2, vehicle, random));
        plan
    }
}
