"""Changes that scripts/proof/altered conceals in recordings, and how it tells whether they were found."""

import contextlib
import io
import json
import math
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "proof"))

from altered import __main__ as command
from altered import recordings
from altered.cases import LEFT, POSE, Case, located
from altered.recordings import Table

SIDECAR = Path("none.json")


def row(time: float, **told: float) -> dict[str, str]:
    names = ("omega_left", "omega_right", "x", "y", "heading", "yaw_rate")
    return {"time": f"{time:g}"} | {name: f"{told[name]:g}" if name in told else "" for name in names}


DRIVE = Table([row(0.0, omega_left=1.0, x=0.0, y=0.0, heading=0.5, yaw_rate=0.1), row(0.1, yaw_rate=0.2),
               row(0.2, omega_left=2.0, x=1.0, y=2.0, heading=1.0)], SIDECAR)


def answer(**found: dict) -> dict:
    """An answer with findings of the whole recording."""
    return {"findings": [{"effect": name, "kind": "physics", "local": False, "where": [], "parameters":
                          {key: {"value": value} for key, value in values.items()}} for name, values in found.items()]}


class Changes(unittest.TestCase):
    def test_only_what_is_named_changes(self) -> None:
        slower, biased = recordings.slower_left(DRIVE, 0.5), recordings.biased_gyro(DRIVE, 1.0)
        self.assertEqual([r["omega_left"] for r in slower.rows], ["0.5", "", "1"])
        self.assertEqual([r["yaw_rate"] for r in biased.rows], ["1.1", "1.2", ""])
        for before, after, column in zip(DRIVE.rows * 2, slower.rows + biased.rows, ["omega_left"] * 3 + ["yaw_rate"] * 3, strict=True):
            self.assertEqual({k: v for k, v in before.items() if k != column}, {k: v for k, v in after.items() if k != column})

    def test_a_late_pose_keeps_its_values_and_the_others_their_times(self) -> None:
        late = recordings.late_pose(DRIVE, 0.1).rows
        self.assertEqual([(r["time"], r["x"], r["yaw_rate"], r["omega_left"]) for r in late],
                         [("0", "", "0.1", "1"), ("0.1", "0", "0.2", ""), ("0.2", "", "", "2"), ("0.3", "1", "", "")])

    def test_a_second_drive_begins_where_the_first_ended(self) -> None:
        rows = recordings.joined([DRIVE, DRIVE]).rows
        self.assertAlmostEqual(float(rows[3]["time"]), 0.2 + recordings.BREAK)
        self.assertEqual([float(rows[3][name]) for name in ("x", "y", "heading")], [1.0, 2.0, 1.0])
        turn = 0.5
        self.assertAlmostEqual(float(rows[5]["x"]), 1.0 + math.cos(turn) - 2.0 * math.sin(turn), places=4)
        self.assertAlmostEqual(float(rows[5]["y"]), 2.0 + math.sin(turn) + 2.0 * math.cos(turn), places=4)
        self.assertAlmostEqual(float(rows[5]["heading"]), 1.5)
        self.assertEqual(recordings.stretches([DRIVE, DRIVE]), [[(0, 0.0, 0.2)], [(0, 3.2, 3.4)]])

    def test_what_is_driven_begins_where_wheels_turn(self) -> None:
        still = [row(float(k), omega_left=0.0, omega_right=0.0) for k in range(60)]
        rolls = [row(60.0 + k, omega_right=-1.0) for k in range(60)]
        part = Table(still + rolls, SIDECAR).driven(10.0)
        self.assertEqual([r["time"] for r in part.rows], [f"{time:g}" for time in range(58, 68)])
        with self.assertRaises(ValueError):
            Table(still, SIDECAR).driven(10.0)

    def test_runs_are_numbered_on(self) -> None:
        steps = Table([{"run": str(run)} | row(0.1 * k) for run in (0, 2) for k in range(3)], SIDECAR)
        self.assertEqual([r["run"] for r in recordings.joined([steps, steps.runs(1)]).rows], list("000222333"))
        self.assertEqual(recordings.stretches([steps, steps.runs(1)])[1], [(3, 0.0, 0.2)])


class Judging(unittest.TestCase):
    def test_what_moved_is_told_against_the_recording_unchanged(self) -> None:
        before = answer(wheel_radius={"left": 0.97, "right": 0.99}, latency={"pose": 0.3, "wheels": 0.2})
        after = answer(wheel_radius={"left": 1.02, "right": 0.99}, latency={"pose": 0.58})
        self.assertAlmostEqual(LEFT.moved(before, after), 1.02 / 0.97)
        self.assertAlmostEqual(POSE.moved(before, after), 0.28)
        self.assertAlmostEqual(LEFT.moved(answer(), answer(wheel_radius={"left": 1.05})), 1.05)
        self.assertIsNone(LEFT.finding(answer()))

    def test_either_side_of_a_join_locates_it(self) -> None:
        parts = [[(0, 0.0, 10.0)], [(0, 10.0, 20.0)]]
        said = answer(terrain_change={})
        self.assertIsNone(located(said, parts))
        said["findings"][0] |= {"local": True, "where": [{"run": 0, "start": 0.0, "end": 8.0}]}
        self.assertAlmostEqual(located(said, parts), 0.8)


    def test_a_case_is_told_in_a_line(self) -> None:
        errors = {name: {"position_rmse_m": metres} for name, metres in (("nominal", 0.3), ("retuned", 0.2), ("augmented", 0.1))}
        rest = {"verdict": "sensor", "fit": {"held_out": errors | {"gain": {"value": 1.0}, "horizon": 4.0, "stretches": 9}}}
        before, after = (answer(latency={"pose": pose}) | rest for pose in (0.3, 0.58))
        after["findings"][0] |= {"probability": 0.97}
        case = Case("late", "later", lambda data: [DRIVE], "plain", POSE)
        result = command.judged(case, Path(), {"late": after, "plain": before})
        self.assertEqual(command.row(result), "| later | sensor: latency 97 % | 0.280 of 0.300 s | 0.3, 0.2, 0.1 |")
        self.assertEqual(command.judged(case, Path(), {"late": after | {"fit": {"held_out": None}}})["position_m"], {})


class Command(unittest.TestCase):
    def test_without_data_it_says_so(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            call = [sys.executable, "-m", "altered", "--tool", "ugv", "--data", folder]
            done = subprocess.run(call, cwd=ROOT / "scripts" / "proof", capture_output=True, text=True, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("UGV_DATA", done.stderr)

    def run_main(self, folder: Path, *words: str) -> int | str | None:
        (folder / "data" / "recordings").mkdir(parents=True, exist_ok=True)
        (folder / "drive.json").write_text("{}")
        drive = Table(DRIVE.rows, folder / "drive.json")
        cases = [Case("plain", "as it is", lambda data: [drive]), Case("late", "later", lambda data: [drive], "plain", POSE)]
        arguments = ["altered", "--data", str(folder / "data"), "--out", str(folder / "out"), *words]
        with mock.patch.object(command, "cases", lambda: cases), mock.patch.object(sys, "argv", arguments), \
                contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()) as told:
            try:
                command.main()
            except SystemExit as stopped:
                return told.getvalue() if stopped.code == 2 else stopped.code
        return None

    def tool(self, folder: Path, pose: float) -> str:
        """A program that tells this latency of every recording."""
        errors = {name: {"position_rmse_m": 0.1} for name in ("nominal", "retuned", "augmented")}
        said = answer(latency={"pose": pose}) | {"verdict": "sensor", "fit": {"held_out": errors}}
        said["findings"][0] |= {"probability": 0.97}
        path = folder / f"tool{pose}"
        path.write_text(f"#!/bin/sh\nmkdir answer && echo '{json.dumps(said)}' > answer/diagnosis.json\n")
        path.chmod(0o755)
        return str(path)

    def test_answers_are_kept_for_the_tool_that_gave_them(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            told = folder / "out" / "altered.json"
            self.assertIsNone(self.run_main(folder, "--tool", self.tool(folder, 0.3)))
            first = json.loads(told.read_text())
            self.assertEqual([(case["case"], case.get("moved")) for case in first["cases"]], [("plain", None), ("late", 0.0)])
            # One that is asked for alone is told against the other all the same, once that has an answer of the same tool.
            other = self.tool(folder, 0.4)
            self.assertIsNone(self.run_main(folder, "--tool", other, "--only", "late"))
            second = json.loads(told.read_text())
            self.assertNotEqual(second["tool"], first["tool"])
            self.assertEqual([(case["case"], "moved" in case) for case in second["cases"]], [("late", False)])
            self.assertIsNone(self.run_main(folder, "--tool", other, "--only", "plain"))
            self.assertEqual([case["case"] for case in json.loads(told.read_text())["cases"]], ["plain", "late"])
            self.assertIn("no such case; there are plain, late", str(self.run_main(folder, "--tool", other, "--only", "typo")))
            self.assertIn("no answer to plain, late", str(self.run_main(folder, "--tool", "/bin/false")))


if __name__ == "__main__":
    unittest.main()
