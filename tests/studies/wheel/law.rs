//! Laws of contact, the paper's or with effects, and what each predicts of a trial.

use super::data::{Plate, RADIUS, Trial, WIDTH};
use fearless_simd::Level;
use ugv_terrain::contact::{
    Detail, Regularisation, Resolution, Wheel, WheelContact, WheelForces, WheelLaw, WheelMemory,
    WheelMotion,
};
use ugv_terrain::effects::{
    Bulldozing, Declaration, ElasticRebound, ShearAnisotropy, SlipSinkage, Soil, StressPeak,
    whole_slip,
};

/// Unit weight of the sand \[N/m^3\]: 1330 kg/m^3, of the authors of the data.
pub const UNIT_WEIGHT: f64 = 1330.0 * 9.81;
/// Depth \[m\] at which the pressure of the soil is a parameter instead of k: k has the unit of
/// its exponent and cannot be told apart from it, the pressure can.
pub const DEPTH: f64 = 0.020;
/// Believed deviation of ln p(20 mm) from what plates say: a rolling wheel is no plate.
const PRESSURE_DEVIATION: f64 = 0.3;
/// The speeds at which a vehicle's laws are smoothed are those at which this wheel travels.
const SMOOTHING: Regularisation = Regularisation {
    slip_speed: 1e-6,
    angular_speed: 1e-4,
    travel_speed: 1e-5,
};
/// Entry angles that are tried: from hardly any contact to a wheel buried up to its axle.
const ENTRY: [f64; 2] = [0.02, 1.56];
const SEARCH_STEPS: usize = 16;
/// Of the balance of the load \[N\]; differences for the slopes of a fit need it this small.
const LOAD_TOLERANCE: f64 = 1e-10;
/// Strips of a flank whose integral is not the library's.
const STRIPS: usize = 64;

/// A parameter of a fit.
#[derive(Debug, Clone)]
pub struct Parameter {
    pub name: String,
    pub unit: &'static str,
    pub low: f64,
    pub high: f64,
    pub start: f64,
    /// Whether the fit moves its logarithm.
    pub logarithmic: bool,
    /// Mean and deviation of what the fit moves.
    pub prior: Option<(f64, f64)>,
}

/// An effect of the catalogue, or a part of one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    Bulldozing,
    /// `slip_sinkage` with S alone.
    SinkageGrowth,
    /// `slip_sinkage` with n1 alone.
    ExponentGrowth,
    Anisotropy,
    Peak,
    Rebound,
}

impl Effect {
    pub const ALL: [Self; 6] = [
        Self::Bulldozing,
        Self::SinkageGrowth,
        Self::ExponentGrowth,
        Self::Anisotropy,
        Self::Peak,
        Self::Rebound,
    ];

    /// What the catalogue declares, and which parameters are fitted.
    fn parts(self) -> (&'static Declaration, &'static [&'static str]) {
        match self {
            Self::Bulldozing => (&Bulldozing::<f64>::DECLARATION, &["lateral", "frontal"]),
            Self::SinkageGrowth => (&SlipSinkage::<f64>::DECLARATION, &["sinkage_growth"]),
            Self::ExponentGrowth => (&SlipSinkage::<f64>::DECLARATION, &["exponent_growth"]),
            Self::Anisotropy => (
                &ShearAnisotropy::<f64>::DECLARATION,
                &["modulus_ratio", "strength_ratio"],
            ),
            Self::Peak => (&StressPeak::<f64>::DECLARATION, &["a0", "a1"]),
            Self::Rebound => (&ElasticRebound::<f64>::DECLARATION, &["share"]),
        }
    }

    pub fn name(self) -> String {
        match self {
            Self::SinkageGrowth => "`slip_sinkage`, S".into(),
            Self::ExponentGrowth => "`slip_sinkage`, n1".into(),
            _ => format!("`{}`", self.parts().0.name),
        }
    }
}

/// How the sinkage grows with slip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Growth {
    /// As in the library: (1 + S s)/(1 - S s/2), s along and across.
    Library,
    /// 1 + S s, s along and across.
    Linear,
    /// 1 + S abs(i), i along only.
    LinearAlong,
    /// (1 + S abs(i))/(1 - S abs(i)/2), i along only.
    LyaskoAlong,
}

/// How wide the blades of a flank are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flank {
    /// As in the library: r cos(theta) dtheta.
    Library,
    /// (r - h cos(theta)) dtheta, as Ishigami et al. have it.
    Ishigami,
}

/// A law with the parameters that are fitted.
#[derive(Debug, Clone)]
pub struct Law {
    pub effects: Vec<Effect>,
    pub growth: Growth,
    pub flank: Flank,
    pub parameters: Vec<Parameter>,
}

/// What a law says of a trial.
#[derive(Debug, Clone, Copy)]
pub struct Prediction {
    /// Traction and side force \[N\], sinkage \[m\].
    pub values: [f64; 3],
    /// Load that no sinkage up to the axle carries \[N\].
    pub uncarried: f64,
}

impl Law {
    pub fn new(effects: &[Effect], plates: &[Plate]) -> Self {
        let believed = Believed::from_plates(plates);
        let soil = |name: &str, unit, [low, high]: [f64; 2], start, logarithmic, prior| Parameter {
            name: name.into(),
            unit,
            low,
            high,
            start,
            logarithmic,
            prior,
        };
        let pressure = believed.log_pressure;
        let mut parameters = vec![
            soil("cohesion c", "Pa", [1.0, 5e3], 300.0, true, None),
            soil("friction angle phi", "deg", [10.0, 50.0], 30.0, false, None),
            soil(
                "p(20 mm)",
                "kPa",
                [1.0, 300.0],
                pressure.0.exp(),
                true,
                Some(pressure),
            ),
            soil(
                "exponent n",
                "1",
                [0.4, 2.5],
                believed.exponent.0,
                false,
                Some(believed.exponent),
            ),
            soil("shear modulus K", "mm", [0.3, 80.0], 10.0, true, None),
        ];
        for effect in effects {
            let (declaration, names) = effect.parts();
            for part in declaration
                .parameters
                .iter()
                .filter(|part| names.contains(&part.name))
            {
                parameters.push(Parameter {
                    name: format!("{}.{}", declaration.name, part.name),
                    unit: part.unit,
                    low: part.low,
                    high: part.high,
                    start: part.default + 0.1 * (part.high - part.default),
                    logarithmic: false,
                    prior: None,
                });
            }
        }
        Self {
            effects: effects.to_vec(),
            growth: Growth::Library,
            flank: Flank::Library,
            parameters,
        }
    }

    /// The paper's law, or its effects.
    pub fn name(&self) -> String {
        let names: Vec<String> = self.effects.iter().map(|effect| effect.name()).collect();
        let both = self.has(Effect::SinkageGrowth) && self.has(Effect::ExponentGrowth);
        match names.join(" + ") {
            name if name.is_empty() => "the paper's law".into(),
            name if both => name
                .replacen(", S", ", S and n1", 1)
                .replace(" + `slip_sinkage`, n1", ""),
            name => name,
        }
    }

    fn has(&self, effect: Effect) -> bool {
        self.effects.contains(&effect)
    }

    fn value(&self, values: &[f64], name: &str) -> Option<f64> {
        let place = self
            .parameters
            .iter()
            .position(|parameter| parameter.name == name);
        place.map(|place| values[place])
    }

    fn wheel(&self, values: &[f64], trial: &Trial) -> WheelLaw<f64> {
        let [cohesion, angle, pressure, exponent, shear] = [0, 1, 2, 3, 4].map(|at| values[at]);
        let or = |name: &str, off: f64| self.value(values, name).unwrap_or(off);
        let mut soil = Soil {
            cohesion,
            friction: angle.to_radians().tan(),
            modulus: 1e3 * pressure / DEPTH.powf(exponent),
            exponent,
            shear_modulus: 1e-3 * shear,
        };
        let mut slip_sinkage = (self.has(Effect::SinkageGrowth)
            || self.has(Effect::ExponentGrowth))
        .then(|| SlipSinkage {
            exponent_growth: or("slip_sinkage.exponent_growth", 0.0),
            sinkage_growth: or("slip_sinkage.sinkage_growth", 0.0),
        });
        if let (Some(effect), true) = (slip_sinkage, self.growth != Growth::Library) {
            let (forward, lateral) = trial.velocity();
            let across = if self.growth == Growth::Linear {
                lateral
            } else {
                0.0
            };
            let slip = whole_slip(
                RADIUS * trial.omega,
                forward,
                across,
                SMOOTHING.travel_speed,
            );
            let grown = 1.0 + effect.sinkage_growth * slip;
            let deeper = match self.growth {
                Growth::LyaskoAlong => grown / (1.0 - 0.5 * effect.sinkage_growth * slip),
                _ => grown,
            };
            soil.modulus /= deeper.powf(exponent);
            slip_sinkage = None;
        }
        let lateral = or("bulldozing.lateral", 0.0);
        WheelLaw {
            rebound: or("elastic_rebound.share", 0.0),
            modulus_ratio: or("shear_anisotropy.modulus_ratio", 1.0),
            strength_ratio: or("shear_anisotropy.strength_ratio", 1.0),
            peak: self.has(Effect::Peak).then(|| StressPeak {
                a0: or("stress_peak.a0", 0.5),
                a1: or("stress_peak.a1", 0.0),
            }),
            slip_sinkage,
            bulldozing: self.has(Effect::Bulldozing).then(|| Bulldozing {
                lateral: if self.flank == Flank::Library {
                    lateral
                } else {
                    0.0
                },
                frontal: or("bulldozing.frontal", 0.0),
                unit_weight: UNIT_WEIGHT,
            }),
            ..WheelLaw::paper(soil, RADIUS, WIDTH)
        }
    }

    /// The flank's force as Ishigami et al. have it \[N\], which is not in the library.
    fn ishigami(&self, values: &[f64], wheel: &WheelLaw<f64>, trial: &Trial, entry: f64) -> f64 {
        let (Flank::Ishigami, Some(effect)) = (self.flank, &wheel.bulldozing) else {
            return 0.0;
        };
        let strength = self.value(values, "bulldozing.lateral").unwrap_or(0.0);
        let exit = -wheel.rebound * entry;
        let step = (entry - exit) / STRIPS as f64;
        let strip = |place: usize| {
            let theta = exit + (place as f64 + 0.5) * step;
            let depth = RADIUS * (theta.cos() - entry.cos());
            effect.blade_resistance(&wheel.soil, depth) * (RADIUS - depth * theta.cos()) * step
        };
        -strength * trial.beta.sin() * (0..STRIPS).map(strip).sum::<f64>()
    }
}

/// What the plates say of the soil under the wheel: mean and deviation.
#[derive(Debug)]
pub struct Believed {
    /// ln(p(20 mm) / kPa): a straight line over the logarithm of the plates' diameters, at the
    /// wheel's width.
    pub log_pressure: (f64, f64),
    /// Mean of the plates, and twice their deviation.
    pub exponent: (f64, f64),
}

impl Believed {
    pub fn from_plates(plates: &[Plate]) -> Self {
        let mean = |value: &dyn Fn(&Plate) -> f64| {
            plates.iter().map(value).sum::<f64>() / plates.len() as f64
        };
        let exponent = mean(&|plate| plate.exponent);
        let deviation = mean(&|plate| (plate.exponent - exponent).powi(2)).sqrt();
        let size = |plate: &Plate| (plate.diameter / WIDTH).ln();
        let pressure = |plate: &Plate| (1e-3 * plate.modulus * DEPTH.powf(plate.exponent)).ln();
        let (sizes, pressures) = (mean(&size), mean(&pressure));
        let together = mean(&|plate| (size(plate) - sizes) * (pressure(plate) - pressures));
        let slope = together / mean(&|plate| (size(plate) - sizes).powi(2));
        Self {
            log_pressure: (pressures - slope * sizes, PRESSURE_DEVIATION),
            exponent: (exponent, 2.0 * deviation),
        }
    }
}

/// The rig that pulls the wheel.
pub struct Rig {
    contact: WheelContact,
    level: Level,
    detail: Detail,
}

impl Rig {
    pub fn new(detail: Detail) -> Self {
        let contact = WheelContact::new(SMOOTHING, Resolution::default());
        Self {
            contact: contact.expect("a wheel on sand"),
            level: Level::new(),
            detail,
        }
    }

    /// What a law says of a trial, at the entry angle that carries the measured load.
    pub fn predict(&self, law: &Law, values: &[f64], trial: &Trial) -> Prediction {
        let wheel = law.wheel(values, trial);
        let (forward, lateral) = trial.velocity();
        let motion = WheelMotion {
            forward,
            lateral,
            yaw_rate: 0.0,
            angular_speed: trial.omega,
        };
        let forces = |entry: f64| -> WheelForces<f64> {
            let wheel = Wheel {
                motion,
                reach: entry,
                memory: WheelMemory::NONE,
                law: wheel,
            };
            self.contact.forces(self.level, &wheel, self.detail)
        };
        let entry = first_balance(|entry| forces(entry).vertical - trial.load);
        let found = forces(entry);
        Prediction {
            values: [
                found.thrust - found.compaction,
                found.lateral + law.ishigami(values, &wheel, trial, entry),
                RADIUS * (1.0 - entry.cos()),
            ],
            uncarried: (trial.load - found.vertical).max(0.0),
        }
    }
}

/// The smallest entry angle at which a load is carried, or the deepest where none does: a wheel
/// that is dragged may be drawn down more by the shear than the soil pushes it up.
fn first_balance(excess: impl Fn(f64) -> f64) -> f64 {
    let [mut low, deepest] = ENTRY;
    let mut below = excess(low);
    if below >= 0.0 {
        return low;
    }
    for step in 1..=SEARCH_STEPS {
        let mut high = ENTRY[0] + (deepest - ENTRY[0]) * step as f64 / SEARCH_STEPS as f64;
        let mut above = excess(high);
        if above < 0.0 {
            (low, below) = (high, above);
            continue;
        }
        // Regula falsi; an end that stays twice loses half its weight (Illinois).
        let mut last = 0.0;
        for _ in 0..60 {
            let middle = (low * above - high * below) / (above - below);
            let at = excess(middle);
            if at.abs() < LOAD_TOLERANCE || high - low < 1e-13 {
                return middle;
            }
            if at < 0.0 {
                (low, below) = (middle, at);
                above *= if last < 0.0 { 0.5 } else { 1.0 };
            } else {
                (high, above) = (middle, at);
                below *= if last > 0.0 { 0.5 } else { 1.0 };
            }
            last = at;
        }
        return 0.5 * (low + high);
    }
    deepest
}
