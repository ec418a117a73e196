"""The pages of `ugv diagnose` in a real browser: those that `cargo test --test analysis report` and
`--test diagnosis_suite` left, one of a drive that is diagnosed here, and those that UGV_REPORT_PAGES
names (separated by colons)."""

import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import pytest
from page_check import PATIENCE, browser, check_page, find_chromium, limited

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PAGES = TARGET / "tmp" / "report"
VERDICTS = (
    "ambiguous",
    "insufficient_data",
    "missing_physics",
    "nothing_missing",
    "sensor",
    "unknown_physics",
)
CHROMIUM = find_chromium()
UGV = Path(os.environ.get("UGV_TOOL") or TARGET / "release" / "ugv")
CASES = ROOT / "tests" / "cases"

# A page with everything that the check must see.
BAD = """<!doctype html><html><body style="margin:0;background:#fff">
<p style="width:900px;color:#ddd">too wide and too pale</p>
<svg viewBox="0 0 360 200" aria-label="empty" style="width:100%">
<text x="-30" y="20">cut off</text><text x="100" y="100">one</text><text x="104" y="100">other</text>
<path class="line" d="M10 10h0"/></svg>
<img src="missing.png"><script>undefined_name()</script></body></html>"""


@unittest.skipUnless(CHROMIUM, "no chromium found: apt-get install chromium, or set UGV_CHROMIUM")
class Pages(unittest.TestCase):
    """Every page, at every width, light and dark, and on paper."""

    @classmethod
    def setUpClass(cls) -> None:
        cls.browser = cls.enterClassContext(browser(CHROMIUM))

    def assert_well(self, path: Path) -> None:
        """Nothing is wrong with a page."""
        problems = check_page(self.browser, path)
        self.assertFalse(problems, "\n".join([str(path), *problems]))

    def assert_verdict_well(self, verdict: str) -> None:
        """The page of a made-up diagnosis is well set."""
        path = PAGES / f"{verdict}.html"
        self.assertTrue(path.is_file(), f"{path} is missing; run cargo test --release --features fmu --test analysis report")
        self.assert_well(path)

    def test_ambiguous_is_well_set(self) -> None:
        self.assert_verdict_well("ambiguous")

    def test_insufficient_data_is_well_set(self) -> None:
        self.assert_verdict_well("insufficient_data")

    def test_missing_physics_is_well_set(self) -> None:
        self.assert_verdict_well("missing_physics")

    def test_nothing_missing_is_well_set(self) -> None:
        self.assert_verdict_well("nothing_missing")

    def test_sensor_is_well_set(self) -> None:
        self.assert_verdict_well("sensor")

    def test_unknown_physics_is_well_set(self) -> None:
        self.assert_verdict_well("unknown_physics")

    @pytest.mark.nightly
    def test_a_diagnosis_of_a_drive_is_well_set(self) -> None:
        self.assertTrue(UGV.is_file(), f"{UGV} is missing; run cargo build --release")
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "out"
            drives = [CASES / "lookalike" / f"{name}.csv" for name in ("drive", "second")]
            # With a second drive, the page has more than one path to draw.
            subprocess.run([UGV, "diagnose", *drives, "--output", out, "--quiet"], check=True)
            said = json.loads((out / "diagnosis.json").read_text())
            self.assertIn(said["verdict"], VERDICTS)
            self.assertEqual(said["recordings"], ["drive", "second"])
            self.assert_well(out / "report.html")

    def test_a_time_is_marked_in_all_charts_and_models_can_be_hidden(self) -> None:
        page = self.browser.new_page()
        page.set_default_timeout(1000 * PATIENCE)
        page.goto((PAGES / "missing_physics.html").as_uri())
        with limited(PATIENCE, "the script"):
            page.locator("#misses svg[data-frame]:not([data-map])").first.hover()
            readout = page.locator("#misses .readout").nth(1).text_content()
            self.assertRegex(readout, r"^[0-9.]+ s: as given [-0-9.e]+, refitted [-0-9.e]+, mended [-0-9.e]+$")
            for role in ("measured", "given", "refitted", "mended"):
                self.assertEqual(page.locator(f"#paths svg .dot.{role}").count(), 1, role)
            self.assertRegex(page.locator("#paths .readout").text_content(), "refitted [0-9.]+ m off")
            button = page.get_by_role("button", name="refitted")
            button.click()
            self.assertEqual(button.get_attribute("aria-pressed"), "false")
            self.assertFalse(page.locator("#paths path.refitted").first.is_visible())
            self.assertTrue(page.locator("#paths path.mended").first.is_visible())
        page.close()

    def test_a_page_without_script_has_the_same_content(self) -> None:
        texts = []
        for script in (True, False):
            context = self.browser.new_context(java_script_enabled=script)
            page = context.new_page()
            page.goto((PAGES / "missing_physics.html").as_uri())
            sections = page.locator("section")
            texts.append([sections.nth(index).text_content() for index in range(sections.count())])
            context.close()
        self.assertEqual(*texts)

    def test_the_check_sees_what_is_wrong(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "bad.html"
            path.write_text(BAD)
            problems = "\n".join(check_page(self.browser, path))
        for part in (
            "900 px wide in 360 px",
            "sticks out",
            "contrast",
            "empty: nothing is drawn",
            'text "cut off" is cut off',
            'texts "one" and "other" overlap',
            "undefined_name",
            "missing.png",
            "dark: the background's lightness is 1.00",
        ):
            self.assertIn(part, problems)


if __name__ == "__main__":
    unittest.main()
