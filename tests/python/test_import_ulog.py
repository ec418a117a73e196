"""`ugv import` on logs of PX4: one written byte by byte after the format's page, and what pyulog makes of it."""

import json
import resource
import struct
import subprocess
from pathlib import Path

import make_ulog
from make_bags import truth
from make_ulog import BOOT, DELAY, record, subscription, ulog
from pyulog import ULog
from test_import import BAD_INPUT, UGV, ImportCase, Recording, setUpModule, ugv

__all__ = ["setUpModule"]
# PX4 writes floats of 32 bits, and turns angles up to pi.
SINGLE = 3e-6
TOPICS = ("wheel_encoders", "vehicle_local_position", "vehicle_angular_velocity")


class LogCase(ImportCase):
    """Logs of PX4."""

    def ulog(self, content: bytes, name: str = "log.ulg") -> Path:
        """Writes a log."""
        path = self.folder / name
        path.write_bytes(content)
        return path

    def assert_truth(self, recording: Recording, names: str) -> None:
        """Columns are those of the drive."""
        for name in names.split():
            self.assert_column(recording, name, lambda t: getattr(truth(t), name), SINGLE)


class Logs(LogCase):
    """Whole logs."""

    def test_pyulog_reads_what_is_written_here(self) -> None:
        log = ULog(str(self.ulog(ulog())))
        self.assertFalse(log.file_corruption)
        self.assertEqual(log.msg_info_dict["sys_name"], "PX4")
        encoders = log.get_dataset("wheel_encoders").data
        self.assertEqual(encoders["timestamp"][50], round((BOOT + 1.0) * 1e6))
        self.assertAlmostEqual(encoders["wheel_speed[0]"][50], truth(1.0).omega_right, places=5)
        place = log.get_dataset("vehicle_local_position").data
        self.assertAlmostEqual(place["x"][20], truth(1.0).y, places=5)

    def test_the_drive_is_that_of_the_truth(self) -> None:
        path = self.ulog(ulog())
        anew = self.folder / "anew.ulg"
        ULog(str(path)).write_ulog(str(anew))
        for log in (path, anew):
            with self.subTest(log.name):
                recording = self.imported(log)
                self.assert_truth(recording, "omega_left omega_right x y heading v_x v_y yaw_rate")
                self.assertEqual(len(recording.columns["omega_left"]), 1000)
                self.assertEqual(len(recording.columns["x"]), 400)
                self.assertNotIn("warning", recording.notes)
                self.assertIn("counts as the right wheel", recording.notes)
                provenance = recording.beside["provenance"]
                self.assertEqual(provenance["container"], "PX4 ULog")
                # Encoders have no time of measurement but that of the message.
                self.assertEqual(provenance["start_since_boot_s"], "5")
                self.assertNotIn("start_unix_s", provenance)

    def test_other_topics_serve_as_well(self) -> None:
        log = self.ulog(ulog())
        recording = self.imported(log, "--topics", "odometry=vehicle_odometry,imu=sensor_combined")
        self.assert_truth(recording, "x y heading v_x v_y yaw_rate")
        self.assert_column(recording, "a_x", lambda _: 0.3, SINGLE)
        self.assert_column(recording, "a_y", lambda _: 0.2, SINGLE)
        recording = self.imported(log, "--topics", "imu=vehicle_attitude", "--heading", "imu")
        self.assert_truth(recording, "heading")
        self.assertEqual(len(recording.columns["heading"]), 1000)
        swapped = self.imported(log, "--left", "right_wheel_0", "--right", "left_wheel_1")
        self.assert_column(swapped, "omega_left", lambda t: truth(t).omega_right, SINGLE)
        listed = json.loads(ugv(log, "--list", "--json").printed)["topics"]
        serves = {topic["topic"]: topic["serves_as"] for topic in listed}
        self.assertEqual((serves["wheel_encoders"], serves["actuator_outputs"]), ("joints", None))

    def test_other_commands_import_it_by_themselves(self) -> None:
        log = self.ulog(ulog())
        for command in (
            ["inspect", log],
            ["score", log, "--vehicle", "husky"],
            ["fit", log, "--vehicle", "husky", "--starts", "0", "--output", "m.json"],
            ["diagnose", log, "--vehicle", "husky", "--within", "3", "--output", "d"],
        ):
            words = [str(UGV), *map(str, command)]
            done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=self.folder)
            with self.subTest(command[0]):
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertIn("x from vehicle_local_position", done.stderr)

    def test_actuator_outputs_are_no_wheel_speeds(self) -> None:
        log = self.ulog(ulog(("vehicle_local_position", "actuator_outputs")))
        message = " ".join(self.refused(log).split())
        self.assertIn("log the topic wheel_encoders; actuator outputs and setpoints are commands", message)

    def test_older_and_nested_formats(self) -> None:
        older = {
            # `yaw` before `heading`, no time of measurement and no flags.
            "vehicle_local_position": "uint64_t timestamp;uint64_t other;double ref;float x;float y;float z;"
            "float vx;float vy;float yaw;bool p;bool q;"
        }
        recording = self.imported(self.ulog(ulog(TOPICS, older)))
        shifted = {time - DELAY: value for time, value in recording.columns["x"].items()}
        self.assertLess(max(abs(value - truth(t).x) for t, value in shifted.items()), SINGLE)
        # A topic with parts of another format is listed, without being read.
        log = ulog(TOPICS) + subscription(9, "esc_status")
        log += record("D", struct.pack("<HQB", 9, 6_000_000, 1) + bytes(24))
        self.assertIn("esc_status", ugv(self.ulog(log), "--list").printed)

    def test_positions_that_the_estimator_does_not_trust_are_left_out(self) -> None:
        values = make_ulog.local_position(25_000_000, 25_000_000, truth(20.0))
        values[-2] = False
        log = ulog(TOPICS) + make_ulog.message(1, "vehicle_local_position", values)
        recording = self.imported(self.ulog(log))
        self.assertIn("x: 1 of 401 values", recording.notes)


class Damage(LogCase):
    """Logs that are cut off, damaged or hostile."""

    def test_a_log_that_was_cut_off_names_the_byte(self) -> None:
        whole = ulog(TOPICS)
        place = len(ulog(TOPICS, duration=10.0))
        log = self.ulog(whole[: place + 5])
        stderr = " ".join(self.refused(log).split())
        self.assertRegex(stderr, r"log\.ulg is damaged at byte \d+: the file ends in the middle of a record")
        byte = int(stderr.split("at byte ")[1].split(":")[0])
        self.assertTrue(place - 100 < byte <= place, (byte, place))
        self.assertIn("--partial imports what comes before", stderr)
        recording = self.imported(log, "--partial")
        self.assert_truth(recording, "omega_left x yaw_rate")
        self.assertIn("ends in its header", self.refused(self.ulog(whole[:12])))

    def test_appended_data_follow_a_record_that_was_cut_off(self) -> None:
        begin = ulog(TOPICS, appended=[1], duration=10.0)
        begin += record("D", bytes(40))[:20]
        values = make_ulog.local_position(16_000_000, 16_000_000, truth(11.0))
        rest = make_ulog.message(1, "vehicle_local_position", values)
        log = begin.replace(make_ulog.flags([1]), make_ulog.flags([len(begin)])) + rest
        recording = self.imported(self.ulog(log))
        self.assertEqual(max(recording.columns["x"]), 11.0)
        self.assert_truth(recording, "x y heading")

    def test_what_is_wrong_is_named(self) -> None:
        header = make_ulog.MAGIC + bytes(8) + make_ulog.flags()
        form = record("F", b"wheel_encoders:" + make_ulog.FORMATS["wheel_encoders"].encode())
        topic = subscription(0, "wheel_encoders")
        for content, words in (
            (bytes(100), "a record has the type 0x00"),
            (record("F", b"no fields"), "a format does not parse"),
            (record("F", b"a:float[x] b;"), "a format does not parse"),
            (record("F", b"\xff:float b;"), "a format does not parse"),
            (subscription(0, "unknown"), "the topic unknown has no format"),
            (record("A", b"\0\0"), "a subscription does not parse"),
            (record("D", b"\0\0" + bytes(24)), "a message belongs to no topic"),
            (record("D", b""), "a message belongs to no topic"),
            (form + topic + record("D", bytes(20)), "has 20 bytes, its format 26"),
            (form + topic + record("R", b"\0\0") + record("D", bytes(26)), "belongs to no topic"),
            (record("B", bytes(15) + b"\1" + bytes(24)), "demand what this version of ULog does not have"),
            (record("B", bytes(8)), "its flags are too short"),
        ):
            with self.subTest(words):
                stderr = " ".join(self.refused(self.ulog(header + content)).split())
                self.assertIn(words, stderr)
                self.assertRegex(stderr, r"log\.ulg is damaged at byte \d+")
        # Types that later versions have are passed over.
        later = ulog(TOPICS) + record("Z", b"later")
        self.imported(self.ulog(later))

    def test_no_damage_makes_it_panic_or_write(self) -> None:
        content = ulog(TOPICS, duration=4.0)
        for part in range(60):
            broken = bytearray(content)
            # The definitions are short, and what they say counts for all.
            place = 16 + (part * 37 if part < 40 else len(broken) * (part - 40) // 21)
            broken[place : place + 8] = bytes([255 if part % 2 else 0]) * 8
            log = self.ulog(bytes(broken))
            run = ugv(log, "--partial", "--output", self.folder / "out.csv", "--force")
            self.assertIn(run.status, (0, BAD_INPUT), f"{part}: {run.stderr}")
            self.assertNotIn("panicked", run.stderr)
            self.assertEqual(log.read_bytes(), broken)

    def test_declared_sizes_take_no_memory(self) -> None:
        log = make_ulog.MAGIC + bytes(8) + make_ulog.flags()
        for number in range(3000):
            log += record("F", f"a{number}:uint64_t timestamp;double[65535] x;a{number + 1}[65535] y;".encode())
        log += subscription(0, "a0") + record("D", b"\0\0" + bytes(8))
        limit = 512 << 20

        def confined() -> None:
            resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

        words = [str(UGV), "import", str(self.ulog(log)), "--list"]
        done = subprocess.run(
            words, capture_output=True, text=True, check=False, preexec_fn=confined, timeout=60
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("a0", done.stdout)


if __name__ == "__main__":
    import unittest

    unittest.main()
