//! Vehicles that many have, by their makers' published models.

use super::message::MessageKind;
use crate::vehicle::Vehicle;

/// A known vehicle: its dimensions, and the topics of its sensors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preset(&'static Known);

#[derive(Debug, PartialEq)]
struct Known {
    name: &'static str,
    /// Where the numbers are from.
    source: &'static str,
    /// \[kg\].
    mass: f64,
    /// About the centre of mass \[kg m^2\].
    yaw_inertia: f64,
    /// \[m\].
    wheel_radius: f64,
    wheel_width: f64,
    half_wheelbase: f64,
    half_track: f64,
    /// Ahead of the middle between the axles, and above the ground \[m\].
    com_offset: f64,
    com_height: f64,
    /// Ends of the names of its topics.
    topics: &'static [(MessageKind, &'static str)],
}

/// Topics of Clearpath's drivers for ROS 2, behind a namespace, and for ROS 1.
const CLEARPATH: &[(MessageKind, &str)] = &[
    (MessageKind::Joints, "/platform/joint_states"),
    (MessageKind::Joints, "/joint_states"),
    (MessageKind::Imu, "/sensors/imu_0/data"),
    (MessageKind::Imu, "/imu/data"),
    (MessageKind::Fix, "/sensors/gps_0/fix"),
    (MessageKind::Fix, "/navsat/fix"),
];

/// Topics of drivers that have no namespace.
const USUAL: &[(MessageKind, &str)] = &[
    (MessageKind::Joints, "/joint_states"),
    (MessageKind::Imu, "/imu/data"),
];

/// Masses, yaw inertias and centres of mass are sums over the bodies of the published models.
const KNOWN: [Known; 4] = [
    Known {
        name: "husky",
        source: "Clearpath Husky A200: husky_description (github.com/husky/husky, BSD)",
        // Body 46.034, wheels 4 x 2.637.
        mass: 56.6,
        yaw_inertia: 3.7,
        wheel_radius: 0.1651,
        wheel_width: 0.1143,
        half_wheelbase: 0.256,
        half_track: 0.2854,
        com_offset: 0.0,
        com_height: 0.19,
        topics: CLEARPATH,
    },
    Known {
        name: "jackal",
        source: "Clearpath Jackal: jackal_description (github.com/jackal/jackal, BSD)",
        // Body 16.523, wheels 4 x 0.477.
        mass: 18.4,
        yaw_inertia: 0.55,
        wheel_radius: 0.098,
        wheel_width: 0.04,
        half_wheelbase: 0.131,
        half_track: 0.1878,
        com_offset: 0.011,
        com_height: 0.13,
        topics: CLEARPATH,
    },
    Known {
        name: "warthog",
        source: "Clearpath Warthog: warthog_description (github.com/warthog-cpr/warthog, BSD)",
        // Body 100, rockers 2 x 50, wheels 4 x 15; body and rockers are boxes, whose length and width count: the
        // published formula takes the height for the width.
        mass: 260.0,
        yaw_inertia: 93.0,
        wheel_radius: 0.3,
        wheel_width: 0.25,
        half_wheelbase: 0.46,
        half_track: 0.56,
        com_offset: -0.015,
        com_height: 0.42,
        topics: CLEARPATH,
    },
    Known {
        name: "scout",
        source: "AgileX Scout 2.0: scout_description (github.com/agilexrobotics/scout_ros, BSD)",
        // Body 50, wheels 4 x 8.
        mass: 82.0,
        yaw_inertia: 8.6,
        wheel_radius: 0.1646,
        wheel_width: 0.1165,
        half_wheelbase: 0.249,
        half_track: 0.2915,
        com_offset: 0.0,
        com_height: 0.207,
        topics: USUAL,
    },
];

impl Preset {
    /// The names of all.
    pub const NAMES: [&str; KNOWN.len()] = {
        let mut names = [""; KNOWN.len()];
        let mut index = 0;
        while index < KNOWN.len() {
            names[index] = KNOWN[index].name;
            index += 1;
        }
        names
    };

    /// By its name.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        static ALL: [Known; KNOWN.len()] = KNOWN;
        ALL.iter().find(|known| known.name == name).map(Self)
    }

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.0.name
    }

    /// Where the numbers are from.
    #[must_use]
    pub fn source(self) -> &'static str {
        self.0.source
    }

    /// The vehicle without payload, with four wheels.
    #[must_use]
    pub fn vehicle(self) -> Vehicle {
        let known = self.0;
        Vehicle {
            mass: known.mass,
            yaw_inertia: known.yaw_inertia,
            wheel_radius: known.wheel_radius,
            wheel_width: known.wheel_width,
            row_positions: vec![known.half_wheelbase, -known.half_wheelbase],
            half_track: known.half_track,
            com_offset: known.com_offset,
            com_height: known.com_height,
        }
    }

    /// The place of a topic in this vehicle's order of preference.
    pub(super) fn place(self, kind: MessageKind, topic: &str) -> Option<usize> {
        let mut topics = self.0.topics.iter();
        topics.position(|(known, end)| *known == kind && topic.ends_with(end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::VehicleModel;

    #[test]
    fn every_preset_is_a_vehicle_that_can_drive() {
        for name in Preset::NAMES {
            let preset = Preset::of_name(name).unwrap();
            let vehicle = preset.vehicle();
            assert!(preset.source().contains("github.com"), "{name}");
            // Inertia of a box between that of a point and of all mass at the corners.
            let corner = 1.2 * (vehicle.row_positions[0].powi(2) + vehicle.half_track.powi(2));
            let gyration = vehicle.yaw_inertia / vehicle.mass;
            assert!(
                gyration > 0.2 * corner && gyration < corner,
                "{name}: {gyration} {corner}"
            );
            let soil = crate::terrain::Terrain::preset("sandy_loam").unwrap();
            assert!(VehicleModel::new(vehicle, soil).is_ok(), "{name}");
        }
        assert_eq!(Preset::of_name("tank"), None);
    }

    #[test]
    fn topics_may_have_a_namespace() {
        let husky = Preset::of_name("husky").unwrap();
        let place = |topic| husky.place(MessageKind::Joints, topic);
        assert!(place("/a200_0000/platform/joint_states") < place("/other/joint_states"));
        assert_eq!(husky.place(MessageKind::Imu, "/camera/imu"), None);
    }
}
