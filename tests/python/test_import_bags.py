"""`ugv import` on bags of ROS 2 of every storage and compression, and on messages of every type."""

import json
import math
import shutil
import sqlite3
import subprocess

import make_bags
from backports import zstd
from make_bags import (
    JOINT_STATE,
    ODOMETRY,
    POSE,
    POSE_COVARIANCE,

    START,
    TRANSFORM,
    TRANSFORMS,
    TWIST,
    Factory,
    Message,
    truth,
)
from rosbags.rosbag2 import CompressionMode, StoragePlugin
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from test_import import BAD_INPUT, EXACT, UGV, ImportCase, Recording, setUpModule, ugv

__all__ = ["setUpModule"]
SQLITE, MCAP = StoragePlugin.SQLITE3, StoragePlugin.MCAP


class BagCase(ImportCase):
    """Bags of ROS 2 in folders."""

    def bag(self, messages: list[Message], name: str = "bag", **options: object):
        """Writes a bag and returns its file; the folder is made anew."""
        folder = self.folder / name
        shutil.rmtree(folder, ignore_errors=True)
        return make_bags.write_bag2(folder, messages, **options)

    def assert_truth(self, recording: Recording, count: int = 400) -> None:
        """Wheel speeds and pose are those of the drive."""
        self.assertEqual(len(recording.columns["x"]), count)
        for name in ("omega_left", "omega_right", "x", "y", "heading"):
            self.assert_column(recording, name, lambda t: getattr(truth(t), name), EXACT * 100)


class Storages(BagCase):
    """Every storage and compression, whole and damaged."""

    def test_every_storage_and_compression_gives_the_truth(self) -> None:
        drive = make_bags.drive(self.ros2)
        modes = (CompressionMode.NONE, CompressionMode.FILE, CompressionMode.MESSAGE)
        for storage in (SQLITE, MCAP):
            for mode in modes:
                file = self.bag(drive, storage=storage, mode=mode)
                for log in (file, file.parent):
                    with self.subTest(storage=storage, mode=mode, log=log.name):
                        recording = self.imported(log)
                        self.assert_truth(recording)
                        self.assertEqual(len(recording.columns["yaw_rate"]), 2000)
                        self.assertNotIn("warning", recording.notes)
        # Nothing is left beside the log.
        self.assertEqual(len(list(file.parent.iterdir())), 2)

    def test_a_bag_in_parts_is_one_recording(self) -> None:
        drive = make_bags.drive(self.ros2)
        third = len(drive) // 3
        parts = [drive[:third], drive[third : 2 * third], drive[2 * third :]]
        folder = self.folder / "split"
        folder.mkdir()
        names = []
        for number, part in zip((0, 9, 10), parts):
            mode = CompressionMode.FILE if number == 9 else CompressionMode.NONE
            file = self.bag(part, f"part{number}", mode=mode)
            name = f"split_{number}" + "".join(file.suffixes)
            file.rename(folder / name)
            names.append(name)
        # Lost metadata.
        recording = self.imported(folder)
        self.assert_truth(recording)
        self.assertIn("no metadata.yaml", recording.notes)
        lines = "".join(f"    - {name}\n" for name in [*names, "split_11.db3"])
        information = f"rosbag2_bagfile_information:\n  relative_file_paths:\n{lines}"
        (folder / "metadata.yaml").write_text(information)
        recording = self.imported(folder)
        self.assert_truth(recording)
        self.assertIn("names split_11.db3, which the folder lacks", recording.notes)
        # Another log beside it is no part of it.
        shutil.copy(folder / names[0], folder / "other.db3")
        self.assert_truth(self.imported(folder))
        (folder / "metadata.yaml").unlink()
        self.assertIn("a folder with several logs", self.refused(folder))

    def test_a_bag_that_was_cut_off(self) -> None:
        drive = make_bags.drive(self.ros2)
        for storage, mode in (
            (SQLITE, CompressionMode.NONE),
            (SQLITE, CompressionMode.FILE),
            (MCAP, CompressionMode.FILE),
        ):
            file = self.bag(drive, storage=storage, mode=mode)
            content = file.read_bytes()
            file.write_bytes(content[: len(content) // 2])
            with self.subTest(file.name):
                stderr = self.refused(file)
                self.assertIn("is damaged", stderr)
                if storage == SQLITE and mode == CompressionMode.NONE:
                    self.assertIn("--partial imports what comes before", stderr)
                    recording = self.imported(file, "--partial")
                    self.assertGreater(recording.times[-1], 5.0)
                    self.assert_column(recording, "x", lambda t: truth(t).x, EXACT * 100)

    def test_no_damage_makes_it_panic_or_write(self) -> None:
        for mode in (CompressionMode.NONE, CompressionMode.FILE, CompressionMode.MESSAGE):
            file = self.bag(make_bags.drive(self.ros2)[:800], mode=mode)
            content = file.read_bytes()
            for part in range(12):
                broken = bytearray(content)
                place = 16 + len(broken) * part // 13
                broken[place : place + 16] = bytes([255]) * 16
                file.write_bytes(broken)
                run = ugv(file, "--partial", "--output", self.folder / "out.csv", "--force")
                self.assertIn(run.status, (0, BAD_INPUT), f"{mode} {part}: {run.stderr}")
                self.assertNotIn("panicked", run.stderr)
                self.assertEqual(file.read_bytes(), broken)

    def test_databases_that_mean_harm(self) -> None:
        def database(*statements: str):
            path = self.folder / "evil.db3"
            path.unlink(missing_ok=True)
            with sqlite3.connect(path) as connection:
                for statement in statements:
                    connection.execute(statement)
            connection.close()
            return path

        topics = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT)"
        messages = "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)"
        topic = "INSERT INTO topics VALUES(1, '/j', 'sensor_msgs/msg/JointState', 'cdr')"
        endless = (
            "CREATE VIEW messages AS WITH RECURSIVE r(id) AS (SELECT 1 UNION ALL SELECT id + 1 FROM r) "
            "SELECT id, 1 AS topic_id, id AS timestamp, zeroblob(1000) AS data FROM r"
        )
        computed = messages[:-1].replace("data BLOB", "data BLOB AS (zeroblob(900000000))") + ")"
        for words, statements in (
            ("without the tables of a ROS 2 bag", ["CREATE TABLE a(b)"]),
            ("without the tables of a ROS 2 bag", [topics, endless]),
            (
                "without the tables of a ROS 2 bag",
                [topics, topic, computed, "INSERT INTO messages(topic_id, timestamp) VALUES(1, 1)"],
            ),
            ("belongs to no topic", [topics, messages, "INSERT INTO messages VALUES(1, 7, 1, x'00')"]),
            ("are none", [topics, topic, messages, "INSERT INTO messages VALUES(1, 1, 1, 'text')"]),
            ("is damaged", [topics, topic, messages, "INSERT INTO messages VALUES(1, 1, 'a', x'00')"]),
        ):
            with self.subTest(words):
                stderr = self.refused(database(*statements))
                self.assertIn(words, " ".join(stderr.split()))

    def test_a_bomb_is_refused(self) -> None:
        bomb = self.folder / "bomb.mcap.zstd"
        bomb.write_bytes(zstd.compress(bytes(1 << 29)))
        self.assertIn("packed more than", " ".join(self.refused(bomb).split()))


class Messages(BagCase):
    """Message types of one vehicle."""

    def pose(self, time: int, s: float, kind: str):
        """The pose as a message of a type."""
        state = truth(s)
        if kind == TRANSFORM:
            return self.ros2.transform(time, "map", "base", state.x, state.y, state.heading)
        return self.ros2.pose_stamped(time, state, kind == POSE_COVARIANCE)

    def test_poses_of_every_type(self) -> None:
        for topic, kind in (
            ("/vicon/husky", TRANSFORM),
            ("/amcl_pose", POSE_COVARIANCE),
            ("/mocap/pose", POSE),
        ):
            poses = [Message(topic, kind, t, self.pose(t, s, kind)) for t, s in make_bags.ticks(20)]
            # A goal is no pose.
            goal = Message("/move_base/goal", POSE, START, self.pose(START, 9.0, POSE))
            with self.subTest(kind):
                recording = self.imported(self.log([*self.joints(), *poses, goal]))
                self.assert_truth(recording)
                self.assertNotIn("v_x", recording.names)
                self.assertNotIn("does not show the source", recording.notes)

    def test_transforms_between_frames_are_composed(self) -> None:
        def tree(time: int, s: float) -> list:
            state = truth(s)
            # odom stands at (3, -2) in the map, turned by 0.5.
            x, y = state.x - 3.0, state.y + 2.0
            sin, cos = math.sin(-0.5), math.cos(-0.5)
            inner = (cos * x - sin * y, sin * x + cos * y, state.heading - 0.5)
            return [
                self.ros2.transform(time, "odom", "base_link", *inner),
                self.ros2.transform(time, "base_link", "laser", 0.2, 0.0, 0.0),
            ]

        def message(time: int, transforms: list) -> Message:
            content = self.ros2.make(TRANSFORMS, transforms=transforms)
            return Message("/tf", TRANSFORMS, time, content)

        messages = [message(t, tree(t, s)) for t, s in make_bags.ticks(20)]
        messages += [
            message(t, [self.ros2.transform(t, "map", "odom", 3.0, -2.0, 0.5)])
            for t, _ in make_bags.ticks(5)
        ]
        log = self.log(self.joints() + messages)
        recording = self.imported(log)
        self.assert_column(recording, "x", lambda t: truth(t).x, 1e-9)
        self.assert_column(recording, "y", lambda t: truth(t).y, 1e-9)
        self.assert_column(recording, "heading", lambda t: truth(t).heading, 1e-9)
        self.assertIn("map -> odom -> base_link", recording.notes)
        recording = self.imported(log, "--frames", "odom,base_link")
        self.assert_column(recording, "heading", lambda t: truth(t).heading - 0.5, 1e-9)
        self.assertIn("does not show the source of its pose", recording.notes)
        self.assertIn("map,odom", self.refused(log, "--frames", "map,wheel"))

    def test_velocities_of_a_topic_without_pose(self) -> None:
        poses = [Message("/vicon", POSE, t, self.pose(t, s, POSE)) for t, s in make_bags.ticks(20)]
        twists = [
            Message("/gps/vel", TWIST, t, self.ros2.twist_stamped(t, truth(s)))
            for t, s in make_bags.ticks(10)
        ]
        commands = [m._replace(topic="/cmd_vel") for m in twists] * 2
        recording = self.imported(self.log(self.joints() + poses + twists + commands))
        self.assertEqual(len(recording.columns["v_x"]), 200)
        for name in ("v_x", "v_y", "yaw_rate"):
            self.assert_column(recording, name, lambda t: getattr(truth(t), name), EXACT)

    def test_wheels_of_several_messages_make_one_vehicle(self) -> None:
        def axle(topic: str, names: tuple[str, str], shift: float, off: float) -> list[Message]:
            return [
                Message(
                    topic,
                    JOINT_STATE,
                    t,
                    self.ros2.joints(
                        t,
                        dict(zip(names, (truth(s).omega_left + off, truth(s).omega_right + off))),
                    ),
                )
                for t, s in make_bags.ticks(50, shift)
            ]

        front = ("front_left_wheel", "front_right_wheel")
        rear = ("rear_left_wheel", "rear_right_wheel")
        for topics in (("/joint_states", "/joint_states"), ("/front/joints", "/rear/joints")):
            messages = axle(topics[0], front, 0.0, 0.2) + axle(topics[1], rear, 0.008, -0.2)
            with self.subTest(topics):
                recording = self.imported(self.log(messages))
                self.assertEqual(len(recording.columns["omega_left"]), 1998)
                # The first time with both axles, at 8 ms, becomes zero. Linear between samples 20 ms
                # apart: step^2 / 8 times the second derivative, below 3.
                for name in ("omega_left", "omega_right"):
                    self.assert_column(
                        recording, name, lambda t: getattr(truth(t + 0.008), name), 2e-4
                    )
                self.assertIn("separate messages", recording.notes)

    def test_joints_without_names_have_an_order(self) -> None:
        messages = []
        for t, s in make_bags.ticks(50):
            content = self.ros2.joints(t, make_bags.velocities(truth(s)))
            content.name = []
            messages.append(Message("/joint_states", JOINT_STATE, t, content))
        log = self.log(messages)
        stderr = " ".join(self.refused(log).split())
        self.assertIn("its 5 joints have no names", stderr)
        self.assertIn("--wheels FL,FR,RL,RR", stderr)
        recording = self.imported(log, "--wheels", "FL,RL,FR,RR,-")
        for name in ("omega_left", "omega_right"):
            self.assert_column(recording, name, lambda t: getattr(truth(t), name), EXACT * 100)
        self.assertIn("--wheels has 4", self.refused(log, "--wheels", "FL,FR,RL,RR"))
        self.assertIn("no left or right wheel", self.refused(log, "--wheels", "FL,a,b,c,d"))

    def test_efforts_are_kept(self) -> None:
        names = ("left_wheel", "right_wheel")
        messages = [
            Message(
                "/joint_states",
                JOINT_STATE,
                t,
                self.ros2.joints(
                    t,
                    dict(zip(names, (truth(s).omega_left, truth(s).omega_right))),
                    efforts=dict(zip(names, (s, 2.0 * s))),
                ),
            )
            for t, s in make_bags.ticks(50)
        ]
        recording = self.imported(self.log(messages))
        self.assert_column(recording, "effort_right", lambda t: 2.0 * t, EXACT * 100)
        self.assertEqual(recording.beside["provenance"]["columns"]["effort_left"]["unit"], "N m")

    def test_feedback_of_clearpath_drives(self) -> None:
        # docs.ros.org/en/jazzy/p/clearpath_platform_msgs, docs.ros.org/en/melodic/api/jackal_msgs
        drive = (
            "float32 current\nfloat32 duty_cycle\nfloat32 bridge_temperature\n"
            "float32 motor_temperature\nfloat32 measured_velocity\nfloat32 measured_travel\n"
            "bool driver_fault\n"
        )
        modes = "int8 commanded_mode\nint8 actual_mode\n"
        temperatures = "float32 pcb_temperature\nfloat32 mcu_temperature\n"
        for package, extra in (("clearpath_platform_msgs", ""), ("jackal_msgs", temperatures)):
            store = get_typestore(Stores.ROS2_HUMBLE)
            name, part = f"{package}/msg/Feedback", f"{package}/msg/DriveFeedback"
            text = f"std_msgs/Header header\n{package}/DriveFeedback[2] drivers\n{extra}{modes}"
            store.register({**get_types_from_msg(drive, part), **get_types_from_msg(text, name)})
            make = Factory(store)

            def feedback(time: int, s: float):
                state = truth(s)
                drivers = [
                    make.make(
                        part,
                        current=1.5,
                        duty_cycle=0.5,
                        bridge_temperature=40.0,
                        motor_temperature=41.0,
                        measured_velocity=omega,
                        measured_travel=0.0,
                        driver_fault=False,
                    )
                    for omega in (state.omega_left, state.omega_right)
                ]
                rest = {"pcb_temperature": 1.0, "mcu_temperature": 2.0} if extra else {}
                header = make.header(time, "base_link")
                return make.make(
                    name, header=header, drivers=drivers, commanded_mode=1, actual_mode=1, **rest
                )

            messages = [
                Message("/platform/feedback", name, t, feedback(t, s))
                for t, s in make_bags.ticks(50)
            ]
            with self.subTest(package):
                recording = self.imported(self.bag(messages, store=store))
                for side in ("omega_left", "omega_right"):
                    # Numbers of 32 bits.
                    self.assert_column(recording, side, lambda t: getattr(truth(t), side), 2e-6)
                self.assertEqual(set(recording.columns["current_left"].values()), {1.5})

    def test_a_preset_brings_vehicle_and_topics(self) -> None:
        joints = [m._replace(topic="/a200_0000/platform/joint_states") for m in self.joints()]
        others = [m._replace(topic="/other/joint_states") for m in self.joints()] * 2
        log = self.log(joints + others)
        recording = self.imported(log, "--preset", "husky")
        self.assertEqual(recording.beside["vehicle"]["wheel_radius"], 0.1651)
        self.assertIn("Clearpath", recording.beside["vehicle"]["assumed"])
        topic = recording.beside["provenance"]["topics"][0]["topic"]
        self.assertEqual(topic, "/a200_0000/platform/joint_states")
        # A vehicle that stands there stays.
        beside = self.folder / "out.json"
        mine = {**recording.beside["vehicle"], "mass": 61.0}
        beside.write_text(json.dumps({"vehicle": mine}))
        recording = self.imported(log, "--preset", "husky")
        self.assertEqual(recording.beside["vehicle"]["mass"], 61.0)


class Commands(BagCase):
    """Commands that read recordings import a log by themselves."""

    def test_logs_are_recordings(self) -> None:
        drive = self.joints() + [
            Message("/ins/odom", ODOMETRY, t, self.ros2.odometry(t, truth(s)))
            for t, s in make_bags.ticks(20)
        ]
        file = self.bag(drive)
        for log in (file, file.parent):
            for command in (["inspect"], ["diagnose", "--vehicle", "tran2007", "--within", "1", "--output", self.folder / "d", "--force"]):
                words = [str(UGV), *map(str, command), str(log)]
                done = subprocess.run(words, capture_output=True, text=True, check=False)
                with self.subTest(log=log.name, command=command[0]):
                    self.assertEqual(done.returncode, 0, done.stderr)
                    self.assertIn("imported by itself", done.stderr)
                    self.assertIn("heading from /ins/odom", done.stderr)
        self.assertTrue((self.folder / "d" / "diagnosis.json").is_file())

    def test_options_of_the_import_choose_in_other_commands_too(self) -> None:
        drive = self.joints() + [
            Message(topic, ODOMETRY, t, self.ros2.odometry(t, truth(s)))
            for topic in ("/ins/odom", "/other/odom")
            for t, s in make_bags.ticks(20)
        ]
        log = self.bag(drive)
        words = [str(UGV), "inspect", str(log), "--json"]
        for more, topic in (
            ([], "/ins/odom"),
            (["--topics", "odometry=/other/odom"], "/other/odom"),
            (["--topics", "imu=none,odometry=/other/odom"], "/other/odom"),
            (["--topics", "odometry=/other/odom", "--topics", "imu=none"], "/other/odom"),
        ):
            # A log behind the option is no topic.
            for order in ([*words, *more], [*words[:2], *more, *words[2:]]):
                done = subprocess.run(order, capture_output=True, text=True, check=True)
                self.assertIn(f"heading from {topic}", done.stderr)
        done = subprocess.run([*words, "--preset", "husky"], capture_output=True, text=True, check=True)
        self.assertEqual(json.loads(done.stdout)["format"], "ugv-inspection/1")

    def test_results_are_json_on_demand(self) -> None:
        drive = self.joints() + [
            Message("/ins/odom", ODOMETRY, t, self.ros2.odometry(t, truth(s)))
            for t, s in make_bags.ticks(20)
        ]
        log = self.bag(drive)
        listed = json.loads(ugv(log, "--list", "--json").printed)
        self.assertEqual(listed["format"], "ugv-topics/1")
        used = {topic["topic"]: topic["serves_as"] for topic in listed["topics"] if topic["used"]}
        self.assertEqual(used["/ins/odom"], "odometry")
        table = self.folder / "rec.csv"
        results = json.loads(ugv(log, "--output", table, "--json").printed)
        self.assertEqual(results["format"], "ugv-import/1")
        self.assertEqual(results["rows"], len(table.read_text().splitlines()) - 1)
        self.assertEqual(results["provenance"], json.loads(table.with_suffix(".json").read_text())["provenance"])
        again = ugv(log, "--output", table)
        self.assertEqual(again.status, BAD_INPUT)
        self.assertIn("rec.csv exists", again.stderr)

    def test_warnings_of_the_import_are_doubts(self) -> None:
        """A pose from the wheels is doubted, although no file beside the log says so."""
        drive = self.joints() + [
            Message("/wheel_odom", ODOMETRY, t, self.ros2.odometry(t, truth(s)))
            for t, s in make_bags.ticks(20)
        ]
        words = [str(UGV), "inspect", "--json", "-", "--quiet", str(self.bag(drive))]
        done = subprocess.run(words, capture_output=True, text=True, check=True)
        doubts = json.loads(done.stdout)["doubts"]
        source = [doubt for doubt in doubts if doubt["kind"] == "source"]
        self.assertIn("/wheel_odom is wheel odometry", str(source))


