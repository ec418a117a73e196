//! The FMU, stepped by fmpy, gives the bits of the native library: on every terrain, with steps
//! of every size, with states saved and restored in one process and taken along into another.

use crate::support;
use crate::support::outputs;
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use ugv_terrain::declaration::{Causality, Configuration, Variable, variables};
use ugv_terrain::effects::Effects;
use ugv_terrain::simulation::{Simulation, State, WheelSpeeds};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Specification, Vehicle, VehicleModel};

/// Step sizes \[s\], taken in turn: from 0.1 ms to 100 ms, most of them no binary fractions.
const STEPS: [f64; 9] = [
    1e-4,
    3.7e-3,
    0.05,
    1e-3,
    0.1,
    2e-4,
    1.0 / 30.0,
    0.01,
    0.007_812_5,
];

/// How the wheel speeds get where a phase wants them.
#[derive(Clone, Copy, PartialEq)]
enum How {
    /// At once.
    Jump,
    /// By input derivatives alone.
    Rates,
    /// By input derivatives, each step beginning with speeds that are set.
    RatesAndSpeeds,
}

/// Left and right wheel speed \[rad/s\] at the end of so many seconds.
type Phase = (f64, [f64; 2], How);

/// The first half of a drive: from rest to speed, a turn, braking to rest.
const BEFORE: [Phase; 6] = [
    (0.05, [0.0, 0.0], How::Jump),
    (1.0, [6.0, 6.0], How::Rates),
    (0.8, [8.0, 5.0], How::RatesAndSpeeds),
    (0.4, [8.0, 5.0], How::Jump),
    (0.5, [0.0, 0.0], How::Rates),
    (0.5, [0.0, 0.0], How::Jump),
];

/// What happens between a save and the return to it.
const DETOUR: [Phase; 2] = [
    (0.2, [-4.0, 7.0], How::Jump),
    (0.2, [20.0, 21.0], How::Rates),
];

/// The second half, mostly in another process: a pivot, reverse, at speed, to rest at once.
const AFTER: [Phase; 5] = [
    (0.5, [-3.0, 3.0], How::Jump),
    (1.0, [-5.0, -6.0], How::RatesAndSpeeds),
    (0.4, [10.0, 9.5], How::Jump),
    (0.3, [18.0, 20.0], How::Rates),
    (0.3, [0.0, 0.0], How::Jump),
];

/// A model as the FMU is told of it and as the library knows it.
struct Case {
    name: &'static str,
    model: Specification,
    initial: State,
    /// Start values of the FMU that make it the same.
    start: Value,
}

/// The drive as the FMU and the library make it, step by step.
struct Drive {
    simulation: Simulation,
    variables: Vec<Variable>,
    saved: Option<Simulation>,
    steps: usize,
    /// What the FMU is told to do, and what it should answer.
    operations: Vec<Value>,
    expected: Vec<Vec<f64>>,
}

impl Drive {
    fn new(case: &Case) -> Self {
        let model = VehicleModel::from_specification(&case.model).unwrap();
        let mut simulation = Simulation::new(model);
        simulation.set_state(case.initial).unwrap();
        let read = |v: &Variable| v.attributes.causality != Causality::Parameter;
        let configuration = Configuration::from_specification(case.model.clone());
        let mut drive = Self {
            simulation,
            variables: variables(&configuration).into_iter().filter(read).collect(),
            saved: None,
            steps: 0,
            operations: Vec::new(),
            expected: Vec::new(),
        };
        drive.tell(json!(["start", case.start]));
        drive.read();
        drive
    }

    fn tell(&mut self, operation: Value) {
        self.operations.push(operation);
    }

    fn read(&mut self) {
        let simulation = &mut self.simulation;
        let mut row = vec![simulation.time()];
        row.extend(outputs::values(simulation, &self.variables));
        self.expected.push(row);
    }

    fn phases(&mut self, phases: &[Phase]) {
        for (duration, target, how) in phases {
            self.phase(*duration, *target, *how);
        }
    }

    fn phase(&mut self, duration: f64, [left, right]: [f64; 2], how: How) {
        let target = WheelSpeeds { left, right };
        let from = self.simulation.wheel_speeds();
        let rates = WheelSpeeds {
            left: (left - from.left) / duration,
            right: (right - from.right) / duration,
        };
        if how == How::Jump {
            self.set(target);
        }
        let begin = self.simulation.time();
        while self.simulation.time() - begin < duration {
            let done = self.simulation.time() - begin;
            let seconds = STEPS[self.steps % STEPS.len()];
            if how == How::RatesAndSpeeds {
                self.set(from.after(rates, done));
            }
            let rates = if how == How::Jump {
                WheelSpeeds::default()
            } else {
                self.tell(json!(["rates", rates.left, rates.right]));
                rates
            };
            self.simulation.set_wheel_accelerations(rates).unwrap();
            self.simulation.step(seconds).unwrap();
            self.tell(json!(["step", seconds]));
            self.read();
            self.steps += 1;
        }
    }

    fn set(&mut self, speeds: WheelSpeeds) {
        self.simulation.set_wheel_speeds(speeds).unwrap();
        self.tell(json!(["speeds", speeds.left, speeds.right]));
    }

    fn save(&mut self) {
        self.saved = Some(self.simulation.clone());
        self.tell(json!(["save"]));
    }

    fn restore(&mut self) {
        self.simulation = self.saved.take().expect("saved before");
        self.tell(json!(["restore"]));
        self.read();
    }

    /// Ends what one process does, and begins what another does.
    fn change_process(&mut self, file: &Path) -> (Value, Vec<Vec<f64>>) {
        self.tell(json!(["store", file]));
        let part = self.take();
        self.tell(json!(["load", file]));
        self.read();
        part
    }

    fn take(&mut self) -> (Value, Vec<Vec<f64>>) {
        let names: Vec<&str> = self.variables.iter().map(|v| v.name.as_str()).collect();
        let operations = std::mem::take(&mut self.operations);
        let part = json!({"read": names, "do": operations});
        (part, std::mem::take(&mut self.expected))
    }
}

/// Has fmpy drive each case in two processes and compares every number with the library's.
fn compare(fmu: &Path, python: &Path, cases: &[Case]) {
    let folder = tempfile::tempdir().unwrap();
    let mut parts = [Vec::new(), Vec::new()];
    for (index, case) in cases.iter().enumerate() {
        let mut drive = Drive::new(case);
        let [pivot, rest @ ..] = &AFTER;
        drive.phases(&BEFORE[..3]);
        drive.save();
        drive.phases(&DETOUR);
        drive.restore();
        drive.phases(&BEFORE[3..]);
        drive.phases(std::slice::from_ref(pivot));
        let file = folder.path().join(format!("{index}.state"));
        parts[0].push(drive.change_process(&file));
        drive.phases(rest);
        parts[1].push(drive.take());
    }
    for part in parts {
        let (drives, expected): (Vec<Value>, Vec<Vec<Vec<f64>>>) = part.into_iter().unzip();
        let printed = run(python, &json!({"fmu": fmu, "drives": drives}));
        let mut lines = printed.lines();
        for ((case, drive), rows) in cases.iter().zip(&drives).zip(&expected) {
            for (row, values) in rows.iter().enumerate() {
                let line = lines.next().expect("one line for each row");
                compare_row(case.name, row, &drive["read"], values, line);
            }
        }
        assert_eq!(lines.next(), None);
    }
}

fn compare_row(case: &str, row: usize, names: &Value, values: &[f64], line: &str) {
    let printed: Vec<u64> = line
        .split(' ')
        .map(|bits| u64::from_str_radix(bits, 16).unwrap())
        .collect();
    assert_eq!(printed.len(), values.len(), "{case}, row {row}");
    for (column, (value, bits)) in values.iter().zip(printed).enumerate() {
        let name = column.checked_sub(1).map(|index| &names[index]);
        assert_eq!(
            value.to_bits(),
            bits,
            "{case}, row {row} at {} s, {}: {value:?} natively, {:?} by the FMU (of the same source? \
             scripts/package.sh builds it)",
            values[0],
            name.unwrap_or(&json!("time")),
            f64::from_bits(bits)
        );
    }
}

fn run(python: &Path, task: &Value) -> String {
    let mut child = Command::new(python)
        .arg(support::root().join("tests/python/step_fmu.py"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    stdin.write_all(task.to_string().as_bytes()).unwrap();
    drop(stdin);
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "step_fmu.py: {}", output.status);
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn fmpy_gets_the_bits_of_the_library_on_every_terrain() {
    let (Some(fmu), Some(python)) = (support::fmu(), support::python()) else {
        return;
    };
    let mut cases: Vec<Case> = Terrain::PRESETS
        .into_iter()
        .zip(1..)
        .map(|(name, number)| Case {
            name,
            model: Specification::plain(Vehicle::tran2007(), Terrain::preset(name).unwrap()),
            initial: State::default(),
            start: json!({"terrain": number}),
        })
        .collect();
    let soil = Terrain {
        cohesion: 2500.0,
        friction_angle: 21.3_f64.to_radians(),
        ..cases[1].model.terrain
    };
    let vehicle = Vehicle {
        mass: 433.3,
        com_offset: -0.05,
        ..Vehicle::tran2007()
    };
    cases.push(Case {
        name: "parameters",
        model: Specification::plain(vehicle, soil),
        initial: State {
            x: -3.0,
            heading: 2.1,
            v_x: 1.3,
            yaw_rate: -0.2,
            ..State::default()
        },
        start: json!({
            "terrain": 5, "soil.cohesion": 2500.0, "soil.friction_angle_deg": 21.3,
            "soil.cohesive_modulus": soil.cohesive_modulus,
            "soil.frictional_modulus": soil.frictional_modulus,
            "soil.sinkage_exponent": soil.sinkage_exponent, "soil.shear_modulus": soil.shear_modulus,
            "vehicle.mass": 433.3, "vehicle.com_offset": -0.05,
            "initial.x": -3.0, "initial.heading": 2.1, "initial.v_x": 1.3, "initial.yaw_rate": -0.2,
        }),
    });
    let mut effects = Effects::NONE;
    let mut start = json!({"terrain": 3});
    for (name, value) in [
        ("grade.slope_east", 0.06),
        ("grade.slope_north", -0.11),
        ("terrain_change.stiffness_factor", 0.4),
        ("terrain_change.position", 0.7),
        ("left_right_soil.ratio", 1.4),
        ("payload.mass", 70.0),
        ("payload.left", 0.2),
        ("drag.coefficient", 30.0),
        ("stress_peak.a0", 0.43),
    ] {
        effects = effects.with(name, value).unwrap();
        start[format!("effects.{name}")] = value.into();
    }
    cases.push(Case {
        name: "effects as parameters",
        model: Specification {
            effects,
            ..cases[2].model.clone()
        },
        initial: State::default(),
        start,
    });
    compare(&fmu, &python, &cases);
}

/// Packages an FMU with the library of another, and has fmpy look for faults in it.
fn package(fmu: &Path, python: &Path, folder: &Path, arguments: &[&std::ffi::OsStr]) -> PathBuf {
    let library = folder.join("ugv.so");
    std::fs::write(&library, support::member(fmu, "binaries/linux64/ugv.so")).unwrap();
    let packaged = folder.join("own.fmu");
    let status = Command::new(env!("CARGO_BIN_EXE_ugv"))
        .arg("package")
        .args(arguments)
        .arg("--library")
        .arg(format!("linux64={}", library.display()))
        .arg("--output")
        .arg(&packaged)
        .arg("--force")
        .status()
        .unwrap();
    assert!(status.success());
    let validated = Command::new(python)
        .args(["-m", "fmpy", "validate"])
        .arg(&packaged)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&validated.stdout);
    assert!(validated.status.success(), "{said}");
    packaged
}

#[test]
fn fmpy_gets_the_bits_of_the_library_with_a_vehicle_and_soil_of_ones_own() {
    const VEHICLE: &str = r#"{"mass": 180.5, "yaw_inertia": 61.7, "wheel_radius": 0.21,
        "wheel_width": 0.18, "row_positions": [0.45, -0.35], "half_track": 0.4,
        "com_offset": 0.03, "com_height": 0.27}"#;
    const SOIL: &str = r#"{"cohesion": 3300, "friction_angle_deg": 24.7, "cohesive_modulus": 7100.5,
        "frictional_modulus": 1210000, "sinkage_exponent": 0.83, "shear_modulus": 0.0135}"#;
    let (Some(fmu), Some(python)) = (support::fmu(), support::python()) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        path
    };
    let vehicle = file("vehicle.json", VEHICLE.as_bytes());
    let soil = file("soil.json", SOIL.as_bytes());
    let arguments = [
        "--vehicle".as_ref(),
        vehicle.as_os_str(),
        "--terrain".as_ref(),
        soil.as_os_str(),
    ];
    let packaged = package(&fmu, &python, folder.path(), &arguments);
    let case = Case {
        name: "two rows on a soil of one's own",
        model: Specification::plain(
            Vehicle::from_json(VEHICLE).unwrap(),
            Terrain::from_json(SOIL).unwrap(),
        ),
        initial: State::default(),
        start: json!({}),
    };
    compare(&packaged, &python, &[case]);
}

/// A vehicle of three rows on a soil of its own, with effects that remember and slopes over time.
const MODEL: &str = r#"{"format": "ugv-model/1",
    "vehicle": {"mass": 240, "yaw_inertia": 71.5, "wheel_radius": 0.2, "wheel_width": 0.17,
        "row_positions": [0.5, 0.05, -0.45], "half_track": 0.42, "com_offset": 0.02, "com_height": 0.3},
    "terrain": {"cohesion": 2900, "friction_angle_deg": 27.3, "cohesive_modulus": 6200.5,
        "frictional_modulus": 1410000, "sinkage_exponent": 0.91, "shear_modulus": 0.0145},
    "effects": {
        "grade": {"slope_north": 0.04, "profile": {"over": "time",
            "points": [[0, 0, 0], [1.5, 0.12, 0], [4, -0.1, 0.05]]}},
        "left_right_soil": {"ratio": 1.25},
        "multipass": {"memory": 0.9},
        "transient_shear": {"relaxation": 1.0},
        "payload": {"mass": 35, "ahead": 0.1, "left": -0.15}}}"#;

#[test]
fn fmpy_gets_the_bits_of_the_library_with_effects_that_remember() {
    let (Some(fmu), Some(python)) = (support::fmu(), support::python()) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.json");
    std::fs::write(&file, MODEL).unwrap();
    let arguments = ["--model".as_ref(), file.as_os_str()];
    let packaged = package(&fmu, &python, folder.path(), &arguments);
    let description =
        String::from_utf8(support::member(&packaged, "modelDescription.xml")).unwrap();
    assert!(description.contains("<CoSimulation") && !description.contains("<ModelExchange"));
    assert!(description.contains("wheel[6].load") && !description.contains("wheel[7].load"));
    let model = Specification::from_json(MODEL).unwrap();
    let stronger = model.effects.clone().with("multipass.stiffness_ratio", 4.0);
    let stronger = stronger
        .and_then(|e| e.with("transient_shear.relaxation", 0.0))
        .unwrap();
    let cases = [
        Case {
            name: "effects that remember",
            model: model.clone(),
            initial: State::default(),
            start: json!({}),
        },
        Case {
            name: "effects that remember, otherwise",
            model: Specification {
                effects: stronger,
                ..model
            },
            initial: State {
                v_x: 0.4,
                ..State::default()
            },
            start: json!({
                "initial.v_x": 0.4, "effects.multipass.stiffness_ratio": 4.0,
                "effects.transient_shear.relaxation": 0.0,
            }),
        },
    ];
    compare(&packaged, &python, &cases);
}
