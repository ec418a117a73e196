//! What sensors make of a drive.

use super::manoeuvres::STEP;
use super::random::Random;
use super::world::Track;
use ugv_terrain::effects::{Effects, ParameterName};

/// How good the sensors are.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensors {
    /// White and coloured noise of a coordinate \[m\], and the latter's correlation time \[s\].
    pub position: [f64; 3],
    /// The same of the heading \[rad\].
    pub heading: [f64; 3],
    /// White noise \[rad/s\].
    pub yaw_rate: f64,
    /// White noise of the velocities \[m/s\], where they are recorded.
    pub velocity: Option<f64>,
    /// Steps of the encoders \[rad/s\], where these are noisy, too.
    pub quantum: Option<f64>,
    /// Whether there is no position for some seconds now and then.
    pub drops: bool,
    /// Share of positions that are far off.
    pub outliers: f64,
}

/// Share of the wheels' speeds that a noisy encoder errs by.
const ENCODER_NOISE: f64 = 0.005;

/// One row of a recording; poses and velocities every other time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    pub time: f64,
    pub wheels: [f64; 2],
    pub position: Option<[f64; 2]>,
    pub heading: Option<f64>,
    pub velocity: Option<[f64; 2]>,
    pub yaw_rate: f64,
}

impl Sensors {
    pub fn draw(random: &mut Random) -> Self {
        Self {
            position: [
                random.scaled(0.01, 0.03),
                random.scaled(0.01, 0.03),
                random.scaled(1.0, 5.0),
            ],
            heading: [random.scaled(0.003, 0.01), 0.003, random.scaled(1.0, 5.0)],
            yaw_rate: random.scaled(0.003, 0.01),
            velocity: random.chance(1.0 / 3.0).then(|| random.scaled(0.02, 0.04)),
            quantum: random.chance(0.5).then(|| random.scaled(0.005, 0.04)),
            drops: random.chance(0.25),
            outliers: if random.chance(0.25) {
                random.between(0.003, 0.01)
            } else {
                0.0
            },
        }
    }

    /// Sensors without noise.
    pub fn quiet() -> Self {
        Self {
            position: [0.0, 0.0, 1.0],
            heading: [0.0, 0.0, 1.0],
            yaw_rate: 0.0,
            velocity: None,
            quantum: None,
            drops: false,
            outliers: 0.0,
        }
    }

    /// What they are, in a user's words.
    pub fn words(&self) -> Vec<(&'static str, String)> {
        let centimetres = |metres: f64| (metres * 100.0).round();
        let pose = format!(
            "GNSS and heading, 10 Hz; position good to about {:.0} cm, drifts by about as much over seconds; \
             heading to about {:.1} deg",
            centimetres(self.position[0]).max(1.0),
            self.heading[0].to_degrees(),
        );
        let wheels = match self.quantum {
            Some(quantum) => format!("encoders, 20 Hz, steps of {quantum:.3} rad/s"),
            None => "encoders, 20 Hz".into(),
        };
        let mut words = vec![
            ("pose", pose),
            ("yaw_rate", "gyro, 20 Hz".into()),
            ("wheels", wheels),
        ];
        if let Some(noise) = self.velocity {
            words.push(("velocity", format!("Doppler, 10 Hz, about {noise:.2} m/s")));
        }
        words
    }

    /// Records a drive with sensors that have these faults.
    pub fn record(&self, track: &Track, faults: &Effects, random: &mut Random) -> Vec<Row> {
        let fault = |name| faults.get(ParameterName::find(name).expect("in the catalogue"));
        let (late_pose, late_rate, late_wheels) = (
            fault("latency.pose"),
            fault("latency.yaw_rate"),
            fault("latency.wheels"),
        );
        let arm = [fault("lever_arm.ahead"), fault("lever_arm.left")];
        let (bias, offset) = (fault("yaw_rate_bias.bias"), fault("heading_offset.offset"));
        let count = track.wheels.len();
        let drift = |[_, size, time]: [f64; 3], random: &mut Random| -> Vec<f64> {
            let course = random.coloured(count, STEP, time);
            course.into_iter().map(|value| size * value).collect()
        };
        let drifts = [
            drift(self.position, random),
            drift(self.position, random),
            drift(self.heading, random),
        ];
        let gaps = self.gaps(track.duration(), random);
        let row = |k: usize| {
            let time = k as f64 * STEP;
            let (pose, is_pose) = (track.at(time - late_pose), k.is_multiple_of(2));
            let (sin, cos) = pose.heading.sin_cos();
            let antenna = [
                pose.x + arm[0] * cos - arm[1] * sin,
                pose.y + arm[0] * sin + arm[1] * cos,
            ];
            let stray = random.chance(self.outliers);
            let position = [0, 1].map(|axis| {
                let far = if stray { 0.4 * random.normal() } else { 0.0 };
                antenna[axis] + drifts[axis][k] + self.position[0] * random.normal() + far
            });
            let heading = pose.heading + offset + drifts[2][k] + self.heading[0] * random.normal();
            let now = track.at(time);
            let velocity = self.velocity.map(|noise| {
                [now.v_x, now.v_y].map(|component| component + noise * random.normal())
            });
            let is_lost = gaps.iter().any(|gap| time >= gap[0] && time < gap[1]);
            Row {
                time,
                wheels: self.wheels(wheels_at(track, time - late_wheels), random),
                position: (is_pose && !is_lost).then_some(position),
                heading: is_pose.then_some(heading),
                velocity: velocity.filter(|_| is_pose),
                yaw_rate: track.at(time - late_rate).yaw_rate
                    + bias
                    + self.yaw_rate * random.normal(),
            }
        };
        (0..count).map(row).collect()
    }

    fn wheels(&self, truth: [f64; 2], random: &mut Random) -> [f64; 2] {
        match self.quantum {
            None => truth,
            Some(quantum) => truth.map(|speed| {
                let noisy = speed * (1.0 + ENCODER_NOISE * random.normal());
                (noisy / quantum).round() * quantum
            }),
        }
    }

    /// When there is no position.
    fn gaps(&self, duration: f64, random: &mut Random) -> Vec<[f64; 2]> {
        let count = if self.drops {
            random.pick(&[1, 2, 3])
        } else {
            0
        };
        let gap = |_| {
            let start = random.between(2.0, duration - 8.0);
            [start, start + random.between(1.5, 5.0)]
        };
        (0..count).map(gap).collect()
    }
}

fn wheels_at(track: &Track, time: f64) -> [f64; 2] {
    let last = track.wheels.len() - 1;
    let place = (time / STEP).clamp(0.0, last as f64);
    let k = (place as usize).min(last - 1);
    let share = place - k as f64;
    [0, 1].map(|side| {
        let (from, to) = (track.wheels[k][side], track.wheels[k + 1][side]);
        from + share * (to - from)
    })
}
