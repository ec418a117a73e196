#!/usr/bin/env python3
"""Wheel-terrain interaction of an eight-wheel skid-steer vehicle in NumPy and SciPy.

T. H. Tran, N. M. Kwok, S. Scheding, Q. P. Ha, "Dynamic Modelling of Wheel-Terrain
Interaction of a UGV", IEEE CASE 2007; equation numbers in brackets are the paper's.
SI units and radians; body frame X forward, Y left; wheels odd left, even right, front first.
"""

import argparse
import json
import platform
import sys
import time
import timeit
import warnings
from pathlib import Path

import numpy as np
import scipy
from scipy.integrate import solve_ivp

STATE = ("x", "y", "heading", "v_x", "v_y", "yaw_rate")
# Table II: kg, kg m^2, m.
VEHICLE = {"m": 490.0, "Iz": 309.43, "r": 0.25, "b": 0.246, "a": 0.61, "B": 0.61, "d": 0.17, "h": 0.35}
# Table I: c [kPa], phi [deg], k_c [kN/m^(n+1)], k_phi [kN/m^(n+2)], n, K [m].
TABLE_I = {
    "dry_sand": (1.04, 28.0, 0.99, 1528.43, 1.1, 0.01),
    "sandy_loam": (1.72, 29.0, 5.27, 1515.04, 0.7, 0.025),
    "clayed_soil": (4.14, 13.0, 13.19, 692.15, 0.5, 0.006),
    "dry_clay": (68.95, 34.0, 12.70, 1555.95, 0.13, 0.006),
}
TERRAINS = {
    name: {"c": 1e3 * c, "phi": np.radians(phi), "k_c": 1e3 * k_c, "k_phi": 1e3 * k_phi, "n": n, "K": K}
    for name, (c, phi, k_c, k_phi, n, K) in TABLE_I.items()
}
TOTALS = ("F_X", "F_Y", "M_Z", "rolling_resistance", "turning_resistance_moment")
WRENCH_TOLERANCE = (1e-3, 0.1)  # of the largest wheel force; N or N m, whichever is larger
TRAJECTORY_TOLERANCE = (2e-3, 1e-3)  # m, rad at the last sample


def graded_gauss(count):
    """Gauss-Legendre nodes and weights on s = t^2, 0 <= s <= 1: s^n becomes t^(2 n) at the end point s = 0."""
    t, weight = np.polynomial.legendre.leggauss(count)
    t = 0.5 * (t + 1.0)
    return t * t, weight * t


class Model:
    """Forces and motion of the vehicle on one terrain.

    vehicle: keys of VEHICLE, optionally g [m/s^2], omega_min [rad/s] (bound of the contact time
    1/omega) and slip_speed [m/s] (regularises the directions of slip and of forward motion at zero).
    terrain: c [Pa], phi [rad], k_c [N/m^(n+1)], k_phi [N/m^(n+2)], n, K [m].
    Nodes: theta_nodes for each of the three panels of theta, lateral_nodes across the width.
    """

    def __init__(self, vehicle, terrain, theta_nodes=5, lateral_nodes=3):
        self.m, self.inertia, self.r, self.b = (vehicle[key] for key in ("m", "Iz", "r", "b"))
        self.h, self.g = vehicle["h"], vehicle.get("g", 9.81)
        self.omega_min, self.slip_speed = vehicle.get("omega_min", 0.05), vehicle.get("slip_speed", 1e-3)
        self.cohesion, self.tan_phi = terrain["c"], np.tan(terrain["phi"])
        self.n, self.K = terrain["n"], terrain["K"]
        self.stiffness = (terrain["k_c"] / self.b + terrain["k_phi"]) * self.r**self.n
        self.X = (1.5 - np.arange(8) // 2) * vehicle["a"] - vehicle["d"]  # (7)
        self.Y = np.where(np.arange(8) % 2 == 0, vehicle["B"], -vehicle["B"])
        y, y_weight = np.polynomial.legendre.leggauss(lateral_nodes)
        self.Y_nodes = self.Y[:, None] + 0.5 * self.b * y
        self.t, weight = graded_gauss(theta_nodes)
        self.weight = 0.5 * self.b * self.r * y_weight[:, None, None] * weight  # dA = r dtheta dy
        self.load_matrix = self._load_matrix(np.ones(8, bool))
        self.entry = np.full(8, 0.4)  # of the last solution: the next one starts from here
        self.entry_at_rest = self._solve(np.zeros(3), np.zeros(8))[2]

    def _load_matrix(self, grounded):
        """Loads per (m g, -h F_X, -h F_Y): the fit u + v X + w Y over the grounded wheels (26)-(28)."""
        basis = np.stack([np.ones(8), self.X, self.Y], axis=1) * grounded[:, None]
        moments = basis.T @ basis
        if np.linalg.cond(moments) > 1e8:
            raise ValueError("load distribution: the wheels left on the ground cannot carry the vehicle")
        return basis @ np.linalg.inv(moments)

    def _contact(self, entry, v, omega, side):
        """Integrals (18), (21), (24), (25) of each wheel: F_X, F_Y, F_Z, turning moment, M_r, R_r.

        entry: (..., 8); v = (V_X, V_Y, Omega): (..., 3); side = +1 or -1 per wheel, -1 mirrors the
        contact front to back. The nodes lie on the two last axes (y, theta).
        """
        v_x, v_y, yaw_rate = (v[..., k, None, None] for k in range(3))
        v_x, yaw_rate = side[:, None] * v_x, side[:, None] * yaw_rate
        r, rim = self.r, (side * omega * self.r)[:, None]
        contact_time = (1.0 / np.maximum(np.abs(omega), self.omega_min))[:, None, None]
        v_xi = v_x - yaw_rate * self.Y_nodes  # (10)

        # Panels of theta: sigma has a kink at theta_m, V_jX changes sign where cos theta = r omega / V_Xi.
        # Nodes cluster at 0 and theta_1, where sigma is singular, and at the sign change.
        entry, middle = entry[..., None], 0.5 * entry[..., None]
        ratio = rim / np.where(v_xi == 0.0, 1e-12, v_xi)
        reversal = np.minimum(np.arccos(np.clip(ratio, -1.0, 1.0)), entry)
        origin, width = np.zeros((2, *reversal.shape, 3, 1))
        origin[..., 1, 0], origin[..., 2, 0] = reversal, entry
        width[..., 0, 0], width[..., 1, 0] = np.minimum(middle, reversal), middle - reversal
        width[..., 2, 0] = np.maximum(middle, reversal) - entry
        shape = (*reversal.shape, 3 * self.t.size)
        theta = (origin + width * self.t).reshape(shape)
        area = (np.abs(width) * self.weight).reshape(shape)

        entry, v_xi, rim = entry[..., None], v_xi[..., None], rim[..., None]
        yaw_rate, v_yi = yaw_rate[..., None], v_y[..., None] + yaw_rate[..., None] * (side * self.X)[:, None, None]
        cos, sin, cos_1, sin_1 = np.cos(theta), np.sin(theta), np.cos(entry), np.sin(entry)
        rest = entry - theta
        depth = np.cos(np.maximum(theta, rest)) - cos_1  # (3) in front of theta_m, (5) behind
        sigma = self.stiffness * np.maximum(depth, 0.0) ** self.n
        j_x = v_xi * 0.5 * (rest + sin_1 * cos_1 - sin * cos) - rim * (sin_1 - sin)  # (14)
        j_y = v_yi * rest + r * yaw_rate * (cos - cos_1)
        j_z = v_xi * 0.5 * (cos * cos - cos_1 * cos_1) + rim * (cos_1 - cos)
        j = contact_time * np.sqrt(j_x * j_x + j_y * j_y + j_z * j_z)  # (15)
        tangential = v_xi * cos - rim  # V_jX = tangential cos theta, V_jZ = tangential sin theta (12)
        lateral = v_yi + r * yaw_rate * sin
        speed = np.sqrt(tangential * tangential + lateral * lateral + self.slip_speed**2)
        shear = (self.cohesion + sigma * self.tan_phi) * np.expm1(-j / self.K) * area / speed  # (6), (16)
        along, across, normal = shear * tangential, shear * lateral, sigma * area
        # Compaction opposes the forward motion and vanishes with it: it cannot push a vehicle at rest.
        v_xi, resistance = v_xi[..., 0], np.vecdot(normal, sin)
        f_x = np.vecdot(along, cos) - resistance * v_xi / np.sqrt(v_xi * v_xi + self.slip_speed**2)
        f_y, f_z = across.sum((-2, -1)), (np.vecdot(along, sin) + np.vecdot(normal, cos)).sum(-1)
        turning = -side * np.vecdot(f_x, self.Y_nodes)
        resisting = -side * (side * self.X * f_y + r * np.vecdot(across, sin).sum(-1))
        return np.stack([side * f_x.sum(-1), f_y, f_z, turning, resisting, resistance.sum(-1)], axis=-1)

    def _wheels(self, entry, v, omega):
        """_contact() with the leading side of each wheel; both sides, blended, for abs(omega) < omega_min."""
        if np.abs(omega).min() >= self.omega_min:
            return self._contact(entry, v, omega, np.sign(omega))
        ahead = np.clip(0.5 + 0.5 * omega / self.omega_min, 0.0, 1.0)
        ahead = (ahead * ahead * (3.0 - 2.0 * ahead))[:, None]
        ones = np.ones(8)
        return ahead * self._contact(entry, v, omega, ones) + (1.0 - ahead) * self._contact(entry, v, omega, -ones)

    def _newton_matrix(self, slope, load_matrix, grounded):
        """Derivative of F_Zi - W_i by the entry angles; W follows the forces (22a), (28)."""
        jacobian = self.h * load_matrix[:, 1:] @ slope[:, :2].T
        jacobian.flat[::9] += np.where(grounded, slope[:, 2], 1.0)
        return jacobian

    def _solve(self, v, omega):
        """Wheel integrals, loads and entry angles: Newton on (22a) and the loop (19), (20), (28) of all wheels at once.

        The last step, below 1e-3 rad, also updates the forces to first order (error below 0.01 N).
        """
        entry, load_matrix, grounded = self.entry, self.load_matrix, np.ones(8, bool)
        delta, limit = 1e-6, 0.5 * np.pi
        for _ in range(100):
            base, moved = self._wheels(np.stack([entry, entry + delta]), v, omega) * grounded[:, None]
            slope, total = (moved - base) / delta, base.sum(0)
            loads = load_matrix @ np.array([self.m * self.g, -self.h * total[0], -self.h * total[1]])
            step = np.linalg.solve(self._newton_matrix(slope, load_matrix, grounded), loads - base[:, 2])
            size, lifted = np.abs(step), grounded & (loads < 0.0)
            if size.max() < 1e-3 and not lifted.any():
                self.entry, self.solved_with = np.where(grounded, entry + step, 0.1), (load_matrix, grounded)
                base += slope * step[:, None]
                return base, base[:, 2], self.entry * grounded
            if lifted.any() and size[~lifted].max(initial=0.0) < 1e-2:
                warnings.warn("a wheel lifts: its load is 0 and the others carry m g", stacklevel=2)
                grounded = grounded & ~lifted
                load_matrix = self._load_matrix(grounded)
            if (grounded & (entry == limit) & (step >= 0.0)).any():
                raise ValueError("entry angle: it would pass pi/2, the vehicle is bogged to the axle")
            entry = np.minimum(entry + np.clip(step, -0.5 * entry, 0.5 * entry), limit)
        raise ArithmeticError("entry angle: no convergence in 100 Newton steps")

    def wrench(self, v_x, v_y, yaw_rate, omega_left, omega_right):
        """Forces, moments and accelerations at a state, from the entry angles at rest."""
        self.entry = self.entry_at_rest
        wheels, loads, entry = self._solve(np.array([v_x, v_y, yaw_rate]), np.tile([omega_left, omega_right], 4))
        f_x, f_y, _, turning, resisting, rolling = wheels.sum(0)
        keys = ("F_X", "F_Y", "M_Z", "a_X", "a_Y", "rolling_resistance", "turning_resistance_moment")
        totals = (f_x, f_y, turning - resisting, f_x / self.m, f_y / self.m, rolling, resisting)
        wheelwise = {"loads": loads, "entry_angles": entry, "forces": wheels[:, :2]}
        return dict(zip(keys, map(float, totals), strict=True)) | wheelwise

    def _derivative(self, state, omega):
        """Time derivative of the state: (19), (20), (24)."""
        _, _, heading, v_x, v_y, yaw_rate = state
        f_x, f_y, _, turning, resisting, _ = self._solve(state[3:], omega)[0].sum(0)
        cos, sin = np.cos(heading), np.sin(heading)
        position = (v_x * cos - v_y * sin, v_x * sin + v_y * cos, yaw_rate)
        a_x, a_y = f_x / self.m + v_y * yaw_rate, f_y / self.m - v_x * yaw_rate
        return np.array([*position, a_x, a_y, (turning - resisting) / self.inertia])

    def _jacobian(self, state, omega):
        """Derivative of _derivative() by the state; the entry angles follow V as implicit functions."""
        _, _, heading, v_x, v_y, yaw_rate = state
        self._solve(state[3:], omega)
        load_matrix, grounded = self.solved_with
        entry, v, delta = np.tile(self.entry, (5, 1)), np.tile(state[3:], (5, 1)), 1e-6
        entry[1] += delta
        v[2:] += delta * np.eye(3)
        wheels = self._wheels(entry, v, omega) * grounded[:, None]
        slope, by_v = (wheels[1] - wheels[0]) / delta, (wheels[2:] - wheels[0]) / delta
        residual = by_v[..., 2] + self.h * by_v[..., :2].sum(1) @ load_matrix[:, 1:].T
        entry_by_v = -np.linalg.solve(self._newton_matrix(slope, load_matrix, grounded), residual.T)
        f_x, f_y, _, turning, resisting, _ = by_v.sum(1).T + slope.T @ entry_by_v
        cos, sin = np.cos(heading), np.sin(heading)
        out = np.zeros((6, 6))
        out[:3, 2:] = (-v_x * sin - v_y * cos, cos, -sin, 0.0), (v_x * cos - v_y * sin, sin, cos, 0.0), (0, 0, 0, 1)
        rotation = np.array([(0.0, yaw_rate, v_y), (-yaw_rate, 0.0, -v_x), (0.0, 0.0, 0.0)])
        out[3:, 3:] = np.array([f_x / self.m, f_y / self.m, (turning - resisting) / self.inertia]) + rotation
        return out

    def simulate(self, times, omega_left, omega_right, initial_state, method="LSODA", rtol=1e-6, atol=1e-5):
        """States at the given times, one row of STATE each; wheel speeds are linear between the times.

        LSODA was the fastest of SciPy's methods at millimetre accuracy and copes with standstill, where
        dF/dV grows like 1/omega. The bounded step keeps it from stepping over a start from rest.
        """
        times, table = np.asarray(times, float), np.stack([omega_left, omega_right] * 4, axis=1)
        slopes = np.diff(table, axis=0) / np.diff(times)[:, None]
        self.entry = self.entry_at_rest

        def omega(t):
            k = min(max(times.searchsorted(t) - 1, 0), len(slopes) - 1)
            return table[k] + (t - times[k]) * slopes[k]

        options = {"method": method, "t_eval": times, "rtol": rtol, "atol": atol, "max_step": 0.25}
        if method in ("LSODA", "BDF", "Radau"):
            options["jac"] = lambda t, s: self._jacobian(s, omega(t))
        solution = solve_ivp(lambda t, s: self._derivative(s, omega(t)), times[[0, -1]], initial_state, **options)
        if not solution.success:
            raise ArithmeticError(f"integration: {solution.message}")
        return solution.y.T


def check(golden):
    """Compare with the golden wrenches and trajectories; return whether all agree within the tolerances."""
    data, passed = json.loads((golden / "wrenches.json").read_text()), []
    vehicle = data["vehicle"] | {"g": data["gravity"]}
    print("wrench       terrain      totals [N, N m]   wheels [N]   entry angle [rad]   tolerance")
    for number, state in enumerate(data["states"], 1):
        model = Model(vehicle, TERRAINS[state["terrain"]])
        result = model.wrench(*(state[key] for key in ("V_X", "V_Y", "yaw_rate", "omega_left", "omega_right")))
        wheels = np.array([[w[key] for key in ("F_X", "F_Y", "load", "entry_angle")] for w in state["wheels"]])
        deviation = np.abs(np.column_stack([result["forces"], result["loads"], result["entry_angles"]]) - wheels)
        total = max(abs(result[key] - state[key]) for key in TOTALS)
        tolerance = max(WRENCH_TOLERANCE[0] * np.abs(wheels[:, :2]).max(), WRENCH_TOLERANCE[1])
        passed.append(max(total, deviation[:, :3].max()) <= tolerance)
        values = f"{total:17.4f} {deviation[:, :3].max():12.4f} {deviation[:, 3].max():19.2e} {tolerance:11.3f}"
        print(f"{number:6} {state['terrain']:>13} {values}  {'ok' if passed[-1] else 'DEVIATES'}")
    print("trajectory   at the end: position [m]   heading [rad]   anywhere: position [m]")
    for name, terrain in TERRAINS.items():
        table = np.genfromtxt(golden / f"trajectory_{name}.csv", delimiter=",", names=True)
        expected = np.stack([table[key] for key in STATE], axis=1)
        inputs = (table["time"], table["omega_left"], table["omega_right"])
        deviation = Model(vehicle, terrain).simulate(*inputs, expected[0]) - expected
        distance, heading = np.hypot(deviation[:, 0], deviation[:, 1]), abs(deviation[-1, 2])
        passed.append(distance[-1] <= TRAJECTORY_TOLERANCE[0] and heading <= TRAJECTORY_TOLERANCE[1])
        values = f"{distance[-1]:24.6f} {heading:15.6f} {distance.max():24.6f}"
        print(f"{name:12} {values}  {'ok' if passed[-1] else 'DEVIATES'}")
    return all(passed)


def processor_seconds(work, number):
    """Seconds of the processor of one call, the best of 3 x number calls."""
    return min(timeit.repeat(work, number=number, repeat=3, timer=time.process_time)) / number


def bench(golden, drive):
    """Seconds of the processor on each soil: a wrench, mean over the golden states of the soil, and the drive of a table."""
    states = json.loads((golden / "wrenches.json").read_text())["states"]
    times, left, right = np.loadtxt(drive, delimiter=",", skiprows=1).T
    soils = {}
    for name, terrain in TERRAINS.items():
        model = Model(VEHICLE, terrain)
        keys = ("V_X", "V_Y", "yaw_rate", "omega_left", "omega_right")
        motions = [[state[key] for key in keys] for state in states if state["terrain"] == name]
        wrench = processor_seconds(lambda: [model.wrench(*motion) for motion in motions], 20) / len(motions)
        ends = []
        try:
            seconds = processor_seconds(lambda: ends.append(model.simulate(times, left, right, np.zeros(6))[-1]), 1)
        except (ArithmeticError, ValueError) as error:
            soils[name] = {"wrench": wrench, "error": str(error)}
        else:
            soils[name] = {"wrench": wrench, "drive": seconds, "end": list(ends[-1][:3])}
    versions = {"python": platform.python_version(), "numpy": np.__version__, "scipy": scipy.__version__}
    return {"soils": soils, "versions": versions}


def main():
    parser = argparse.ArgumentParser(description="Wheel-terrain model of a skid-steer vehicle in NumPy and SciPy.")
    commands = parser.add_subparsers(dest="command", required=True)
    command = commands.add_parser("check", help="compare with golden values; exit code 1 beyond tolerance")
    command.add_argument("--golden", type=Path, required=True, metavar="DIR", help="wrenches.json and trajectory_*.csv")
    command = commands.add_parser("bench", help="time wrenches and a drive on each soil")
    command.add_argument("--golden", type=Path, required=True, metavar="DIR", help="wrenches.json")
    command.add_argument("--drive", type=Path, required=True, metavar="FILE.csv", help="time,omega_left,omega_right")
    command.add_argument("--json", type=Path, required=True, metavar="FILE", help="where the timings are written")
    arguments = parser.parse_args()
    if arguments.command == "check":
        return 0 if check(arguments.golden) else 1
    arguments.json.write_text(json.dumps(bench(arguments.golden, arguments.drive), indent=2) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
