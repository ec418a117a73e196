"""scripts/examples/controllers/slip_control: an SSP of the FMU, a controller FMU that limits slip, and a driver FMU."""

import math
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import matplotlib.image
import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.ssp.ssd import read_ssd
from fmpy.validation import validate_fmu

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "examples"))

from controllers.slip_control import blocks
from controllers.slip_control.__main__ import SLIP, SPEED, run_libcosim
from controllers.slip_control.drawing import draw
from controllers.slip_control.masters import Columns, cosimulate, largest_difference, run_ssp
from controllers.slip_control.system import NO_LIMIT, SAND_FROM, Setting, build_ssp

TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
FMU = TARGET / "ugv.fmu"
LIBCOSIM = ROOT / "target" / "venv-ssp" / "bin" / "python"
LIMIT = 0.2
# The bound is of the speed one step ago: while the vehicle slows down the slip is past it by that much.
OVERSHOOT = 0.01
# The masters add up time in different ways: their step ends differ by rounding, and so do the FMU's steps.
ROUNDING = 1e-9


def setUpModule() -> None:
    if not FMU.is_file():
        raise FileNotFoundError(f"{FMU} is missing; run ./scripts/package.sh first")


class SlipControl(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.ssps = {limit: cls.folder / f"{limit}.ssp" for limit in (LIMIT, NO_LIMIT)}
        for limit, path in cls.ssps.items():
            build_ssp(path, FMU, Setting(limit))
        cls.runs: dict[float, Columns] = {limit: run_ssp(path) for limit, path in cls.ssps.items()}

    def test_the_limit_holds_and_without_it_the_vehicle_digs_in(self) -> None:
        limited, unlimited = self.runs[LIMIT], self.runs[NO_LIMIT]
        loose = limited["ugv.x"] > SAND_FROM
        self.assertLess(limited[SLIP][loose].max(), LIMIT + OVERSHOOT)
        self.assertGreater(limited[SLIP][loose].max(), LIMIT - OVERSHOOT, "the limit was never needed")
        self.assertGreater(limited[SPEED][-1], 1.2)
        self.assertGreater(unlimited[SLIP][-1], 0.95)
        self.assertLess(unlimited[SPEED][-1], 0.05)
        self.assertGreater(limited["ugv.x"][-1], unlimited["ugv.x"][-1] + 5.0)
        self.assertGreater(unlimited["ugv.wheel[1].sinkage"][-1], 2 * limited["ugv.wheel[1].sinkage"][-1])

    def test_a_master_of_our_own_agrees(self) -> None:
        for limit, path in self.ssps.items():
            with self.subTest(limit):
                own = cosimulate(path)
                self.assertLess(largest_difference(own, self.runs[limit]), ROUNDING)
                np.testing.assert_allclose(own["time"], self.runs[limit]["time"], atol=ROUNDING)
        self.assertGreater(largest_difference(self.runs[LIMIT], self.runs[NO_LIMIT]), 0.1)

    def test_libcosim_agrees(self) -> None:
        if not LIBCOSIM.is_file():
            self.skipTest(f"no {LIBCOSIM.relative_to(ROOT)}: scripts/examples/controllers.sh slip_control installs libcosim there")
        sand, ssp = self.folder / "sand.fmu", self.folder / "sand.ssp"
        command = [TARGET / "release" / "ugv", "package", "--terrain", "dry_sand", "--output", sand]
        subprocess.run([*command, "--library", f"linux64={TARGET / 'fmu' / 'ugv.so'}"], check=True, capture_output=True)
        build_ssp(ssp, sand, Setting(LIMIT))
        names = ["ugv.x", SPEED, SLIP, "ugv.wheel[1].sinkage"]
        self.assertLess(largest_difference(run_libcosim(ssp, LIBCOSIM, names), self.runs[LIMIT]), ROUNDING)

    def test_the_vehicle_turns_as_demanded_on_firm_sand(self) -> None:
        path = self.folder / "turn.ssp"
        demand = {"speed": 1.0, "turn_rate": 0.1, "turn_until": 20.0}
        build_ssp(path, FMU, Setting(NO_LIMIT, ground={}, demand=demand))
        run = run_ssp(path)
        settled = run["time"] > 12.0
        np.testing.assert_allclose(run["ugv.yaw_rate"][settled], 0.1, atol=0.01)
        np.testing.assert_allclose(run[SPEED][settled], 1.0, atol=0.01)

    def test_the_structure_has_units_and_the_starts_that_were_asked_for(self) -> None:
        structure = read_ssd(str(self.ssps[LIMIT]), validate=True)  # against the schema
        units = {unit.name: unit for unit in structure.units}
        self.assertEqual((units["m/s"].m, units["m/s"].s, units["rad/s"].rad), (1, -1, 1))
        parts = {part.name: part for part in structure.system.elements}
        self.assertEqual(set(parts), {"driver", "slip_control", "ugv"})
        values = parts["slip_control"].parameterBindings[0].parameterValues[0].parameters
        self.assertEqual([(p.name, p.value, p.unit) for p in values], [("slip_limit", str(LIMIT), "1")])

    def test_it_is_drawn(self) -> None:
        picture = self.folder / "picture.png"
        draw(self.runs[LIMIT], self.runs[NO_LIMIT], LIMIT).savefig(picture, dpi=50)
        self.assertGreater(matplotlib.image.imread(picture).std(), 0.05)


class Blocks(unittest.TestCase):
    """The small FMUs alone."""

    @classmethod
    def setUpClass(cls) -> None:
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        for block in (blocks.DRIVER, blocks.SLIP_CONTROL):
            blocks.build(block, cls.folder / f"{block.name}.fmu")

    def controller(self, **values: float) -> tuple[FMU2Slave, dict[str, int]]:
        place = extract(str(self.folder / "slip_control.fmu"), unzipdir=tempfile.mkdtemp(dir=self.folder))
        model = read_model_description(place)
        reference = {v.name: v.valueReference for v in model.modelVariables}
        slave = FMU2Slave(guid=model.guid, unzipDirectory=place, modelIdentifier="slip_control")
        slave.instantiate()
        self.addCleanup(slave.freeInstance)
        slave.setReal([reference[name] for name in values], values.values())
        return slave, reference

    def test_validators_find_nothing(self) -> None:
        for block in (blocks.DRIVER, blocks.SLIP_CONTROL):
            self.assertEqual(validate_fmu(str(self.folder / f"{block.name}.fmu")), [])

    def test_the_same_source_gives_the_same_bytes(self) -> None:
        again = self.folder / "again.fmu"
        blocks.build(blocks.SLIP_CONTROL, again)
        self.assertEqual(again.read_bytes(), (self.folder / "slip_control.fmu").read_bytes())

    def test_wheel_speeds_are_the_limit_s(self) -> None:
        slave, reference = self.controller(speed_demand=3.0, v_x=1.0, yaw_rate=0.1, slip_limit=0.5)
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        slave.doStep(0.0, 0.01)
        radius, half_track = 0.25, 0.61
        expected = [(1.0 + side * 0.1 * half_track) / (1 - 0.5) / radius for side in (-1, 1)]
        np.testing.assert_allclose(slave.getReal([reference["omega_left"], reference["omega_right"]]), expected, rtol=1e-12)
        # The bound held, so the integrals waited.
        self.assertEqual(slave.getReal([reference["integral_left"], reference["integral_right"]]), [0.0, 0.0])

    def test_what_makes_no_sense_is_refused(self) -> None:
        slave, reference = self.controller()
        for name, value in (("slip_limit", 1.5), ("wheel_radius", 0.0), ("v_x", math.nan), ("speed_demand", math.inf)):
            with self.subTest(name), self.assertRaisesRegex(Exception, "fmi2SetReal"):
                slave.setReal([reference[name]], [value])
        with self.assertRaisesRegex(Exception, "fmi2DoStep"):
            slave.doStep(0.0, 0.01)  # before it is initialized


if __name__ == "__main__":
    unittest.main()
