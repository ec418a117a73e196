//! Made-up diagnoses, one for every verdict, with what a real one has: gaps, missing channels,
//! missing values, long series, several runs.

use ugv_terrain::diagnosis::{
    Account, Candidate, Channel, Diagnosis, Errors, Finding, HeldOut, Insufficient, Interval,
    Manoeuvre, PredictedPath, Quantity, ResidualTrace, RunTrace, Subject, Term, Verdict,
    WrenchTrace,
};
use ugv_terrain::effects::{CATALOGUE, Effects};
use ugv_terrain::fit::{
    Estimate, NoiseEstimate,
    noise::ChannelNoise,
    parameter::{ActsBy, FreeParameter, Prior, Scale},
    signal::NoiseGroup,
};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Specification, Vehicle};

/// All verdicts.
pub const VERDICTS: [Verdict; 6] = [
    Verdict::NothingMissing,
    Verdict::MissingPhysics,
    Verdict::Sensor,
    Verdict::Ambiguous,
    Verdict::UnknownPhysics,
    Verdict::InsufficientData,
];

/// The effect of a name.
pub fn effect(name: &str) -> Subject {
    let found = CATALOGUE.iter().position(|effect| effect.name == name);
    Subject::Effect(found.unwrap_or_else(|| panic!("no effect {name}")))
}

/// A made-up diagnosis of this verdict.
pub fn sample(verdict: Verdict) -> Diagnosis {
    let (findings, statement) = findings(verdict);
    let recordings: Vec<String> = match verdict {
        Verdict::Sensor => vec!["north_field_2024-05-17_afternoon".into(), "spirals".into()],
        _ => vec!["drive3".into()],
    };
    let mut runs = match verdict {
        Verdict::InsufficientData => Vec::new(),
        Verdict::UnknownPhysics => (0..6)
            .map(|index| run("drive3", index, 60.0, 9.0))
            .collect(),
        Verdict::Sensor => vec![
            run(&recordings[0], 0, 400.0, 40.0),
            run("spirals", 0, 30.0, 3.0),
        ],
        Verdict::NothingMissing => vec![run("drive3", 0, 90.0, 0.0)],
        _ => vec![run("drive3", 0, 90.0, 12.0)],
    };
    if verdict == Verdict::UnknownPhysics {
        for (index, run) in runs.iter_mut().enumerate() {
            run.label = (index + 1).to_string();
        }
        runs[2].wrench = None;
        runs[2].residuals.remove(0);
    }
    let nominal = Specification {
        vehicle: Vehicle::tran2007(),
        terrain: Terrain::preset("dry_sand").expect("a preset"),
        effects: Effects::default(),
    };
    Diagnosis {
        verdict,
        insufficient: (verdict == Verdict::InsufficientData).then_some(Insufficient::TooLittle),
        statement: statement.into(),
        cautions: Vec::new(),
        minor_doubts: Vec::new(),
        recordings,
        candidates: candidates(verdict, &findings),
        leading: (!findings.is_empty()).then_some(0),
        claims: Vec::new(),
        findings,
        held_out: (verdict != Verdict::InsufficientData).then(|| held_out(verdict)),
        soil: soil(verdict),
        next: next(verdict),
        runs,
        account: account(verdict),
        nominal: nominal.clone(),
        model: nominal,
    }
}

fn quantity(name: &str, value: f64, half: f64, unit: &'static str) -> Quantity {
    Quantity {
        name: name.into(),
        recording: None,
        value,
        low: value - half,
        high: value + half,
        off: 0.0,
        unit,
    }
}

fn place(start: f64, end: f64, channel: Channel, regime: &str) -> Interval {
    Interval {
        recording: "drive3".into(),
        run: 0,
        label: String::new(),
        start,
        end,
        channel,
        regime: regime.into(),
        patch: None,
    }
}

fn findings(verdict: Verdict) -> (Vec<Finding>, &'static str) {
    let finding = |subject, probability| Finding {
        subject,
        probability,
        ambiguous_with: Vec::new(),
        evidence: 88.0,
        rivals: vec![(subject, 88.0), (Subject::Unknown, 71.5)],
        parameters: Vec::new(),
        places: Vec::new(),
        local: false,
        law: Vec::new(),
        mended_by: Vec::new(),
        statement: String::new(),
    };
    match verdict {
        Verdict::NothingMissing => (
            Vec::new(),
            "The residuals of the refitted model are as large as chance makes them, 0.7 of the threshold.",
        ),
        Verdict::InsufficientData => (
            Vec::new(),
            "Only 3 s of 41 s are in motion with a pose: too little to hold anything out.",
        ),
        Verdict::MissingPhysics => {
            let mut patch = place(12.4, 31.0, Channel::Longitudinal, "heading 60..120 deg");
            patch.patch = Some([14.0, 6.5, 4.0]);
            let grade = Finding {
                parameters: vec![
                    quantity("slope_east", 0.031, 0.004, "rad"),
                    quantity("slope_north", -0.002, 0.005, "rad"),
                ],
                places: vec![patch, place(61.0, 64.2, Channel::Longitudinal, "")],
                local: true,
                statement: "From 12.4 s to 31.0 s the ground rises by 1.8 deg towards the east."
                    .into(),
                ..finding(effect("grade"), 0.962)
            };
            let payload = Finding {
                parameters: vec![
                    quantity("mass", 48.0, 11.0, "kg"),
                    quantity("ahead", 0.2, 0.3, "m"),
                    quantity("left", -0.01, 0.06, "m"),
                    quantity("height", 0.5, 0.3, "m"),
                ],
                places: vec![place(0.0, 90.0, Channel::Yaw, "turn rate over 0.4 rad/s")],
                statement: "A load of about 48 kg ahead of the centroid.".into(),
                ..finding(effect("payload"), 0.31)
            };
            (
                vec![grade, payload],
                "The ground rises by 1.8 deg towards the east between 12 s and 31 s; refitting the soil does \
                 not explain it.",
            )
        }
        Verdict::Sensor => {
            let pose = |recording: &str, value| Quantity {
                recording: Some(recording.into()),
                ..quantity("pose", value, 0.02, "s")
            };
            let mut place = place(0.0, 400.0, Channel::Measurement, "turn rate over 0.2 rad/s");
            place.recording = "north_field_2024-05-17_afternoon".into();
            let latency = Finding {
                parameters: vec![
                    pose("north_field_2024-05-17_afternoon", 0.21),
                    pose("spirals", 0.18),
                ],
                places: vec![place],
                statement: "The pose is reported 0.2 s late.".into(),
                ..finding(effect("latency"), 0.9993)
            };
            (
                vec![latency],
                "The pose trails the wheels by 0.2 s in both recordings.",
            )
        }
        Verdict::Ambiguous => {
            let multipass = Finding {
                ambiguous_with: vec![effect("drawbar"), effect("elastic_rebound")],
                parameters: vec![
                    quantity("memory", 0.7, 0.28, "1"),
                    quantity("stiffness_ratio", 12.0, 9.0, "1"),
                ],
                places: vec![place(
                    20.0,
                    45.0,
                    Channel::Longitudinal,
                    "speed over 1.2 m/s",
                )],
                statement: "A resistance along the vehicle is not the refitted model's.".into(),
                ..finding(effect("multipass"), 0.48)
            };
            (
                vec![multipass],
                "Something pushes along the vehicle; three candidates look alike on these recordings.",
            )
        }
        Verdict::UnknownPhysics => {
            let term = |channel, parameter: &str, group: &str, value, stability| Term {
                channel,
                parameter: parameter.into(),
                group: group.into(),
                coefficient: quantity(parameter, value, 0.006, "1"),
                stability,
            };
            let mut somewhere = place(10.0, 18.0, Channel::Lateral, "turn rate over 0.5 rad/s");
            somewhere.run = 4;
            let unknown = Finding {
                places: vec![somewhere, place(30.0, 40.0, Channel::Yaw, "slip over 0.2")],
                law: vec![
                    term(
                        Channel::Lateral,
                        "residual_lateral.speed_turning",
                        "u q",
                        -0.042,
                        0.98,
                    ),
                    term(
                        Channel::Lateral,
                        "residual_lateral.sideways",
                        "w|w|",
                        0.019,
                        0.81,
                    ),
                    term(
                        Channel::Yaw,
                        "residual_yaw.speed_turning",
                        "|u| q",
                        -0.027,
                        0.9,
                    ),
                    term(Channel::Yaw, "residual_yaw.constant", "1", 0.008, 0.66),
                ],
                statement: "A lateral force grows with speed times yaw rate.".into(),
                ..finding(Subject::Unknown, 0.87)
            };
            (
                vec![unknown],
                "A lateral force that grows with v times the yaw rate; no effect of the catalogue acts so.",
            )
        }
    }
}

fn candidates(verdict: Verdict, findings: &[Finding]) -> Vec<Candidate> {
    let probability = |subject: Subject| {
        let found = findings.iter().find(|finding| finding.subject == subject);
        found.map(|finding| finding.probability)
    };
    let sum: f64 = findings.iter().map(|finding| finding.probability).sum();
    let scale = if sum > 1.0 { 0.97 / sum } else { 1.0 };
    let nothing = if findings.is_empty() {
        0.91
    } else {
        0.2 * (1.0 - scale * sum)
    };
    let rest = (1.0 - nothing - scale * sum).max(0.0);
    let alike = |name: &str| match name {
        "multipass" => vec![(effect("drawbar"), 0.97), (effect("elastic_rebound"), 0.93)],
        "payload" => vec![(effect("com_shift"), 0.88)],
        _ => Vec::new(),
    };
    let ambiguous = ["drawbar", "elastic_rebound"];
    let effects = CATALOGUE.iter().enumerate().map(|(index, declared)| {
        let subject = Subject::Effect(index);
        let parameter = &declared.parameters[0];
        let found = probability(subject);
        let pair = verdict == Verdict::Ambiguous && ambiguous.contains(&declared.name);
        let other = if verdict == Verdict::Ambiguous {
            0.0
        } else {
            rest / 24.0
        };
        Candidate {
            subject,
            probability: found.map_or(if pair { 0.24 } else { other }, |p| scale * p),
            absorbed: (0.31 + 0.37 * index as f64) % 1.0,
            significance: if found.is_some() {
                4.2
            } else {
                0.2 + 0.03 * index as f64
            },
            smallest_detectable: if index % 6 == 5 {
                f64::INFINITY
            } else {
                0.02 * (parameter.high - parameter.low).min(500.0)
            },
            parameter: parameter.name,
            unit: parameter.unit,
            estimate: if index == 7 {
                f64::NAN
            } else {
                0.013 * (index as f64 - 4.0)
            },
            interval: [0.5 * index as f64, 1.5 * index as f64],
            held_out_gain: (found.is_some() || pair).then_some((0.212, 0.031)),
            alike: alike(declared.name),
        }
    });
    let mut all: Vec<Candidate> = effects.collect();
    let sum: f64 = all.iter().map(|candidate| candidate.probability).sum();
    let unknown =
        probability(Subject::Unknown).map_or((1.0 - nothing - sum).max(0.0), |p| scale * p);
    let nothing = 1.0 - unknown - sum;
    for (subject, probability) in [(Subject::Unknown, unknown), (Subject::Nothing, nothing)] {
        all.push(Candidate {
            subject,
            probability,
            absorbed: f64::NAN,
            significance: f64::NAN,
            smallest_detectable: f64::NAN,
            parameter: "",
            unit: "",
            estimate: f64::NAN,
            interval: [f64::NAN; 2],
            held_out_gain: None,
            alike: Vec::new(),
        });
    }
    all
}

fn held_out(verdict: Verdict) -> HeldOut {
    let errors = |position, heading, log_score| Errors {
        position,
        heading,
        yaw_rate: if verdict == Verdict::Sensor {
            0.021
        } else {
            f64::NAN
        },
        log_score,
    };
    HeldOut {
        nominal: errors(0.41, 0.05, -3.1),
        refitted: errors(0.30, 0.04, -2.2),
        augmented: errors(0.052, 0.0104, 1.9),
        gain: (4.1, 0.3),
        horizon: 5.0,
        stretches: 14,
    }
}

fn soil(verdict: Verdict) -> Vec<(Estimate, Estimate)> {
    if verdict == Verdict::InsufficientData {
        return Vec::new();
    }
    let estimate = |name: &str, unit, nominal: f64, factor: f64, ratio| Estimate {
        parameter: FreeParameter {
            name: name.into(),
            unit,
            scale: Scale::Log,
            acts_by: ActsBy::Coordinate,
            prior: Prior {
                median: nominal,
                deviation: 0.5,
            },
            low: 0.01 * nominal,
            high: 100.0 * nominal,
        },
        nominal,
        value: factor * nominal,
        low: (factor - 0.3 * ratio) * nominal,
        high: (factor + 0.4 * ratio) * nominal,
        posterior_prior_ratio: ratio,
    };
    [
        ("cohesion", "Pa", 1040.0, 0.31),
        ("friction_angle", "rad", 0.489, 0.12),
        ("frictional_modulus", "N/m^(n+2)", 1.528e6, 0.93),
        ("sinkage_exponent", "1", 1.1, 0.6),
        ("shear_modulus", "m", 0.025, 0.2),
    ]
    .map(|(name, unit, nominal, ratio)| {
        let of = |factor| estimate(name, unit, nominal, factor, ratio);
        (of(1.41), of(1.07))
    })
    .to_vec()
}

fn next(verdict: Verdict) -> Option<Manoeuvre> {
    let separates = match verdict {
        Verdict::Ambiguous => [effect("multipass"), effect("drawbar")],
        Verdict::InsufficientData => [effect("grade"), Subject::Nothing],
        _ => return None,
    };
    Some(Manoeuvre {
        name: "opposite_pass",
        description:
            "Drive 20 m straight at 1 m/s, turn on the spot, and come back beside the track.".into(),
        separates,
        separation: 6.3,
        compared: vec![
            ("opposite_pass", 6.3),
            ("slalom", 3.1),
            ("spiral", 2.2),
            ("pivot", 0.9),
            ("straight", 0.04),
        ],
    })
}

fn run(recording: &str, run: usize, seconds: f64, peak: f64) -> RunTrace {
    let count = (50.0 * seconds) as usize;
    let time: Vec<f64> = (0..count).map(|k| 0.02 * k as f64).collect();
    let noise = |k: usize, size: f64| size * ((k as f64 * 12.9898).sin() * 43758.5453).fract();
    // Strongest between 12.4 s and 31 s, without a kink.
    let bump = |t: f64| 1.0 / (1.0 + (-(t - 12.4)).exp()) / (1.0 + (t - 31.0).exp());
    let at = |t: &f64| {
        let (turn, reach) = (0.11 * t + run as f64, 12.0 + 3.0 * (0.05 * t).sin());
        [reach * turn.cos(), 0.7 * reach * (1.3 * turn).sin()]
    };
    let path = time.iter().map(at).collect();
    let predicted = time.chunks(375).map(|window| {
        let away = |share: f64| {
            let each = window.iter();
            let each = each.map(|t| (at(t), share * (t - window[0])));
            each.map(|([x, y], far)| [x + far, y - 0.5 * far]).collect()
        };
        PredictedPath {
            time: window.to_vec(),
            measured: window.iter().map(at).collect(),
            predicted: [0.2, 0.1, 0.01].map(away),
        }
    });
    let mut predicted: Vec<PredictedPath> = predicted.collect();
    // A model that cannot follow.
    predicted[0].predicted[0].clear();
    let mismatch = time
        .iter()
        .enumerate()
        .map(|(k, t)| 0.8 + noise(k, 0.5).abs() + peak * bump(*t))
        .collect();
    let residual = |channel, unit, size: f64| {
        let mut trace = ResidualTrace {
            channel,
            unit,
            time: time.iter().copied().step_by(5).collect(),
            errors: Default::default(),
        };
        for (k, t) in trace.time.iter().enumerate() {
            for (errors, share) in trace.errors.iter_mut().zip([0.5, 0.3, 0.0]) {
                errors.push(noise(k, size) + share * size * peak * bump(*t));
            }
        }
        // A gap.
        for k in 200..215.min(trace.time.len()) {
            trace
                .errors
                .iter_mut()
                .for_each(|errors| errors[k] = f64::NAN);
        }
        trace
    };
    let coarse: Vec<f64> = time.iter().copied().step_by(10).collect();
    let wrench = WrenchTrace {
        value: coarse
            .iter()
            .enumerate()
            .map(|(k, t)| {
                [
                    noise(k, 20.0) - 12.0 * peak * bump(*t),
                    noise(k + 1, 15.0),
                    noise(k + 2, 9.0),
                ]
            })
            .collect(),
        deviation: coarse.iter().map(|_| [24.0, 18.0, 11.0]).collect(),
        time: coarse,
    };
    RunTrace {
        recording: recording.into(),
        run,
        label: String::new(),
        time: time.clone(),
        path,
        mismatch,
        predicted,
        residuals: vec![
            residual("x", "m", 0.02),
            residual("y", "m", 0.02),
            residual("heading", "rad", 0.01),
            residual("yaw_rate", "rad/s", 0.03),
        ],
        wrench: Some(wrench),
    }
}

fn account(verdict: Verdict) -> Account {
    let noise = |group, white: f64| NoiseEstimate {
        recording: 0,
        group,
        noise: ChannelNoise {
            white,
            coloured: 1.7 * white,
            correlation_time: 0.8,
        },
        samples: 4500,
        rms: 2.1 * white,
        outliers: 0.013,
    };
    let few = verdict == Verdict::InsufficientData;
    Account {
        seed: 1,
        segments: if few { 1 } else { 18 },
        seconds: if few { 3.0 } else { 90.0 },
        used: vec![if few { 3.0 } else { 90.0 }],
        left_out: 38.2,
        noise: vec![
            noise(NoiseGroup::Position, 0.012),
            noise(NoiseGroup::Heading, 0.004),
            noise(NoiseGroup::YawRate, 0.011),
        ],
        overdispersion: 1.31,
        threshold: 3.42,
        refused: Vec::new(),
        steps: vec![
            ("fit", 3.2),
            ("screen", 1.1),
            ("locate", 4.8),
            ("name", 11.9),
        ],
        notes: if few {
            vec!["38 s were left out because the wheels stand still.".into()]
        } else {
            vec!["<drive3.json> does not mention the gyro; its noise was estimated.".into()]
        },
    }
}
