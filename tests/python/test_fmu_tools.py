"""What other people's tools say of the FMU."""

import csv
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from fmpy.validation import validate_fmu
from fmu_support import fmu, fmu_path, scratch

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


if __name__ == "__main__":
    unittest.main()
