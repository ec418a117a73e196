//! The frame of an odometry's velocities. The message's definition requires the vehicle's frame; some publishers, for
//! example simulators, use the world's.

use super::attitude::Yaw;
use super::collect::OdometrySample;

/// Displacements are compared over this duration \[s\], so that position noise counts once per window.
const WINDOW: f64 = 0.5;
/// Minimum number of windows.
const MIN_WINDOWS: usize = 10;
/// Maximum ratio of the squared errors in the world's frame to those in the vehicle's frame, and to the squared
/// displacements.
const BETTER: f64 = 0.25;

/// Whether the velocities fit the displacements in the frame of the pose, and not in that of the vehicle. Without turns
/// both fit.
pub(super) fn is_in_world(samples: &[(i64, OdometrySample)]) -> bool {
    let mut windows = 0;
    let (mut as_body, mut as_world, mut moved) = (0.0, 0.0, 0.0);
    let mut window = Window::default();
    for pair in samples.windows(2) {
        let ((from, before), (to, after)) = (&pair[0], &pair[1]);
        let seconds = (to - from) as f64 * 1e-9;
        window.add(seconds, before, after);
        if window.seconds >= WINDOW {
            let [displacement, body, world] = window.take();
            let square = |difference: [f64; 2]| difference.iter().map(|d| d * d).sum::<f64>();
            let [to_body, to_world] =
                [body, world].map(|sum| [0, 1].map(|axis| displacement[axis] - sum[axis]));
            let terms = [square(to_body), square(to_world), square(displacement)];
            if terms.iter().all(|term| term.is_finite()) {
                as_body += terms[0];
                as_world += terms[1];
                moved += terms[2];
                windows += 1;
            }
        }
    }
    windows >= MIN_WINDOWS && as_world < BETTER * as_body && as_world < BETTER * moved
}

/// Sums over a window.
#[derive(Default)]
struct Window {
    seconds: f64,
    /// Displacement, then velocity times time in the vehicle's and in the world's frame.
    sums: [[f64; 2]; 3],
}

impl Window {
    fn add(&mut self, seconds: f64, before: &OdometrySample, after: &OdometrySample) {
        self.seconds += seconds;
        for axis in 0..2 {
            self.sums[0][axis] += after.position[axis] - before.position[axis];
            self.sums[1][axis] += 0.5 * seconds * (turned(before)[axis] + turned(after)[axis]);
            self.sums[2][axis] += 0.5 * seconds * (before.velocity[axis] + after.velocity[axis]);
        }
    }

    fn take(&mut self) -> [[f64; 2]; 3] {
        std::mem::take(self).sums
    }
}

/// The velocity, taken in the vehicle's frame and rotated into the frame of the pose.
fn turned(sample: &OdometrySample) -> [f64; 2] {
    let heading = match sample.yaw {
        Yaw::Of(heading) | Yaw::Normalised(heading) => heading,
        Yaw::None => f64::NAN,
    };
    let ([v_x, v_y], (sin, cos)) = (sample.velocity, heading.sin_cos());
    [v_x * cos - v_y * sin, v_x * sin + v_y * cos]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drive at 2 m/s that turns at `yaw_rate`, with velocities of the world or the vehicle.
    fn drive(yaw_rate: f64, is_world: bool) -> Vec<(i64, OdometrySample)> {
        let mut position = [0.0; 2];
        let step = |k: i64| {
            let heading = 1.0 + yaw_rate * k as f64 * 0.01;
            let world = [2.0 * heading.cos(), 2.0 * heading.sin()];
            let sample = OdometrySample {
                position,
                yaw: Yaw::Of(heading),
                velocity: if is_world { world } else { [2.0, 0.0] },
                yaw_rate,
            };
            position = [position[0] + 0.01 * world[0], position[1] + 0.01 * world[1]];
            (k * 10_000_000, sample)
        };
        (0..2000).map(step).collect()
    }

    #[test]
    fn velocities_of_the_world_are_recognised() {
        assert!(is_in_world(&drive(0.4, true)));
        assert!(!is_in_world(&drive(0.4, false)));
        // Too short, or without attitude: no conclusion.
        assert!(!is_in_world(&drive(0.4, true)[..300]));
        let mut unknown = drive(0.4, true);
        for (_, sample) in &mut unknown {
            sample.yaw = Yaw::None;
        }
        assert!(!is_in_world(&unknown));
    }
}
