//! Vehicles, and grounds that are not what they are taken for.

use super::random::Random;
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::Vehicle;

/// A vehicle's mass and shape: mass, yaw inertia, wheel's radius and width, rows, half track,
/// offset and height of the centre of mass.
type Build = (f64, f64, f64, f64, &'static [f64], f64, f64, f64);

const BUILDS: [(&str, Build); 5] = [
    (
        "8x8_490kg",
        (
            490.0,
            309.43,
            0.25,
            0.246,
            &[0.915, 0.305, -0.305, -0.915],
            0.61,
            0.17,
            0.35,
        ),
    ),
    (
        "4x4_470kg",
        (470.0, 165.0, 0.3, 0.25, &[0.457, -0.457], 0.568, 0.0, 0.45),
    ),
    (
        "6x6_150kg",
        (
            150.0,
            32.0,
            0.19,
            0.16,
            &[0.48, 0.0, -0.48],
            0.40,
            0.02,
            0.28,
        ),
    ),
    (
        "4x4_75kg",
        (75.0, 6.5, 0.15, 0.12, &[0.27, -0.27], 0.29, 0.01, 0.2),
    ),
    (
        "6x6_1800kg",
        (
            1800.0,
            2100.0,
            0.42,
            0.36,
            &[1.15, 0.0, -1.15],
            0.88,
            0.05,
            0.75,
        ),
    ),
];

/// The vehicle of a kind by its number; all but the paper's vary a little.
pub fn vehicle(kind: usize, random: &mut Random) -> (&'static str, Vehicle) {
    let (name, (mass, inertia, radius, width, rows, half_track, offset, height)) =
        BUILDS[kind % BUILDS.len()];
    let spread = if kind.is_multiple_of(BUILDS.len()) {
        0.0
    } else {
        0.05
    };
    let mut vary = |value: f64, digits: f64| {
        (value * (spread * random.normal()).exp() * digits).round() / digits
    };
    let loaded = vary(mass, 1.0);
    let vehicle = Vehicle {
        mass: loaded,
        yaw_inertia: vary(inertia * loaded / mass, 100.0),
        wheel_radius: radius,
        wheel_width: width,
        row_positions: rows.to_vec(),
        half_track: vary(half_track, 1000.0),
        com_offset: offset,
        com_height: vary(height, 100.0),
    };
    (name, vehicle)
}

/// A ground as somebody takes it for, and as it is.
pub struct Ground {
    pub name: String,
    pub nominal: Terrain,
    pub truth: Terrain,
}

fn factor(random: &mut Random, deviation: f64) -> f64 {
    // Beyond two and a half deviations is another soil.
    (deviation * random.normal().clamp(-2.5, 2.5)).exp()
}

/// One of the paper's terrains, or one between two of them; the truth is off in every parameter.
pub fn ground(random: &mut Random) -> Ground {
    let preset = |name| Terrain::preset(name).expect("one of the paper's");
    let first = random.pick(&Terrain::PRESETS);
    let (name, nominal) = if random.chance(0.6) {
        (first.to_owned(), preset(first))
    } else {
        let others = Terrain::PRESETS.map(|name| (name, f64::from(u8::from(name != first))));
        let second = random.weighted(&others);
        let share = random.between(0.2, 0.8);
        let mixed = mix(&preset(first), &preset(second), share);
        (format!("{first}..{second} {share:.2}"), mixed)
    };
    let truth = Terrain {
        cohesion: nominal.cohesion * factor(random, 0.4),
        friction_angle: nominal.friction_angle
            + (3.0 * random.normal().clamp(-2.0, 2.0)).to_radians(),
        cohesive_modulus: nominal.cohesive_modulus * factor(random, 0.4),
        frictional_modulus: nominal.frictional_modulus * factor(random, 0.4),
        sinkage_exponent: nominal.sinkage_exponent * factor(random, 0.1),
        shear_modulus: nominal.shear_modulus * factor(random, 0.4),
    };
    Ground {
        name,
        nominal,
        truth,
    }
}

/// Between two soils: geometrically, the friction angle linearly.
fn mix(first: &Terrain, second: &Terrain, share: f64) -> Terrain {
    let between = |a: f64, b: f64| a.powf(1.0 - share) * b.powf(share);
    let short = |value: f64| {
        let digits = 10f64.powi(2 - value.abs().log10().floor() as i32);
        (value * digits).round() / digits
    };
    let degrees =
        first.friction_angle_degrees() * (1.0 - share) + second.friction_angle_degrees() * share;
    Terrain {
        cohesion: short(between(first.cohesion, second.cohesion)),
        friction_angle: (degrees.round()).to_radians(),
        cohesive_modulus: short(between(first.cohesive_modulus, second.cohesive_modulus)),
        frictional_modulus: short(between(first.frictional_modulus, second.frictional_modulus)),
        sinkage_exponent: short(between(first.sinkage_exponent, second.sinkage_exponent)),
        shear_modulus: short(between(first.shear_modulus, second.shear_modulus)),
    }
}
