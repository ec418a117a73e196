"""The commands of the proof, told to write where nothing can be written."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PATH = os.environ | {"PYTHONPATH": str(ROOT / "scripts" / "proof")}


class Folders(unittest.TestCase):
    def test_a_folder_that_cannot_be_made_is_named_with_the_remedy(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            data, file = Path(name), Path(name) / "file"
            (data / "recordings").mkdir()
            file.touch()
            for command in (["generator"], ["judge", "--tool", "ugv"], ["altered", "--tool", "ugv", "--data", name]):
                for out in ("/proc/x", str(file / "below")):
                    with self.subTest(command[0], out=out):
                        whole = [sys.executable, "-m", *command, "--out", out]
                        run = subprocess.run(whole, env=PATH, capture_output=True, text=True, check=False)
                        self.assertNotIn("Traceback", run.stderr)
                        self.assertRegex(run.stderr.splitlines()[-1], rf"--out {out} cannot be made .*; give a folder that can be written")
                        self.assertNotEqual(run.returncode, 0)


if __name__ == "__main__":
    unittest.main()
