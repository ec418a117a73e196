"""One wheel with its effects: which soil it stands on, its shape, its speeds, and what acts beside the contact."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .catalogue import I
from .contact import SLIP_SPEED, bounded_rate, smooth_step
from .formulas import changed_soil, exit_share, passed_soil, peak_place, pressed_tyre, sheared_soil, soil_of_side, wedges

BOGGED = 0.5 * math.pi


@njit(cache=True)
def wheel_motion(x_ref, y_ref, v, omega, radius, motion):
    """V_X, V_Y of the wheel's centre, Omega, r omega (10). x_ref, y_ref: its place seen from the reference point."""
    motion[0] = v[0] - v[2] * y_ref
    motion[1] = v[1] + v[2] * x_ref
    motion[2] = v[2]
    motion[3] = radius * omega


@njit(cache=True)
def slips(motion):
    """Longitudinal slip, at most 1 in size, and the slip of both directions, at most 1."""
    slide = motion[3] - motion[0]
    size = max(abs(motion[3]), abs(motion[0]), SLIP_SPEED)
    speed = math.sqrt(motion[0] ** 2 + motion[1] ** 2)
    both = math.sqrt(slide**2 + motion[1] ** 2) / max(abs(motion[3]), speed, SLIP_SPEED)
    return min(abs(slide) / size, 1.0), min(both, 1.0)


@njit(cache=True)
def wheel_soil(e, left, rank, east, north, pose, time, distance, load, mean_load, motion, rut, soil):
    """The soil under a wheel: k, n, c, tan phi, K and what else the contact needs. rank: rows that lead its own."""
    k, n, c, tan_phi, shear_k = e[I.k], e[I.n], e[I.c], e[I.tan_phi], e[I.shear_k]

    over = e[I.terrain_change_over]
    u = time
    if over > 1.5:
        u = east * math.cos(e[I.terrain_change_direction]) + north * math.sin(e[I.terrain_change_direction])
    elif over > 0.5:
        u = distance
    w = smooth_step((u - e[I.terrain_change_position]) / e[I.terrain_change_transition])
    soil[0], soil[1], soil[2], soil[3], soil[4] = k, n, c, tan_phi, shear_k
    if e[I.terrain_change_formula] > 0.5:
        u_body = u
        if over > 1.5:
            u_body = pose[0] * math.cos(e[I.terrain_change_direction]) + pose[1] * math.sin(e[I.terrain_change_direction])
        changed_soil(e, u, u_body, soil)
        w = 0.0
    if e[I.left_right_soil_formula] > 0.5:
        soil_of_side(e, left, soil)
    passed_soil(e, rank, soil)
    k, n, c, tan_phi, shear_k = soil[0], soil[1], soil[2], soil[3], soil[4]
    if w > 0.0:
        c *= e[I.terrain_change_cohesion_factor] ** w
        tan_phi *= e[I.terrain_change_friction_factor] ** w
        k *= e[I.terrain_change_stiffness_factor] ** w
        shear_k *= e[I.terrain_change_shear_modulus_factor] ** w

    if e[I.left_right_soil_ratio] != 1.0 and e[I.left_right_soil_formula] < 0.5:
        share = math.sqrt(e[I.left_right_soil_ratio])
        share = share if left else 1.0 / share
        c, tan_phi, k = c * share, tan_phi * share, k * share

    along, slip = slips(motion)
    if 0.5 < e[I.slip_sinkage_formula] < 1.5:
        slip = min(2.0 * slip * slip, 1.0)
    if e[I.slip_sinkage_formula] < 1.5:
        growth = e[I.slip_sinkage_sinkage_growth] * slip
        if growth > 0.0:  # under the same pressure a plate sinks (1 + S s) / (1 - S s / 2) times as deep
            k *= ((1.0 + growth) / (1.0 - 0.5 * growth)) ** -n
        n += e[I.slip_sinkage_exponent_growth] * slip
    elif e[I.slip_sinkage_formula] < 2.5:
        k *= math.exp(-1.5 * (e[I.slip_sinkage_sinkage_growth] + e[I.slip_sinkage_exponent_growth]) * along)

    if e[I.crust_strength] > 0.0:
        slide = math.sqrt((motion[3] - motion[0]) ** 2 + motion[1] ** 2)
        whole = smooth_step((e[I.crust_breaking_load] - load / mean_load) / 0.15)
        whole *= smooth_step(2.0 * (e[I.crust_breaking_speed] - slide) / e[I.crust_breaking_speed])
        k *= 1.0 + e[I.crust_strength] * whole

    if e[I.tyre_compliance_pressure] < 2e6 and e[I.tyre_compliance_formula] < 0.5:  # rubber adheres with half its pressure
        c = min(c, 0.5 * e[I.tyre_compliance_pressure])
    soil[0], soil[1], soil[2], soil[3], soil[4] = k, n, c, tan_phi, shear_k
    soil[5], soil[6], soil[7] = 0.0, 0.0, 0.0
    if e[I.multipass_memory] > 0.0 and rut > 1e-6 and e[I.multipass_formula] < 0.5:
        z_m, ratio = rut * e[I.multipass_memory], e[I.multipass_stiffness_ratio]
        soil[5], soil[6], soil[7] = z_m * (1.0 - 1.0 / ratio), z_m, ratio * k * z_m ** (n - 1.0)
    soil[8], soil[9] = e[I.shear_anisotropy_modulus_ratio], e[I.shear_anisotropy_strength_ratio]
    if e[I.shear_anisotropy_formula] > 0.5:
        sheared_soil(e, rank, motion, soil)
    soil[10], soil[11] = e[I.polished_soil_loss], e[I.polished_soil_speed]


@njit(cache=True)
def flat_tyre(e, radius, soil, table):
    """Reach at which a tyre is flat. The circle that stands on its pressure, (3 W / ((3-n) b))^2 k^(1/n)
    p^(-(2n+1)/n) / 2, sinks equally deep whatever the load W is: here under a load of 1 N for each m of width."""
    k, n, pressure = soil[0], soil[1], e[I.tyre_compliance_pressure]
    circle = 0.5 * (3.0 / (3.0 - n)) ** 2 * k ** (1.0 / n) * pressure ** (-(2.0 * n + 1.0) / n)
    mean = 0.0  # (5) over a flat arc: the two halves have the same stresses
    for i in range(int(table[0, -1])):
        mean += table[1, i] * (1.0 - (0.5 + 0.5 * table[0, i]) ** 2) ** n
    entry = (1.0 / (mean * k * 0.5**n * circle ** (n + 1.0))) ** (1.0 / (2.0 * n + 1.0))
    return math.sqrt(circle / radius) * entry


@njit(cache=True)
def wheel_shape(e, radius, reach, load, mean_load, soil, motion, table, shape):
    """Fills in radius of the (substitute) circle, width, exit angle's share, place of the stress peak; the entry angle.

    reach: length of the contact from its lowest point ahead, over the wheel's radius.
    """
    circle, theta_1 = radius, reach
    if e[I.tyre_compliance_pressure] < 2e6 and e[I.tyre_compliance_formula] < 0.5:
        flat = flat_tyre(e, radius, soil, table)
        if reach > flat:
            circle, theta_1 = radius * (reach / flat) ** 2, flat * flat / reach
    slip, _ = slips(motion)
    shape[0], shape[1] = circle, e[I.wheel_width]
    shape[2] = e[I.elastic_rebound_share]
    shape[3] = e[I.stress_peak_a0] + e[I.stress_peak_a1] * slip
    if e[I.tyre_compliance_pressure] < 2e6 and e[I.tyre_compliance_formula] > 0.5:
        pressed_tyre(e, radius, load, shape)
        theta_1 = reach * radius / shape[0]
    if e[I.elastic_rebound_formula] > 0.5:
        shape[2] = exit_share(e, theta_1, slip)
    if e[I.stress_peak_formula] > 0.5:
        shape[3] = peak_place(e, theta_1, load / mean_load, slip, motion)
    return theta_1


@njit(cache=True)
def steady_lag(motion, radius, circle, lag):
    """The four velocities times that in which the rim passes a radian of the contact. What turns too slowly is the
    wheel, however large the circle in its place."""
    time_per_angle = circle / (radius * bounded_rate(motion[3] / radius))
    for i in range(4):
        lag[i] = motion[i] * time_per_angle


@njit(cache=True)
def bulldozing(e, rank, theta_1, radius, motion, soil, out):
    """Wedges of soil beside and before the wheel, added to its forces (Hegedus' bulldozing resistance)."""
    lateral, frontal = e[I.bulldozing_lateral], e[I.bulldozing_frontal]
    if lateral <= 0.0 and frontal <= 0.0:
        return
    if e[I.bulldozing_formula] > 0.5:
        wedges(e, rank, theta_1, radius, motion, soil, out)
        return
    c, phi = soil[2], math.atan(soil[3])
    cot_x = 1.0 / math.tan(0.25 * math.pi - 0.5 * phi)
    d_1 = cot_x + math.tan(0.25 * math.pi + 0.5 * phi)
    d_2 = cot_x + cot_x * cot_x * math.tan(phi)
    heavy = 0.5 * d_2 * e[I.bulldozing_unit_weight]
    speed = math.sqrt(motion[0] ** 2 + motion[1] ** 2 + SLIP_SPEED**2)
    ahead = 1.0 if motion[0] >= 0.0 else -1.0
    cos_1 = math.cos(theta_1)
    side, moment = 0.0, 0.0
    steps = 16
    for i in range(steps + 1):  # Simpson
        weight = (1.0 if i == 0 or i == steps else (4.0 if i % 2 == 1 else 2.0)) * theta_1 / (3.0 * steps)
        theta = theta_1 * i / steps
        h = radius * (math.cos(theta) - cos_1)
        push = weight * d_1 * (c * h + heavy * h * h) * radius * math.cos(theta)
        side += push
        moment += push * radius * math.sin(theta) * ahead
    h = radius * (1.0 - cos_1)
    out[0] -= frontal * e[I.wheel_width] * d_1 * (c * h + heavy * h * h) * motion[0] / speed
    out[1] -= lateral * side * motion[1] / speed
    out[3] -= lateral * moment * motion[1] / speed


@njit(cache=True)
def plane_loads(xs, ys, weight, about_x, about_y, loads, active):
    """Loads u + v X + w Y with sum W = weight, sum Y W = about_x, sum X W = about_y; a lifted wheel carries nothing."""
    wheels = len(xs)
    active[:] = 1.0
    for _ in range(wheels):
        a = np.zeros((3, 3))
        for i in range(wheels):
            row = (1.0, xs[i], ys[i])
            for j in range(3):
                for m in range(3):
                    a[j, m] += active[i] * row[j] * row[m]
        a[0, 0] += 1e-9
        a[1, 1] += 1e-9
        a[2, 2] += 1e-9
        u = np.linalg.solve(a, np.array([weight, about_y, about_x]))
        lowest, at = 0.0, -1
        for i in range(wheels):
            loads[i] = active[i] * (u[0] + u[1] * xs[i] + u[2] * ys[i])
            if loads[i] < lowest:
                lowest, at = loads[i], i
        if at < 0:
            return
        active[at] = 0.0
