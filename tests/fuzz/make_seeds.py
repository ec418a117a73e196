"""Seeds for the fuzz targets: small files of each kind.

`target/venv/bin/python tests/fuzz/make_seeds.py` writes them anew to tests/fuzz/seeds. Those of the sequences
of calls (fmi2, fmi3) are not made here: they are what was found by fuzzing, and kept.
"""

import bz2
import json
import math
import struct
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPOSITORY / "tests" / "python"))

import lz4.frame
from make_bags import (
    FIX,
    IMU,
    JOINT_STATE,
    ODOMETRY,
    ORIGIN,
    ROS1,
    ROS2,
    START,
    Factory,
    Message,
    logged,
    truth,
    velocities,
    write_mcap,
)
from make_ulog import ulog
from mcap.writer import CompressionType

SEEDS = Path(__file__).resolve().parent / "seeds"
PRESETS = REPOSITORY / "modelDescription" / "resources"
# The first byte of a log's seed: what the user asks for.
WISHES = {"nothing": 0x00, "all_there_is": 0x01, "from_fixes": 0x65, "upside_down": 0x9E}


def log(make: Factory, count: int = 2) -> list[Message]:
    """A few messages of each sensor."""
    messages = []
    for number in range(count):
        time, seconds = START + number * 100_000_000, 0.1 * number
        now = truth(seconds)
        joints = make.joints(time, velocities(now))
        place = (ORIGIN[0] + 1e-6 * number, ORIGIN[1], ORIGIN[2])
        messages += [
            Message("/joint_states", JOINT_STATE, time, joints),
            Message("/odom", ODOMETRY, time, make.odometry(time, now)),
            Message("/imu", IMU, time, make.imu(time, now)),
            Message("/fix", FIX, time, make.fix(time, place)),
        ]
    return messages


def field(name: str, value: bytes) -> bytes:
    """A field of a record's header."""
    content = name.encode() + b"=" + value
    return struct.pack("<I", len(content)) + content


def record(op: int, data: bytes, *fields: bytes) -> bytes:
    """A record of a ROS 1 bag."""
    header = b"".join([field("op", bytes([op])), *fields])
    return struct.pack("<I", len(header)) + header + struct.pack("<I", len(data)) + data


def bag(messages: list[Message], compression: str) -> bytes:
    """A ROS 1 bag without the definitions of its messages, which are most of a small one."""
    topics = list(dict.fromkeys((m.topic, m.type) for m in messages))
    content = b""
    for number, (topic, kind) in enumerate(topics):
        data = field("topic", topic.encode()) + field("type", kind.replace("/msg/", "/").encode())
        connection = field("conn", struct.pack("<I", number))
        content += record(0x07, data, connection, field("topic", topic.encode()))
    for message in messages:
        number = topics.index((message.topic, message.type))
        time = struct.pack("<II", *divmod(logged(message), 10**9))
        data = bytes(ROS1.serialize_ros1(message.content, message.type))
        content += record(0x02, data, field("conn", struct.pack("<I", number)), field("time", time))
    pack = {"none": bytes, "bz2": bz2.compress, "lz4": lz4.frame.compress}[compression]
    size, name = field("size", struct.pack("<I", len(content))), compression.encode()
    chunk = record(0x05, pack(content), size, field("compression", name))

    def start(index: int) -> bytes:
        return b"#ROSBAG V2.0\n" + record(0x03, b"", field("index_pos", struct.pack("<Q", index)))

    return start(len(start(0)) + len(chunk)) + chunk


def logs(folder: Path) -> None:
    """MCAP files, ROS 1 bags and logs of PX4."""
    (folder / "ulog_all_there_is").write_bytes(bytes([WISHES["all_there_is"]]) + ulog(duration=0.1))
    ros1, ros2 = log(Factory(ROS1)), log(Factory(ROS2))
    for compression, (wish, byte) in zip(("none", "bz2", "lz4", "none"), WISHES.items()):
        (folder / f"bag_{compression}_{wish}").write_bytes(bytes([byte]) + bag(ros1, compression))
    for wish, (encoding, messages, options) in zip(
        WISHES,
        (
            ("cdr", ros2, {"use_chunking": False}),
            ("cdr", ros2, {"compression": CompressionType.LZ4}),
            ("ros1", ros1, {"compression": CompressionType.ZSTD}),
            ("cdr", ros2, {"use_chunking": False, "little_endian": False}),
        ),
    ):
        path = folder / f"mcap_{wish}"
        write_mcap(path, messages, encoding, enable_crcs=False, **options)
        path.write_bytes(bytes([WISHES[wish]]) + path.read_bytes())


def recordings(folder: Path) -> None:
    """Recordings, with what stands beside them behind a zero byte, and drives."""
    rows = []
    for number in range(12):
        now = truth(0.1 * number)
        values = (now.omega_left, now.omega_right, now.x, now.y, now.heading, now.v_x, now.yaw_rate)
        rows.append([f"{0.1 * number:.2f}", *(f"{value:.4g}" for value in values)])
    names = ["time", "omega_left", "omega_right", "x", "y", "heading", "v_x", "yaw_rate"]

    def table(header: list[str], lines: list[list[str]]) -> bytes:
        return "\n".join(map(",".join, [header, *lines])).encode() + b"\n"

    beside = json.dumps({"terrain": "dry_sand", "sensors": {"x": {"noise": 0.02}}, "source": "seed"})
    (folder / "all").write_bytes(table(names, rows) + b"\0" + beside.encode())
    runs = [[str(number // 6), *row] for number, row in enumerate(rows)]
    (folder / "runs").write_bytes(table(["run", *names], runs))
    (folder / "drive").write_bytes(table(names[:3], [row[:3] for row in rows]))
    holes = [[cell if (i + j) % 3 or j < 3 else ("", "nan")[j % 2] for j, cell in enumerate(row)] for i, row in enumerate(rows)]
    (folder / "holes").write_bytes(b"\xef\xbb\xbf" + table(names, holes).replace(b"\n", b"\r\n"))
    milli = [[f"{1.7e12 + 100 * i:.0f}", *row[1:4], row[4], f"{math.degrees(float(row[5])):.3g}", *row[6:]] for i, row in enumerate(rows)]
    (folder / "milliseconds_and_degrees").write_bytes(table(names, milli[::-1]))


def objects(folder: Path) -> None:
    """What is read as JSON."""
    effects = {
        "format": "ugv-effects/1",
        "grade": {"profile": {"over": "time", "points": [[0, 0, 0], [5, 0.1, 0]]}},
        "terrain_change": {"over": "distance", "cohesion_factor": 0.5, "position": 3.0},
        "payload": {"mass": 20.0, "ahead": 0.1},
        "multipass": {},
        "window": {"effects": ["payload"], "time": [1.0, 2.0]},
    }
    vehicle = json.loads((PRESETS / "vehicle.json").read_text())
    terrains = json.loads((PRESETS / "terrains.json").read_text())
    somewhere = {
        "grade": {
            "profile": {"over": "place", "x": [0, 5], "y": [0, 9], "slopes": [[[0, 0], [0.1, 0]], [[0, 0.1], [0, 0]]]}
        },
        "drawbar": {"force": 300},
        "window": {"effects": ["drawbar"], "place": {"x": 5, "y": 0, "radius": 2}},
    }
    model = {"format": "ugv-model/1", "vehicle": vehicle, "terrain": "dry_clay", "effects": {"drag": {"coefficient": 1.0}}}
    about = {"vehicle": vehicle, "terrain": terrains["dry_sand"], "sensors": {"x": {"noise": 0.02}}, "note": None}
    seeds = {
        "vehicle": vehicle,
        "terrains": terrains,
        "terrain": terrains["dry_sand"],
        "selected": {"selected": "dry_clay"},
        "effects": effects,
        "somewhere": somewhere,
        "model": model,
        "about": about,
    }
    for name, content in seeds.items():
        (folder / name).write_text(json.dumps(content))


def main() -> None:
    """All of them."""
    for make, name in ((logs, "import"), (recordings, "recording"), (objects, "json")):
        folder = SEEDS / name
        folder.mkdir(parents=True, exist_ok=True)
        make(folder)


if __name__ == "__main__":
    main()
