"""`ugv import` on logs that other people's writers wrote, against the drive's truth."""

import csv
import json
import math
import os
import subprocess
import tempfile
import unittest
from dataclasses import dataclass
from pathlib import Path

import make_bags
from make_bags import FIX, IMU, JOINT_STATE, ODOMETRY, ROS1, ROS2, START, Factory, Message, truth
from mcap.writer import CompressionType

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
UGV = Path(os.environ.get("UGV_TOOL") or TARGET / "release" / "ugv")

# What serialising 64-bit numbers leaves of them: all.
EXACT = 1e-12
# Latitude and longitude in degrees have 14 digits behind the point: a billionth of a metre. The
# inverse transformation's iteration stops a little above.
POSITION = 1e-7  # m
BAD_INPUT = 2


def setUpModule() -> None:
    if not UGV.is_file():
        raise FileNotFoundError(
            f"{UGV} is missing; run cargo build --release, or name another in UGV_TOOL"
        )


@dataclass
class Run:
    """What the tool did."""

    status: int
    printed: str
    stderr: str


def ugv(*arguments: object) -> Run:
    """Runs the tool."""
    words = [str(UGV), "import", *map(str, arguments)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    return Run(done.returncode, done.stdout, done.stderr)


class Recording:
    """A recording: each column's samples by their time [s]."""

    def __init__(self, path: Path) -> None:
        with path.open(newline="") as file:
            rows = list(csv.DictReader(file))
        self.names = list(rows[0])
        self.times = [float(row["time"]) for row in rows]
        self.columns = {
            name: {float(row["time"]): float(row[name]) for row in rows if row[name]}
            for name in self.names[1:]
        }
        self.beside = json.loads(path.with_suffix(".json").read_text())
        self.notes = "\n".join(self.beside["provenance"]["notes"])


class ImportCase(unittest.TestCase):
    """A folder for logs, and what they are compared with."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.ros1, self.ros2 = Factory(ROS1), Factory(ROS2)

    def log(self, messages: list[Message], name: str = "log.mcap", **options: object) -> Path:
        """Writes a log of ROS 2."""
        path = self.folder / name
        make_bags.write_mcap(path, messages, **options)
        return path

    def imported(self, log: Path, *arguments: object) -> Recording:
        """Imports what can be imported."""
        output = self.folder / "out.csv"
        run = ugv(log, "--output", output, "--force", *arguments)
        self.assertEqual(run.status, 0, run.stderr)
        self.stderr = run.stderr
        return Recording(output)

    def refused(self, log: Path, *arguments: object) -> str:
        """Why a log is refused; nothing is written."""
        output = self.folder / "refused.csv"
        run = ugv(log, "--output", output, *arguments)
        self.assertEqual(run.status, BAD_INPUT, run.stderr)
        self.assertFalse(output.exists())
        self.assertNotIn("panicked", run.stderr)
        return run.stderr

    def joints(self, speeds: dict[str, float] | None = None) -> list[Message]:
        """Joint states."""
        return [
            Message(
                "/joint_states",
                JOINT_STATE,
                t,
                self.ros2.joints(t, speeds or make_bags.velocities(truth(s))),
            )
            for t, s in make_bags.ticks(50)
        ]

    def odometry(self, topic: str = "/ins/odom", rate: float = 20.0) -> list[Message]:
        """Odometry."""
        return [
            Message(topic, ODOMETRY, t, self.ros2.odometry(t, truth(s)))
            for t, s in make_bags.ticks(rate)
        ]

    def assert_column(
        self, recording: Recording, name: str, expected: object, within: float
    ) -> None:
        """Every sample of a column against a function of time."""
        samples = recording.columns[name]
        self.assertGreater(len(samples), 0, name)
        worst = max(abs(value - expected(time)) for time, value in samples.items())
        self.assertLessEqual(worst, within, name)


class Drive(ImportCase):
    """The whole drive in every container, encoding and compression."""

    @classmethod
    def setUpClass(cls) -> None:
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.logs = Path(folder.name)
        make_bags.main(cls.logs)

    def test_every_file_gives_the_truth(self) -> None:
        logs = sorted(self.logs.iterdir())
        self.assertEqual(len(logs), 9)
        for log in logs:
            with self.subTest(log.name):
                recording = self.imported(log)
                expected = "time omega_left omega_right x y heading v_x v_y yaw_rate a_x a_y"
                self.assertEqual(recording.names, expected.split())
                self.assertEqual(recording.times, sorted(set(recording.times)))
                for name in ("omega_left", "omega_right", "x", "y", "heading", "v_x", "v_y"):
                    self.assert_column(
                        recording, name, lambda t: getattr(truth(t), name), EXACT * 100
                    )
                self.assert_column(
                    recording, "yaw_rate", lambda t: truth(t).yaw_rate + 0.001, EXACT
                )
                self.assert_column(recording, "a_x", lambda t: 0.3, EXACT)
                counts = {name: len(samples) for name, samples in recording.columns.items()}
                self.assertEqual(
                    [counts[name] for name in ("omega_left", "x", "yaw_rate")], [1000, 400, 2000]
                )

    def test_provenance_tells_where_everything_is_from(self) -> None:
        recording = self.imported(self.logs / "drive_lz4.bag")
        self.assertEqual(recording.beside["source"], "drive_lz4.bag (ROS 1 bag)")
        provenance = recording.beside["provenance"]
        self.assertEqual(provenance["start_unix_s"], "1700000000")
        topics = {topic["serves_as"]: topic for topic in provenance["topics"]}
        self.assertEqual(topics["joints"]["topic"], "/joint_states")
        self.assertEqual(topics["odometry"]["messages"], 400)
        self.assertEqual(topics["odometry"]["child_frame"], "base_link")
        self.assertEqual(topics["imu"]["frame"], "imu_link")
        left = provenance["columns"]["omega_left"]
        self.assertIn("mean of front_left_wheel, rear_left_wheel", left["conversion"])
        self.assertNotIn("left_arm", left["conversion"])
        self.assertIn("pose from /ins/odom (--pose fix takes it from /gps/fix)", recording.notes)
        self.assertIn("2 of 100 fixes are invalid", recording.notes)

    def test_pose_from_fixes(self) -> None:
        recording = self.imported(
            self.logs / "drive_cdr_zstd.mcap", "--pose", "fix", "--heading", "imu"
        )
        self.assertEqual(len(recording.columns["x"]), 98)
        fixes = sorted(recording.columns["x"])[1:]
        for name in ("x", "y"):
            samples = recording.columns[name]
            worst = max(abs(samples[time] - getattr(truth(time), name)) for time in fixes)
            self.assertLess(worst, POSITION)
            self.assertEqual(samples[min(samples)], 0.0)
        self.assert_column(recording, "heading", lambda t: truth(t).heading, EXACT * 100)
        self.assertEqual(len(recording.columns["heading"]), 2000)

    def test_list_shows_the_topics(self) -> None:
        for log in ("drive_bz2.bag", "drive_ros1.mcap"):
            run = ugv(self.logs / log, "--list")
            self.assertEqual(run.status, 0, run.stderr)
            lines = {line.split()[0]: line for line in run.printed.splitlines()}
            self.assertIn("sensor_msgs/Imu", lines["/imu/data"].replace("/msg/", "/"))
            for word in ("ros1", "2000", "100.00", "0.00 .. 19.99", "imu *"):
                self.assertIn(word, lines["/imu/data"])
            self.assertIn("front_left_wheel", run.printed)
            self.assertTrue(lines["/log"].endswith("-"))

    def test_files_that_were_cut_off(self) -> None:
        for name in (
            "drive_none.bag",
            "drive_bz2.bag",
            "drive_cdr_lz4.mcap",
            "drive_cdr_no_chunks.mcap",
        ):
            whole = (self.logs / name).read_bytes()
            cut = self.folder / name
            cut.write_bytes(whole[: len(whole) // 2])
            with self.subTest(name):
                stderr = self.refused(cut)
                self.assertIn("is damaged near byte", stderr)
                self.assertIn("--partial imports what comes before", stderr)
                recording = self.imported(cut, "--partial")
                self.assertTrue(recording.beside["provenance"]["damaged"])
                self.assertIn("these were imported", recording.notes)
                self.assertTrue(5.0 < recording.times[-1] < 15.0, recording.times[-1])
                self.assert_column(recording, "x", lambda t: truth(t).x, EXACT * 100)

    def test_no_damage_makes_it_panic(self) -> None:
        for name in (
            "drive_none.bag",
            "drive_lz4.bag",
            "drive_cdr_none.mcap",
            "drive_cdr_zstd.mcap",
        ):
            whole = (self.logs / name).read_bytes()
            path = self.folder / name
            for part in range(1, 12):
                broken = bytearray(whole)
                place = len(broken) * part // 13
                broken[place : place + 16] = bytes([255]) * 16
                path.write_bytes(broken)
                run = ugv(path, "--partial", "--output", self.folder / "out.csv", "--force")
                self.assertIn(run.status, (0, BAD_INPUT), f"{name} {part}: {run.stderr}")
                self.assertNotIn("panicked", run.stderr)

    def test_what_stands_in_the_json_stays(self) -> None:
        beside = self.folder / "out.json"
        beside.write_text('{"terrain": {"name": "mine"}, "source": "old"}')
        recording = self.imported(self.logs / "drive_lz4.bag")
        self.assertEqual(recording.beside["terrain"], {"name": "mine"})
        self.assertEqual(recording.beside["source"], "drive_lz4.bag (ROS 1 bag)")
        beside.write_text("[1]")
        run = ugv(self.logs / "drive_lz4.bag", "--output", self.folder / "out.csv", "--force")
        self.assertEqual(run.status, BAD_INPUT)
        self.assertIn("not a JSON object", run.stderr)
        self.assertEqual(beside.read_text(), "[1]")

    def test_standard_output_has_the_table(self) -> None:
        run = ugv(self.logs / "drive_lz4.bag", "--quiet")
        self.assertEqual((run.status, run.stderr), (0, ""))
        self.assertTrue(run.printed.startswith("time,omega_left,omega_right,x,y,"))


class Wheels(ImportCase):
    """Wheel speeds."""

    def test_positions_where_there_is_no_velocity(self) -> None:
        for wrapped in (False, True):
            messages = []
            for t, s in make_bags.ticks(50):
                left, right = make_bags.wheel_angles(s)
                angles = {"wheel_l": left, "wheel_r": right}
                if wrapped:
                    angles = {name: math.remainder(a, math.tau) for name, a in angles.items()}
                message = self.ros2.joints(t, None, angles)
                messages.append(Message("/joint_states", JOINT_STATE, t, message))
            recording = self.imported(self.log(messages))
            self.assertIn("wheel speeds are differences of positions", recording.notes)
            self.assertEqual("after unwrapping" in recording.notes, wrapped)
            # The first difference is at 10 ms, which becomes zero; a difference's error is
            # step^2 / 24 times the second derivative, below 3 rad/s^3.
            for name in ("omega_left", "omega_right"):
                self.assertEqual(len(recording.columns[name]), 999)
                self.assert_column(recording, name, lambda t: getattr(truth(t + 0.01), name), 1e-4)

    def test_mirrored_wheels_are_noted_and_turned(self) -> None:
        mirrored = [
            Message("/joint_states", JOINT_STATE, t, self.ros2.joints(t, {"fl": 4.0, "fr": -5.0}))
            for t, _ in make_bags.ticks(50)
        ]
        log = self.log(mirrored)
        self.assertIn("--invert right", self.imported(log).notes)
        recording = self.imported(log, "--invert", "right")
        self.assertNotIn("--invert", recording.notes)
        self.assertEqual(set(recording.columns["omega_right"].values()), {5.0})

    def test_joints_that_tell_no_side_are_named(self) -> None:
        log = self.log(self.joints({"m1": 1.0, "m2": 2.0, "m3": 3.0, "m4": 5.0}))
        stderr = self.refused(log)
        for word in ("m1, m2, m3, m4", "--left NAME", "left wheel"):
            self.assertIn(word, stderr)
        recording = self.imported(log, "--left", "m1,m2", "--right", "m3,m4")
        self.assertEqual(set(recording.columns["omega_left"].values()), {1.5})
        self.assertEqual(set(recording.columns["omega_right"].values()), {4.0})
        self.assertIn("no joint `m9`", self.refused(log, "--left", "m9", "--right", "m3"))
        self.assertIn("both sides", self.refused(log, "--left", "m3", "--right", "m3"))

    def test_no_joint_states(self) -> None:
        stderr = self.refused(self.log(self.odometry()))
        self.assertIn("wheel speeds are required", stderr)
        self.assertIn("/ins/odom (nav_msgs/msg/Odometry)", stderr)


class Choices(ImportCase):
    """Topics, poses and clocks."""

    def test_of_several_topics_by_the_rule(self) -> None:
        log = self.log(
            self.joints()
            + self.odometry("/wheel/odom", 40.0)
            + self.odometry("/odometry/filtered", 30.0)
            + self.odometry("/lidar_slam/pose", 10.0)
        )
        recording = self.imported(log)
        self.assertEqual(len(recording.columns["x"]), 200)
        self.assertIn("odometry from /lidar_slam/pose", recording.notes)
        self.assertIn("/odometry/filtered, /wheel/odom", recording.notes)
        recording = self.imported(log, "--topics", "odometry=odometry/filtered")
        self.assertEqual(len(recording.columns["x"]), 600)
        self.assertIn("does not show the source of its pose", recording.notes)
        recording = self.imported(log, "--topics", "odometry=none")
        self.assertEqual(recording.names, ["time", "omega_left", "omega_right"])
        self.assertIn("no pose", recording.notes)
        stderr = self.refused(log, "--topics", "odometry=/wheel/odm")
        self.assertIn("no such topic", stderr)
        self.assertIn("--topics odometry=/wheel/odom", stderr)
        self.assertIn("it is of type", self.refused(log, "--topics", "imu=/wheel/odom"))
        self.assertIn("KIND=TOPIC", self.refused(log, "--topics", "laser=/scan"))
        self.assertIn("--pose fix needs", self.refused(log, "--pose", "fix"))

    def test_wheel_odometry_is_no_ground_truth(self) -> None:
        def computed(s: float) -> make_bags.Truth:
            state = truth(s)
            return state._replace(v_x=0.14 * (state.omega_left + state.omega_right) / 2)

        odometry = [
            Message("/odom", ODOMETRY, t, self.ros2.odometry(t, computed(s)))
            for t, s in make_bags.ticks(25)
        ]
        recording = self.imported(self.log(self.joints() + odometry))
        self.assertIn("v_x is 0.1400 m times the mean wheel speed", recording.notes)
        self.assertIn("no ground truth for slip", recording.notes)
        fixes = [
            Message("/fix", FIX, t, self.ros2.fix(t, make_bags.geodetic(truth(s).x, truth(s).y)))
            for t, s in make_bags.ticks(5)
        ]
        recording = self.imported(self.log(self.joints() + odometry + fixes))
        self.assertEqual(len(recording.columns["x"]), 100)
        self.assertNotIn("v_x", recording.names)
        self.assertIn("pose from /fix, not from /odom", recording.notes)
        self.assertIn("no heading", recording.notes)

    def test_velocities_of_the_world_are_left_out(self) -> None:
        def world(s: float) -> make_bags.Truth:
            state = truth(s)
            sin, cos = math.sin(state.heading), math.cos(state.heading)
            return state._replace(
                v_x=state.v_x * cos - state.v_y * sin, v_y=state.v_x * sin + state.v_y * cos
            )

        odometry = [
            Message("/truth", ODOMETRY, t, self.ros2.odometry(t, world(s)))
            for t, s in make_bags.ticks(25)
        ]
        recording = self.imported(self.log(self.joints() + odometry))
        expected = ["time", "omega_left", "omega_right", "x", "y", "heading", "yaw_rate"]
        self.assertEqual(recording.names, expected)
        self.assertIn("in the frame of the pose, not in that of the vehicle", recording.notes)

    def test_a_sensor_upside_down(self) -> None:
        imu = [
            Message("/imu", IMU, t, self.ros2.imu(t, truth(s), up=-1.0, known=False))
            for t, s in make_bags.ticks(50)
        ]
        log = self.log(self.joints() + imu)
        # Gravity tells how it yaws, not where its x axis points to.
        recording = self.imported(log)
        self.assertIn("warning: /imu: its z axis points down", recording.notes)
        self.assert_column(recording, "yaw_rate", lambda t: truth(t).yaw_rate + 0.001, EXACT)
        self.assertNotIn("a_y", recording.names)
        recording = self.imported(log, "--imu-z-down")
        self.assertNotIn("z axis", recording.notes)
        self.assert_column(recording, "yaw_rate", lambda t: truth(t).yaw_rate + 0.001, EXACT)
        self.assert_column(recording, "a_y", lambda t: truth(t).v_x * truth(t).yaw_rate, EXACT)
        self.assertIn("needs messages with an attitude", self.refused(log, "--heading", "imu"))

    def test_a_camera_goes_last_and_yaws_about_the_vertical(self) -> None:
        camera = [
            Message("/camera/imu", IMU, t, self.ros2.imu(t, truth(s), optical=True))
            for t, s in make_bags.ticks(200)
        ]
        vehicle = [
            Message("/imu/data", IMU, t, self.ros2.imu(t, truth(s)))
            for t, s in make_bags.ticks(50)
        ]
        log = self.log(self.joints() + camera + vehicle)
        recording = self.imported(log)
        self.assertEqual(len(recording.columns["yaw_rate"]), 1000)
        self.assertIn("imu from /imu/data", recording.notes)
        recording = self.imported(log, "--topics", "imu=/camera/imu")
        self.assertNotIn("a_x", recording.names)
        self.assertIn("deg from upright", recording.notes)
        # The drive does not rest: the mean specific force is 9 deg from the vertical.
        self.assert_column(recording, "yaw_rate", lambda t: truth(t).yaw_rate, 0.01)

    def test_precise_fixes_beside_odometry_of_unknown_origin(self) -> None:
        def fixes(deviation: float) -> list[Message]:
            return [
                Message(
                    "/fix",
                    FIX,
                    t,
                    self.ros2.fix(
                        t, make_bags.geodetic(truth(s).x, truth(s).y), deviation=deviation
                    ),
                )
                for t, s in make_bags.ticks(5)
            ]

        drive = self.joints() + self.odometry("/odom")
        recording = self.imported(self.log(drive + fixes(0.02)))
        self.assertEqual(len(recording.columns["x"]), 100)
        self.assertIn("warning: pose from /fix", recording.notes)
        self.assertNotIn("v_x", recording.names)
        recording = self.imported(self.log(drive + fixes(1.5)))
        self.assertEqual(len(recording.columns["x"]), 400)
        self.assertIn("warning: pose from /odom (--pose fix", recording.notes)
        self.assertIn("warning: the name of /odom does not show", recording.notes)

    def test_odd_attitudes_and_numbers(self) -> None:
        odometry = self.odometry()
        states = [truth((message.time - START) * 1e-9) for message in odometry]
        long = self.ros2.odometry(odometry[3].time, states[3], length=2.0)
        zero = self.ros2.odometry(odometry[5].time, states[5], length=0.0)
        nan = self.ros2.odometry(odometry[7].time, states[7]._replace(x=math.nan))
        for place, content in ((3, long), (5, zero), (7, nan)):
            odometry[place] = odometry[place]._replace(content=content)
        recording = self.imported(self.log(self.joints() + odometry))
        self.assertEqual(len(recording.columns["heading"]), 399)
        self.assertEqual(len(recording.columns["x"]), 399)
        self.assertIn("1 of 400 messages of /ins/odom have no attitude", recording.notes)
        self.assertIn("1 of 400 quaternions of /ins/odom are not of length 1", recording.notes)
        self.assertIn("x: 1 of 400 values of /ins/odom are no finite numbers", recording.notes)
        self.assert_column(recording, "heading", lambda t: truth(t).heading, EXACT * 100)

    def test_times_that_are_missing_repeated_or_out_of_order(self) -> None:
        bare = [
            Message("/joint_states", JOINT_STATE, 0, self.ros2.joints(0, {"l": 1.0, "r": s}), t)
            for t, s in make_bags.ticks(50, 0.5)
        ]
        recording = self.imported(self.log(bare + self.odometry()))
        self.assertIn("1000 of 1000 of /joint_states", recording.notes)
        self.assertEqual(recording.beside["provenance"]["clock"], "log")
        # The first odometry is logged 3 ms after it was measured, the wheels at once.
        self.assert_column(recording, "omega_right", lambda t: t + 0.003, EXACT)

        # A topic of few messages spares one, and one that serves as nothing all of them.
        def fixes(bare: set[int]) -> list[Message]:
            return [
                Message("/fix", FIX, t, self.ros2.fix(-1 if k in bare else t, place), t)
                for k, (t, s) in enumerate(make_bags.ticks(2))
                for place in [make_bags.geodetic(truth(s).x, truth(s).y)]
            ]

        drive = self.joints() + self.odometry()
        recording = self.imported(self.log(drive + fixes({0, 1, 2, 7})), "--pose", "fix")
        self.assertEqual(recording.beside["provenance"]["clock"], "header")
        self.assertEqual(len(recording.columns["x"]), 36)
        recording = self.imported(self.log(drive + fixes(set(range(40)))))
        self.assertEqual(recording.beside["provenance"]["clock"], "header")
        recording = self.imported(self.log(drive + fixes(set(range(40)))), "--pose", "fix")
        self.assertEqual(recording.beside["provenance"]["clock"], "log")
        self.assertIn("warning: messages without a time of measurement", recording.notes)

        joints = self.joints()
        joints[10], joints[20] = joints[20], joints[10]
        recording = self.imported(self.log([*joints, joints[30]]))
        self.assertIn("steps back", recording.notes)
        self.assertIn("1 of 1001 messages repeat a time", recording.notes)
        self.assert_column(recording, "omega_left", lambda t: truth(t).omega_left, EXACT * 100)

        late = [m._replace(logged=m.time + 18_000_000_000) for m in self.odometry()]
        log = self.log(self.joints() + late)
        self.assertIn("/ins/odom is logged 18.000 s after", self.imported(log).notes)
        recording = self.imported(log, "--time", "log")
        self.assertAlmostEqual(min(recording.columns["x"]), 17.997, places=9)

    def test_files_of_other_formats(self) -> None:
        for content, words in (
            (b"", "is empty"),
            (b"time,omega_left,omega_right\n", "is no MCAP file, no bag of ROS 1 or ROS 2 and no log of PX4"),
            (b"SQLite format 3\0 and more", "is damaged behind message 0"),
            (b"\x1f\x8b and more", "gunzip"),
            (b"\xa3\x95\x80\x80 and more", "ArduPilot"),
            (b"#ROSBAG V1.2\n", "rosbag migrate"),
        ):
            log = self.folder / "other"
            log.write_bytes(content)
            with self.subTest(content):
                self.assertIn(words, " ".join(self.refused(log).split()))
        (self.folder / "empty").mkdir()
        self.assertIn("a folder without .mcap", self.refused(self.folder / "empty"))
        self.assertIn("cannot read", self.refused(self.folder / "nowhere.bag"))
        json_log = self.log(self.joints(), encoding="json", compression=CompressionType.NONE)
        self.assertIn("encoding `json`", self.refused(json_log))


if __name__ == "__main__":
    unittest.main()
