"""How scripts/tools/importers.sh compares: what it must not let pass, and what it must. No importer is installed."""

import math
import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

from fmu_support import REPOSITORY

sys.path.append(str(REPOSITORY / "scripts" / "tools" / "importers"))

import matrix
import task
from comparison import FORCES, MOTION, Deviation, Unfit, compare, read
from runs import CS_2, FMI_2, IMPORTERS, INTEGRATED, RUNS, SAME_BITS, Run

NATIVE = {0.0: {"x": 1.0, "force": 0.0}, 0.01: {"x": 4.0, "force": 300.0}, 0.02: {"x": 2.0, "force": -600.0}}
RUN = Run("fmpy", "cs", FMI_2, CS_2)


def copied(shift: float = 0.0) -> dict[float, dict[str, float]]:
    return {time + shift: dict(row) for time, row in NATIVE.items()}


def written(text: str) -> Path:
    path = Path(tempfile.mkdtemp()) / "motion.csv"
    path.write_text(text)
    return path


class Comparison(unittest.TestCase):
    """The deviation of a motion."""

    def test_the_same_has_none(self) -> None:
        found = compare(copied(), NATIVE)
        self.assertEqual([found[group].share for group in (MOTION, FORCES)], [0.0, 0.0])
        self.assertEqual(str(found[MOTION]), "same bits")

    def test_the_last_bit_counts(self) -> None:
        motion = copied()
        motion[0.02]["force"] = math.nextafter(-600.0, 0.0)
        self.assertGreater(compare(motion, NATIVE)[FORCES].share, 0.0)

    def test_it_is_a_share_of_the_largest_value_or_of_one(self) -> None:
        motion = copied()
        motion[0.01]["force"] += 6.0
        motion[0.0]["x"] -= 0.2
        found = compare(motion, NATIVE)
        self.assertEqual((found[FORCES].output, found[FORCES].time), ("force", 0.01))
        self.assertAlmostEqual(found[FORCES].share, 6.0 / 600.0)
        self.assertAlmostEqual(found[MOTION].share, 0.2 / 4.0)
        small = {time: {"x": row["x"] / 100} for time, row in NATIVE.items()}
        moved = {time: {"x": row["x"] + 0.1} for time, row in small.items()}
        self.assertAlmostEqual(compare(moved, small)[MOTION].share, 0.1)

    def test_rows_a_step_late_are_no_match(self) -> None:
        late = dict(zip(NATIVE, [NATIVE[0.0], NATIVE[0.0], NATIVE[0.01]], strict=True))
        self.assertGreater(compare(late, NATIVE)[FORCES].share, 1.0)

    def test_times_off_by_rounding_are_the_same(self) -> None:
        self.assertEqual(compare(copied(1e-12), NATIVE)[MOTION].share, 0.0)

    def test_missing_rows_are_refused(self) -> None:
        motion = copied()
        del motion[0.01]
        with self.assertRaisesRegex(Unfit, "no row at 0.01 s"):
            compare(motion, NATIVE)
        without_first = {time: row for time, row in NATIVE.items() if time}
        compare(without_first, NATIVE, first=1)
        with self.assertRaisesRegex(Unfit, "no row at 0 s"):
            compare(without_first, NATIVE)

    def test_missing_and_foreign_outputs_are_refused(self) -> None:
        without = {time: {"x": row["x"]} for time, row in NATIVE.items()}
        with self.assertRaisesRegex(Unfit, "lacks 1 of 2 outputs"):
            compare(without, NATIVE)
        self.assertEqual(list(compare(without, NATIVE, omitted=1)), [MOTION])
        with self.assertRaisesRegex(Unfit, "no outputs: z"):
            compare({time: row | {"z": 0.0} for time, row in NATIVE.items()}, NATIVE)

    def test_what_is_no_number_is_refused_with_its_line(self) -> None:
        for bad in ("nan", "inf", "", "1,5 m"):
            with self.assertRaisesRegex(Unfit, r"motion\.csv:3: x is"):
                read(written(f'time,x\n0,1\n0.01,"{bad}"\n'))
        with self.assertRaisesRegex(Unfit, "has no row"):
            read(written("time,x\n"))

    def test_the_sides_of_a_step_are_told_apart(self) -> None:
        path = written("side,time,x\nend,0,1\nbegin,0,2\n")
        self.assertEqual(read(path, "end"), {0.0: {"x": 1.0}})
        self.assertEqual(read(path, "begin"), {0.0: {"x": 2.0}})


class Verdicts(unittest.TestCase):
    """What passes."""

    def result(self, share: float, failure: str = "", **expectation: object) -> matrix.Result:
        deviations = {} if failure else {MOTION: Deviation(share, "x", 0.0), FORCES: Deviation(share, "a_x", 0.0)}
        return matrix.Result(replace(RUN, **expectation), "1.0", deviations, failure)

    def test_a_deviation_beyond_its_tolerance_fails(self) -> None:
        self.assertTrue(self.result(0.0, tolerance=SAME_BITS).expected)
        self.assertFalse(self.result(1e-16, tolerance=SAME_BITS).expected)
        self.assertTrue(self.result(5e-4, tolerance=INTEGRATED).expected)
        self.assertFalse(self.result(5e-3, tolerance=INTEGRATED).expected)

    def test_a_failure_fails(self) -> None:
        self.assertFalse(self.result(0.0, "cannot be installed").expected)
        self.assertFalse(self.result(0.0, "it complains", check_only=True).expected)

    def test_a_fault_must_be_as_described(self) -> None:
        self.assertTrue(self.result(0.0, "no arrays here", fault="no arrays").expected)
        self.assertFalse(self.result(0.0, "cannot be installed", fault="no arrays").expected)
        self.assertFalse(self.result(0.0, fault="no arrays").expected)
        self.assertTrue(self.result(1.4, wrong_by=0.1).expected)
        self.assertFalse(self.result(1e-9, wrong_by=0.1).expected)
        self.assertFalse(self.result(0.0, "cannot be installed", wrong_by=0.1).expected)


class Matrix(unittest.TestCase):
    """The runs and the page."""

    def test_only_what_is_expected_is_remembered(self) -> None:
        scratch = Path(tempfile.mkdtemp())
        (scratch / RUN.name).mkdir()
        version = IMPORTERS[RUN.importer].version(Path(matrix.__file__).parent)
        good = matrix.Result(RUN, version, {MOTION: Deviation(0.0, "x", 0.0)})
        matrix.remember(replace(good, failure="it crashed"), scratch, "key")
        self.assertIsNone(matrix.remembered(RUN, scratch, "key"))
        matrix.remember(good, scratch, "key")
        self.assertEqual(matrix.remembered(RUN, scratch, "key"), good)
        self.assertIsNone(matrix.remembered(RUN, scratch, "another FMU"))

    def test_runs_have_folders_of_their_own(self) -> None:
        self.assertEqual(len({run.name for run in RUNS}), len(RUNS))

    def test_the_manoeuvre_starts_turns_reverses_pivots_and_stops(self) -> None:
        rows = task.manoeuvre()
        self.assertEqual(len(rows), task.STEPS + 1)
        for number, (time, left, right) in enumerate(rows):
            self.assertAlmostEqual(time, number * task.STEP, delta=1e-12)
            self.assertTrue(math.isfinite(left) and math.isfinite(right))
        self.assertEqual(rows[0][1:], (0.0, 0.0))
        self.assertEqual(rows[-1][1:], (0.0, 0.0))
        for wanted in (lambda l, r: l > r > 1, lambda l, r: r > l > 1, lambda l, r: l < 0 and r < 0, lambda l, r: l < -1 and r > 1):
            self.assertTrue(any(wanted(left, right) for _, left, right in rows))

    def test_every_importer_runs_and_is_pinned(self) -> None:
        here = Path(matrix.__file__).parent
        self.assertEqual({run.importer for run in RUNS}, set(IMPORTERS))
        for name, importer in IMPORTERS.items():
            self.assertRegex(importer.version(here), r"^\d+\.\d+", name)
            pins = [line for line in importer.pinned(here).splitlines() if line and not line.startswith("#")]
            if type(importer).__name__ == "Importer":
                self.assertTrue(all("==" in pin for pin in pins), name)

    def test_the_table_takes_its_place_in_the_page(self) -> None:
        page = written(f"before\n{matrix.MARKS[0]}\nold\n{matrix.MARKS[1]}\nafter\n")
        result = matrix.Result(RUN, "1.0", {MOTION: Deviation(0.0, "x", 0.0)})
        matrix.write_page(page, matrix.markdown([result]))
        text = page.read_text()
        self.assertTrue(text.startswith("before\n") and text.endswith("\nafter\n"))
        self.assertIn("| fmpy | 1.0 | CS 2.0 | all outputs | same bits | 0 | passed |", text)
        self.assertNotIn("old", text)
        with self.assertRaisesRegex(SystemExit, "lacks the lines"):
            matrix.write_page(written("nothing\n"), "")

    def test_the_page_has_the_runs_of_today(self) -> None:
        text = (REPOSITORY / "docs" / "contributing" / "importers.md").read_text()
        here = Path(matrix.__file__).parent
        for run in RUNS:
            row = f"| {run.importer} | {IMPORTERS[run.importer].version(here)} | {run.interface} | {run.what} |"
            self.assertTrue(row in text, f"no row {row} on the page: run scripts/tools/importers.sh --page docs/contributing/importers.md")


if __name__ == "__main__":
    unittest.main()
