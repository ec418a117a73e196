"""scripts/examples/follow_recording.py: FMUs driven with the wheel speeds of a recording."""

import contextlib
import csv
import io
import os
import re
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import fmpy
import matplotlib.image
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "examples"))

import follow_recording

FMU = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "ugv.fmu"
PLACE = {"initial.x": 3.0, "initial.y": -2.0, "initial.heading": 0.7}


def recorded(path: Path, terrain: int, first: float = 0.0) -> None:
    """What the FMU itself does on a terrain, as a recording with its pose at 5 Hz, from a moment on."""
    time = np.arange(0.0, 12.0, 0.02)
    speeds = [4.0 * np.minimum(time, 1.0) + side * np.sin(0.6 * time) for side in (-1.0, 1.0)]
    names = ("time", "omega_left", "omega_right")
    signals = np.array(list(zip(time, *speeds, strict=True)), dtype=[(name, float) for name in names])
    result = fmpy.simulate_fmu(str(FMU), stop_time=time[-1], output_interval=0.01, input=signals, fmi_type="CoSimulation",
                               start_values=PLACE | {"terrain": terrain}, output=["x", "y", "heading"])
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([*names, "x", "y", "heading"])
        for k, moment in enumerate(time):
            at = np.argmin(np.abs(result["time"] - moment))
            pose = [f"{result[name][at]:.6f}" for name in ("x", "y", "heading")] if k % 10 == 0 and moment >= first else ["", "", ""]
            writer.writerow([f"{moment:.3f}", *(f"{speed[k]:.6f}" for speed in speeds), *pose])


class Follow(unittest.TestCase):
    def test_the_same_soil_follows_and_another_does_not(self) -> None:
        # The FMU starts with terrain 3.
        for terrain, least, most in ((3, 0.0, 0.01), (1, 0.3, 10.0)):
            with self.subTest(terrain), tempfile.TemporaryDirectory() as folder:
                recording, picture = Path(folder) / "drive.csv", Path(folder) / "follow.png"
                recorded(recording, terrain)
                said = io.StringIO()
                arguments = ["follow", str(recording), str(FMU), "--output", str(picture)]
                with mock.patch.object(sys, "argv", arguments), contextlib.redirect_stdout(said):
                    follow_recording.main()
                after = float(re.search(r"ugv\.fmu: .* ([0-9.]+) m after 12 s", said.getvalue())[1])
                self.assertTrue(least <= after <= most, said.getvalue())
                self.assertGreater(matplotlib.image.imread(picture).std(), 0.05)

    def test_it_begins_where_the_vehicle_is_known_to_be(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            recording = Path(folder) / "drive.csv"
            recorded(recording, 3, 5.0)
            said = io.StringIO()
            arguments = ["follow", str(recording), str(FMU), "--output", str(Path(folder) / "follow.png")]
            with mock.patch.object(sys, "argv", arguments), contextlib.redirect_stdout(said):
                follow_recording.main()
        after = float(re.search(r"ugv\.fmu: .* ([0-9.]+) m after 7 s", said.getvalue())[1])
        self.assertLess(after, 0.2, said.getvalue())  # it was driven without slip there, so far as it knows

    def test_times_count_from_the_first_row(self) -> None:
        # Stamps since 1970 are far apart as fmpy compares them; effects over time begin with the drive.
        with tempfile.TemporaryDirectory() as folder:
            recording = Path(folder) / "drive.csv"
            recorded(recording, 3)
            header, *rows = recording.read_text().splitlines()
            said = []
            for epoch in (0, 1_700_000_000):
                moved = (f"{epoch + int(time)}.{digits}" for time, digits in (row.partition(",")[0].split(".") for row in rows))
                recording.write_text("\n".join([header, *(f"{time},{row.partition(',')[2]}" for time, row in zip(moved, rows, strict=True))]))
                output = io.StringIO()
                arguments = ["follow", str(recording), str(FMU), "--output", str(Path(folder) / "follow.png")]
                with mock.patch.object(sys, "argv", arguments), contextlib.redirect_stdout(output):
                    follow_recording.main()
                said.append(output.getvalue())
        self.assertEqual(said[0], said[1])

    def test_what_is_wrong_is_told_in_a_line_and_no_picture_is_left(self) -> None:
        header = "time,omega_left,omega_right,x,y,heading"
        rows = [f"{0.1 * k:.1f},1,1,0,0,0" for k in range(4)]
        whole = "\n".join([header, *rows])
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            broken = folder / "broken.fmu"
            broken.write_bytes(FMU.read_bytes()[:5000])
            for text, arguments, complaint in (
                ("", [], "drive.csv: line 1: there is no column time"),
                (whole.replace("time", "t"), [], "drive.csv: line 1: there is no column time"),
                (whole.replace("x,", "z,"), [], "drive.csv: line 1: there is no column x"),
                (whole.replace("0.1,1", "0.1,fast"), [], "drive.csv: line 3: omega_left is `fast`, not a finite number"),
                (whole.replace("0.1,1", "0.1,nan"), [], "drive.csv: line 3: omega_left is `nan`, not a finite number"),
                (whole.replace("0.2,", "inf,"), [], "drive.csv: line 4: time is `inf`, not a finite number"),
                (whole.replace("0.2,1,1", "0.2,1"), [], "drive.csv: line 4: 5 cells, not 6 as in the header"),
                (whole.replace("0.3,", "0.1,"), [], "drive.csv: line 5: time 0.1 is not after 0.2"),
                ("\n".join([f"{header},run", *(f"{row},{k // 2}" for k, row in enumerate(rows))]), [], "drive.csv: line 4: run 1 follows run 0"),
                ("\n".join([header, rows[0]]), [], "drive.csv: fewer than two values of omega_left"),
                (b"\xff\xfe\x9f", [], "drive.csv: .* UTF-8"),
                (whole, [str(broken)], "broken.fmu: .* zip"),
                (whole, ["--seconds", "nan"], "--seconds nan"),
                (whole, ["--seconds", "0"], "--seconds 0"),
                (whole, ["--output", "/proc/x.png"], "/proc/x.png cannot be written"),
                (whole, ["--output", str(folder)], "is a folder; name a picture"),
            ):
                with self.subTest(complaint):
                    recording, picture = folder / "drive.csv", folder / "follow.png"
                    recording.write_bytes(text if isinstance(text, bytes) else text.encode())
                    command = ["follow", str(recording), str(FMU), "--output", str(picture), *arguments]
                    if arguments[:1] == [str(broken)]:
                        command[2] = str(broken)
                        del command[-1]
                    said = io.StringIO()
                    with mock.patch.object(sys, "argv", command), contextlib.redirect_stderr(said):
                        with self.assertRaises(SystemExit) as stopped:
                            follow_recording.main()
                    told = f"{said.getvalue()}{stopped.exception.code}"
                    self.assertRegex(told, complaint)
                    self.assertEqual(sorted(path.name for path in folder.iterdir()), ["broken.fmu", "drive.csv"])


if __name__ == "__main__":
    unittest.main()
