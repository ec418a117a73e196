//! Vehicles that many have, by their makers' published models.

use super::message::MessageKind;
use crate::vehicle::Vehicle;

/// A known vehicle: its dimensions, and the topics of its sensors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset(&'static Known);

#[derive(Debug, PartialEq, Eq)]
struct Known {
    name: &'static str,
    /// Where the numbers are from.
    source: &'static str,
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

const KNOWN: [Known; 4] = [
    Known {
        name: "husky",
        source: "Clearpath Husky A200: mass of the data sheet; dimensions and yaw inertia of husky_description \
                 (github.com/husky/husky, BSD)",
        topics: CLEARPATH,
    },
    Known {
        name: "jackal",
        source: "Clearpath Jackal: jackal_description (github.com/jackal/jackal, BSD)",
        topics: CLEARPATH,
    },
    Known {
        name: "warthog",
        source: "Clearpath Warthog: warthog_description (github.com/warthog-cpr/warthog, BSD)",
        topics: CLEARPATH,
    },
    Known {
        name: "scout",
        source: "AgileX Scout 2.0: scout_description (github.com/agilexrobotics/scout_ros2, BSD)",
        topics: &[
            (MessageKind::Joints, "/joint_states"),
            (MessageKind::Imu, "/imu/data"),
            (MessageKind::Fix, "/gps/fix"),
        ],
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
        static ALL: [Known; 4] = KNOWN;
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

    /// The vehicle without payload. The mass of a scout is that of its maker's simulation: weigh yours.
    #[must_use]
    pub fn vehicle(self) -> Vehicle {
        // Yaw inertias and heights are sums over the bodies of the published models: body and four wheels, for the
        // Warthog also its two rockers as boxes.
        let (mass, yaw_inertia, radius, width, row, half_track, com_offset, com_height) =
            match self.0.name {
                "husky" => (50.0, 3.6, 0.1651, 0.1143, 0.256, 0.2854, 0.0, 0.19),
                "jackal" => (18.4, 0.55, 0.098, 0.04, 0.131, 0.1878, 0.011, 0.13),
                "warthog" => (260.0, 93.0, 0.3, 0.25, 0.46, 0.56, -0.015, 0.42),
                _ => (52.0, 5.2, 0.1646, 0.1165, 0.249, 0.2915, 0.0, 0.22),
            };
        Vehicle {
            mass,
            yaw_inertia,
            wheel_radius: radius,
            wheel_width: width,
            row_positions: vec![row, -row],
            half_track,
            com_offset,
            com_height,
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
