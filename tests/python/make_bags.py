"""Robots' logs of a drive whose truth is known, written by other people's writers.

`python make_bags.py FOLDER` leaves one log of each container, encoding and compression there.
"""

import math
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Bag2Writer
from rosbags.typesys import Stores, get_typestore

START = 1_700_000_000_000_000_000  # ns
DURATION = 20.0  # s
RADIUS, HALF_TRACK = 0.15, 0.4  # m
# Of the earth: where the drive begins.
ORIGIN = (48.1, 11.6, 520.0)
# From measuring to logging [ns].
DELAY = 3_000_000
JOINTS = (
    "front_left_wheel",
    "rear_left_wheel",
    "front_right_wheel",
    "rear_right_wheel",
    "left_arm",
)
ROS1, ROS2 = get_typestore(Stores.ROS1_NOETIC), get_typestore(Stores.ROS2_HUMBLE)


class Truth(NamedTuple):
    """Where the vehicle is, and how fast."""

    omega_left: float
    omega_right: float
    x: float
    y: float
    heading: float
    v_x: float
    v_y: float
    yaw_rate: float


def truth(time: float) -> Truth:
    """The drive: over two whole turns to the left on a circle, with slip that comes and goes."""
    yaw_rate, radius = 0.7, 3.0
    heading = 0.2 + yaw_rate * time
    v_x = yaw_rate * radius
    slip = 0.1 + 0.05 * math.sin(2.0 * time)
    omega = v_x / (RADIUS * (1.0 - slip))
    return Truth(
        omega_left=omega - yaw_rate * HALF_TRACK / RADIUS,
        omega_right=omega + yaw_rate * HALF_TRACK / RADIUS,
        x=radius * (math.sin(heading) - math.sin(0.2)),
        y=-radius * (math.cos(heading) - math.cos(0.2)),
        heading=heading,
        v_x=v_x,
        v_y=0.05 * math.sin(time),
        yaw_rate=yaw_rate,
    )


def wheel_angles(time: float) -> tuple[float, float]:
    """How far the wheels of both sides have turned [rad], by Simpson's rule."""
    times = np.linspace(0.0, time, 2 * max(1, math.ceil(time / 0.02)) + 1)
    weights = np.ones(len(times))
    weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
    share = weights / weights.sum() * time
    states = [truth(t) for t in times]
    return (
        float(share @ [s.omega_left for s in states]),
        float(share @ [s.omega_right for s in states]),
    )


def geodetic(east: float, north: float, up: float = 0.0) -> tuple[float, float, float]:
    """Latitude, longitude [deg], height [m] of a place near the origin (WGS-84).

    Iterates from Cartesian coordinates, which is not how they were made from fixes.
    """
    a, f = 6378137.0, 1.0 / 298.257223563
    e2 = f * (2.0 - f)
    phi, lam, height = math.radians(ORIGIN[0]), math.radians(ORIGIN[1]), ORIGIN[2]
    n = a / math.sqrt(1.0 - e2 * math.sin(phi) ** 2)
    centre = np.array(
        [
            (n + height) * math.cos(phi) * math.cos(lam),
            (n + height) * math.cos(phi) * math.sin(lam),
            (n * (1.0 - e2) + height) * math.sin(phi),
        ]
    )
    axes = np.array(
        [
            [-math.sin(lam), math.cos(lam), 0.0],
            [-math.sin(phi) * math.cos(lam), -math.sin(phi) * math.sin(lam), math.cos(phi)],
            [math.cos(phi) * math.cos(lam), math.cos(phi) * math.sin(lam), math.sin(phi)],
        ]
    )
    x, y, z = centre + axes.T @ np.array([east, north, up])
    p, latitude = math.hypot(x, y), phi
    for _ in range(20):
        n = a / math.sqrt(1.0 - e2 * math.sin(latitude) ** 2)
        latitude = math.atan2(z + e2 * n * math.sin(latitude), p)
    return math.degrees(latitude), math.degrees(math.atan2(y, x)), p / math.cos(latitude) - n


class Message(NamedTuple):
    """What goes into a log."""

    topic: str
    type: str
    time: int  # of measuring [ns]
    content: Any
    logged: int | None = None


class Factory:
    """Makes messages of ROS 1 or ROS 2."""

    def __init__(self, store: Any) -> None:
        self.store = store
        self.is_ros1 = store is ROS1

    def make(self, message_type: str, **fields: Any) -> Any:
        """A message of a type."""
        return self.store.types[message_type](**fields)

    def header(self, time: int, frame: str) -> Any:
        """A header; a time below zero leaves it without."""
        time = max(time, 0)
        stamp = self.make("builtin_interfaces/msg/Time", sec=time // 10**9, nanosec=time % 10**9)
        counter = {"seq": 7} if self.is_ros1 else {}
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame, **counter)

    def vector(self, x: float, y: float, z: float) -> Any:
        """A vector."""
        return self.make("geometry_msgs/msg/Vector3", x=x, y=y, z=z)

    def quaternion(self, heading: float, length: float = 1.0) -> Any:
        """An attitude that is level."""
        sin, cos = length * math.sin(heading / 2), length * math.cos(heading / 2)
        return self.make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=sin, w=cos)

    def joints(
        self,
        time: int,
        velocities: dict[str, float] | None,
        positions: dict[str, float] | None = None,
        efforts: dict[str, float] | None = None,
    ) -> Any:
        """`sensor_msgs/JointState`."""

        def listed(values: dict[str, float] | None) -> np.ndarray:
            return np.array(list((values or {}).values()), dtype=np.float64)

        return self.make(
            "sensor_msgs/msg/JointState",
            header=self.header(time, ""),
            name=list(velocities or positions or {}),
            position=listed(positions),
            velocity=listed(velocities),
            effort=listed(efforts),
        )

    def odometry(self, time: int, s: Truth, length: float = 1.0) -> Any:
        """`nav_msgs/Odometry`."""
        point = self.make("geometry_msgs/msg/Point", x=s.x, y=s.y, z=0.4)
        pose = self.make(
            "geometry_msgs/msg/Pose",
            position=point,
            orientation=self.quaternion(s.heading, length),
        )
        twist = self.make(
            "geometry_msgs/msg/Twist",
            linear=self.vector(s.v_x, s.v_y, 0.0),
            angular=self.vector(0.0, 0.0, s.yaw_rate),
        )
        covariance = np.arange(36.0)
        return self.make(
            "nav_msgs/msg/Odometry",
            header=self.header(time, "odom"),
            child_frame_id="base_link",
            pose=self.make(
                "geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=covariance
            ),
            twist=self.make(
                "geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=covariance
            ),
        )

    def pose(self, s: Truth) -> Any:
        """`geometry_msgs/Pose`."""
        point = self.make("geometry_msgs/msg/Point", x=s.x, y=s.y, z=0.4)
        return self.make(
            "geometry_msgs/msg/Pose", position=point, orientation=self.quaternion(s.heading)
        )

    def pose_stamped(self, time: int, s: Truth, with_covariance: bool = False) -> Any:
        """`geometry_msgs/PoseStamped`, or with covariance."""
        header, pose = self.header(time, "map"), self.pose(s)
        if not with_covariance:
            return self.make("geometry_msgs/msg/PoseStamped", header=header, pose=pose)
        pose = self.make(
            "geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=np.arange(36.0)
        )
        return self.make("geometry_msgs/msg/PoseWithCovarianceStamped", header=header, pose=pose)

    def transform(
        self, time: int, parent: str, child: str, x: float, y: float, heading: float
    ) -> Any:
        """`geometry_msgs/TransformStamped`."""
        return self.make(
            "geometry_msgs/msg/TransformStamped",
            header=self.header(time, parent),
            child_frame_id=child,
            transform=self.make(
                "geometry_msgs/msg/Transform",
                translation=self.vector(x, y, 0.0),
                rotation=self.quaternion(heading),
            ),
        )

    def twist_stamped(self, time: int, s: Truth) -> Any:
        """`geometry_msgs/TwistStamped`."""
        twist = self.make(
            "geometry_msgs/msg/Twist",
            linear=self.vector(s.v_x, s.v_y, 0.0),
            angular=self.vector(0.0, 0.0, s.yaw_rate),
        )
        header = self.header(time, "base_link")
        return self.make("geometry_msgs/msg/TwistStamped", header=header, twist=twist)

    def imu(
        self, time: int, s: Truth, up: float = 1.0, known: bool = True, optical: bool = False
    ) -> Any:
        """`sensor_msgs/Imu`; `up` is -1 for one that hangs upside down about its x axis.

        One of a camera (`optical`) has axes to the right, down and ahead.
        """

        def own(x: float, y: float, z: float) -> Any:
            return self.vector(-y, -z, x) if optical else self.vector(x, y, z)

        unknown = np.array([0.0 if known else -1.0] + [0.0] * 8)
        return self.make(
            "sensor_msgs/msg/Imu",
            header=self.header(time, "imu_link"),
            orientation=self.quaternion(s.heading),
            orientation_covariance=unknown,
            angular_velocity=own(0.01, 0.02, up * (s.yaw_rate + 0.001)),
            angular_velocity_covariance=np.zeros(9),
            linear_acceleration=own(0.3, up * s.v_x * s.yaw_rate, up * 9.81),
            linear_acceleration_covariance=np.zeros(9),
        )

    def fix(
        self,
        time: int,
        place: tuple[float, float, float],
        status: int = 0,
        deviation: float = 0.0,
    ) -> Any:
        """`sensor_msgs/NavSatFix`; a deviation of zero is one that nobody told."""
        return self.make(
            "sensor_msgs/msg/NavSatFix",
            header=self.header(time, "gps"),
            status=self.make("sensor_msgs/msg/NavSatStatus", status=status, service=1),
            latitude=place[0],
            longitude=place[1],
            altitude=place[2],
            position_covariance=np.diag([deviation**2, deviation**2, 9.0 * deviation**2]).ravel(),
            position_covariance_type=2,
        )


JOINT_STATE, ODOMETRY = "sensor_msgs/msg/JointState", "nav_msgs/msg/Odometry"
IMU, FIX = "sensor_msgs/msg/Imu", "sensor_msgs/msg/NavSatFix"
POSE, TWIST = "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/TwistStamped"
POSE_COVARIANCE = "geometry_msgs/msg/PoseWithCovarianceStamped"
TRANSFORM, TRANSFORMS = "geometry_msgs/msg/TransformStamped", "tf2_msgs/msg/TFMessage"


def velocities(s: Truth) -> dict[str, float]:
    """Joints whose mean on each side is the truth."""
    sides = (s.omega_left + 0.1, s.omega_left - 0.1, s.omega_right + 0.2, s.omega_right - 0.2)
    return dict(zip(JOINTS, (*sides, 99.0)))


def ticks(rate: float, shift: float = 0.0) -> Iterator[tuple[int, float]]:
    """Times of a sensor [ns since 1970] and [s since the start]."""
    for k in range(int(DURATION * rate)):
        offset = round((k / rate + shift) * 1e9)
        yield START + offset, offset * 1e-9


def drive(make: Factory) -> list[Message]:
    """All sensors; some fixes are invalid, and some topics belong to nothing."""
    messages = [
        Message("/joint_states", JOINT_STATE, t, make.joints(t, velocities(truth(s))))
        for t, s in ticks(50)
    ]
    messages += [
        Message("/ins/odom", ODOMETRY, t, make.odometry(t, truth(s))) for t, s in ticks(20, 0.005)
    ]
    messages += [Message("/imu/data", IMU, t, make.imu(t, truth(s))) for t, s in ticks(100, 0.001)]
    for number, (t, s) in enumerate(ticks(5, 0.003)):
        # The first valid fix shall be the drive's begin.
        place = geodetic(truth(s).x, truth(s).y, 0.5) if number != 1 else ORIGIN
        broken = number == 0
        nowhere = number == 7
        place = (math.nan, math.nan, math.nan) if nowhere else place
        messages.append(Message("/gps/fix", FIX, t, make.fix(t, place, status=-1 if broken else 0)))
    text = make.make("std_msgs/msg/String", data="started")
    messages.append(Message("/log", "std_msgs/msg/String", START, text))
    return sorted(messages, key=lambda message: message.time)


def logged(message: Message) -> int:
    """When a message reaches the log [ns]."""
    return message.time + DELAY if message.logged is None else message.logged


def write_bag(path: Path, messages: list[Message], compression: str | None = None) -> None:
    """A ROS 1 bag."""
    path.unlink(missing_ok=True)
    writer = BagWriter(path)
    # Several chunks.
    writer.chunk_threshold = 1 << 16
    if compression:
        writer.set_compression(getattr(BagWriter.CompressionFormat, compression.upper()))
    connections: dict[str, Any] = {}
    with writer:
        for message in messages:
            if message.topic not in connections:
                connections[message.topic] = writer.add_connection(
                    message.topic, message.type, typestore=ROS1
                )
            data = ROS1.serialize_ros1(message.content, message.type)
            writer.write(connections[message.topic], logged(message), data)


def write_mcap(
    path: Path,
    messages: list[Message],
    encoding: str = "cdr",
    compression: CompressionType = CompressionType.ZSTD,
    little_endian: bool = True,
    **options: Any,
) -> None:
    """An MCAP file of messages of ROS 2 (cdr), of ROS 1 (ros1), or of neither."""
    serialize: Callable[[Any, str], Any] = {
        "cdr": lambda content, name: ROS2.serialize_cdr(content, name, little_endian=little_endian),
        "ros1": ROS1.serialize_ros1,
        "json": lambda content, name: b"{}",
    }[encoding]
    with path.open("wb") as file:
        writer = McapWriter(file, chunk_size=1 << 16, compression=compression, **options)
        writer.start(profile="", library="test")
        channels: dict[str, int] = {}
        for message in messages:
            if message.topic not in channels:
                name = message.type.replace("/msg/", "/") if encoding == "ros1" else message.type
                schema = writer.register_schema(name=name, encoding="", data=b"")
                channels[message.topic] = writer.register_channel(
                    topic=message.topic, message_encoding=encoding, schema_id=schema
                )
            writer.add_message(
                channel_id=channels[message.topic],
                log_time=logged(message),
                publish_time=message.time,
                data=bytes(serialize(message.content, message.type)),
            )
        writer.finish()


def write_bag2(
    path: Path,
    messages: list[Message],
    storage: StoragePlugin = StoragePlugin.SQLITE3,
    mode: CompressionMode = CompressionMode.NONE,
    store: Any = ROS2,
) -> Path:
    """The folder of a ROS 2 bag; returns its file of messages."""
    writer = Bag2Writer(path, version=9, storage_plugin=storage)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    connections: dict[str, Any] = {}
    with writer:
        for message in messages:
            if message.topic not in connections:
                connections[message.topic] = writer.add_connection(
                    message.topic, message.type, typestore=store
                )
            data = store.serialize_cdr(message.content, message.type)
            writer.write(connections[message.topic], logged(message), data)
    (file,) = (file for file in path.iterdir() if file.suffix != ".yaml")
    return file


def main(folder: Path) -> None:
    """One log of each kind."""
    folder.mkdir(parents=True, exist_ok=True)
    ros1, ros2 = drive(Factory(ROS1)), drive(Factory(ROS2))
    for compression in (None, "bz2", "lz4"):
        write_bag(folder / f"drive_{compression or 'none'}.bag", ros1, compression)
    for compression in CompressionType:
        name = compression.name.lower()
        write_mcap(folder / f"drive_cdr_{name}.mcap", ros2, compression=compression)
    write_mcap(folder / "drive_cdr_big_endian.mcap", ros2, little_endian=False)
    write_mcap(folder / "drive_cdr_no_chunks.mcap", ros2, use_chunking=False)
    write_mcap(folder / "drive_ros1.mcap", ros1, "ros1")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: make_bags.py FOLDER")
    main(Path(sys.argv[1]))
