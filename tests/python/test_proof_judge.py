"""The judge of scripts/proof: its measures against truths and answers made by hand, and how it runs the tool."""

import csv
import gzip
import io
import json
import math
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock
from xml.etree import ElementTree

import numpy as np
from page_check import browser, check_page, find_chromium

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "proof"))

from judge import answers, estimates, files, work
from judge.__main__ import arguments, claim, judged, numbered
from judge.case import Judged
from judge.drawing import figure
from judge.listing import listing
from judge.metrics import confusion, metrics, reliability
from judge.oracle import active, knowable
from judge.page import page
from judge.report import report
from judge.run import Bench, Processes, each
from judge.tables import tables

CHROMIUM = find_chromium()
DRAWBAR = {"effect": "drawbar", "kind": "physics", "size": "large", "off": {"force": 0.0},
           "parameters": {"force": 200.0, "hitch_height": 0.3}}
GUSTS = {"effect": "outside:gusts", "kind": "outside", "size": "small", "parameters": {"side": 3.0}, "off": {"side": 0.0}}
PLACE, TIME = ({"windows": {"drive": {"kind": kind, "numbers": [1.0, 2.0, 3.0]}}} for kind in ("disc", "time"))
FACTS = {"seed": [7], "drawn": 1, "answered": 1, "tool": ["t"], "limit_s": 600, "took_s": 1}


def truth(family: str = "single", effects: tuple = (DRAWBAR,), signal: float = 20.0, **more: object) -> dict:
    """A truth with one effect of the catalogue."""
    names = [e["effect"] if e["kind"] != "outside" else "unknown" for e in effects] or ["nothing_missing"]
    expected = {"nothing": ["nothing_missing"], "outside": ["unknown_physics"]}.get(family, ["missing_physics"])
    drives = {"drive": {"acts": [{"effect": "drawbar", "intervals": [[10.0, 20.0]]}]}, "unseen": {}}
    return {"case": "case", "family": family, "variant": "", "effects": list(effects), "names": names, "expected": expected,
            "signal_left": signal, "drives": drives, "rivals": []} | more


def said(verdict: str, *names: str, p: float = 0.9, group: tuple = (), **more: object) -> dict:
    """An answer whose findings all have one probability."""
    findings = [{"effect": name, "probability": p, "ambiguous_with": list(group)} | more for name in names]
    first = names[0] if names else "nothing_missing"
    rest = [{"effect": name, "probability": (1 - p) / 2} for name in ("grade", "unknown") if name != first]
    return {"verdict": verdict, "findings": findings, "candidates": [{"effect": first, "probability": p}, *rest]}


def case(true: dict, answer: dict | None, **unseen: float | None) -> Judged:
    return Judged("case_0000", true, answer, unseen, 3.0, 0 if answer else "timeout")


def measured(cases: list[Judged]) -> dict[str, float | None]:
    return {metric.key: metric.value for metric in metrics(cases)}


class Estimates(unittest.TestCase):
    """Numbers with known values."""

    def test_wilson_solves_the_score_equation(self) -> None:
        for hits, n in ((5, 10), (1, 40), (97, 100)):
            for end in estimates.wilson(hits, n):
                self.assertAlmostEqual(abs(hits / n - end), estimates.Z * math.sqrt(end * (1 - end) / n), places=12)
        self.assertAlmostEqual(estimates.wilson(0, 10)[1], 0.21294, places=5)
        self.assertEqual(estimates.wilson(0, 0), (0.0, 1.0))

    def test_bootstrap_of_a_mean_has_its_known_width(self) -> None:
        values = list(np.random.default_rng(3).normal(2.0, 1.0, 400))
        low, high = estimates.bootstrap(values, lambda drawn: float(np.mean(drawn)))
        self.assertAlmostEqual(high - low, 2 * estimates.Z / 20, delta=0.03)
        self.assertLess(abs((low + high) / 2 - np.mean(values)), 0.01)

    def test_overlap_of_intervals(self) -> None:
        self.assertAlmostEqual(estimates.overlap([[0, 10]], [[5, 15]]), 1 / 3)
        self.assertAlmostEqual(estimates.overlap([[0, 4], [6, 10]], [[0, 10]]), 0.8)
        self.assertEqual(estimates.overlap([], [[0, 1]]), 0.0)

    def test_calibration_error(self) -> None:
        perfect = [(0.8, k < 4) for k in range(5)] + [(0.3, k < 3) for k in range(10)]
        self.assertAlmostEqual(estimates.calibration_error(perfect), 0.0)
        self.assertAlmostEqual(estimates.calibration_error([(0.8, True)] * 4 + [(0.6, False)]), (4 * 0.2 + 0.6) / 5)
        self.assertEqual([b["n"] for b in estimates.bins(perfect)], [10, 5])

    def test_calibration_error_by_chance(self) -> None:
        # Of n claims of a half, the mean distance of a share from a half by the normal distribution.
        expected = np.sqrt(2 / np.pi * 0.25 / 400)
        self.assertAlmostEqual(estimates.calibration_error_by_chance([(0.5, True)] * 400), expected, delta=0.05 * expected)
        # Twice as far with a quarter of the claims; nothing where all is sure.
        self.assertAlmostEqual(estimates.calibration_error_by_chance([(0.5, False)] * 100), 2 * expected, delta=0.1 * expected)
        self.assertEqual(estimates.calibration_error_by_chance([(1.0, True), (0.0, False)]), 0.0)


class Metrics(unittest.TestCase):
    """Every metric on cases that it must tell apart."""

    def test_false_alarms_and_crashes(self) -> None:
        nothing = truth("nothing", (), 0.0)
        answers = [said("nothing_missing"), said("missing_physics", "grade"), None, said("insufficient_data")]
        found = measured([case(nothing, answer) for answer in answers])
        self.assertEqual(found["false_alarms"], 0.5)
        self.assertEqual(found["failed"], 0.25)
        self.assertIsNone(found["detection"])

    def test_detection_counts_strong_signals_only(self) -> None:
        cases = [case(truth(), said("missing_physics", "drawbar")), case(truth(), said("nothing_missing")), case(truth(), None),
                 case(truth(signal=7.9), said("nothing_missing"))]
        self.assertAlmostEqual(measured(cases)["detection"], 1 / 3)

    def test_names(self) -> None:
        cases = [case(truth(), said("missing_physics", "drawbar")), case(truth(), said("missing_physics", "grade", "drawbar")),
                 case(truth(), said("missing_physics", "grade")), case(truth(), None),
                 case(truth("lookalike"), said("missing_physics", "drawbar"))]
        found = measured(cases)
        self.assertEqual((found["first"], found["two"]), (0.25, 0.5))
        # That nothing is missing is a place in the order as any other.
        third = {"verdict": "missing_physics", "findings": [{"effect": "grade", "probability": 0.6}],
                 "candidates": [{"effect": name, "probability": p} for name, p in (("grade", 0.6), ("nothing_missing", 0.3), ("drawbar", 0.1))]}
        self.assertFalse(case(truth(), third).two)

    def test_both_of_a_pair(self) -> None:
        pair = truth("pair", (DRAWBAR, DRAWBAR | {"effect": "grade"}))
        cases = [case(pair, said("missing_physics", "grade", "drawbar")), case(pair, said("missing_physics", "grade", "drag"))]
        self.assertEqual(measured(cases)["both"], 0.5)
        # A candidate is not a finding.
        second = said("missing_physics", "grade")
        second["candidates"].append({"effect": "drawbar", "probability": 0.09})
        self.assertFalse(case(pair, second).both)
        self.assertIn("one or both of them", confusion(cases)["two effects"])

    def test_probability_and_claims(self) -> None:
        cases = [case(truth(), said("missing_physics", "drawbar", p=0.8)), case(truth(), said("missing_physics", "grade", p=0.8)),
                 case(truth("nothing", (), 0.0), said("nothing_missing", p=0.7)), case(truth(), None)]
        found = measured(cases)
        self.assertAlmostEqual(found["p_truth"], (0.8 + 0.0 + 0.7 + 0.0) / 4)
        self.assertAlmostEqual(found["calibration"], (abs(1.6 - 1) + 0.3) / 3)
        calibration = next(m for m in metrics(cases) if m.key == "calibration")
        self.assertTrue(0.0 <= calibration.low <= calibration.value <= calibration.high)
        # Silence may be allowed where little is left; that nothing is missing is wrong all the same.
        faint = case(truth("edge", signal=3.0, expected=["missing_physics", "nothing_missing"]), said("nothing_missing", p=0.8))
        self.assertEqual((faint.right, faint.claim), (True, (0.8, False)))

    def test_the_truth_and_nothing_else(self) -> None:
        pair = truth("pair", (DRAWBAR, DRAWBAR | {"effect": "grade"}))
        cases = [case(truth(), said("missing_physics", "drawbar")), case(truth(), said("missing_physics", "drawbar", "latency")),
                 case(truth(), said("ambiguous", "drawbar", group=("drag",))), case(pair, said("missing_physics", "grade", "drawbar")),
                 case(pair, said("missing_physics", "grade")), case(truth("outside", (GUSTS,)), said("unknown_physics", "unknown")),
                 case(truth("outside", (GUSTS,)), said("unknown_physics", "unknown", "unknown")),
                 case(truth("nothing", (), 0.0), said("nothing_missing")), case(truth(), None)]
        self.assertEqual([c.exact for c in cases], [True, False, False, True, False, True, False, True, False])
        self.assertEqual(measured(cases)["exact"], 4 / 9)

    def test_names_of_what_is_not_there(self) -> None:
        outside = truth("outside", (GUSTS,))
        cases = [case(outside, said("unknown_physics", "unknown", "grade")), case(outside, said("ambiguous", "grade", group=("unknown",))),
                 case(truth(rivals=["drag"]), said("missing_physics", "drag")), case(truth(), said("missing_physics", "drawbar", "drag")),
                 case(truth(), said("nothing_missing")), case(truth(), None)]
        self.assertEqual([c.false_names for c in cases], [["grade"], [], [], ["drag"], [], []])
        self.assertEqual(measured(cases)["false_names"], 0.4)

    def test_names_that_ride_along(self) -> None:
        cases = [case(truth(), said("missing_physics", "drawbar", "drag")), case(truth(), said("missing_physics", "grade")),
                 case(truth(), said("missing_physics", "grade", "drag", "drawbar")), case(truth(), said("nothing_missing"))]
        self.assertEqual([c.extra_names for c in cases], [["drag"], [], ["drag"], []])
        self.assertEqual(measured(cases)["extra_names"], 0.5)

    def test_sets_and_their_size(self) -> None:
        cases = [case(truth(), said("missing_physics", "drawbar")), case(truth(), said("ambiguous", "grade", group=("drawbar", "drag"))),
                 case(truth(), said("missing_physics", "grade")), case(truth(), None)]
        found = measured(cases)
        self.assertEqual((found["first"], found["in_set"]), (0.25, 0.5))
        self.assertAlmostEqual(found["set_size"], 5 / 3)

    def test_sure_and_wrong(self) -> None:
        nothing, faint = truth("nothing", (), 0.0), truth("edge", signal=3.0)
        cases = [case(truth(), said("missing_physics", "grade", p=0.95)), case(truth(), said("missing_physics", "grade", p=0.85)),
                 case(truth(), said("ambiguous", "grade", p=0.95, group=("drawbar",))), case(truth(), said("nothing_missing", p=0.95)),
                 case(truth(), said("missing_physics", "drawbar", p=0.95)), case(nothing, said("missing_physics", "grade", p=0.95)),
                 case(nothing, said("nothing_missing", p=0.95)), case(truth(), None)]
        self.assertEqual([c.sure_and_wrong for c in cases], [True, False, False, True, False, True, False, False])
        self.assertEqual(measured(cases)["sure_wrong"], 3 / 8)
        # Silence about what is hardly there is not counted.
        self.assertIsNone(measured([case(faint, said("nothing_missing", p=0.95))])["sure_wrong"])

    def test_classes_of_mechanisms(self) -> None:
        claims = [{"level": "where", "name": "gravity", "probability": 0.99}, {"level": "mechanism", "name": "gravity", "probability": 0.3},
                  {"level": "mechanism", "name": "drag", "probability": 0.6}]
        named = said("missing_physics", "grade")
        answers = [said("missing_physics", "drag"), named, named | {"claims": claims}, said("unknown_physics", "unknown"),
                   named | {"claims": [{"level": "mechanism", "name": "resistance_along", "probability": 0.7}]}, said("nothing_missing"), None]
        cases = [case(truth(), answer) for answer in answers]
        self.assertEqual([c.told_mechanisms for c in cases],
                         [["resistance_along"], ["gravity"], ["resistance_along"], [], ["resistance_along"], [], []])
        self.assertEqual(measured(cases)["mechanism"], 3 / 7)
        # A strength decides where an effect has several classes, in the truth as in the answer.
        wedge = {"effect": "bulldozing", "kind": "physics", "size": "large", "off": {"lateral": 0.0, "frontal": 0.0}, "parameters": {"frontal": 0.3}}
        parameters = {name: {name: {"value": 0.3, "low": 0.2, "high": 0.4}} for name in ("lateral", "frontal")}
        told = [case(truth(effects=(wedge,)), said("missing_physics", "bulldozing", parameters=own)) for own in parameters.values()]
        self.assertEqual([c.right_mechanism for c in told], [False, True])
        # The truth's own table comes first; effects outside the catalogue count by themselves.
        own = truth(mechanism={"drawbar": ["gravity"]})
        self.assertTrue(case(own, said("missing_physics", "grade")).right_mechanism)
        outside = truth("outside", (GUSTS,))
        found = measured([case(outside, said("missing_physics", "grade")), case(outside, said("unknown_physics", "unknown"))])
        self.assertEqual((found["mechanism"], found["mechanism_outside"]), (None, 0.5))

    def test_other_worlds_have_the_conditions_of_the_usual_ones(self) -> None:
        where = [{"recording": "drive", "start": 12.0, "end": 20.0}]
        for family in ("other_single", "other_local", "other_absorbed"):
            self.assertTrue(case(truth(family), None).identifiable, family)
        self.assertFalse(case(truth("other_pair"), None).identifiable)
        self.assertAlmostEqual(case(truth("other_local"), said("missing_physics", "drawbar", where=where)).located, 0.8)
        targets = {family: next(m for m in metrics([case(truth(family), None)]) if m.key == "first").target.value for family in ("single", "other_single")}
        self.assertEqual(targets, {"single": 0.9, "other_single": 0.8})

    def test_location(self) -> None:
        where = [{"recording": "drive", "start": 12.0, "end": 20.0}, {"recording": "second", "start": 0.0, "end": 90.0}]
        right = case(truth("local"), said("missing_physics", "drawbar", where=where))
        self.assertAlmostEqual(right.located, 0.8)
        self.assertEqual(case(truth("local"), said("nothing_missing")).located, 0.0)
        self.assertIsNone(case(truth("single"), said("missing_physics", "drawbar", where=where)).located)

    def test_parameters(self) -> None:
        told = {"force": {"value": 230.0, "low": 205.0, "high": 260.0}, "hitch_height": {"value": 9.0, "low": 8.0, "high": 9.5}}
        found = measured([case(truth(), said("missing_physics", name, parameters=told)) for name in ("drawbar", "grade")])
        self.assertAlmostEqual(found["parameter_error"], 0.15)
        self.assertEqual(found["coverage"], 0.0)
        # Of several recordings the first; what is truly off as well.
        shift = {"effect": "com_shift", "kind": "physics", "size": "large", "off": {"ahead": 0.0, "left": 0.0},
                 "parameters": {"ahead": -0.1}}
        told = {"drive.ahead": {"value": -0.09, "low": -0.12, "high": -0.07}, "second.ahead": {"value": 9.0, "low": 8.0, "high": 9.5},
                "left": {"value": 0.03, "low": 0.01, "high": 0.05}}
        one = case(truth(effects=(shift,)), said("missing_physics", "com_shift", parameters=told))
        self.assertEqual([(name, round(error, 9), held) for name, error, held in one.parameters],
                         [("com_shift.ahead", 0.1, True), ("com_shift.left", 0.3, False)])
        # Strengths of one arrow are compared with the largest, others each with itself.
        pushed = {"effect": "bulldozing", "kind": "physics", "size": "large", "off": {"lateral": 0.0, "frontal": 0.0},
                  "parameters": {"lateral": 0.8, "frontal": 0.1}}
        told = {"lateral": {"value": 0.8, "low": 0.7, "high": 0.9}, "frontal": {"value": 0.15, "low": 0.0, "high": 0.2}}
        one = case(truth(effects=(pushed,)), said("missing_physics", "bulldozing", parameters=told))
        self.assertEqual([round(error, 9) for _, error, _ in one.parameters], [0.0, 0.5])

    def test_latencies_count_from_the_gyro(self) -> None:
        late = {"effect": "latency", "kind": "sensor", "size": "large", "off": {"pose": 0.0, "yaw_rate": 0.0, "wheels": 0.0},
                "parameters": {"pose": 0.2, "yaw_rate": 0.06, "wheels": 0.0}}
        told = {"pose": {"value": 0.14, "low": 0.13, "high": 0.15}, "wheels": {"value": -0.06, "low": -0.07, "high": -0.05}}
        one = case(truth("sensor", (late,)), said("sensor", "latency", parameters=told))
        self.assertEqual([(name, round(error, 9), held) for name, error, held in one.parameters],
                         [("latency.pose", 0.0, True), ("latency.wheels", 0.0, True)])

    def test_a_change_of_soil_may_be_told_from_its_other_side(self) -> None:
        change = {"effect": "terrain_change", "kind": "physics", "size": "large", "off": {"cohesion_factor": 1.0},
                  "parameters": {"cohesion_factor": 0.5, "over": "time", "position": 30.0}}
        drives = {"drive": {"seconds": 50.0, "acts": [{"effect": "terrain_change", "intervals": [[30.0, 50.0]]}]}, "unseen": {}}
        true = truth("local", (change,), drives=drives)

        def told(start: float, end: float, value: float) -> Judged:
            parameters = {"cohesion_factor": {"value": value, "low": 0.8 * value, "high": 1.25 * value}}
            where = [{"recording": "drive", "start": start, "end": end}]
            return case(true, said("missing_physics", "terrain_change", where=where, parameters=parameters))

        for start, end, value in ((30.0, 50.0, 0.5), (0.0, 30.0, 2.0)):
            one = told(start, end, value)
            self.assertAlmostEqual(one.located, 1.0)
            self.assertEqual([(name, round(error, 9), held) for name, error, held in one.parameters],
                             [("terrain_change.cohesion_factor", 0.0, True)])
        for start, end, value in ((30.0, 50.0, 2.0), (0.0, 30.0, 0.5)):
            self.assertFalse(told(start, end, value).parameters[0][2])
        self.assertAlmostEqual(told(0.0, 20.0, 2.0).located, 20.0 / 30.0)

    def test_gain_on_the_unseen_drive(self) -> None:
        answer = said("missing_physics", "drawbar")
        gain = lambda own, oracle=0.1: case(truth(), answer, retuned=0.3, oracle=oracle, own=own).gain
        self.assertAlmostEqual(gain(0.15), 0.75)
        self.assertEqual(gain(9.0), -1.0)
        self.assertEqual(gain(None), 0.0)
        self.assertIsNone(gain(0.15, 0.29))
        cases = [case(truth(), answer, retuned=0.3, oracle=o, own=0.15) for o in (0.1, 0.29, None)]
        metric = next(m for m in metrics(cases) if m.key == "gain")
        self.assertEqual((metric.n, metric.note[:10]), (1, "2 left out"))
        late = Judged("case_0000", truth(), answer, {"retuned": 0.3, "own": 0.2}, oracle="timeout")
        metric = next(m for m in metrics([*cases, late]) if m.key == "gain")
        self.assertEqual(metric.note, "2 left out: no oracle, or it gains too little; 1: the oracle took too long")
        lost = Judged("case_0000", truth(), answer, {"retuned": 0.3, "own": 0.2}, oracle="1")
        metric = next(m for m in metrics([*cases, lost]) if m.key == "gain")
        self.assertEqual(metric.note, "2 left out: no oracle, or it gains too little; 1: the oracle failed")
        cases = [case(truth(), answer, retuned=0.3, own=own) for own in (0.32, 0.34, 0.1, None)]
        self.assertAlmostEqual(measured(cases)["harm"], 1 / 3)
        # Also where little is left; not where what is missing keeps to seconds that the unseen drive does not have.
        for faint, harm in ((truth("edge", signal=3.0), 1.0), (truth("local", (DRAWBAR | TIME,)), None)):
            self.assertEqual(measured([case(faint, answer, retuned=0.3, own=0.34)])["harm"], harm)

    def test_look_alikes(self) -> None:
        alike = truth("lookalike", expected=["missing_physics", "ambiguous"])
        twice = alike | {"drives": {**alike["drives"], "second": {}}}
        cases = [case(alike, said("ambiguous", "grade", group=("drawbar", "drag"))), case(alike, said("missing_physics", "grade")),
                 case(twice, said("missing_physics", "drawbar")), case(twice, said("ambiguous", "drawbar", group=("grade",)))]
        found = measured(cases)
        self.assertEqual((found["alike_in_set"], found["alike_size"], found["alike_resolved"]), (0.75, 2.0, 0.5))
        self.assertEqual([c.right for c in cases], [True, False, True, False])

    def test_outside_of_the_catalogue(self) -> None:
        outside = truth("outside", (GUSTS,))
        answers = [said("unknown_physics", "unknown"), said("missing_physics", "grade"), said("nothing_missing"),
                   said("ambiguous", "grade", group=("unknown",)), None]
        self.assertEqual(measured([case(outside, answer) for answer in answers])["misnamed"], 0.25)
        # Whatever the verdict, a name that is told first counts; a peer that names nothing, and silence, do not.
        answers = [said("unknown_physics", "latency", "unknown"), said("unknown_physics", "grade", group=("unknown",)),
                   {"verdict": "unknown_physics"}, said("insufficient_data")]
        self.assertEqual([case(outside, answer).misnamed for answer in answers], [True, False, False, False])
        allowed = outside | {"expected": ["unknown_physics", "ambiguous"]}
        self.assertTrue(case(allowed, said("ambiguous", "grade", group=("drag",))).misnamed)

    def test_targets(self) -> None:
        found = {m.key: m for m in metrics([case(truth(), said("missing_physics", "drawbar", p=1.0))])}
        self.assertTrue(found["first"].met and found["calibration"].met)
        self.assertIsNone(found["false_alarms"].met)
        self.assertFalse({m.key: m for m in metrics([case(truth(), None)])}["detection"].met)


class Oracle(unittest.TestCase):
    """What one who knows the effect fits."""

    def test_what_an_oracle_can_be_told(self) -> None:
        self.assertTrue(knowable(truth()))
        self.assertTrue(knowable(truth("local", (DRAWBAR | PLACE,))))
        self.assertFalse(knowable(truth("local", (DRAWBAR | TIME,))))
        change = DRAWBAR | {"effect": "terrain_change", "parameters": {"cohesion_factor": 0.5, "over": "time"}}
        self.assertFalse(knowable(truth("single", (change,))))
        self.assertFalse(knowable(truth("outside", (GUSTS,))))
        self.assertFalse(knowable(truth("other_local", (DRAWBAR | TIME,))))
        self.assertEqual(active(DRAWBAR | {"off": {"force": 0.0, "hitch_height": 0.3}}), ["force"])


TOOL = """#!/bin/sh
# Answers as a tool that knows one answer; "crash" and "slow" in the recording make it fail.
echo called >> "{log}"
for last; do case $want in --output) out=$last;; esac; want=$last; done
grep -q crash drive.csv && exit 3
grep -q slow drive.csv && sleep 30
[ -n "$out" ] || exit 4
mkdir -p "$out"
echo '{{"verdict": "nothing_missing"}}' > "$out/diagnosis.json"
"""


class Running(unittest.TestCase):
    """What has a result is not redone, what is half-written is; what fails is told."""

    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.log, tool = self.folder / "calls", self.folder / "tool"
        tool.write_text(TOOL.format(log=self.log))
        tool.chmod(0o755)
        self.bench = Bench(tool, "mark", self.folder / "cases", self.folder / "results", 2.0, 5.0, Processes())

    def case(self, name: str, content: str = "time\n") -> Path:
        folder = self.folder / "cases" / name
        folder.mkdir(parents=True)
        for file in ("drive.csv", "drive.json", "unseen.csv"):
            (folder / file).write_text(content)
        return self.folder / "results" / name

    @property
    def calls(self) -> int:
        return self.log.read_text().count("called")

    def test_a_result_is_not_redone_and_a_half_written_one_is(self) -> None:
        result = self.case("a")
        self.assertEqual(self.bench.diagnose("a")["status"], 0)
        self.bench.diagnose("a")
        self.assertEqual(self.calls, 1)
        (result / "answer").rename(result / "answer.part")
        self.assertEqual(self.bench.diagnose("a")["status"], 0)
        self.assertEqual(self.calls, 2)
        self.assertFalse((result / "answer.part").exists())
        files.write(result / "answer" / "run.json", json.dumps({"status": 0, "tool": "another build"}))
        self.bench.diagnose("a")
        self.assertEqual(self.calls, 3)

    def test_a_stage_with_a_result_is_not_redone_and_one_that_fails_is_told(self) -> None:
        result = self.case("a")
        files.save(result / "nominal.json", {"status": "done", "unseen": {"rmse": 0.5, "errors": {"0": 0.5}}})
        self.assertEqual(self.bench.stage("a", "nominal")["unseen"]["rmse"], 0.5)
        (result / "retuned.json").write_text('{"status": "do')
        self.assertNotEqual(self.bench.stage("a", "retuned")["status"], "done")
        self.assertIn("error", json.loads((result / "retuned.json").read_text()))

    def test_an_answer_of_an_earlier_judge_is_kept_and_scored_anew(self) -> None:
        result, answer = self.case("a"), {"verdict": "unknown_physics"}
        before = {"status": "done", "seconds": 4.2, "answer": answer, "unseen": {"rmse": 0.5, "windows": 3, "failed": 0}}
        files.save(result / "sparse.json", before)
        # It is tried, as the windows are not told; there is no model, so it fails, and what was there stays.
        self.assertNotEqual(self.bench.stage("a", "sparse")["status"], "done")
        self.assertEqual(files.load(result / "sparse.json"), before)

        def peer(*asked: object) -> dict:
            self.assertEqual(asked[-1], answer)
            return {"answer": {"verdict": "nothing_missing"}, "unseen": {"rmse": 0.4, "errors": {"0": 0.4}}}

        command = ["work", "sparse", str(self.folder / "cases" / "a"), str(result), "--tool", "ugv"]
        with mock.patch.object(work, "peer", lambda _: peer), mock.patch.object(sys, "argv", command):
            work.main()
        self.assertEqual(files.load(result / "sparse.json"), before | {"unseen": {"rmse": 0.4, "errors": {"0": 0.4}}})
        # What is fitted already is not fitted again.
        files.write(result / "retuned_model.json", "{}")
        task = work.Task(Path("ugv"), self.folder / "cases" / "a", result, {"status": "done"})
        with mock.patch.object(work, "fit", side_effect=AssertionError), mock.patch.object(work.prediction, "on_unseen", lambda *_: {}):
            self.assertEqual(work.retuned(task), {"unseen": {}})

    def test_a_case_is_judged_over_the_windows_that_all_models_have(self) -> None:
        result, errors = self.folder / "results" / "a", {"retuned": {"0": 0.9, "1": 0.3}, "oracle": {"0": 0.2, "1": 0.1}, "mended": {"1": 0.2}}
        for stage, own in errors.items():
            files.save(result / f"{stage}.json", {"status": "done", "unseen": {"rmse": 1.0, "errors": own}})
        one = judged("a", truth(), self.folder / "results", "mended")
        self.assertEqual(one.unseen, {"nominal": None, "retuned": 0.3, "oracle": 0.1, "own": 0.2})
        self.assertAlmostEqual(one.gain, 0.5)

    def test_peers_and_oracle_have_the_limit_of_the_tool(self) -> None:
        limits = [arguments(["--tool", "t", *given]).peer_limit for given in ([], ["--limit", "9"], ["--peer-limit", "7"])]
        self.assertEqual(limits, [600, 9, 7])

    def test_what_failed_is_done_again_within_a_longer_limit(self) -> None:
        self.case("a")
        path, late = self.folder / "results" / "a" / "oracle.json", {"status": "timeout", "seconds": 9.0, "error": ""}
        # Without a limit, an earlier judge's timeout tells its seconds.
        for there, again in ((late, False), (late | {"seconds": 2.1}, True), (late | {"limit": 5.0}, False), (late | {"limit": 4.0}, True)):
            files.save(path, there)
            self.assertEqual(self.bench.stage("a", "oracle")["status"] != "timeout", again)
            self.assertEqual(files.load(path).get("limit"), 5.0 if again else there.get("limit"))

    def test_a_page_is_of_the_cases_that_it_is_asked_for(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            root = Path(name)
            for folder in (root, root / "edge"):
                (folder / "sealed").mkdir(parents=True)
                for number in (0, 3, 40, 41):
                    (folder / "sealed" / f"case_{number:04d}.json").write_text("{}")
            self.assertEqual(numbered([root], root, range(3, 41)), ["case_0003", "case_0040"])
            self.assertEqual(numbered([root / "edge"], root, range(41, 300)), ["edge/case_0041"])

    def test_answers_belong_to_one_set_of_cases(self) -> None:
        for seed, name in ((1, "first"), (2, "second")):
            files.save(self.folder / name / "set.json", {"seed": seed})
        for name in ("first", "first"):
            claim(self.folder, self.folder / name)
        with self.assertRaisesRegex(SystemExit, "seed 1, these are of 2"):
            claim(self.folder, self.folder / "second")
        # Of the same seed: a family is not the mix of all, nor another; a set from before families were told is not refused.
        for family in ("local", None, "single"):
            files.save(self.folder / str(family) / "set.json", {"seed": 1, "family": family})
        for name in ("local", "first", "local"):
            claim(self.folder, self.folder / name)
        with self.assertRaisesRegex(SystemExit, "seed 1 and family local, these are of 1 and family single"):
            claim(self.folder, self.folder / "single")
        with self.assertRaisesRegex(SystemExit, r"seed 1 and family local, these are of 1\)"):
            claim(self.folder, self.folder / "None")

    def test_a_longer_limit_has_what_ran_into_it_done_again(self) -> None:
        self.case("a")
        self.bench.diagnose("a")
        run = self.folder / "results" / "a" / "answer" / "run.json"
        for limit, calls in ((2.0, 1), (1.0, 2)):
            files.save(run, files.load(run) | {"status": "timeout", "limit": limit})
            self.bench.diagnose("a")
            self.assertEqual(self.calls, calls)

    def test_crash_and_timeout_are_results(self) -> None:
        for name, status in (("crash", 3), ("slow", "timeout")):
            result = self.case(name, f"{name}\n")
            self.assertEqual(self.bench.diagnose(name)["status"], status)
            self.assertEqual(files.load(result / "answer" / "run.json")["status"], status)

    def test_an_interruption_ends_everything(self) -> None:
        self.case("a")
        self.bench.processes.stop()
        with self.assertRaises(KeyboardInterrupt):
            each("answers", ["a"], lambda name: self.bench.diagnose(name) and None, 1, self.bench.processes)
        self.assertFalse((self.folder / "results" / "a" / "answer").exists())


class PageOfAll(unittest.TestCase):
    """The page has every case and is well set."""

    def cases(self) -> list[Judged]:
        answers = [said("missing_physics", "drawbar"), said("nothing_missing"), None, said("unknown_physics", "unknown", p=0.4),
                   said("ambiguous", "rate_dependent_soil", group=("shear_anisotropy", "tyre_compliance", "drawbar"))]
        families = ["single", "lookalike", "local", "outside", "nothing"]
        true = {"outside": (GUSTS,), "nothing": ()}
        return [Judged(f"{family}/case_{k:04d}", truth(family, true.get(family, (DRAWBAR,))), answer,
                       {"retuned": 0.3, "oracle": 0.1, "own": 0.2}, 3.0, 0 if answer else "timeout")
                for k, (family, answer) in enumerate((f, a) for f in families for a in answers)]

    def test_every_case_is_listed(self) -> None:
        cases = self.cases()
        rows = list(csv.DictReader(io.StringIO(listing(report({"mended": cases}, FACTS)["cases"]))))
        self.assertEqual([row["case"] for row in rows], [one.name for one in cases])
        self.assertEqual([row["right"] == "yes" for row in rows], [one.right for one in cases])
        first, silent = rows[0], rows[2]
        self.assertEqual((first["told"], first["p_truth"], first["unseen_own_m"], first["unseen_nominal_m"]), ("drawbar", "0.9", "0.2", ""))
        self.assertEqual((first["in_set"], first["set_size"], first["told_mechanism"], first["right_mechanism"]), ("yes", "1", "resistance_along", "yes"))
        self.assertEqual((silent["verdict"], silent["told"], silent["p_truth"]), ("none", "no answer (timeout)", ""))

    def test_parts_are_judged_together_as_they_would_be_at_once(self) -> None:
        cases = self.cases()
        for one in cases:
            one.truth["seed"] = 7
        whole = report({"mended": cases, "stepwise": cases}, FACTS | {"drawn": len(cases), "answered": len(cases)})
        with tempfile.TemporaryDirectory() as folder:
            parts = [Path(folder) / f"{k}.jsonl" for k in range(2)]
            for path, part in zip(parts, (cases[:11], cases[11:]), strict=True):
                facts = FACTS | {"drawn": len(part), "answered": len(part), "took_s": 0.5}
                path.write_text(answers.lines({"mended": part, "stepwise": part}, facts))
            everyone, facts = answers.load(parts)
            self.assertEqual(report(everyone, facts), whole)
            compressed = Path(folder) / "0.jsonl.gz"
            compressed.write_bytes(gzip.compress(parts[0].read_bytes()))
            self.assertEqual(report(*answers.load([compressed, parts[1]])), whole)
            compressed.write_bytes(compressed.read_bytes()[:-20])
            with self.assertRaisesRegex(SystemExit, "0.jsonl.gz cannot be read"):
                answers.load([compressed])
            self.assertNotIn("href", page(everyone["mended"], whole, linked=False).partition("<h2>Failures")[2])
            for given, message in (([parts[0], parts[0]], "case_0000 of seed 7 is in .* give each case once"),
                                   ([Path(folder) / "none.jsonl"], "cannot be read"),
                                   ([self._other(parts[1], methods=["mended"])], "has answers of mended, the others of mended, stepwise"),
                                   ([self._other(parts[1], limit_s=100)], "had a limit of 100 s, the others 600 s"),
                                   ([self._other(parts[1], format="ugv-proof/1")], "not of the format")):
                with self.subTest(message), self.assertRaisesRegex(SystemExit, message):
                    answers.load([*(parts[:1] if "others" in message else []), *given])

    def _other(self, path: Path, **changed: object) -> Path:
        """The same file with another head."""
        head, _, rest = path.read_text().partition("\n")
        other = path.with_suffix(f".{next(iter(changed))}")
        other.write_text(json.dumps(json.loads(head) | changed) + "\n" + rest)
        return other

    def test_figure_has_every_case(self) -> None:
        cases = self.cases()
        drawn = ElementTree.fromstring(figure(cases, reliability(cases)))
        marks = [mark.get("class") for mark in drawn.iter("{http://www.w3.org/2000/svg}circle")]
        right = sum(one.right for one in cases)
        self.assertEqual((marks.count("right"), marks.count("wrong")), (right, len(cases) - right))

    def test_tables_are_those_of_the_page(self) -> None:
        cases = self.cases()
        summary = report({"mended": cases, "nominal": cases}, FACTS | {"drawn": len(cases), "answered": len(cases)})
        told = tables(summary)
        for metric in summary["metrics"]:
            (line,) = [line for line in told.splitlines() if line.startswith(f"| {metric['label']} |")]
            cells = [cell.strip() for cell in line.strip("|").split(" | ")]
            self.assertEqual((cells[3], cells[2].startswith("**")), (str(metric["n"]), metric["met"] is False), line)
        for name in (*summary["families"], *summary["peers"]):
            self.assertIn(f"\n| {name} | ", told)

    def test_page_and_json(self) -> None:
        cases = self.cases()
        summary = report({"mended": cases, "nominal": cases, "stepwise": cases}, FACTS | {"drawn": len(cases), "answered": len(cases)})
        text = page(cases, summary)
        json.dumps(summary, allow_nan=False)
        self.assertEqual(text.count("<tr data-case>"), len(cases))
        for one in cases:
            self.assertIn(one.name, text)
        self.assertEqual(text.count('class="case"'), sum(not one.right for one in cases))
        self.assertLess(text.rindex('class="case"'), text.index("data-case"))
        self.assertEqual(sum(sum(row.values()) for row in summary["confusion"].values()), len(cases))
        if CHROMIUM is None:
            self.skipTest("no chromium found: apt-get install chromium, or set UGV_CHROMIUM")
        with tempfile.TemporaryDirectory() as folder, browser(CHROMIUM) as opened:
            path = Path(folder) / "proof.html"
            path.write_text(text)
            self.assertEqual(check_page(opened, path), [])


if __name__ == "__main__":
    unittest.main()
