"""Stepping: RODAS3 for the velocities, what effects remember in between them (Strang splitting).

RODAS3 (Sandu et al., Atmos. Environ. 31, 1997): linearly implicit, order 3, stiffly accurate, L-stable.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .body import accelerations
from .catalogue import I
from .contact import bounded_rate
from .formulas import relax

# layout of the state vector
POSE, VELOCITY, DISTANCE, AUX, LAGS = 0, 3, 6, 7, 15
MET = LAGS + 32  # depth of the rut that each wheel runs in
MARKED = MET + 8  # marks that each wheel has left
STATE = MARKED + 8
MARK = 0.02  # m that a wheel goes from one mark of its track to the next
MARKS = 512  # of each wheel are remembered
REACH = 1.0 / 3.0  # radii ahead of its axle where a wheel meets the soil, and over which it then works under it


@njit(cache=True)
def effective(p, off, window_of, windows, time, x, y, e):
    """The parameters that hold at a time and place: outside its window an effect is off."""
    e[:] = p
    for i in range(len(windows)):
        kind, a, b, c = windows[i, 0], windows[i, 1], windows[i, 2], windows[i, 3]
        if kind < 1.5:
            inside = a <= time < b
        else:
            inside = (x - a) ** 2 + (y - b) ** 2 <= c * c
        if not inside:
            for j in range(len(p)):
                if window_of[j] == i:
                    e[j] = off[j]


@njit(cache=True)
def read_series(series, step, time, out):
    """Linear in between."""
    u = min(max(time / step, 0.0), len(series) - 1.001)
    i = int(u)
    for j in range(series.shape[1]):
        out[j] = series[i, j] + (u - i) * (series[i + 1, j] - series[i, j])


@njit(cache=True)
def wheel_place(e, state, i):
    """East and north of a wheel's centre."""
    ahead = e[I.row0 + i // 2] - e[I.com_offset]
    left = e[I.half_track] if i % 2 == 0 else -e[I.half_track]
    c, s = math.cos(state[POSE + 2]), math.sin(state[POSE + 2])
    return state[POSE] + ahead * c - left * s, state[POSE + 1] + ahead * s + left * c


@njit(cache=True)
def arriving(e, state, tracks, details, ruts):
    """Depth of the rut before each wheel: of every track that lies across its way what overlaps with the wheel's own.

    tracks[wheel, mark]: east, north and sinkage of the wheel there, in a ring; the wheel itself stands at the end.
    """
    wheels = 2 * int(e[I.rows])
    c, s = math.cos(state[POSE + 2]), math.sin(state[POSE + 2])
    reach = REACH * e[I.wheel_radius]
    for i in range(wheels):
        left = e[I.half_track] if i % 2 == 0 else -e[I.half_track]
        way = 1.0 if state[VELOCITY] >= state[VELOCITY + 2] * left else -1.0
        east, north = wheel_place(e, state, i)
        east, north = east + way * reach * c, north + way * reach * s
        ruts[i] = 0.0
        for j in range(wheels):
            e_0, n_0 = wheel_place(e, state, j)
            depth_0 = details[5 * j + 3]
            a_0 = (e_0 - east) * c + (n_0 - north) * s
            marked = int(state[MARKED + j])
            for back in range(min(marked, MARKS)):
                mark = (marked - 1 - back) % MARKS
                e_1, n_1, depth_1 = tracks[j, mark, 0], tracks[j, mark, 1], tracks[j, mark, 2]
                a_1 = (e_1 - east) * c + (n_1 - north) * s
                if (a_0 > 0.0) != (a_1 > 0.0):
                    w = a_0 / (a_0 - a_1)
                    aside = (n_0 + w * (n_1 - n_0) - north) * c - (e_0 + w * (e_1 - e_0) - east) * s
                    met = (depth_0 + w * (depth_1 - depth_0)) / (1.0 + (aside / e[I.wheel_width]) ** 2)
                    ruts[i] = max(ruts[i], met)
                e_0, n_0, depth_0, a_0 = e_1, n_1, depth_1, a_1


@njit(cache=True)
def run_in(e, state, tracks, details, ruts, h):
    """Advance by h how deep a rut each wheel runs in: what it meets passes under it."""
    arriving(e, state, tracks, details, ruts)
    for i in range(2 * int(e[I.rows])):
        ahead = e[I.row0 + i // 2] - e[I.com_offset]
        left = e[I.half_track] if i % 2 == 0 else -e[I.half_track]
        yaw = state[VELOCITY + 2]
        speed = math.hypot(state[VELOCITY] - yaw * left, state[VELOCITY + 1] + yaw * ahead)
        keep = math.exp(-speed * h / (REACH * e[I.wheel_radius]))
        ruts[i] = keep * state[MET + i] + (1.0 - keep) * ruts[i]
        state[MET + i] = ruts[i]


@njit(cache=True)
def leave_marks(e, state, tracks, details):
    """A mark of each wheel that has gone far enough since its last one."""
    for i in range(2 * int(e[I.rows])):
        east, north = wheel_place(e, state, i)
        marked = int(state[MARKED + i])
        last = (marked - 1) % MARKS
        if marked == 0 or math.hypot(east - tracks[i, last, 0], north - tracks[i, last, 1]) >= MARK:
            tracks[i, marked % MARKS] = east, north, details[5 * i + 3]
            state[MARKED + i] = marked + 1


@njit(cache=True)
def remember(e, state, omega_left, omega_right, details, h):
    """Advance by h what effects remember, with the velocities held: shear, moving load, trailer."""
    wheels = 2 * int(e[I.rows])
    v_x, v_y, yaw = state[VELOCITY], state[VELOCITY + 1], state[VELOCITY + 2]
    if e[I.transient_shear_relaxation] > 0.0:
        for i in range(wheels):
            left = i % 2 == 0
            omega = omega_left if left else omega_right
            y = e[I.half_track] if left else -e[I.half_track]
            r = e[I.wheel_radius] * (e[I.wheel_radius_left] if left else e[I.wheel_radius_right])
            x = e[I.row0 + i // 2] - e[I.com_offset]
            if e[I.transient_shear_formula] > 0.5:
                motion = (v_x - yaw * y, v_y + yaw * x, yaw, r * omega)
                relax(e, r, motion, omega, bounded_rate(omega), h, state[LAGS + 4 * i : LAGS + 4 * i + 4])
                continue
            angle = details[5 * i + 4] * (1.0 + e[I.elastic_rebound_share])
            gain = 2.0 / (e[I.transient_shear_relaxation] * max(angle, 1e-3))
            rate = gain * abs(omega)
            keep = math.exp(-rate * h)
            fill = gain * ((1.0 - keep) / rate if rate > 1e-9 else h)
            target = (v_x - yaw * y, v_y + yaw * x, yaw, r * omega)
            for j in range(4):
                at = LAGS + 4 * i + j
                state[at] = keep * state[at] + fill * target[j]
    if e[I.slosh_share] > 0.0:
        f, damping = e[I.slosh_frequency], e[I.slosh_damping]
        for i in range(2):
            pull = -f * f * state[AUX + i] - 2.0 * damping * f * state[AUX + 2 + i] - state[AUX + 5 + i]
            state[AUX + 2 + i] += h * pull
            state[AUX + i] += h * state[AUX + 2 + i]
    if e[I.trailer_resistance] > 0.0 or e[I.trailer_mass] > 0.0:
        x_h = -e[I.trailer_hitch] - e[I.com_offset]
        angle = state[AUX + 4] - state[POSE + 2]
        across = -v_x * math.sin(angle) + (v_y + yaw * x_h) * math.cos(angle)
        state[AUX + 4] += h * across / e[I.trailer_length]


@njit(cache=True)
def derivative(world, time, ahead, state, v, ruts, start, e, details, f):
    """dV/dt at `time`, `ahead` after the state's: the pose is carried on with the state's own velocities."""
    pose = np.empty(3)
    psi = state[POSE + 2] + 0.5 * ahead * state[VELOCITY + 2]
    c, s = math.cos(psi), math.sin(psi)
    pose[0] = state[POSE] + ahead * (state[VELOCITY] * c - state[VELOCITY + 1] * s)
    pose[1] = state[POSE + 1] + ahead * (state[VELOCITY] * s + state[VELOCITY + 1] * c)
    pose[2] = state[POSE + 2] + ahead * state[VELOCITY + 2]
    distance = state[DISTANCE] + ahead * abs(state[VELOCITY])
    omega, wind = np.empty(2), np.empty(world.series.shape[1])
    read_series(world.drive, world.steps[0], time, omega)
    read_series(world.series, world.steps[1], time, wind)
    effective(world.p, world.off, world.window_of, world.windows, time, pose[0], pose[1], e)
    wheels = 2 * int(e[I.rows])
    lags = state[LAGS : LAGS + 4 * wheels].reshape((wheels, 4))
    fine = accelerations(e, time, distance, pose, v, omega[0], omega[1], state[AUX : AUX + 8], lags, ruts, wind,
                         world.table, start, details)
    at = 5 * wheels  # the body turns: dV/dt is not the acceleration
    details[at] += v[1] * v[2]
    details[at + 1] -= v[0] * v[2]
    f[:] = details[at : at + 3]
    return fine


@njit(cache=True)
def velocity_step(world, time, h, state, ruts, start, e, details, result, error):
    """One step of RODAS3 for the three velocities; `details` are those of the beginning."""
    v = state[VELOCITY : VELOCITY + 3].copy()
    f, other, slope = np.empty(3), np.empty(3), np.empty(3)
    trial, spare = start.copy(), details.copy()
    if not derivative(world, time, 0.0, state, v, ruts, start, e, details, f):
        return False
    jacobian = np.empty((3, 3))
    for j in range(3):
        delta = 1e-4 if v[j] < 0.0 else -1e-4
        moved = v.copy()
        moved[j] += delta
        trial[:] = start
        if not derivative(world, time, 0.0, state, moved, ruts, trial, e, spare, other):
            return False
        jacobian[:, j] = (other - f) / delta
    delta = min(1e-3, 0.5 * h)
    trial[:] = start
    if not derivative(world, time + delta, delta, state, v, ruts, trial, e, spare, other):
        return False
    slope[:] = (other - f) / delta
    system = np.eye(3) * (2.0 / h) - jacobian
    k_1 = np.linalg.solve(system, f + 0.5 * h * slope)
    k_2 = np.linalg.solve(system, f + 4.0 / h * k_1 + 1.5 * h * slope)
    trial[:] = start
    if not derivative(world, time + h, h, state, v + 2.0 * k_1, ruts, trial, e, spare, other):
        return False
    k_3 = np.linalg.solve(system, other + (k_1 - k_2) / h)
    if not derivative(world, time + h, h, state, v + 2.0 * k_1 + k_3, ruts, trial, e, spare, other):
        return False
    k_4 = np.linalg.solve(system, other + (k_1 - k_2 - 8.0 / 3.0 * k_3) / h)
    result[:] = v + 2.0 * k_1 + k_3 + k_4
    error[:] = k_4
    return True


@njit(cache=True)
def advance_pose(state, h, new, rate):
    """Pose by Simpson's rule on the velocities: the parabola through both ends that begins with the slope `rate`."""
    v = state[VELOCITY : VELOCITY + 3]
    middle = 0.75 * v + 0.25 * new + 0.25 * h * rate
    psi = state[POSE + 2]
    psi_middle = psi + h * (5.0 * v[2] + 8.0 * middle[2] - new[2]) / 24.0
    psi_end = psi + h * (v[2] + 4.0 * middle[2] + new[2]) / 6.0
    x, y = 0.0, 0.0
    for part in range(3):
        at = psi if part == 0 else (psi_middle if part == 1 else psi_end)
        w_x = v[0] if part == 0 else (middle[0] if part == 1 else new[0])
        w_y = v[1] if part == 0 else (middle[1] if part == 1 else new[1])
        weight = 4.0 if part == 1 else 1.0
        x += weight * (w_x * math.cos(at) - w_y * math.sin(at))
        y += weight * (w_x * math.sin(at) + w_y * math.cos(at))
    state[POSE] += h * x / 6.0
    state[POSE + 1] += h * y / 6.0
    state[POSE + 2] = psi_end


@njit(cache=True)
def run(world, time, count, step, state, tracks, start, tolerance, records):
    """Advance by count steps of a fixed length, each as finely as the tolerance wants.

    records[i]: pose, velocities, their rates at time + i step. Returns how many were reached.
    """
    wheels = 2 * int(world.p[I.rows])
    e, details = np.empty(len(world.p)), np.zeros(5 * wheels + 3)
    ruts, new, error, f = np.zeros(wheels), np.empty(3), np.empty(3), np.empty(3)
    omega = np.empty(2)
    remembered = world.p[I.multipass_memory] > 0.0 and world.p[I.multipass_formula] < 0.5
    h = 0.2 * step
    for i in range(count + 1):
        begin = time + i * step
        effective(world.p, world.off, world.window_of, world.windows, begin, state[POSE], state[POSE + 1], e)
        ruts[:] = state[MET : MET + wheels]
        trial = start.copy()
        if not derivative(world, begin, 0.0, state, state[VELOCITY : VELOCITY + 3].copy(), ruts, trial, e, details, f):
            return i
        records[i, 0:6] = state[0:6]
        records[i, 6:9] = f
        if i == count:
            break
        gone = 0.0
        while gone < step * (1.0 - 1e-9):
            h = min(h, step - gone)
            kept = state.copy()
            now = begin + gone
            read_series(world.drive, world.steps[0], now, omega)
            remember(e, state, omega[0], omega[1], details, 0.5 * h)
            if remembered:
                run_in(e, state, tracks, details, ruts, 0.5 * h)
            fine = velocity_step(world, now, h, state, ruts, start, e, details, new, error)
            worst = 100.0
            if fine:
                worst = 0.0
                for j in range(3):
                    worst = max(worst, abs(error[j]) / (tolerance * (1.0 + abs(new[j]))))
            if not worst <= 1.0:
                state[:] = kept
                if not fine:
                    start[:wheels] = 0.0  # look for the entry angles from afresh
                if h < 1e-6:
                    return i
                h *= max(0.2, 0.8 * worst ** (-1.0 / 3.0)) if worst < 100.0 else 0.2
                continue
            at = 5 * wheels
            state[DISTANCE] += 0.5 * h * (abs(state[VELOCITY]) + abs(new[0]))
            advance_pose(state, h, new, details[at : at + 3])
            state[VELOCITY : VELOCITY + 3] = new
            state[AUX + 5] = details[at] - new[1] * new[2]
            state[AUX + 6] = details[at + 1] + new[0] * new[2]
            state[AUX + 7] = details[at + 2]
            read_series(world.drive, world.steps[0], now + h, omega)
            remember(e, state, omega[0], omega[1], details, 0.5 * h)
            leave_marks(e, state, tracks, details)
            if remembered:
                run_in(e, state, tracks, details, ruts, 0.5 * h)
            gone += h
            h *= min(3.0, max(0.3, 0.8 * max(worst, 1e-6) ** (-1.0 / 3.0)))
    return count + 1
