"""The generator of test recordings (scripts/proof/generator): physics, noise, signals, files."""

from __future__ import annotations

import contextlib
import csv
import io
import json
import math
import os
import subprocess
import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "proof"))

from agreement.compare import drive_generator, drive_library, manoeuvre, turning_on_the_spot  # noqa: E402
from generator import families  # noqa: E402
from generator.__main__ import main as draw  # noqa: E402
from generator.cases import is_complete  # noqa: E402
from generator.catalogue import EFFECTS, I, off_vector, slot  # noqa: E402
from generator.contact import contact, rule  # noqa: E402
from generator.drafts import draw_case  # noqa: E402
from generator.rivals import Bench  # noqa: E402
from generator.sensors import Channel, Samples, draw_samples, draw_sensors, encoder, report  # noqa: E402
from generator.signal import Case, Ruler, Signal, left_beside, project, retuned, span  # noqa: E402
from generator.simulator import COARSE, FINE, STEP, Drive, Setup, Window, begin, make_world, simulate  # noqa: E402
from generator.sizes import draw_effect, ways  # noqa: E402
from generator.stepper import derivative  # noqa: E402
from generator.world import GRAVITY, SOILS, VEHICLES, nominal_soil, parameter_vector, true_soil  # noqa: E402

BINARY = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "ugv"


def forces(setup: Setup, velocity: tuple[float, float, float], drive: Drive) -> np.ndarray:
    """Per wheel F_X, F_Y, F_Z, sinkage, theta_1 at the drive's beginning."""
    world = make_world(setup, drive, FINE)
    snapshot = begin(world, velocity=velocity)
    wheels = setup.vehicle.wheels
    e, details, rates = np.empty(len(world.p)), np.zeros(5 * wheels + 3), np.empty(3)
    v = snapshot.state[3:6].copy()
    assert derivative(world, 0.0, 0.0, snapshot.state, v, np.zeros(wheels), snapshot.start, e, details, rates)
    return details[: 5 * wheels].reshape((wheels, 5))


class Physics(unittest.TestCase):
    def test_wheels_carry_the_weight(self):
        for name, vehicle in VEHICLES.items():
            still = Drive(np.zeros((2, 2)), 1.0)
            loads = forces(Setup(vehicle, SOILS["clayed_soil"]), (0.0, 0.0, 0.0), still)[:, 2]
            self.assertAlmostEqual(loads.sum() / (vehicle.mass * GRAVITY), 1.0, places=4, msg=name)
            rows = np.repeat(vehicle.row_positions, 2) - vehicle.com_offset
            self.assertLess(abs((rows * loads).sum()), 1e-3 * vehicle.mass * GRAVITY, name)

    def test_left_and_right_mirror(self):
        drive = manoeuvre()
        for soil in ("dry_sand", "dry_clay"):
            setup = Setup(VEHICLES["hexa"], SOILS[soil])
            one = simulate(setup, drive)
            other = simulate(setup, replace(drive, speeds=drive.speeds[:, ::-1].copy()))
            sign = np.array([1, -1, -1, 1, -1, -1])
            self.assertLess(np.abs(one[:, :6] - sign * other[:, :6]).max(), 1e-5)  # steps are chosen by rounded sums

    def test_backward_mirrors_forward(self):
        even = replace(VEHICLES["hexa"], com_offset=0.0)
        drive = manoeuvre()
        one = simulate(Setup(even, SOILS["sandy_loam"]), drive)
        other = simulate(Setup(even, SOILS["sandy_loam"]), replace(drive, speeds=-drive.speeds))
        sign = np.array([-1, 1, -1, -1, 1, -1])
        self.assertLess(np.abs(one[:, :6] - sign * other[:, :6]).max(), 1e-5)

    def test_quadrature_converges(self):
        rng = np.random.default_rng(1)
        lag, low, high, dense, errors = np.empty(4), np.empty(5), np.empty(5), rule(80, 12), []
        for soil in SOILS.values():
            p = parameter_vector(VEHICLES["tran"], soil)
            numbers = np.array([p[I.k], p[I.n], p[I.c], p[I.tan_phi], p[I.shear_k], 0, 0, 0, 1, 1, 0, 1.0])
            shape = np.array([0.25, 0.246, 0.0, 0.5])
            for _ in range(40):
                motion = np.array([rng.uniform(0.2, 2.0), rng.uniform(-0.4, 0.4), rng.uniform(-0.5, 0.5), 0.0])
                motion[3] = motion[0] * rng.uniform(0.7, 1.6)
                lag[:] = motion / (motion[3] / 0.25)
                contact(0.35, motion, lag, numbers, shape, FINE, low)
                contact(0.35, motion, lag, numbers, shape, dense, high)
                errors.append(np.abs(low[:3] - high[:3]).max() / np.abs(high[:3]).max())
        self.assertLess(np.median(errors), 1e-4)
        self.assertLess(max(errors), 5e-3)  # where the slip changes its sign at another angle at each y

    def test_integrator_converges(self):
        drive = manoeuvre()
        setup = Setup(VEHICLES["scout"], SOILS["sandy_loam"])
        ends = [simulate(setup, drive, tolerance=t, table=COARSE) for t in (1e-3, 1e-4, 1e-5, 1e-7)]
        errors = [np.abs(e[:, :3] - ends[-1][:, :3]).max() for e in ends[:-1]]
        self.assertLess(errors[1], errors[0] + 1e-6)
        self.assertLess(errors[2], 5e-4)

    def test_rest_stays_at_rest(self):
        still = Drive(np.zeros((101, 2)), 0.05)
        path = simulate(Setup(VEHICLES["tran"], SOILS["dry_sand"]), still)
        self.assertLess(np.abs(path[:, :6]).max(), 1e-6)


class Effects(unittest.TestCase):
    def test_each_effect_moves_the_vehicle_and_is_off_at_its_off_value(self):
        drive = manoeuvre(8.0)
        vehicle, soil = VEHICLES["ranger"], SOILS["sandy_loam"]
        plain = simulate(Setup(vehicle, soil), drive, table=COARSE)
        spot = (float(plain[160, 0]), float(plain[160, 1]), float(plain[160, 2]))
        for name, effect in EFFECTS.items():
            if effect.kind == "sensor":
                continue
            with self.subTest(name):
                values = draw_effect(name, [1, 2], 1.5, vehicle, soil, drive.seconds, spot)
                on = simulate(Setup(vehicle, soil, {name: values}), drive, table=COARSE)
                self.assertGreater(np.abs(on[:, :3] - plain[:, :3]).max(), 1e-4)
                for parameter in effect.switches:
                    values[parameter] = effect.parameters[parameter][0]
                off = simulate(Setup(vehicle, soil, {name: values}), drive, table=COARSE)
                self.assertEqual(np.abs(off - plain).max(), 0.0)

    def test_sensor_effects_change_only_the_report(self):
        path = simulate(Setup(VEHICLES["ranger"], SOILS["sandy_loam"]), manoeuvre(6.0), table=COARSE)
        samples = Samples(np.arange(0.1, 5.0, 0.05), np.arange(0.1, 5.0, 0.1))
        channels = ["x", "y", "heading", "yaw_rate"]
        plain = report(path, STEP, samples, channels, {})
        for name, values in {"latency": {"pose": 0.2}, "lever_arm": {"left": 0.3}, "yaw_rate_bias": {"bias": 0.01},
                             "heading_offset": {"offset": 0.02}}.items():
            faulty = report(path, STEP, samples, channels, {name: values})
            self.assertGreater(max(np.abs(faulty[c] - plain[c]).max() for c in channels), 0.005, name)

    def test_a_window_confines_an_effect(self):
        drive = manoeuvre(8.0)
        setup = Setup(VEHICLES["ranger"], SOILS["sandy_loam"])
        plain = simulate(setup, drive, table=COARSE)
        confined = replace(setup, effects={"drawbar": {"force": 80.0}}, windows={"drawbar": Window("time", (4.0, 6.0))})
        on = simulate(confined, drive, table=COARSE)
        self.assertEqual(np.abs(on[: int(3.9 / STEP)] - plain[: int(3.9 / STEP)]).max(), 0.0)
        self.assertGreater(np.abs(on[-1, :2] - plain[-1, :2]).max(), 0.01)

    def test_parameters_off_are_those_of_the_catalogue(self):
        vector = off_vector()
        declarations, name = {}, ""
        for line in (ROOT / "docs" / "reference" / "effects.md").read_text().splitlines():
            name = line.strip("# `") if line.startswith("### `") else name
            cells = [cell.strip(" *") for cell in line.split("|")]
            if len(cells) > 5 and " .. " in cells[3]:
                declarations[name, cells[1]] = (float(cells[4]), *map(float, cells[3].split(" .. ")))
        for name, effect in EFFECTS.items():
            for parameter, numbers in effect.parameters.items():
                if effect.kind == "outside" or parameter == "over":
                    continue
                declared = declarations[name, parameter]
                # The range of an estimate reaches beyond what is drawn: a delay may be negative, a wedge very strong.
                (off, low, high), (default, least, most) = numbers, declared
                self.assertTrue(off == default and least <= low <= high <= most, (name, parameter))
            for parameter in effect.switches:
                self.assertEqual(vector[slot(name, parameter)], effect.parameters[parameter][0])


class Noise(unittest.TestCase):
    def test_noise_has_the_statistics_it_is_said_to_have(self):
        channel = Channel(0.01, 0.02, 2.0)
        times = np.arange(0.0, 40.0, 0.1)
        rng = np.random.default_rng(5)
        draws = np.stack([channel.draw(rng, times) for _ in range(400)])
        wanted = channel.covariance(times)
        for lag in (0, 1, 10, 40):
            found = np.mean(draws[:, lag:] * draws[:, : len(times) - lag])
            self.assertAlmostEqual(found / wanted[0, 0], wanted[0, lag] / wanted[0, 0], delta=0.05)

    def test_encoders_count_what_turned(self):
        drive = manoeuvre()
        samples = Samples(np.arange(0.1, 11.5, 0.05), np.array([1.0, 2.0]))
        seen = encoder(np.random.default_rng(1), drive, samples, 4096, 0.0)
        true = np.stack([np.interp(samples.wheel_times, np.arange(len(drive.speeds)) * 0.05, drive.speeds[:, i])
                         for i in range(2)], axis=1)
        self.assertLess(np.abs(seen - true).max(), 2.0 * math.pi / 4096 / 0.05 + 0.05)
        self.assertLess(abs((seen - true).mean()), 2e-3)

    def test_nominal_soil_is_wrong_by_what_is_said(self):
        rng = np.random.default_rng(2)
        for base in SOILS.values():
            for _ in range(50):
                truth = true_soil(base, rng)
                nominal = nominal_soil(truth, rng)
                for name in ("cohesive_modulus", "frictional_modulus", "cohesion", "shear_modulus"):
                    off = abs(getattr(nominal, name) / getattr(truth, name) - 1.0)
                    self.assertTrue(0.299 <= off <= 0.601, name)
                self.assertTrue(2.0 <= abs(nominal.friction_angle_deg - truth.friction_angle_deg) <= 4.0)


class Signals(unittest.TestCase):
    def test_projection_removes_what_starts_and_soil_explain(self):
        rng = np.random.default_rng(1)
        start, soil, other = span(rng.normal(size=(60, 6))), rng.normal(size=(60, 3)), rng.normal(size=60)
        hidden = project([start @ np.ones(6) + soil @ np.ones(3)], [start], [soil])
        self.assertLess(hidden.left, 1e-9)
        self.assertAlmostEqual(hidden.absorbed, 1.0, places=9)
        self.assertGreater(project([other], [start], [soil]).left, 1.0)
        self.assertAlmostEqual(Signal(10.0, 2.0).absorbed, 0.96)

    def test_another_soil_is_re_tuned_away_however_far_off(self):
        drive, rng = manoeuvre(8.0), np.random.default_rng(1)
        sensors, soil = draw_sensors(rng), SOILS["sandy_loam"]
        off = Setup(VEHICLES["ranger"], soil)
        ruler = Ruler(Case(off, drive, sensors, draw_samples(rng, sensors, drive.seconds), {}))
        base, start, columns = ruler.columns(off)
        other = replace(soil, frictional_modulus=2.0 * soil.frictional_modulus, sinkage_exponent=0.8 * soil.sinkage_exponent,
                        cohesion=0.6 * soil.cohesion, shear_modulus=1.5 * soil.shear_modulus)
        _, change = ruler.moved(off, base, replace(off, soil=other))
        linear = project([change], [start], [columns])
        left = retuned([ruler], [off], [base], [change], [start], [columns])
        self.assertLess(left, 0.2 * linear.left)
        self.assertLess(left, 2.0)  # where it ends

    def test_what_only_adds_imitates_nothing_that_takes_away(self):
        rng = np.random.default_rng(2)
        start, soil, column = span(rng.normal(size=(60, 6))), rng.normal(size=(60, 3)), rng.normal(size=(60, 1))
        for sign, one_sided, imitated in ((1.0, True, True), (-1.0, True, False), (-1.0, False, True)):
            signal = sign * column[:, 0] + soil @ np.ones(3)
            left = left_beside([signal], [start], [soil], [column], [one_sided])
            alone = project([signal], [start], [soil]).left
            self.assertLess(abs(left - (0.0 if imitated else alone)), 1e-9)

    def test_the_ways_of_an_effect_are_all_its_parameters(self):
        vehicle = VEHICLES["hexa"]
        for effect in {name for group in families._ALIKE for name in group}:
            found = ways(effect, 0.5, vehicle, SOILS["sandy_loam"], 30.0)
            moved = {name for values, _ in found for name in EFFECTS[effect].switches
                     if values.get(name, EFFECTS[effect].parameters[name][0]) != EFFECTS[effect].parameters[name][0]}
            self.assertEqual(moved, set(EFFECTS[effect].switches), effect)
        places = {(values["ahead"] > 0.0, values["left"] > 0.0) for values, _ in ways("payload", 0.5, vehicle, SOILS["dry_sand"], 30.0)}
        self.assertEqual(len(places), 4)

    def test_every_way_is_driven_with_its_own_values(self):
        drive, rng = manoeuvre(6.0), np.random.default_rng(1)
        sensors = draw_sensors(rng)
        ruler = Ruler(Case(Setup(VEHICLES["hexa"], SOILS["dry_sand"]), drive, sensors, draw_samples(rng, sensors, drive.seconds), {}))
        ahead, aside = ({"unit_weight": 16000.0, name: 0.3} for name in ("frontal", "lateral"))
        one, other, again = (ruler.response("bulldozing", values) for values in (ahead, aside, ahead))
        self.assertGreater(np.linalg.norm(one - other), 0.1 * np.linalg.norm(one))
        self.assertEqual(np.linalg.norm(one - again), 0.0)

    def test_what_acts_in_the_same_seconds_is_asked_for_there(self):
        drive, rng = manoeuvre(12.0), np.random.default_rng(1)
        sensors, vehicle, soil = draw_sensors(rng), VEHICLES["ranger"], SOILS["sandy_loam"]
        window = Window("time", (4.0, 7.0))
        effects = {"drawbar": {"force": 80.0, "hitch_behind": 0.5, "hitch_height": 0.2}}
        setup = Setup(vehicle, soil, effects, {"drawbar": window})
        ruler = Ruler(Case(setup, drive, sensors, draw_samples(rng, sensors, drive.seconds), {}))
        _, start, columns = ruler.columns(setup.without("drawbar"))
        changes = [{"drawbar": ruler.difference(["drawbar"])}]
        self.assertGreater(project([changes[0]["drawbar"]], [start], [columns]).left, 20.0)
        throughout, there = (Bench([ruler], [start], [columns], changes, [windows]).rivals(["drawbar"], 1)
                             for windows in ({}, {"drawbar": window}))
        self.assertEqual(throughout, [])  # nothing that acts all the time looks like a pull of three seconds
        self.assertLessEqual({"grade", "rate_dependent_soil", "terrain_change"}, set(there))

    def test_columns_of_starts_are_differences_of_the_simulator(self):
        drive, rng = manoeuvre(11.0), np.random.default_rng(1)
        sensors = draw_sensors(rng)
        grade = {"grade": {"slope_east": 0.1, "slope_north": 0.05}}
        for effects, stretch, state in (({}, 0, 2), (grade, 1, 2), (grade, 1, 3), (grade, 1, 5)):
            setup = Setup(VEHICLES["scout"], SOILS["clayed_soil"], effects)
            off = setup.without(*effects)
            ruler = Ruler(Case(setup, drive, sensors, draw_samples(rng, sensors, drive.seconds), {}))
            base = ruler.predict(off, drive)
            columns = ruler.starts(off, base)
            kept = ruler.snapshots[stretch].copy()
            delta = 0.01
            kept.state[state] += delta
            ruler.snapshots[stretch], ruler.without = kept, {}
            moved = ruler.predict(off, drive)
            change = ruler._change(ruler.observe(moved, {}), ruler.observe(base, {})) / delta
            away = np.linalg.norm(change - columns[:, 6 * stretch + state])
            self.assertLess(away, 0.02 * np.linalg.norm(change), (effects, state))

    def test_what_comes_late_comes_from_the_stretch_before(self):
        drive, rng = manoeuvre(12.0), np.random.default_rng(3)
        sensors = draw_sensors(rng)
        samples, late = draw_samples(rng, sensors, drive.seconds), {"latency": {"pose": 0.23, "yaw_rate": 0.04}}
        setup = Setup(VEHICLES["scout"], SOILS["clayed_soil"])
        ruler = Ruler(Case(setup, drive, sensors, samples, late))
        whole = report(np.concatenate([ruler.truth[0][:-1], ruler.truth[1][:-1], ruler.truth[2]]), 0.05, samples, ruler.channels, late)
        for name, values in ruler.observe(ruler.truth, late).items():
            self.assertLess(np.abs(values - whole[name]).max(), 1e-12, name)
        # Predictions have no stretch before: there the vehicle came as it goes on.
        copied = [records.copy() for records in ruler.truth]
        away = ruler.observe(copied, late)["x"] - whole["x"]
        self.assertLess(np.abs(away).max(), 0.02)
        held = report(ruler.truth[1], 0.05, Samples(np.empty(0), np.zeros(1)), ["x"], late)["x"]
        before = report(ruler.truth[0], 0.05, Samples(np.empty(0), np.full(1, 5.0)), ["x"], late)["x"]
        self.assertGreater(abs(held - before).max(), 0.1)

    def test_no_soil_beyond_those_that_there_are(self):
        rng = np.random.default_rng(4)
        start, soil = span(rng.normal(size=(60, 6))), rng.normal(size=(60, 3))
        near, far = (project([soil @ np.array([by, 0.0, 0.0])], [start], [soil]) for by in (1.0, -5.0))
        self.assertLess(near.left, 1e-9)
        self.assertGreater(far.left, 0.5 * far.raw)


class Cases(unittest.TestCase):
    def test_the_mix_is_exact_in_every_hundred(self):
        for block in range(3):
            found = [families.family_of(9, i) for i in range(100 * block, 100 * block + 100)]
            self.assertEqual({f: found.count(f) for f in families.MIX}, families.MIX)

    def test_effects_are_drawn_evenly(self):
        found = [families.effect_of(4, i, "single", "single") for i in range(3 * len(families.EFFECTS_OF["single"]))]
        self.assertTrue(all(found.count(e) == 3 for e in families.EFFECTS_OF["single"]))

    @pytest.mark.nightly
    def test_an_absorbed_case_is_absorbed(self):
        index = next(i for i in range(100) if families.effect_of(1, i, "absorbed", "absorbed") == "drawbar")
        draft = draw_case(1, index, "absorbed", "drawbar")
        part, (name,) = draft.parts[0], draft.effects
        ruler = Ruler(Case(draft.setup(part), part.drive, draft.sensors, part.samples, draft.faults(), part.pose))
        off = ruler.case.setup.without(name)
        base, start, soil = ruler.columns(off)
        change = ruler.difference([name])
        linear = project([change], [start], [soil])
        left = min(linear.left, retuned([ruler], [off], [base], [change], [start], [soil]))
        self.assertGreater(Signal(linear.raw, left).absorbed, 0.9)
        self.assertGreaterEqual(left, 8.0)

    def test_same_seed_same_bytes_whatever_the_jobs(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, jobs in (("a", "1"), ("b", "2")):
                subprocess.run([sys.executable, "-m", "generator", "--out", f"{folder}/{name}", "--cases", "2", "--seed", "5",
                                "--family", "nothing", "--jobs", jobs], cwd=ROOT / "scripts" / "proof", check=True,
                               capture_output=True)
            files = sorted(p.relative_to(f"{folder}/a") for p in Path(folder, "a").rglob("*") if p.is_file())
            self.assertEqual(len(files), 2 * 5 + 1)
            for file in files:
                self.assertEqual(Path(folder, "a", file).read_bytes(), Path(folder, "b", file).read_bytes(), str(file))
            self._check_truth(json.loads(Path(folder, "a", "sealed", "case_0000.json").read_text()))

    def test_pivots_come_beside_the_same_drive(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, more in (("without", []), ("with", ["--pivots"])):
                subprocess.run([sys.executable, "-m", "generator", "--out", f"{folder}/{name}", "--cases", "1", "--seed", "5",
                                "--family", "nothing", *more], cwd=ROOT / "scripts" / "proof", check=True, capture_output=True)
            without, pivoting = (Path(folder, name, "case_0000") for name in ("without", "with"))
            self.assertFalse((without / "second.csv").exists())
            for kept in ("drive.csv", "unseen.csv"):
                self.assertEqual((without / kept).read_bytes(), (pivoting / kept).read_bytes())
            with (pivoting / "second.csv").open() as file:
                rows = [row for row in csv.DictReader(file) if row["omega_left"]]
            left, right = (np.array([float(row[f"omega_{side}"]) for row in rows]) for side in ("left", "right"))
            turning = np.abs(right - left) > 0.1 * np.max(np.abs(right - left))
            self.assertGreater(np.mean(turning), 0.4)
            self.assertLess(np.max(np.abs(left + right)[turning]), 0.2 * np.max(np.abs(right - left)))
            self.assertTrue(is_complete(Path(folder, "with"), 0, True))
            self.assertFalse(is_complete(Path(folder, "without"), 0, True))
            truth = json.loads(Path(folder, "with", "sealed", "case_0000.json").read_text())
            self.assertEqual(truth["drives"]["second"]["style"], "pivots")

    def _check_truth(self, truth: dict) -> None:
        keys = ("format", "case", "seed", "family", "variant", "vehicle", "vehicle_numbers", "ground", "true_terrain",
                "nominal_terrain", "noise", "effects", "drives", "signal_left", "expected", "names", "rivals")
        self.assertEqual(list(truth), list(keys))
        self.assertEqual(truth["format"], "ugv-proof-truth/1")
        self.assertEqual(truth["expected"], ["nothing_missing"])
        self.assertEqual(set(truth["drives"]), {"drive", "unseen"})

    def test_a_folder_with_other_cases_is_refused_and_left_as_it_is(self):
        with tempfile.TemporaryDirectory() as folder:
            # A case that is complete is not drawn.
            (Path(folder) / "case_0000").mkdir()
            (Path(folder) / "sealed").mkdir()
            (Path(folder) / "sealed" / "case_0000.json").write_text("{}")
            told, words = Path(folder) / "set.json", ["--out", folder, "--cases", "1"]
            for held in ({"seed": 7, "family": "absorbed"}, {"seed": 7, "family": None}, {"seed": 7}):
                told.write_text(json.dumps(held))
                own = ["--family", held["family"]] if held.get("family") else []
                others = [["--seed", "8", *own]] + ([["--seed", "7", "--family", "nothing"]] if "family" in held else [])
                for other in others:
                    said = io.StringIO()
                    with self.assertRaises(SystemExit) as stopped, contextlib.redirect_stderr(said):
                        draw([*words, *other])
                    self.assertEqual(stopped.exception.code, 2)
                    self.assertRegex(said.getvalue(), r"holds other cases \(seed 7.*\); take another --out")
                    self.assertEqual(json.loads(told.read_text()), held)
                with contextlib.redirect_stderr(io.StringIO()):
                    self.assertEqual(draw([*words, "--seed", "7", *own]), 0)
                self.assertEqual(json.loads(told.read_text())["family"], held.get("family"))

    def test_wrong_arguments_are_told_with_the_remedy(self):
        for arguments, word in ((["--cases", "0"], "give 1 or more"), (["--jobs", "7"], "give one of them"),
                                (["--seed", "-1"], "give 0 or more")):
            done = subprocess.run([sys.executable, "-m", "generator", "--out", os.devnull + "x", *arguments],
                                  cwd=ROOT / "scripts" / "proof", capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 2)
            self.assertIn(word, done.stderr)


@unittest.skipUnless(BINARY.exists(), f"{BINARY} is not built: agreement with `ugv simulate` is not checked")
class Agreement(unittest.TestCase):
    def test_agrees_with_ugv_simulate(self):
        drive = manoeuvre(20.0)
        cases = [{}, {"grade": {"slope_east": 0.05, "slope_north": -0.03}}, {"drawbar": {"force": 200.0}},
                 {"elastic_rebound": {"share": 0.25}}, {"shear_anisotropy": {"modulus_ratio": 1.5}},
                 {"slip_sinkage": {"sinkage_growth": 0.5}}]
        for soil in ("dry_sand", "clayed_soil"):
            for effects in cases:
                with self.subTest(f"{soil} {effects}"):
                    # The library rounds the slip off within 0.01 of zero, the generator does not.
                    self._agree(soil, effects, drive, 2e-3 if "slip_sinkage" in effects else 1e-3)

    def test_agrees_on_tyres_on_hard_ground(self):
        # The substitute circle is three hundred times as large as the wheel.
        self._agree("dry_clay", {"tyre_compliance": {"pressure": 250e3}}, manoeuvre(20.0), 5e-4)

    def test_agrees_on_ruts_in_turns_and_on_the_spot(self):
        ruts = {"multipass": {"memory": 0.8, "stiffness_ratio": 8.0}}
        for drive in (manoeuvre(20.0), turning_on_the_spot(20.0)):
            self._agree("sandy_loam", ruts, drive, 3e-3)

    def _agree(self, soil: str, effects: dict, drive: Drive, angle: float) -> None:
        theirs = drive_library(BINARY, "tran", SOILS[soil], effects, drive)
        mine = drive_generator("tran", SOILS[soil], effects, drive)
        count = min(len(mine), len(theirs))
        length = np.abs(np.diff(theirs[:, :2], axis=0)).sum()
        self.assertLess(np.abs(mine[:count, :2] - theirs[:count, :2]).max(), 1e-3 * length)
        self.assertLess(np.abs(mine[:count, 2] - theirs[:count, 2]).max(), angle)


if __name__ == "__main__":
    unittest.main()
