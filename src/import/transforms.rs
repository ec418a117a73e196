//! A pose from a tree of transforms (`/tf`).

use super::error::ImportError;
use super::message::{MessageKind, is_transforms};
use super::sample::StampedSample;
use super::survey::Topic;
use std::f64::consts::TAU;

/// Frames of the vehicle and of the world, the best first; a namespace may stand before them.
const BODIES: [&str; 4] = ["base_link", "base_footprint", "base", "chassis_link"];
const WORLDS: [&str; 3] = ["map", "world", "odom"];

/// The transforms between two frames, from the vehicle upwards.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TransformPath {
    /// Child and parent of each step.
    pub steps: Vec<[String; 2]>,
}

impl TransformPath {
    /// The frame of the vehicle.
    pub fn child(&self) -> String {
        self.steps
            .first()
            .map_or(String::new(), |[child, _]| child.clone())
    }

    /// The frame of the world.
    pub fn parent(&self) -> String {
        self.steps
            .last()
            .map_or(String::new(), |[_, parent]| parent.clone())
    }
}

/// A planar pose: x, y \[m\], heading \[rad\].
pub(super) type Planar = [f64; 3];

/// The path of a topic of transforms from the requested child to its parent, or from the vehicle to the world; `None` for
/// another topic.
///
/// # Errors
/// Frames that the topic does not relate.
pub(super) fn path(
    topic: &Topic,
    requested: Option<&[String; 2]>,
) -> Result<Option<TransformPath>, ImportError> {
    if !is_transforms(&topic.message_type) {
        return Ok(None);
    }
    let parent = |frame: &str| {
        let mut steps = topic.transforms.keys();
        steps.find(|[child, _]| child == frame).cloned()
    };
    let failed = |reason: String| {
        let pairs = topic.transforms.keys();
        let pairs: Vec<String> = pairs
            .map(|[child, parent]| format!("{parent},{child}"))
            .collect();
        Err(ImportError::Topic {
            kind: MessageKind::Odometry,
            topic: topic.name.clone(),
            reason,
            remedy: format!(
                "--frames PARENT,CHILD from {}, or --topics odometry=none",
                crate::display::listed(&pairs, " ")
            ),
        })
    };
    let (top, body) = match requested {
        Some([top, body]) => (Some(top.as_str()), body.clone()),
        None => {
            let bodies = BODIES.iter().find_map(|name| {
                let mut children = topic.transforms.keys().map(|[child, _]| child);
                children.find(|child| last(child) == *name)
            });
            match bodies {
                Some(body) => (None, body.clone()),
                None => return failed(format!("none of its frames is {}", BODIES.join(" or "))),
            }
        }
    };
    let mut steps: Vec<[String; 2]> = Vec::new();
    let mut frame = body.clone();
    while Some(frame.as_str()) != top
        && let Some(step) = parent(&frame)
    {
        if steps.iter().any(|[child, _]| *child == step[0]) {
            return failed(format!(
                "its frames follow each other in a circle at {frame}"
            ));
        }
        frame = step[1].clone();
        steps.push(step);
    }
    let reaches = match top {
        Some(top) => frame == top,
        None => WORLDS.contains(&last(&frame)) || !steps.is_empty(),
    };
    if steps.is_empty() || !reaches {
        let top = top.unwrap_or("a world");
        return failed(format!("no transforms lead from {body} to {top}"));
    }
    Ok(Some(TransformPath { steps }))
}

/// A frame's name without a namespace.
fn last(frame: &str) -> &str {
    frame.rsplit('/').next().unwrap_or(frame)
}

/// The poses of the vehicle in the world: at the times of the step with the most samples, the others linear in between, as
/// tf does, and held at the end. Heights, roll and pitch do not count.
pub(super) fn composed(mut steps: Vec<Vec<StampedSample<Planar>>>) -> Vec<StampedSample<Planar>> {
    for step in &mut steps {
        step.sort_by_key(|sample| sample.stamp);
    }
    let finest = (0..steps.len())
        .rev()
        .max_by_key(|index| steps[*index].len());
    let Some(finest) = finest else {
        return Vec::new();
    };
    let at = |sample: &StampedSample<Planar>| -> Option<StampedSample<Planar>> {
        let mut pose = [0.0; 3];
        // From the vehicle upwards: each step turns and shifts what is below it.
        for (index, step) in steps.iter().enumerate() {
            let own = if index == finest {
                sample.value
            } else {
                between(step, sample.stamp)?
            };
            pose = compose(own, pose);
        }
        Some(StampedSample {
            stamp: sample.stamp,
            logged: sample.logged,
            value: pose,
        })
    };
    steps[finest].iter().filter_map(at).collect()
}

/// The pose of a child at `inner` in a frame that is at `outer`.
fn compose(outer: Planar, inner: Planar) -> Planar {
    let (sin, cos) = outer[2].sin_cos();
    [
        outer[0] + cos * inner[0] - sin * inner[1],
        outer[1] + sin * inner[0] + cos * inner[1],
        outer[2] + inner[2],
    ]
}

/// A pose between samples; the last one after them, none before.
fn between(samples: &[StampedSample<Planar>], stamp: i64) -> Option<Planar> {
    let after = samples.partition_point(|sample| sample.stamp <= stamp);
    let before = samples.get(after.checked_sub(1)?)?;
    let Some(next) = samples.get(after) else {
        return Some(before.value);
    };
    let share = (stamp - before.stamp) as f64 / (next.stamp - before.stamp) as f64;
    let mut step = [0, 1, 2].map(|axis| next.value[axis] - before.value[axis]);
    step[2] -= TAU * (step[2] / TAU).round();
    Some([0, 1, 2].map(|axis| before.value[axis] + share * step[axis]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::container::Connection;

    fn topic(pairs: &[(&str, &str)]) -> Topic {
        let connection = Connection {
            topic: "/tf".into(),
            message_type: "tf2_msgs/msg/TFMessage".into(),
            encoding: "cdr".into(),
        };
        let mut topic = Topic::new(&connection, 0);
        for (child, parent) in pairs {
            topic
                .transforms
                .insert([(*child).into(), (*parent).into()], 1);
        }
        topic
    }

    fn names(pairs: &[(&str, &str)], requested: Option<[&str; 2]>) -> Result<String, String> {
        let requested = requested.map(|names| names.map(String::from));
        let found = path(&topic(pairs), requested.as_ref()).map_err(|error| error.to_string())?;
        let steps = found.unwrap().steps;
        Ok(steps
            .iter()
            .map(|step| step.join("<"))
            .collect::<Vec<_>>()
            .join(" "))
    }

    #[test]
    fn the_path_leads_from_the_vehicle_to_the_world() {
        let tree = [
            ("odom", "map"),
            ("base_link", "odom"),
            ("laser", "base_link"),
            ("r1/wheel", "base_link"),
        ];
        assert_eq!(names(&tree, None).unwrap(), "base_link<odom odom<map");
        assert_eq!(
            names(&tree, Some(["odom", "base_link"])).unwrap(),
            "base_link<odom"
        );
        assert_eq!(
            names(&[("a/base_link", "a/odom")], None).unwrap(),
            "a/base_link<a/odom"
        );
        assert!(
            names(&tree, Some(["map", "nothing"]))
                .unwrap_err()
                .contains("no transforms lead")
        );
        assert!(
            names(&[("laser", "mast")], None)
                .unwrap_err()
                .contains("none of its frames")
        );
        let circle = [("base_link", "a"), ("a", "base_link")];
        assert!(names(&circle, None).unwrap_err().contains("circle"));
    }

    #[test]
    fn steps_are_composed_at_the_times_of_the_finest() {
        let sample = |stamp: i64, value: Planar| StampedSample {
            stamp,
            logged: stamp,
            value,
        };
        let quarter = TAU / 4.0;
        // The body goes ahead in odom, which stands a quarter turned at (10, 0) and drifts to (12, 0).
        let body: Vec<_> = (0..5)
            .map(|k| sample(10 * k, [k as f64, 0.0, 0.1]))
            .collect();
        let odom = vec![
            sample(10, [10.0, 0.0, quarter]),
            sample(30, [12.0, 0.0, quarter]),
        ];
        let poses = composed(vec![body, odom]);
        let stamps: Vec<i64> = poses.iter().map(|pose| pose.stamp).collect();
        assert_eq!(stamps, [10, 20, 30, 40]);
        for (pose, expected) in
            poses
                .iter()
                .zip([[10.0, 1.0], [11.0, 2.0], [12.0, 3.0], [12.0, 4.0]])
        {
            let [x, y, heading] = pose.value;
            assert!(
                (x - expected[0]).abs() < 1e-12 && (y - expected[1]).abs() < 1e-12,
                "{pose:?}"
            );
            assert!((heading - quarter - 0.1).abs() < 1e-12);
        }
    }
}
