"""Logs of PX4 (ULog) of the drive whose truth is known, byte by byte as the format's page has them.

`python make_ulog.py FILE.ulg` leaves one. pyulog reads them and writes them anew: see test_import_ulog.py.
"""

import math
import struct
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from make_bags import DURATION, Truth, truth, wheel_angles

MAGIC = b"ULog\x01\x12\x35\x01"
BOOT = 5.0  # From the autopilot's start to the drive's [s].
# From measuring to logging [s].
DELAY = 0.004
# Of the fields' types in Python's `struct`.
CODES = {"uint64_t": "Q", "uint32_t": "I", "uint8_t": "B", "bool": "?", "float": "f", "double": "d"}

# Like PX4's: the larger types first, then padding.
FORMATS = {
    "wheel_encoders": "uint64_t timestamp;float[2] wheel_speed;float[2] wheel_angle;",
    "vehicle_local_position": (
        "uint64_t timestamp;uint64_t timestamp_sample;double ref_lat;float x;float y;float z;float vx;float vy;"
        "float heading;bool xy_valid;bool v_xy_valid;uint8_t[6] _padding0;"
    ),
    "vehicle_odometry": (
        "uint64_t timestamp;uint64_t timestamp_sample;float[3] position;float[4] q;float[3] velocity;"
        "float[3] angular_velocity;uint8_t pose_frame;uint8_t velocity_frame;uint8_t[2] _padding0;"
    ),
    "vehicle_angular_velocity": "uint64_t timestamp;uint64_t timestamp_sample;float[3] xyz;uint8_t[4] _padding0;",
    "sensor_combined": "uint64_t timestamp;float[3] gyro_rad;float[3] accelerometer_m_s2;",
    "vehicle_attitude": "uint64_t timestamp;uint64_t timestamp_sample;float[4] q;",
    # A nested format.
    "esc_status": "uint64_t timestamp;uint8_t counter;esc_report[2] esc;",
    "esc_report": "uint64_t timestamp;float esc_rpm;uint8_t[4] _padding0;",
    "actuator_outputs": "uint64_t timestamp;float[2] output;",
}


def record(kind: str, data: bytes) -> bytes:
    """A record with its header."""
    return struct.pack("<HB", len(data), ord(kind)) + data


def flags(appended: Sequence[int] = ()) -> bytes:
    """The flags; appended data stand at these offsets."""
    offsets = [*appended, 0, 0, 0][:3]
    return record("B", bytes(8) + bytes([bool(appended)]) + bytes(7) + struct.pack("<3Q", *offsets))


def subscription(number: int, topic: str, instance: int = 0) -> bytes:
    """Gives a topic its number."""
    return record("A", struct.pack("<BH", instance, number) + topic.encode())


def message(number: int, topic: str, values: Sequence[float]) -> bytes:
    """A message of a topic, without the padding at its end."""
    code = "<H"
    for field in FORMATS[topic].split(";"):
        kind, _, name = field.partition(" ")
        kind, _, count = kind.partition("[")
        if kind and not name.startswith("_padding"):
            code += count.rstrip("]") + CODES[kind]
    return record("D", struct.pack(code, number, *values))


def quaternion(yaw: float) -> list[float]:
    """w, x, y, z of a yaw, clockwise from north."""
    return [math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)]


def local_position(time: int, sample: int, now: Truth) -> list[float]:
    """North, east, and the velocities on the ground."""
    yaw = math.pi / 2 - now.heading
    north = now.v_x * math.sin(now.heading) + now.v_y * math.cos(now.heading)
    east = now.v_x * math.cos(now.heading) - now.v_y * math.sin(now.heading)
    yaw = math.remainder(yaw, 2 * math.pi)
    return [time, sample, 48.1, now.y, now.x, -1.0, north, east, yaw, True, True]


def odometry(time: int, sample: int, now: Truth) -> list[float]:
    """The pose, and the velocities of the vehicle ahead and to the right."""
    q = quaternion(math.pi / 2 - now.heading)
    velocity = [now.v_x, -now.v_y, 0.0, 0.0, 0.0, -now.yaw_rate]
    return [time, sample, now.y, now.x, 0.0, *q, *velocity, 1, 3]


def encoders(time: int, seconds: float, now: Truth) -> list[float]:
    """The right wheels first."""
    left, right = wheel_angles(seconds)
    return [time, now.omega_right, now.omega_left, right, left]


# Each topic's rate [Hz] and the values of its message at a time of logging [us], of measurement [us], and at a truth.
Values = Callable[[int, int, float, Truth], Sequence[float]]
TOPICS: dict[str, tuple[float, Values]] = {
    "wheel_encoders": (50, lambda time, sample, s, now: encoders(sample, s, now)),
    "vehicle_local_position": (20, lambda time, sample, s, now: local_position(time, sample, now)),
    "vehicle_odometry": (20, lambda time, sample, s, now: odometry(time, sample, now)),
    "vehicle_angular_velocity": (
        100,
        lambda time, sample, s, now: [time, sample, 0.01, 0.02, -now.yaw_rate],
    ),
    "sensor_combined": (
        100,
        lambda time, sample, s, now: [sample, 0.0, 0.0, -now.yaw_rate, 0.3, -0.2, -9.81],
    ),
    "vehicle_attitude": (
        50,
        lambda time, sample, s, now: [time, sample, *quaternion(math.pi / 2 - now.heading)],
    ),
    "actuator_outputs": (20, lambda time, sample, s, now: [time, 1.0, 1.0]),
}


def ulog(
    topics: Sequence[str] = tuple(TOPICS),
    formats: dict[str, str] | None = None,
    appended: Sequence[int] = (),
    duration: float = DURATION,
) -> bytes:
    """A log with these topics, in the order of the times of logging."""
    log = MAGIC + struct.pack("<Q", 1_000_000) + flags(appended)
    for name, fields in (FORMATS | (formats or {})).items():
        log += record("F", f"{name}:{fields}".encode())
    key = b"char[3] sys_name"
    log += record("I", bytes([len(key)]) + key + b"PX4")
    messages = []
    for number, topic in enumerate(topics):
        log += subscription(number, topic)
        rate, values = TOPICS[topic]
        for k in range(round(duration * rate)):
            seconds = k / rate
            sample = round((BOOT + seconds) * 1e6)
            time = sample + round(DELAY * 1e6)
            content = values(time, sample, seconds, truth(seconds))
            messages.append((time, message(number, topic, content)))
    # Neither strings nor dropouts are messages.
    log += record("L", b"6" + struct.pack("<Q", 1) + b"hello") + record("O", struct.pack("<H", 12))
    return log + b"".join(content for _, content in sorted(messages, key=lambda pair: pair[0]))


if __name__ == "__main__":
    Path(sys.argv[1]).write_bytes(ulog())
