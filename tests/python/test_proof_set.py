"""A small fixed set of sealed cases, proven whole: `scripts/prove.sh` on 24 cases of one seed, half an hour."""

import json
import shutil
import subprocess
import unittest
from pathlib import Path

import pytest
from page_check import browser, check_page, find_chromium

ROOT = Path(__file__).resolve().parents[2]
OUT = ROOT / "target" / "proof-ci"
CASES, SEED, LEAST_RIGHT = 24, 20261122, 14
CHROMIUM = find_chromium()
VERDICTS = {"nothing_missing", "missing_physics", "sensor", "ambiguous", "unknown_physics", "insufficient_data"}
KEYS = {"format", "case", "seed", "family", "variant", "vehicle", "ground", "true_terrain", "nominal_terrain", "noise", "effects",
        "drives", "signal_left", "expected", "names", "rivals"}
EFFECT_KEYS = {"effect", "kind", "size", "parameters", "off", "signal", "absorbed"}


@pytest.mark.nightly
class FixedSet(unittest.TestCase):
    """Loose limits: they are there to catch what breaks, not to measure."""

    @classmethod
    def setUpClass(cls) -> None:
        shutil.rmtree(OUT, ignore_errors=True)  # what an earlier generator drew would stay
        command = [ROOT / "scripts" / "prove.sh", "--cases", CASES, "--seed", SEED, "--out", OUT, "--no-peers"]
        cls.run_of_it = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
        if cls.run_of_it.returncode:
            raise AssertionError(cls.run_of_it.stderr[-2000:])
        cls.proof = json.loads((OUT / "proof.json").read_text())

    def test_every_case_is_answered_and_most_are_right(self) -> None:
        cases = self.proof["cases"]
        self.assertEqual(len(cases), CASES)
        told = [(case["case"], case["truth"], case["told"]) for case in cases]
        self.assertEqual([case["status"] for case in cases], [0] * CASES, told)
        self.assertGreaterEqual(sum(case["right"] for case in cases), LEAST_RIGHT, told)
        false_alarms = [case for case in cases if case["names"] == ["nothing_missing"] and not case["right"]]
        self.assertLessEqual(len(false_alarms), 1, told)

    def test_every_model_is_scored_on_the_unseen_drive(self) -> None:
        for case in self.proof["cases"]:
            errors = [case["unseen_m"][key] for key in ("nominal", "retuned", "own")]
            self.assertTrue(all(error is not None and 0.0 < error < 5.0 for error in errors), (case["case"], errors))
            if case["names"] != ["nothing_missing"] and case["family"] != "local":
                self.assertIsNotNone(case["unseen_m"]["oracle"], case["case"])

    def test_truths_keep_their_contract(self) -> None:
        for case in self.proof["cases"]:
            truth = json.loads((OUT / "cases" / "sealed" / f"{case['case']}.json").read_text())
            with self.subTest(case["case"]):
                self.assertEqual(truth["format"], "ugv-proof-truth/1")
                self.assertLessEqual(KEYS, truth.keys())
                self.assertLessEqual(set(truth["expected"]), VERDICTS)
                self.assertTrue(truth["expected"] and truth["names"])
                self.assertLessEqual({"drive", "unseen"}, truth["drives"].keys())
                for effect in truth["effects"]:
                    self.assertLessEqual(EFFECT_KEYS, effect.keys())
                    on = [key for key, off in effect["off"].items() if effect["parameters"].get(key, off) != off]
                    self.assertTrue(on, effect)
                recordings = {stem for stem in ("drive", "second", "unseen") if (OUT / "cases" / truth["case"] / f"{stem}.csv").exists()}
                self.assertEqual(recordings, set(truth["drives"]))

    @unittest.skipUnless(CHROMIUM, "no chromium found: apt-get install chromium, or set UGV_CHROMIUM")
    def test_the_page_is_well_set(self) -> None:
        with browser(CHROMIUM) as opened:
            self.assertEqual(check_page(opened, OUT / "proof.html"), [])


if __name__ == "__main__":
    unittest.main()
