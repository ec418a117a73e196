"""The page of real recordings: which drive is diagnosed, how claims are compared, what is written. On a synthetic set, with a stand-in for the tool.

The two ways in which `ugv score` is used need the tool itself; the last test needs the recordings of UGV_DATA.
"""

import contextlib
import io
import json
import math
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "tools"))

import recordings_report as report

VEHICLE = {"mass": 470.0, "yaw_inertia": 165.0, "wheel_radius": 0.3, "wheel_width": 0.25, "row_positions": [0.457, -0.457], "half_track": 0.568,
           "com_offset": 0.0, "com_height": 0.45}
SENSORS = {"pose": "lidar ICP, trails the gyro by 0.2-0.8 s", "wheels": "encoders; trail the gyro by 0.1-0.2 s"}
RADIUS, TRACK = 0.28, 1.7
SLOPE = (0.03, -0.02)  # towards east and north
MOUNTED = (0.01, -0.005)  # pitch and roll of the sensor on level ground
HEADER = "time,omega_left,omega_right,x,y,heading,yaw_rate"

# Answers as the tool does. Each model has another constant error.
STAND_IN = '''#!{python}
import json, pathlib, sys
words = sys.argv[1:]
pathlib.Path({log!r}).open("a").write(" ".join(words) + "\\n")
after = lambda name: pathlib.Path(words[words.index(name) + 1])
errors = lambda size: dict(position_m=dict(median=dict(value=size), p95=dict(value=3 * size)), heading_rad=dict(median=dict(value=size / 10), p95=dict(value=size / 5)))
if words == ["--version"]:
    print("ugv 9.8.7 (somewhere)")
elif words[0] == "diagnose":
    after("--output").mkdir()
    (after("--output") / "model.json").write_text("{{}}")
    (after("--output") / "diagnosis.json").write_text({diagnosis!r})
elif words[0] == "score":
    two = dict(parameters=dict(wheel_radius_m=dict(value=0.28), track_m=dict(value=1.7)))
    sizes = dict(no_slip=0.2, two_parameter=0.3, three_parameter=0.3, nominal_soil=0.4, given_model=0.1)
    if "--model" not in words:
        del sizes["given_model"]
    models = [dict(model=name, failed=0, **errors(size)) | (two if name == "two_parameter" else {{}}) for name, size in sizes.items()]
    after("--json").write_text(json.dumps(dict(recordings=[dict(judged=7, counted=7, models=models)])))
elif words[0] == "fit":
    if "--half" in words and "short" in words[1]:
        sys.exit(1)
    after("--json").write_text(json.dumps(dict(parameters=[dict(name="shear_modulus", low=0.001, high=0.002, unit="m")])))
'''


def number(value: float, width: float = 0.01) -> dict[str, float]:
    return {"value": value, "low": value - width, "high": value + width, "unit": "rad"}


FINDINGS = [
    {"effect": "latency", "probability": 0.9, "parameters": {"pose": number(0.3), "wheels": number(0.4)}},
    {"effect": "grade", "probability": 0.8, "parameters": {"slope_east": number(0.02), "slope_north": number(-0.02)}},
    {"effect": "com_shift", "probability": 0.6, "ambiguous_with": ["payload"], "parameters": {"ahead": number(0.09)}},
]
ERRORS = {"position_rmse_m": 0.3, "heading_rmse_rad": 0.04}
DIAGNOSIS = {"findings": FINDINGS, "fit": {"held_out": {"nominal": ERRORS, "retuned": ERRORS, "augmented": ERRORS, "horizon": 6.5, "gain": {"value": 0.1, "standard_error": 0.01}}}}


def drive(seconds: float, speed: float = 5.0) -> tuple[list[str], list[str]]:
    """Rows of a drive by kinematics, ten a second, with curves both ways; and of its withheld file, on a slope."""
    rows, withheld = [], ["time,roll,pitch,z"]
    x = y = heading = 0.0
    for k in range(round(10 * seconds) + 1):
        time = 0.1 * k
        turn = 2.0 * math.sin(0.4 * time) + 0.5
        left, right = speed - turn, speed + turn
        rate = RADIUS / TRACK * (right - left)
        rows.append(f"{time:g},{left:.9f},{right:.9f},{x:.9f},{y:.9f},{heading:.9f},{rate:.9f}")
        ahead = SLOPE[0] * math.cos(heading) + SLOPE[1] * math.sin(heading)
        aside = -SLOPE[0] * math.sin(heading) + SLOPE[1] * math.cos(heading)
        withheld.append(f"{time:g},{MOUNTED[1] + aside:.9f},{MOUNTED[0] - ahead:.9f},0")
        for _ in range(100):
            x += 0.001 * RADIUS * speed * math.cos(heading)
            y += 0.001 * RADIUS * speed * math.sin(heading)
            time += 0.001
            heading += 0.001 * RADIUS / TRACK * 2 * (2.0 * math.sin(0.4 * time) + 0.5)
    return rows, withheld


def write(folder: Path, name: str, runs: int, seconds: float, vehicle: dict = VEHICLE) -> Path:
    """A recording of some runs with its sidecar; of a single run, what is withheld too."""
    rows, withheld = drive(seconds)
    path = folder / f"{name}.csv"
    lines = [HEADER, *rows] if runs == 1 else [f"run,{HEADER}", *(f"{run},{row}" for run in range(runs) for row in rows)]
    path.write_text("\n".join(lines) + "\n")
    path.with_suffix(".json").write_text(json.dumps({"vehicle": vehicle, "sensors": SENSORS}))
    if runs == 1:
        (folder / "withheld").mkdir(exist_ok=True)
        (folder / "withheld" / path.name).write_text("\n".join(withheld) + "\n")
    return path


class Folder(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.recordings = self.folder / "data" / "recordings"
        self.recordings.mkdir(parents=True)


class Choice(Folder):
    def test_the_longest_drive_in_one_run_is_diagnosed(self) -> None:
        paths = [write(self.recordings, "a", 1, 8.0), write(self.recordings, "b", 1, 12.0), write(self.recordings, "c", 4, 6.0)]
        a, b, c = map(report.Recording.read, paths)
        self.assertEqual([len(recording.runs()) for recording in (a, b, c)], [1, 1, 4])
        self.assertEqual([round(recording.driven()) for recording in (a, b, c)], [8, 12, 24])
        self.assertAlmostEqual(a.fastest(), 1.5)
        self.assertIs(report.richest([a, b, c]), b)
        self.assertIs(report.richest([c]), c)

    def test_a_clock_that_goes_back_starts_a_run(self) -> None:
        path = write(self.recordings, "a", 2, 1.0)
        text = path.read_text().replace("\n1,", "\n0,")
        path.write_text(text)
        self.assertEqual([len(run) for run in report.Recording.read(path).runs()], [11, 11])

    def test_a_vehicle_has_its_own_recordings(self) -> None:
        paths = [write(self.recordings, "a", 1, 1.0), write(self.recordings, "b", 1, 1.0, VEHICLE | {"mass": 90.0}), write(self.recordings, "c", 1, 1.0)]
        groups = report.vehicles(map(report.Recording.read, paths))
        self.assertEqual([[recording.name for recording in group] for group in groups], [["a", "c"], ["b"]])


class Claims(Folder):
    def setUp(self) -> None:
        super().setUp()
        self.recording = report.Recording.read(write(self.recordings, "a", 1, 40.0))
        self.truth = report.Slope.read(self.recording, self.recordings / "withheld" / "a.csv")

    def verdicts(self, *findings: dict, truth: bool = True) -> list[str]:
        return [claim.verdict for claim in report.claims(self.recording, {"findings": findings}, self.truth if truth else None)]

    def test_slopes_are_recorded_by_pitch_and_roll(self) -> None:
        np.testing.assert_allclose(self.truth.fit(), SLOPE, atol=1e-8)
        np.testing.assert_allclose(self.truth.fit(self.truth.time < 9.0), SLOPE, atol=1e-8)
        self.assertIsNone(report.Slope.read(self.recording, self.recordings / "withheld" / "none.csv"))

    def test_a_slope_is_true_if_it_is_nearer_than_level_ground(self) -> None:
        for claimed, verdict in ((SLOPE, "true"), ((0.04, -0.04), "true"), ((-0.03, 0.02), "false"), ((0.07, -0.04), "false")):
            grade = {"effect": "grade", "probability": 1.0, "parameters": {"slope_east": number(claimed[0]), "slope_north": number(claimed[1])}}
            self.assertEqual(self.verdicts(grade), [verdict], claimed)
            self.assertEqual(self.verdicts(grade, truth=False), ["cannot be known"])
        self.assertEqual(report.slope_verdict(np.array([0.004, 0.0]), np.array([0.0, 0.008])), "cannot be known")
        self.assertEqual(report.slope_verdict(np.array([0.02, 0.0]), np.array([0.0, 0.008])), "false")

    def test_a_slope_that_is_not_claimed_is_missed(self) -> None:
        self.assertEqual(self.verdicts(), ["missed"])
        here = {"effect": "grade", "probability": 1.0, "local": True, "where": [{"start": 0.0, "end": 9.0}],
                "parameters": {"slope_east": number(0.03), "slope_north": number(-0.02)}}
        self.assertEqual(self.verdicts(here), ["true", "missed"])
        self.assertEqual(self.verdicts(here | {"where": [{"start": 90.0, "end": 99.0}]}), ["cannot be known", "missed"])
        patch = {"start": 0.0, "end": 1.0, "patch": {"east": 0.0, "north": 0.0, "radius": 2.0}}
        chosen = self.truth.within(here | {"where": [patch]})
        self.assertTrue(0 < chosen.sum() < len(chosen))

    def test_latencies_are_compared_with_what_is_stated(self) -> None:
        self.assertEqual(self.verdicts(*FINDINGS), ["true", "false", "true", "cannot be known"])
        self.recording.about["sensors"].pop("pose")
        self.assertEqual(self.verdicts(FINDINGS[0])[:2], ["cannot be known", "false"])


    def test_radii_are_compared_with_the_turns_of_other_drives(self) -> None:
        for row in self.recording.rows:
            for side in ("omega_left", "omega_right"):
                row[side] = str(float(row[side]) + math.sin(0.15 * float(row["time"])))
            row["yaw_rate"] = str(RADIUS / TRACK * (1.02 * float(row["omega_right"]) - float(row["omega_left"])))
        self.assertAlmostEqual(report.rolled_ratio(self.recording), 1.02, delta=1e-6)
        wheels = {"effect": "wheel_radius", "probability": 0.9, "parameters": {"left": number(0.95, 0.005), "right": number(0.97, 0.005)}}
        for others, verdict in (([1.02, 1.01, 1.03], "true"), ([1.05], "false"), ([], "cannot be known")):
            (claim, _) = report.claims(self.recording, {"findings": [wheels]}, self.truth, others)
            self.assertEqual(claim.verdict, verdict)
        self.assertEqual(claim.claimed, "right/left 1.021 (1.010 to 1.032)")
        for row in self.recording.rows:
            row["yaw_rate"] = ""
        self.assertIsNone(report.rolled_ratio(self.recording))


class Page(Folder):
    """From the data to the page."""

    def setUp(self) -> None:
        super().setUp()
        for name, runs, seconds in (("a_warthog_grass_2024-01-01", 1, 20.0), ("b_warthog_ice", 1, 12.0), ("c_short", 3, 6.0)):
            write(self.recordings, name, runs, seconds)
        self.log, self.tool, self.page = (self.folder / name for name in ("log", "ugv", "page.md"))
        self.tool.write_text(STAND_IN.format(python=sys.executable, log=str(self.log), diagnosis=json.dumps(DIAGNOSIS)))
        self.tool.chmod(0o755)
        parts = [f"{start}\nold\n{end}\n" for start, end in map(report.marks, (*report.PARTS, "multibody"))]
        self.page.write_text("# Page\n\nby hand\n\n" + "\nmore by hand\n".join(parts))

    def call(self, *words: str) -> str:
        """What the script says where it stops."""
        with contextlib.redirect_stderr(io.StringIO()):
            try:
                report.main(["--tool", str(self.tool), "--data", str(self.folder / "data"), "--out", str(self.page), "--work", str(self.folder / "work"), *words])
            except SystemExit as stopped:
                return str(stopped.code)
        return ""

    def test_every_part_is_written_between_its_marks(self) -> None:
        self.assertEqual(self.call(), "")
        text = self.page.read_text()
        self.assertEqual(text.count("by hand"), 4)
        self.assertEqual(text.count("old"), 1)  # there is no multibody/
        self.assertIn("Diagnosed: a grass, driven 20 s", text)
        self.assertIn("effective radius 0.280 m, effective track 1.70 m", text)
        self.assertIn("| b ice (7) | 1.5 | 0.10 / 0.30 | 0.20 / 0.60 | 0.30 / 0.90 | 0.010 / 0.020 | 0.020 / 0.040 | 0.030 / 0.060 |", text)
        self.assertIn("| kinematics in place | 2 of 2 | 2 of 2 | 2 of 2 | 2 of 2 |", text)
        self.assertIn("| a grass | `latency` of the wheels | 90 % | 0.40 s (0.39 to 0.41) | 0.1 to 0.2 s | false |", text)
        self.assertIn("| a grass | `com_shift` or `payload` | 60 % | ahead 0.09 rad |  | cannot be known |", text)
        self.assertIn("Claims by verdict: true: 4, false: 2, cannot be known: 2, missed: 0.", text)
        self.assertIn("| c short* (7) | 0.20 / 0.60, 0.020 / 0.04 |", text)
        self.assertIn("| c short* |  | 1.00 to 2.00 |", text)
        self.assertIn("ugv 9.8.7.", text)
        self.assertNotIn(str(self.folder), text)
        self.assertIn("![", text)
        self.assertIn("<svg", self.page.with_suffix(".svg").read_text())

    def test_a_diagnosis_is_kept_for_the_tool_that_gave_it(self) -> None:
        def diagnosed() -> list[str]:
            return [Path(line.split()[1]).stem[0] for line in self.log.read_text().splitlines() if line.startswith("diagnose")]

        self.assertEqual((self.call("--only", "transfer"), diagnosed()), ("", ["a"]))
        self.assertEqual((self.call("--only", "claims"), diagnosed()), ("", ["a", "b"]))
        self.tool.write_text(self.tool.read_text() + "# another\n")
        self.assertEqual((self.call("--only", "transfer"), diagnosed()), ("", ["a", "b", "a"]))
        self.assertIn("--within none", self.log.read_text())

    def test_what_is_not_there_is_named(self) -> None:
        self.assertIn("UGV_DATA names the folder", self.call("--data", str(self.folder / "nowhere")))
        self.assertIn("no nothing; scripts/package.sh builds it", self.call("--tool", "nothing"))
        self.assertIn("there is no page", self.call("--out", str(self.folder / "other.md")))
        self.page.write_text("without marks")
        self.assertIn("written by recordings_report.py: claims", self.call("--only", "claims"))


@unittest.skipUnless((report.TARGET / "release" / "ugv").exists(), "the tool is not built: scripts/package.sh")
class Kinematics(Folder):
    """What the copies of a recording are for, with the tool itself."""

    def test_kinematics_are_fitted_to_a_whole_drive_and_transferred(self) -> None:
        tool = report.Tool(report.TARGET / "release" / "ugv", self.folder / "work", 1)
        recording = report.Recording.read(write(self.recordings, "a", 1, 40.0))
        scored = tool.scored(tool.doubled(recording))
        self.assertEqual(scored["fitted"], scored["judged"])
        parameters = report.model_of(scored, "two_parameter")["parameters"]
        self.assertAlmostEqual(report.value(parameters["wheel_radius_m"]), RADIUS, delta=0.003)
        self.assertAlmostEqual(report.value(parameters["track_m"]), TRACK, delta=0.02)
        moved = tool.scored(tool.with_vehicle(recording, RADIUS, TRACK))
        self.assertLess(report.errors(report.model_of(moved, "no_slip"))["position_m"][1], 0.02)


@unittest.skipUnless((report.DATA / "recordings").is_dir(), "there are no recordings; UGV_DATA names the folder")
class Real(unittest.TestCase):
    def test_the_drive_of_the_page_is_the_richest(self) -> None:
        recordings = [report.Recording.read(path) for path in sorted((report.DATA / "recordings").glob("*.csv"))]
        (own,) = report.vehicles(recordings)
        self.assertEqual(report.richest(own).short, "c10")
        self.assertIn(f"Diagnosed: {report.richest(own).label}, ", report.PAGE.read_text())
        for recording in own:
            truth = report.Slope.read(recording, report.DATA / "recordings" / "withheld" / recording.path.name)
            self.assertEqual(truth is not None, recording.short.startswith("c"))
            self.assertEqual(report.stated(recording.about, "pose"), (0.2, 0.8))


if __name__ == "__main__":
    unittest.main()
