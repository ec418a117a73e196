"""scripts/examples/sweep.py and scripts/examples/fleet.py: the same bits one after the other, on Dask workers, with one of them killed, and by the tool."""

import contextlib
import csv
import io
import json
import os
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import pyarrow.parquet as pq

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "examples"))

import fleet
import sweep
from scale import cluster, picture, table
from scale.fmu import Sweep
from scale.tool import Fleet, Recording

TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
FMU = Path(os.environ.get("UGV_FMU") or TARGET / "ugv.fmu")
UGV = Path(os.environ.get("UGV_TOOL") or TARGET / "release" / "ugv")
SAMPLES = 50
# Soft ground from a few metres on, for a vehicle that is sometimes too heavy for it: a third of the drives bogs down.
VARIED = {"soil.cohesion": "log-normal:1040,1.5", "soil.friction_angle_deg": "normal:28,3,15,45", "vehicle.mass": "uniform:400,1000",
          "effects.terrain_change.stiffness_factor": "log-uniform:0.02,1", "effects.terrain_change.position": "uniform:1,8",
          "initial.heading": "uniform:-0.5,0.5"}
START = ["--terrain", "dry_sand", "--initial", "no-slip", "y=2"]
COSTS = ["cpu_seconds", "wall_seconds", "peak_mb"]


def ugv(*words: str | Path) -> None:
    subprocess.run([UGV, *words], check=True, stderr=subprocess.PIPE)


def call(main: object, *words: str | Path) -> str:
    """Runs a script in this process; what it printed."""
    said = io.StringIO()
    with mock.patch.object(sys, "argv", ["script", *map(str, words)]), contextlib.redirect_stdout(said):
        main()
    return said.getvalue()


def bits(value: float | str | None) -> bytes | str | None:
    """A number by its bits; anything else as it is."""
    return struct.pack("d", value) if isinstance(value, float) else value


def kill_one(client: object) -> int:
    """Kills the worker that has most to do, and tells its process."""
    processes, work = client.run(os.getpid), client.processing()
    address = max(work, key=lambda worker: len(work[worker]))
    assert work[address], "the worker has nothing to lose"
    os.kill(processes[address], signal.SIGKILL)
    return processes[address]


def survived(job: object, pieces: list) -> list:
    """Results in the order of the pieces, though a worker is killed after the first."""
    results = {}
    with cluster.connected(None, 2) as client:
        for number, result in cluster.spread(client, job, pieces):
            if not results:
                lost = kill_one(client)
            results[number] = result
        assert lost not in client.run(os.getpid).values(), "the worker that was killed lives"
    return [results[number] for number in range(len(pieces))]


class Bench(unittest.TestCase):
    """Files to work on."""

    @classmethod
    def setUpClass(cls) -> None:
        for path in (FMU, UGV):
            if not path.is_file():
                raise FileNotFoundError(f"{path} is missing; build it with scripts/package.sh, or name another in UGV_FMU, UGV_TOOL")
        cls.folder = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        time = np.arange(0.0, 8.0, 0.1)
        rows = zip(time, 5.0 - np.sin(0.6 * time), 5.0 + np.sin(0.6 * time), strict=True)
        cls.drive = cls.folder / "drive.csv"
        cls.drive.write_text("time,omega_left,omega_right\n" + "".join(",".join(map(repr, map(float, row))) + "\n" for row in rows))


class Tables(unittest.TestCase):
    """What scripts/examples/sweep.py reads, and what it refuses before it drives."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def write(self, name: str, content: bytes) -> Path:
        path = self.folder / name
        path.write_bytes(content)
        return path

    def test_input_is_read_as_the_tool_reads_it(self) -> None:
        told = "time,,omega_right,note,omega_left\r\n0,,,start,\r\n\r\n0.1, ,2,,4\n   \n0.3,1,,a b,\n0.7,,,\udcb0,5\n1,,3,,\n"
        time, speeds = table.read_input(self.write("drive.csv", b"\xef\xbb\xbf" + told.encode(errors="surrogateescape")))
        self.assertEqual(time.tolist(), [0.0, 0.1, 0.3, 0.7, 1.0])
        self.assertEqual(speeds[:, 0].tolist(), [4.0, 4.0, 4.0 + (5.0 - 4.0) * ((0.3 - 0.1) / (0.7 - 0.1)), 5.0, 5.0])
        self.assertEqual(speeds[:, 1].tolist(), [2.0, 2.0, *(2.0 + (3.0 - 2.0) * ((t - 0.1) / (1.0 - 0.1)) for t in (0.3, 0.7)), 3.0])

    def test_gaps_are_filled_to_the_bit(self) -> None:
        # As the loop in src/recording/drive.rs does it.
        random = np.random.default_rng(1)
        time = np.cumsum(random.uniform(0.01, 0.1, 500))
        values = np.where(random.uniform(size=500) < 0.4, random.normal(5.0, 3.0, 500), np.nan)
        expected, last = [], None
        for row in np.flatnonzero(~np.isnan(values)):
            while len(expected) < row:
                here = len(expected)
                expected.append(values[row] if last is None else
                                values[last] + (values[row] - values[last]) * ((time[here] - time[last]) / (time[row] - time[last])))
            expected.append(values[row])
            last = row
        expected += [values[last]] * (500 - len(expected))
        self.assertEqual(table.filled(time, values).tobytes(), np.array(expected).tobytes())

    def test_input_that_is_no_drive_is_refused(self) -> None:
        for content, expected in ((b"time,omega_left,omega_right\n0,1,1\n,1,1\n", "line 3, time: found ``"),
                                  (b"time,omega_left,omega_right\n0,1,x\n", "line 2, omega_right: found `x`"),
                                  (b"time,omega_left,omega_right\n0,1,\n1,1,\n", "omega_right: nothing but empty cells"),
                                  (b"time,omega_left,omega_right,\n0,1,1\n", "line 2: not as many cells as the header has, 4"),
                                  (b"time,omega_left,omega_right,run\n0,1,1,a\n9,1,1,b\n", "line 3, run: found `b`, expected `a`"),
                                  (b'time,omega_left,omega_right,note\n0,1,1,"\n1,1,1,"\n', "a quote that is not closed on its line"),
                                  (b"time,omega_left\n0,1\n", "no column omega_right"),
                                  (b"time,omega_left,omega_left,omega_right\n0,1,1,1\n", "named twice")):
            with self.assertRaises(SystemExit) as stopped:
                table.read_input(self.write("wrong.csv", content))
            self.assertIn(expected, str(stopped.exception))

    def test_samples_may_have_blank_lines_and_no_gaps(self) -> None:
        names, numbers, values = table.read_samples(self.write("a.csv", b"\xef\xbb\xbfindex,soil.cohesion\n\n4,5\n\n6,7\n\n"))
        self.assertEqual((names, numbers.tolist(), values.tolist()), (["soil.cohesion"], [4, 6], [[5.0], [7.0]]))
        with self.assertRaises(SystemExit) as stopped:
            table.read_samples(self.write("b.csv", b"index,soil.cohesion\n4,\n"))
        self.assertIn("line 2, soil.cohesion: found ``, expected a finite number", str(stopped.exception))

    def test_a_start_is_told_once(self) -> None:
        def fixed(*initial: str) -> object:
            return sweep.fixed(self.folder, None, list(initial), [])

        self.assertEqual(fixed("no-slip", "y = 2"), {"initial.no_slip": True, "initial.y": 2.0})
        for words, expected in ((["y=1", "y=2"], "--initial sets y twice"), (["v_x=1", "no-slip"], "sets v_x beside no-slip"),
                                (["no-slip", "yaw_rate=0"], "sets yaw_rate beside no-slip")):
            with self.assertRaises(SystemExit) as stopped:
                fixed(*words)
            self.assertIn(expected, str(stopped.exception))

    def test_outputs_that_cannot_be_written_are_refused_before_the_drives(self) -> None:
        drive, samples, fmu = (self.write(name, b"") for name in ("drive.csv", "samples.csv", "ugv.fmu"))
        (self.folder / "link.parquet").symlink_to(samples)
        ends, file = self.folder / "ends.parquet", drive / "below" / "ends.parquet"
        for words, expected in ((["--output", samples], "samples.csv is read as well"),
                                (["--output", self.folder / "link.parquet"], "link.parquet is read as well"),
                                (["--output", fmu], "ugv.fmu is read as well"),
                                (["--output", ends, "--map", drive], "no picture ends in .csv; there are"),
                                (["--output", self.folder / "a.png", "--map", self.folder / "a.png"], "a.png is read as well, or written twice"),
                                (["--output", self.folder], "is a folder; name a file in it"),
                                (["--output", "/proc/ends.parquet"], "ends.parquet cannot be written"),
                                (["--output", file], "cannot be written (Not a directory)"),
                                (["--output", ends, "--map", self.folder / "map.xyz"], "no picture ends in .xyz; there are")):
            said = io.StringIO()
            with self.assertRaises(SystemExit) as stopped, contextlib.redirect_stderr(said):
                call(sweep.main, "--input", drive, "--table", samples, "--fmu", fmu, *words)
            self.assertEqual(stopped.exception.code, 2)
            self.assertIn(expected, said.getvalue())
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["drive.csv", "link.parquet", "samples.csv", "ugv.fmu"])


class Places(unittest.TestCase):
    """Where scripts/examples/fleet.py keeps answers."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.fleet = Fleet(b"", "score", [], None, [".json"], 60.0)

    def recordings(self, *names: str) -> Path:
        data = self.folder / f"data{len(list(self.folder.iterdir()))}"
        for name in names:
            (data / name).parent.mkdir(parents=True, exist_ok=True)
            (data / name).write_text("")
        return data

    def test_answers_do_not_delete_each_other(self) -> None:
        for names in (("a.csv", "a/b.csv"), ("a.csv", "a/b/c.csv"), ("a.csv", "a.part.csv"), ("b/a.csv", "b/a.part/c.csv")):
            with self.assertRaises(SystemExit) as stopped:
                fleet.places([self.recordings(*names)], self.folder / "out", self.fleet)
            self.assertIn("would be in each other's way; rename one", str(stopped.exception))
        apart = self.recordings("a.csv", "b/a.csv", "ab.csv", "b.part/a.csv", "c.part.csv")
        self.assertEqual(len(fleet.places([apart], self.folder / "out", self.fleet)), 5)

    def test_columns_have_one_type_whatever_the_answers(self) -> None:
        healthy = {"findings": [], "verdict": "nothing_missing", "statement": "", "account": {"seconds": 60.0}}
        found = healthy | {"findings": [{"effect": "grade", "probability": 0.9}]}
        schemas = []
        for answers in ([healthy], [found], [found, healthy]):
            rows = [{"recording": "a", "status": "done", "error": None} | fleet.told("diagnose", answer, "a") | dict.fromkeys(fleet.COSTS, 1.0)
                    for answer in answers]
            path = self.folder / "fleet.parquet"
            fleet.write_table(path, rows, {})
            schemas.append(pq.read_schema(path))
        self.assertEqual(schemas[0], schemas[1])
        self.assertEqual(schemas[0], schemas[2])

    def test_sensors_have_one_name_in_all_rows(self) -> None:
        fit = {"converged": True, "data": {"seconds": 9.0}, "parameters": [{"name": "a.b.pose_latency", "value": 1.0, "low": 0.0, "high": 2.0}]}
        self.assertEqual(fleet.told("fit", fit, "a.b")["pose_latency_high"], 2.0)

    def test_an_answer_that_is_gone_is_lost(self) -> None:
        (place,) = fleet.places([self.recordings("a.csv")], self.folder / "out", self.fleet)
        row = fleet.row(place, "score")
        self.assertEqual((row["recording"], row["status"], row["cpu_seconds"]), ("a", "lost", None))


class Sweeps(Bench):
    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.table, by_tool, cls.serial = (cls.folder / name for name in ("samples.csv", "tool.csv", "serial.parquet"))
        varied = [word for name, values in VARIED.items() for word in ("--vary", f"{name}={values}")]
        ugv("sweep", *varied, "--samples", str(SAMPLES), "--samples-only", "--output", cls.table)
        ugv("sweep", "--input", cls.drive, "--table", cls.table, *START, "--output", by_tool, "--quiet")
        with by_tool.open(newline="") as file:
            cls.by_tool = list(csv.DictReader(file))
        cls.common = ["--input", cls.drive, "--table", cls.table, "--fmu", FMU, *START, "--quiet"]
        call(sweep.main, *cls.common, "--serial", "--output", cls.serial, "--map", cls.folder / "map.png")

    def test_the_fmu_has_the_bits_of_the_tool(self) -> None:
        rows = pq.read_table(self.serial).to_pylist()
        self.assertEqual((len(rows), list(rows[0])), (SAMPLES, list(self.by_tool[0])))
        for told, row in zip(self.by_tool, rows, strict=True):
            for name, value in row.items():
                expected = (told[name] or None) if name == "error" or not told[name] else float(told[name])
                self.assertEqual(bits(expected), bits(float(value) if name == "index" else value), f"{name} of {told['index']}")
        failed = [row for row in rows if row["error"]]
        self.assertTrue(0 < len(failed) < SAMPLES)
        self.assertTrue(any(0.0 < row["time"] < 7.9 for row in failed), "some bog down on the way")

    def test_dask_workers_give_the_same_bytes(self) -> None:
        output = self.folder / "dask.parquet"
        said = call(sweep.main, *self.common, "--workers", "2", "--batch", "7", "--output", output)
        self.assertEqual(output.read_bytes(), self.serial.read_bytes())
        self.assertIn(f"{SAMPLES} drives of 7.90 s", said)

    def test_a_killed_worker_changes_nothing(self) -> None:
        time, speeds = table.read_input(self.drive)
        names, numbers, values = table.read_samples(self.table)
        fixed = sweep.fixed(FMU, "dry_sand", ["no-slip", "y=2"], names)
        job = Sweep(FMU.read_bytes(), time, speeds, names, fixed)
        serial = pq.read_table(self.serial)
        expected = np.column_stack([serial[name].to_numpy() for name in sweep.RESULTS])
        for kept, errors in survived(job, [(numbers, values)] * 12):
            self.assertEqual(kept.tobytes(), expected.tobytes())
            self.assertEqual(errors, serial["error"].to_pylist())

    def test_gaps_text_and_blank_lines_give_the_bits_of_the_tool(self) -> None:
        rows = self.drive.read_text().splitlines()[1:]
        gappy = [f"{time},{left if number % 3 else ''},{right if number % 4 else ''},{'' if number % 5 else 'turn'}"
                 for number, (time, left, right) in enumerate(row.split(",") for row in rows)]
        drive, by_tool, by_script = (self.folder / name for name in ("gappy.csv", "gappy_tool.csv", "gappy.parquet"))
        drive.write_text("\ufefftime,omega_left,omega_right,note\n" + "\n\n".join(gappy) + "\n", encoding="utf-8")
        few = self.folder / "few.csv"
        few.write_text("\n\n".join(self.table.read_text().splitlines()[:4]) + "\n")
        common = ["--input", drive, "--table", few, *START, "--quiet"]
        ugv("sweep", *common, "--output", by_tool)
        call(sweep.main, *common, "--fmu", FMU, "--serial", "--output", by_script)
        with by_tool.open(newline="") as file:
            told = list(csv.DictReader(file))
        self.assertEqual([bits(row["x"]) for row in pq.read_table(by_script).to_pylist()], [bits(float(row["x"])) for row in told])

    def test_a_map_is_drawn(self) -> None:
        self.assertEqual((self.folder / "map.png").read_bytes()[:4], b"\x89PNG")

    def test_a_region_holds_its_share(self) -> None:
        angle = np.random.default_rng(1).normal(0.0, 0.7, 20_000)
        points = np.column_stack([9.0 * np.cos(angle), 9.0 * np.sin(angle)]) + np.random.default_rng(2).normal(size=(20_000, 2))
        east, north, counts, smoothed = picture.density(points)
        size = east[1] - east[0]
        inside = smoothed[tuple(np.rint((points[:, axis] - first) / size).astype(int) for axis, first in ((1, north[0]), (0, east[0])))]
        for share in (0.5, 0.9):
            # The cell on the boundary counts whole.
            self.assertAlmostEqual(np.mean(inside >= picture.level(counts, smoothed, share)), share, delta=0.002)

    def refused(self, content: str, *words: str) -> str:
        wrong = self.folder / "wrong.csv"
        wrong.write_text(content)
        arguments = ["--input", self.drive, "--table", wrong, "--fmu", FMU, "--output", self.folder / "wrong.parquet", "--quiet", *words]
        with self.assertRaises(SystemExit) as stopped:
            call(sweep.main, *arguments)
        self.assertFalse((self.folder / "wrong.parquet").exists())
        return str(stopped.exception)

    def test_what_is_wrong_is_told(self) -> None:
        for content, expected in (("soil.cohesion\n5\n-3\n", "sample 1: cohesion = -3 Pa is outside its range"),
                                  ("index,soil.cohesion\n0,5\n1,x\n", "line 3, soil.cohesion: found `x`, expected a finite number"),
                                  ("soil.cohesio\n5\n", "`soil.cohesio` is no parameter of"),
                                  ("soil.cohesion\n5,6\n", "line 2: not as many cells as the header has, 1"),
                                  ("soil.cohesion\n", "there is no row below the header")):
            self.assertIn(expected, self.refused(content, "--serial"))
        self.assertIn("--initial sets it too", self.refused("initial.v_x\n1\n", "--initial", "no-slip"))

    def test_a_worker_tells_what_is_wrong_as_well(self) -> None:
        self.assertIn("sample 1: cohesion = -3 Pa is outside its range", self.refused("soil.cohesion\n5\n-3\n", "--workers", "1"))


class Fleets(Bench):
    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.recordings = cls.folder / "recordings"
        (cls.recordings / "more").mkdir(parents=True)
        drive = cls.folder / "long.csv"
        time = np.arange(0.0, 20.0, 0.05)
        rows = zip(time, 5.0 - np.sin(0.6 * time), 5.0 + np.sin(0.6 * time), strict=True)
        drive.write_text("time,omega_left,omega_right\n" + "".join(",".join(map(repr, map(float, row))) + "\n" for row in rows))
        vehicle = subprocess.run([UGV, "vehicle"], check=True, capture_output=True, text=True).stdout
        for place in ("dry_sand", "sandy_loam", "clayed_soil", "more/dry_clay"):
            path, terrain = cls.recordings / f"{place}.csv", Path(place).name
            ugv("simulate", "--input", drive, "--terrain", terrain, "--output", path, "--quiet")
            soil = subprocess.run([UGV, "terrains", terrain], check=True, capture_output=True, text=True).stdout
            path.with_suffix(".json").write_text(json.dumps({"vehicle": json.loads(vehicle), "terrain": json.loads(soil)}))
        (cls.recordings / "broken.csv").write_text("time,omega_left\n0,1\n")
        cls.serial = cls.folder / "serial"
        call(fleet.main, *cls.words(cls.serial), "--serial")

    @classmethod
    def words(cls, out: Path) -> list[str | Path]:
        return [cls.recordings, "--command", "score", "--tool", UGV, "--out", out, "--quiet"]

    def answers(self, out: Path) -> dict[str, bytes]:
        """What the tool wrote, by recording."""
        return {str(path.relative_to(out)): path.read_bytes() for path in sorted(out.rglob("score.json"))}

    def rows(self, out: Path) -> list[dict]:
        """The table without what the work cost."""
        return pq.read_table(out / "fleet.parquet").drop_columns(COSTS).to_pylist()

    def test_each_recording_has_a_row(self) -> None:
        rows = {row["recording"]: row for row in pq.read_table(self.serial / "fleet.parquet").to_pylist()}
        self.assertEqual(sorted(rows), ["broken", "clayed_soil", "dry_sand", "more/dry_clay", "sandy_loam"])
        self.assertEqual(rows["broken"]["status"], "refused")
        self.assertIn("no column `omega_right`", rows["broken"]["error"])
        self.assertIsNone(rows["broken"]["nominal_soil_position_m"])
        sand = rows["more/dry_clay"]
        self.assertEqual((sand["status"], sand["error"]), ("done", None))
        # Its own soil, told beside it, predicts it; wheels without slip do not.
        self.assertLess(sand["nominal_soil_position_m"], 0.1 * sand["no_slip_position_m"])
        self.assertTrue(all(row[cost] > 0.0 for row in rows.values() for cost in COSTS if row["status"] == "done"))

    def test_answers_are_those_of_the_tool(self) -> None:
        own = self.folder / "alone.json"
        subprocess.run([UGV, "score", self.recordings / "dry_sand.csv", "--json", own, "--quiet"], check=True, stdout=subprocess.DEVNULL)
        self.assertEqual(own.read_bytes(), self.answers(self.serial)["answers/dry_sand/score.json"])

    def test_a_recording_may_have_the_name_of_another_file(self) -> None:
        # `ugv score` tells of a model that has seen the recording, by its name.
        out, recording, model = self.folder / "named", self.folder / "model.csv", self.folder / "begin.json"
        for ending in (".csv", ".json"):
            shutil.copyfile(self.recordings / f"dry_sand{ending}", recording.with_suffix(ending))
        model.write_bytes(subprocess.run([UGV, "model"], check=True, capture_output=True).stdout)
        words = [recording, "--command", "fit", "--tool", UGV, "--out", out, "--model", model, "--serial", "--quiet"]
        call(fleet.main, *words, "--", "--starts", "0", "--free", "friction_angle", "--sensors", "pose_latency")
        fitted = json.loads((out / "answers" / "model" / "model.json").read_text())["fitted_to"]
        self.assertEqual([to["recording"] for to in fitted], ["model"])
        (row,) = self.rows(out)
        self.assertEqual((row["status"], row["pose_latency"] is None), ("done", False))

    def test_dask_workers_give_the_same_answers(self) -> None:
        out = self.folder / "dask"
        said = call(fleet.main, *self.words(out), "--workers", "2")
        self.assertEqual((self.rows(out), self.answers(out)), (self.rows(self.serial), self.answers(self.serial)))
        self.assertIn("5 recordings, 4 answered", said)

    def test_a_killed_worker_changes_nothing(self) -> None:
        # Many windows: a third of a second for each recording.
        job = Fleet(UGV.read_bytes(), "score", ["--spacing", "0.05"], None, [".json"], 60.0)
        paths = sorted(self.recordings.rglob("*.csv"))
        pieces = [Recording.read(path.stem, path) for path in paths]
        alone = [answer for _, answer in cluster.one_by_one(job, pieces)]
        self.assertEqual([answer.status for answer in alone].count("done"), 4)
        for expected, answer in zip(alone * 2, survived(job, pieces * 2), strict=True):
            for what in ("name", "status", "error", "files"):
                self.assertEqual(getattr(answer, what), getattr(expected, what))

    def test_the_same_command_goes_on_where_it_was_cut_off(self) -> None:
        out = self.folder / "again"
        shutil.copytree(self.serial, out)
        shutil.rmtree(out / "answers" / "dry_sand")
        kept = (out / "answers" / "sandy_loam" / "run.json").stat().st_mtime_ns
        call(fleet.main, *self.words(out), "--serial")
        self.assertEqual((self.rows(out), self.answers(out)), (self.rows(self.serial), self.answers(self.serial)))
        self.assertEqual((out / "answers" / "sandy_loam" / "run.json").stat().st_mtime_ns, kept)
        # Other arguments are other answers.
        call(fleet.main, *self.words(out), "--serial", "--", "--horizon", "3")
        self.assertEqual({row["horizon_s"] for row in self.rows(out) if row["status"] == "done"}, {3.0})

    def test_what_takes_too_long_is_ended_and_told(self) -> None:
        out = self.folder / "limited"
        call(fleet.main, self.recordings / "dry_sand.csv", "--command", "fit", "--tool", UGV, "--out", out, "--limit", "0.02", "--serial", "--quiet")
        self.assertEqual([(row["status"], row["verdict"] if "verdict" in row else None) for row in self.rows(out)], [("timeout", None)])

    def test_recordings_that_are_not_there_are_named(self) -> None:
        with self.assertRaises(SystemExit) as stopped:
            call(fleet.main, self.folder / "nowhere", "--tool", UGV, "--out", self.folder / "nothing")
        self.assertIn("nowhere is not there", str(stopped.exception))


if __name__ == "__main__":
    unittest.main()
