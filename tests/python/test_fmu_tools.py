"""What other people's tools say of the FMU."""

import csv
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

from fmi3_support import fmi3_path
from fmpy import read_model_description
from fmpy.validation import validate_fmu
from fmu_support import TARGET, fmu, fmu_path, scratch

ROOT = Path(__file__).resolve().parents[2]

# A name that an importer has to percent-encode in the resource URI.
AWKWARD = "Übung mit Leerzeichen, 100% 空"


def simulate(path: Path, temporary: Path) -> tuple[list[dict[str, str]], str]:
    """Runs `fmpy simulate`, unpacking into `temporary`: the rows of its result, what it said."""
    result = temporary / "result.csv"
    command = [sys.executable, "-m", "fmpy", "simulate", str(path), "--output-file", str(result)]
    command += ["--stop-time", "0.5", "--output-interval", "0.05"]
    command += ["--start-values", "terrain", "1", "omega_left", "4", "omega_right", "5"]
    environment = os.environ | {"TMPDIR": str(temporary)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0 or not result.is_file():
        raise AssertionError(done.stdout + done.stderr)
    with result.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file)), done.stdout + done.stderr


class Tools(unittest.TestCase):
    """Validators and the fmpy tool."""

    def test_fmpy_finds_nothing_to_complain_about(self) -> None:
        self.assertEqual(validate_fmu(str(fmu_path())), [])

    def test_fmutool_finds_nothing_to_complain_about(self) -> None:
        tool = Path(sys.executable).parent / "fmutool"
        command = [str(tool), "-input", str(fmu_path()), "-check"]
        # The tool leaves its files in the current folder.
        done = subprocess.run(command, cwd=scratch(), capture_output=True, text=True, check=False)
        said = (done.stdout + done.stderr).splitlines()
        self.assertEqual(done.returncode, 0, said)
        self.assertEqual([line for line in said if not line.startswith("INFO")], [])

    def test_fmpy_simulates_from_any_folder(self) -> None:
        plain, said = simulate(fmu_path(), Path(tempfile.mkdtemp(dir=scratch())))
        self.assertNotIn("no folder", said)
        self.assertEqual(len(plain), 11)
        self.assertGreater(float(plain[-1]["x"]), 0.1)
        self.assertGreater(float(plain[-1]["heading"]), 0.001)
        self.assertEqual(set(plain[0]), {"time", *fmu().outputs})
        for row in plain:
            self.assertTrue(all(math.isfinite(float(value)) for value in row.values()))

        folder = scratch() / AWKWARD
        folder.mkdir()
        path = Path(shutil.copy(fmu_path(), folder / f"{AWKWARD}.fmu"))
        awkward, said = simulate(path, folder)
        # Resources that it cannot find would be reported.
        self.assertNotIn("no folder", said)
        self.assertEqual(awkward, plain)


class Archive(unittest.TestCase):
    """What lies in it beside the description and the libraries."""

    def packaged(self, *words: str | Path) -> Path:
        """An FMU that `ugv package` makes of the library in the one that is tested."""
        folder = Path(tempfile.mkdtemp(dir=scratch()))
        with zipfile.ZipFile(fmu_path()) as archive:
            library = archive.extract("binaries/linux64/ugv.so", folder)
        command = [TARGET / "release" / "ugv", "package", "--library", f"linux64={library}", "--output", folder / "own.fmu", *words]
        subprocess.run(command, check=True, capture_output=True)
        return folder / "own.fmu"

    def test_licences_of_what_is_linked_are_there(self) -> None:
        with zipfile.ZipFile(fmu_path()) as archive:
            said = archive.read("documentation/licenses/THIRD-PARTY.txt").decode()
        for crate in ("nalgebra", "serde_json", "fmi-sys"):
            self.assertRegex(said, rf"(?m)^{crate} [0-9]")
        check = [sys.executable, ROOT / "scripts" / "tools" / "third_party.py", "--check"]
        done = subprocess.run(check, capture_output=True, text=True, check=False)
        if "failed to download" in done.stderr:
            self.skipTest("crates for other platforms are not here and cannot be fetched")
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_the_custom_soil_starts_as_the_packaged_one(self) -> None:
        description = read_model_description(str(self.packaged("--terrain", "dry_sand")))
        starts = {variable.name: variable.start for variable in description.modelVariables}
        self.assertEqual((starts["terrain"], float(starts["soil.cohesion"])), ("1", 1040.0))

    def test_the_page_tells_what_no_variable_does(self) -> None:
        effects = scratch() / "window.json"
        effects.write_text('{"drawbar": {"force": 300}, "window": {"effects": ["drawbar"], "time": [12.4, 21]}}')
        with zipfile.ZipFile(self.packaged("--effects", effects)) as archive:
            self.assertIn("12.4", archive.read("documentation/index.html").decode())
        with zipfile.ZipFile(fmu_path()) as archive:
            self.assertNotIn("<pre>", archive.read("documentation/index.html").decode())

    def test_the_pose_is_unbounded_and_starts_from_its_own_values(self) -> None:
        for path in (fmu_path(), fmi3_path()):
            description = read_model_description(str(path))
            unbounded = {variable.name for variable in description.modelVariables if variable.unbounded}
            self.assertEqual(unbounded, {"x", "y", "heading"})
            initial = {each.variable.name: each.dependencies for each in description.initialUnknowns}
            for name in unbounded:
                self.assertEqual([known.name for known in initial[name]], [f"initial.{name}"])


if __name__ == "__main__":
    unittest.main()
