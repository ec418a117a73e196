//! The FMU, stepped by fmpy, gives the bits of the native library: on every terrain, with steps
//! of every size, with states saved and restored in one process and taken along into another.

#![cfg(feature = "cli")]

mod support;

use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use ugv_terrain::declaration::{Causality, Quantity, Variable, variables};
use ugv_terrain::simulation::{Simulation, State, WheelSpeeds};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Vehicle, VehicleModel};

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

/// A vehicle on a terrain as the FMU is told of it and as the library knows it.
struct Case {
    name: &'static str,
    vehicle: Vehicle,
    terrain: Terrain,
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
        let model = VehicleModel::new(case.vehicle.clone(), case.terrain).unwrap();
        let mut simulation = Simulation::new(model);
        simulation.set_state(case.initial).unwrap();
        let read = |v: &Variable| v.attributes.causality != Causality::Parameter;
        let rows = case.vehicle.row_positions.len();
        let mut drive = Self {
            simulation,
            variables: variables(rows).into_iter().filter(read).collect(),
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
        let (speeds, state) = (simulation.wheel_speeds(), simulation.state().to_array());
        let rates = simulation.derivative().unwrap();
        let wrench = simulation.wrench().unwrap().clone();
        let value = |variable: &Variable| match variable.quantity {
            Quantity::Input(0) => speeds.left,
            Quantity::Input(_) => speeds.right,
            Quantity::State(index) => state[index],
            Quantity::Rate(index) => rates[index],
            Quantity::Total(index) => [
                wrench.a_x,
                wrench.a_y,
                wrench.rolling_resistance,
                wrench.turning_resistance_moment,
                wrench.turning_moment,
            ][index],
            Quantity::Wheel(wheel, field) => {
                let wheel = &wrench.wheels[wheel];
                [
                    wheel.longitudinal_slip,
                    wheel.lateral_slip,
                    wheel.load,
                    wheel.sinkage,
                    wheel.entry_angle,
                    wheel.force_x,
                    wheel.force_y,
                ][field]
            }
            other => panic!("{other:?} is not read"),
        };
        let mut row = vec![simulation.time()];
        row.extend(self.variables.iter().map(value));
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
            vehicle: Vehicle::tran2007(),
            terrain: Terrain::preset(name).unwrap(),
            initial: State::default(),
            start: json!({"terrain": number}),
        })
        .collect();
    let soil = Terrain {
        cohesion: 2500.0,
        friction_angle: 21.3_f64.to_radians(),
        ..cases[1].terrain
    };
    let vehicle = Vehicle {
        mass: 433.3,
        com_offset: -0.05,
        ..Vehicle::tran2007()
    };
    cases.push(Case {
        name: "parameters",
        vehicle,
        terrain: soil,
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
    compare(&fmu, &python, &cases);
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
    let library = support::member(&fmu, "binaries/linux64/ugv.so");
    let library = file("ugv.so", &library);
    let packaged = folder.path().join("own.fmu");
    let status = Command::new(env!("CARGO_BIN_EXE_ugv"))
        .arg("package")
        .arg("--vehicle")
        .arg(file("vehicle.json", VEHICLE.as_bytes()))
        .arg("--terrain")
        .arg(file("soil.json", SOIL.as_bytes()))
        .arg("--library")
        .arg(format!("linux64={}", library.display()))
        .arg("--output")
        .arg(&packaged)
        .status()
        .unwrap();
    assert!(status.success());
    let validated = Command::new(&python)
        .args(["-m", "fmpy", "validate"])
        .arg(&packaged)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&validated.stdout);
    assert!(validated.status.success(), "{said}");
    let case = Case {
        name: "two rows on a soil of one's own",
        vehicle: Vehicle::from_json(VEHICLE).unwrap(),
        terrain: Terrain::from_json(SOIL).unwrap(),
        initial: State::default(),
        start: json!({}),
    };
    compare(&packaged, &python, &[case]);
}
