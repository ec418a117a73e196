"""The demo and the example controller, on the packaged FMU."""

import contextlib
import html
import io
import json
import os
import re
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock
from xml.etree import ElementTree

import matplotlib.image
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts" / "examples"))

import concealed
import demo
import path_follower

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
FMU = TARGET / "ugv.fmu"
UGV = Path(os.environ.get("UGV_TOOL") or TARGET / "release" / "ugv")

# Half a wheel's width: closer than this, the wheels still cover the tracks they should make.
LARGEST_ERROR = 0.123  # m
# What remains is the controller's own: it reacts to the error, so that in a curve it keeps one.
RMS_ERROR = 0.06  # m
# The mended FMU is this many times nearer to the recorded path than the given one, over the unseen drive.
TIMES_NEARER = 3
# What a repository carries lightly [bytes].
LARGEST_RECORDING = 200_000
# Without feedback nothing brings the vehicle back: the error grows to the size of the path.
TIMES_WORSE = 10


def setUpModule() -> None:
    if not FMU.is_file():
        raise FileNotFoundError(f"{FMU} is missing; run ./scripts/package.sh first")


def run_main(module: object, *arguments: str) -> str:
    """What a script prints, called with these arguments."""
    output = io.StringIO()
    with mock.patch.object(sys, "argv", ["script", *arguments]), contextlib.redirect_stdout(output):
        module.main()
    return output.getvalue()


class Pictures(unittest.TestCase):
    """Assertions on picture files."""

    def assert_drawn(self, path: Path) -> None:
        """A PNG whose content differs from place to place, or an SVG with many curves."""
        if path.suffix == ".png":
            self.assertEqual(path.read_bytes()[:8], b"\x89PNG\r\n\x1a\n", path.name)
            image = matplotlib.image.imread(path)[..., :3]
            inked = np.mean(np.any(image < 0.9, axis=2))
            self.assertGreater(inked, 0.01, f"{path.name} is all but empty")
        else:
            svg = ElementTree.parse(path).getroot()
            self.assertEqual(svg.tag, "{http://www.w3.org/2000/svg}svg", path.name)
            curves = svg.findall(".//{http://www.w3.org/2000/svg}path")
            longest = max(len(curve.get("d", "")) for curve in curves)
            self.assertGreater(longest, 500, f"{path.name} shows no curve")


class PathFollower(Pictures):
    """scripts/examples/path_follower.py."""

    def test_keeps_to_the_path_on_every_terrain(self) -> None:
        for terrain in path_follower.TERRAINS:
            with self.subTest(terrain):
                rms, largest = path_follower.errors(path_follower.follow(FMU, terrain))
                self.assertLess(rms, RMS_ERROR)
                self.assertLess(largest, LARGEST_ERROR)

    def test_needs_its_feedback(self) -> None:
        closed, _ = path_follower.errors(path_follower.follow(FMU, "dry_sand"))
        drive = path_follower.follow(FMU, "dry_sand", feedback=False)
        opened, _ = path_follower.errors(drive)
        self.assertGreater(opened, TIMES_WORSE * closed)

    def test_as_a_script(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            picture = Path(folder) / "new folder" / "eight.png"
            printed = run_main(path_follower, "--fmu", str(FMU), "--output", str(picture))
            self.assert_drawn(picture)
        self.assertIn("m RMS", printed)


class Demo(Pictures):
    """scripts/examples/demo.py."""

    @classmethod
    def setUpClass(cls) -> None:
        cls.ideal = demo.no_slip(FMU)
        cls.drives = {terrain: demo.drive(FMU, terrain) for terrain in demo.TERRAINS}

    def test_the_findings_of_the_paper_hold(self) -> None:
        findings = demo.check(self.drives, self.ideal)
        self.assertGreaterEqual(len(findings), 8)
        for finding in findings:
            with self.subTest(finding.statement):
                self.assertTrue(finding.holds, finding.evidence)

    def test_a_finding_can_fail(self) -> None:
        swapped = dict(self.drives)
        swapped["dry_sand"], swapped["dry_clay"] = swapped["dry_clay"], swapped["dry_sand"]
        failed = [f.statement for f in demo.check(swapped, self.ideal) if not f.holds]
        self.assertEqual(len([s for s in failed if "resistance: dry clay <" in s]), 2)

    def test_the_vehicle_keeps_moving_forward(self) -> None:
        for terrain, drive in self.drives.items():
            with self.subTest(terrain):
                self.assertTrue(np.all(np.diff(drive["x"]) > 0))
                self.assertTrue(np.all(drive["v_x"][1:] > 0))

    def test_as_a_script(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            printed = run_main(demo, "--fmu", str(FMU), "--tool", str(UGV), "--output", name)
            page = (folder / "index.html").read_text(encoding="utf-8")
            self.assert_diagnosed(folder, page, printed)
            pictures = [*folder.glob("*.png"), *folder.glob("*.svg")]
            for picture in pictures:
                self.assert_drawn(picture)
        self.assertLessEqual(
            {"demo.png", "demo.svg", "figure_of_eight.png", "follow.png"}, {picture.name for picture in pictures}
        )
        for terrain in demo.TERRAINS:
            lines = [line for line in printed.splitlines() if line.startswith(demo.label(terrain))]
            self.assertEqual(len(lines), 1, printed)
        self.assertIn("index.html", printed)
        self.assertEqual(page.count("<svg"), len(demo.PANELS) + 2)
        self.assertIn(demo.PRODUCT, page)
        for reference in ('src="', "<link", "url(http", str(ROOT)):
            self.assertNotIn(reference, page, "the page must stand alone")

    def assert_diagnosed(self, folder: Path, page: str, printed: str) -> None:
        """The concealed effect is named, its number lies in the interval, and the mended FMU is nearer to the path."""
        said = json.loads((folder / "diagnosis" / "diagnosis.json").read_text())
        truth = json.loads((concealed.RECORDINGS / "truth.json").read_text())
        (effect,) = truth["effects"]
        self.assertEqual([finding["effect"] for finding in said["findings"]], [effect["effect"]])
        for name, off in effect["off"].items():
            found = said["findings"][0]["parameters"][name]
            self.assertTrue(found["low"] <= effect["parameters"][name] <= found["high"], f"{name}, off at {off}: {found}")
        self.assertIn(html.escape(said["statement"]), page)
        self.assertIn('<a href="diagnosis/report.html">', page)
        self.assertIn("<html", (folder / "diagnosis" / "report.html").read_text(encoding="utf-8"))
        given, mended = (float(re.search(rf"{name}\.fmu: ([0-9.]+) m RMS", printed)[1]) for name in ("given", "mended"))
        self.assertLess(TIMES_NEARER * mended, given)

    def test_the_recordings_are_small(self) -> None:
        files = [path for path in concealed.RECORDINGS.iterdir() if path.suffix in (".csv", ".json")]
        self.assertGreaterEqual(len(files), 5)
        for path in files:
            self.assertLess(path.stat().st_size, LARGEST_RECORDING, path.name)


if __name__ == "__main__":
    unittest.main()
