"""Accelerations of the vehicle: loads, entry angles and forces solved together, then (19) to (28)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .catalogue import I
from .contact import wheel_forces
from .formulas import dragged, place_in_line, rate_law, towed, wheel_extras
from .wheels import BOGGED, bulldozing, plane_loads, slips, steady_lag, wheel_motion, wheel_shape, wheel_soil
from .world import GRAVITY

HITCH_SPEED = 0.01  # m/s: below, dry friction fades
BALANCE = 1e-5  # of the mean wheel load
SWEEPS = 60

# what a solution begins with and leaves: per wheel its reach and the slope d log F_Z / d log reach; then a_X, a_Y
# details: per wheel F_X, F_Y, F_Z, sinkage, theta_1; then the accelerations at the reference point


@njit(cache=True)
def loaded_body(e, body):
    """Mass, height and place (from the reference point) of the centre of mass, and the inertia about it."""
    mass, extra = e[I.mass], e[I.payload_mass]
    total = mass + extra
    shift_x, shift_y = e[I.com_shift_ahead], e[I.com_shift_left]
    load_x, load_y = e[I.payload_ahead] - e[I.com_offset], e[I.payload_left]
    x = (mass * shift_x + extra * load_x) / total
    y = (mass * shift_y + extra * load_y) / total
    height = (mass * e[I.com_height] + extra * e[I.payload_height]) / total
    inertia = e[I.yaw_inertia] + mass * ((shift_x - x) ** 2 + (shift_y - y) ** 2)
    inertia += extra * ((load_x - x) ** 2 + (load_y - y) ** 2)
    body[0], body[1], body[2], body[3], body[4] = total, x, y, height, inertia


@njit(cache=True)
def outer_forces(e, time, pose, v, aux, wind, body, total):
    """Forces that do not come through the wheels: adds F_X, F_Y, M_Z, and the moments for the loads (X, then Y)."""
    mass, c_x, c_y, height = body[0], body[1], body[2], body[3]
    cos_p, sin_p = math.cos(pose[2]), math.sin(pose[2])

    q_e, q_n = math.tan(e[I.grade_slope_east]), math.tan(e[I.grade_slope_north])
    steep = math.sqrt(1.0 + q_e * q_e + q_n * q_n)
    total[0] -= mass * GRAVITY / steep * (q_e * cos_p + q_n * sin_p)
    total[1] -= mass * GRAVITY / steep * (-q_e * sin_p + q_n * cos_p)

    if e[I.drag_formula] > 0.5:
        dragged(e, v, body, total)
    else:  # at the centre of mass
        u_x, u_y = v[0] - v[2] * c_y, v[1] + v[2] * c_x
        speed = math.sqrt(u_x * u_x + u_y * u_y)
        total[0] -= e[I.drag_coefficient] * speed * u_x
        total[1] -= e[I.drag_coefficient] * speed * u_y

    if e[I.drawbar_formula] > 0.5:
        towed(e, v, body, total)
    elif e[I.drawbar_force] > 0.0:
        x_h = -e[I.drawbar_hitch_behind] - e[I.com_offset]
        h_y = v[1] + v[2] * x_h
        size = math.sqrt(v[0] * v[0] + h_y * h_y + HITCH_SPEED * HITCH_SPEED)
        f_x, f_y = -e[I.drawbar_force] * v[0] / size, -e[I.drawbar_force] * h_y / size
        total[0] += f_x
        total[1] += f_y
        total[2] += (x_h - c_x) * f_y + c_y * f_x
        total[3] += (e[I.drawbar_hitch_height] - height) * f_x
        total[4] += (e[I.drawbar_hitch_height] - height) * f_y

    if e[I.gusts_side] > 0.0:
        wind_x = wind[0] * cos_p + wind[1] * sin_p - v[0]
        wind_y = -wind[0] * sin_p + wind[1] * cos_p - v[1]
        f_x = e[I.gusts_front] * wind_x * abs(wind_x)
        f_y = e[I.gusts_side] * wind_y * abs(wind_y)
        total[0] += f_x
        total[1] += f_y
        total[2] += e[I.gusts_point_ahead] * f_y

    if e[I.rut_guidance_stiffness] > 0.0:
        n_e, n_n = -math.sin(e[I.rut_guidance_direction]), math.cos(e[I.rut_guidance_direction])
        off = pose[0] * n_e + pose[1] * n_n - e[I.rut_guidance_offset]
        pull = -e[I.rut_guidance_stiffness] * off * math.exp(-0.5 * (off / e[I.rut_guidance_width]) ** 2)
        total[0] += pull * (n_e * cos_p + n_n * sin_p)
        total[1] += pull * (-n_e * sin_p + n_n * cos_p)

    if e[I.tether_tension] > 0.0 or e[I.tether_growth] > 0.0:
        d_e, d_n = e[I.tether_anchor_x] - pose[0], e[I.tether_anchor_y] - pose[1]
        far = math.sqrt(d_e * d_e + d_n * d_n + 0.01)
        pull = (e[I.tether_tension] + e[I.tether_growth] * far) / far
        total[0] += pull * (d_e * cos_p + d_n * sin_p)
        total[1] += pull * (-d_e * sin_p + d_n * cos_p)

    if e[I.slosh_share] > 0.0:  # aux 0..3: place and speed of the moving load
        m_s, f = e[I.slosh_share] * e[I.mass], e[I.slosh_frequency]
        for i in range(2):
            back = f * f * aux[i] + 2.0 * e[I.slosh_damping] * f * aux[2 + i]
            total[i] += m_s * (back + aux[5 + i])
            total[3 + i] += m_s * GRAVITY * aux[i]

    if e[I.trailer_resistance] > 0.0 or e[I.trailer_mass] > 0.0:  # aux 4: its heading
        angle = aux[4] - pose[2]
        x_h = -e[I.trailer_hitch] - e[I.com_offset]
        t_x, t_y = math.cos(angle), math.sin(angle)
        ahead = v[0] * t_x + (v[1] + v[2] * x_h) * t_y
        a_t = aux[5] * t_x + (aux[6] + aux[7] * x_h) * t_y
        pull = e[I.trailer_resistance] * ahead / math.sqrt(ahead * ahead + HITCH_SPEED**2) + e[I.trailer_mass] * a_t
        total[0] -= pull * t_x
        total[1] -= pull * t_y
        total[2] += -(x_h - c_x) * pull * t_y - c_y * pull * t_x


@njit(cache=True)
def accelerations(e, time, distance, pose, v, omega_left, omega_right, aux, lags, ruts, wind, table, start, details):
    """Fills details; returns whether loads and entry angles were found."""
    wheels = 2 * int(e[I.rows])
    body = np.empty(5)
    loaded_body(e, body)
    mass, c_x, c_y, height, inertia = body[0], body[1], body[2], body[3], body[4]
    outer = np.zeros(5)
    outer_forces(e, time, pose, v, aux, wind, body, outer)
    q2 = math.tan(e[I.grade_slope_east]) ** 2 + math.tan(e[I.grade_slope_north]) ** 2
    weight = mass * GRAVITY / math.sqrt(1.0 + q2)
    mean = weight / wheels

    xs, ys = np.empty(wheels), np.empty(wheels)  # from the centre of mass
    loads, active = np.empty(wheels), np.empty(wheels)
    motions, radii = np.empty((wheels, 4)), np.empty(wheels)
    cos_p, sin_p = math.cos(pose[2]), math.sin(pose[2])
    for i in range(wheels):
        left = i % 2 == 0
        x_ref = e[I.row0 + i // 2] - e[I.com_offset]
        y_ref = e[I.half_track] if left else -e[I.half_track]
        radii[i] = e[I.wheel_radius] * (e[I.wheel_radius_left] if left else e[I.wheel_radius_right])
        omega = omega_left if left else omega_right
        if i >= wheels - 2 and (e[I.sticky_brake_side] > 0.0) == left:
            omega *= 1.0 - e[I.sticky_brake_loss] * wind[2]
        wheel_motion(x_ref, y_ref, v, omega, radii[i], motions[i])
        xs[i], ys[i] = x_ref - c_x, y_ref - c_y

    soil, shape, lag, force, scratch = np.empty(12), np.empty(4), np.empty(4), np.empty(5), np.empty(16)
    last_log, last_force = np.zeros(wheels), np.zeros(wheels)
    a_x, a_y = start[2 * wheels], start[2 * wheels + 1]
    contact_x, contact_y, moment = 0.0, 0.0, 0.0
    settled = False
    for sweep in range(SWEEPS):
        if not (math.isfinite(a_x) and math.isfinite(a_y)):
            start[2 * wheels], start[2 * wheels + 1] = 0.0, 0.0
            return False
        # a_x, a_y are the contact's forces over the mass: they act at the ground, the centre of mass is above it
        plane_loads(xs, ys, weight, -height * mass * a_y + outer[4], -height * mass * a_x + outer[3], loads, active)
        contact_x, contact_y, moment = 0.0, 0.0, 0.0
        worst = 0.0
        for i in range(wheels):
            x_ref, y_ref = xs[i] + c_x, ys[i] + c_y
            load = loads[i]
            if e[I.wheel_hop_amplitude] > 0.0:
                rate = 2.0 * math.pi * abs(motions[i, 0]) / e[I.wheel_hop_wavelength] / e[I.wheel_hop_resonance]
                gain = rate * rate / math.sqrt((1.0 - rate * rate) ** 2 + (0.5 * rate) ** 2)
                phase = 2.0 * math.pi * (distance + x_ref) / e[I.wheel_hop_wavelength] + (0.9 if y_ref > 0 else 0.0)
                load *= 1.0 + min(0.5 * e[I.wheel_hop_amplitude] * gain, 0.9) * math.sin(phase)
            if load <= 1e-6 * mean:
                details[5 * i : 5 * i + 5] = 0.0
                continue
            east = pose[0] + x_ref * cos_p - y_ref * sin_p
            north = pose[1] + x_ref * sin_p + y_ref * cos_p
            rank = place_in_line(e, i, motions[i, 0])
            wheel_soil(e, i % 2 == 0, rank, east, north, pose, time, distance, load, mean, motions[i], ruts[i], soil)
            if sweep == 0 and not 1e-9 < start[i] < BOGGED:
                depth = (3.0 * load / ((3.0 - soil[1]) * soil[0] * e[I.wheel_width] * math.sqrt(2.0 * radii[i])))
                depth = depth ** (2.0 / (2.0 * soil[1] + 1.0))
                start[i] = math.acos(1.0 - min(depth / radii[i], 0.9))
                start[wheels + i] = 2.0 * soil[1] + 1.0
            theta_1 = wheel_shape(e, radii[i], start[i], load, mean, soil, motions[i], table, shape)
            if e[I.transient_shear_relaxation] > 0.0:
                for j in range(4):
                    lag[j] = lags[i, j]
                if e[I.transient_shear_formula] > 2.5:
                    along = lag[1], lag[2]
                    steady_lag(motions[i], radii[i], shape[0], lag)
                    lag[1], lag[2] = along
            else:
                steady_lag(motions[i], radii[i], shape[0], lag)
            wheel_forces(theta_1, motions[i], lag, soil, shape, table, force, scratch)
            f_z = force[2]
            details[5 * i + 3] = soil[5] + shape[0] * (1.0 - math.cos(theta_1))
            details[5 * i + 4] = theta_1
            bulldozing(e, rank, theta_1, radii[i], motions[i], soil, force)
            share = 1.0 / wheels
            if e[I.rate_dependent_soil_formula] > 0.5:
                formula, p = e[I.rate_dependent_soil_formula], load / mean
                force[0] -= e[I.rate_dependent_soil_forward] * rate_law(formula, motions[i, 0], p) * share
                force[1] -= e[I.rate_dependent_soil_lateral] * rate_law(formula, motions[i, 1], p) * share
            else:
                force[0] -= e[I.rate_dependent_soil_forward] * motions[i, 0] * share
                force[1] -= e[I.rate_dependent_soil_lateral] * motions[i, 1] * share
            slip, _ = slips(motions[i])
            wheel_extras(e, rank, load, radii[i], motions[i], slip, force)
            details[5 * i], details[5 * i + 1], details[5 * i + 2] = force[0], force[1], f_z
            # forces go about with the load: taken at the load that is wanted, not at the one found so far
            near = load / f_z if 0.8 * load < f_z < 1.25 * load else 1.0
            contact_x += near * force[0]
            contact_y += near * force[1]
            moment += near * (force[3] + xs[i] * force[1] - ys[i] * force[0])
            worst = max(worst, abs(f_z - load) / mean)

            # F_Z grows about as a power of the reach; the exponent follows from the last two sweeps
            log = math.log(start[i])
            if f_z > 0.05 * load:
                log_force = math.log(f_z)
                if last_force[i] != 0.0 and abs(log - last_log[i]) > 1e-4:
                    slope = (log_force - last_force[i]) / (log - last_log[i])
                    start[wheels + i] = min(max(slope, 0.6), 6.0)
                last_log[i], last_force[i] = log, log_force
                step = (math.log(load) - log_force) / start[wheels + i]
            else:
                step, last_force[i] = 0.4, 0.0
            start[i] *= math.exp(min(max(step, -0.7), 0.5))
            if not start[i] < BOGGED:
                return False
        change = abs(contact_x / mass - a_x) + abs(contact_y / mass - a_y)
        a_x, a_y = contact_x / mass, contact_y / mass
        if worst < BALANCE and change < 10.0 * BALANCE * GRAVITY:
            settled = True
            break
        if sweep > 20:  # a wheel that lifts and sets down again: halve the steps
            a_x, a_y = 0.5 * (a_x + start[2 * wheels]), 0.5 * (a_y + start[2 * wheels + 1])
        start[2 * wheels], start[2 * wheels + 1] = a_x, a_y
    start[2 * wheels], start[2 * wheels + 1] = a_x, a_y
    spin = (moment + outer[2]) / inertia
    at = 5 * wheels
    com_x, com_y = (contact_x + outer[0]) / mass, (contact_y + outer[1]) / mass
    # from the centre of mass to the reference point
    details[at] = com_x + spin * c_y + v[2] * v[2] * c_x
    details[at + 1] = com_y - spin * c_x + v[2] * v[2] * c_y
    details[at + 2] = spin
    return (settled or worst < 1e-3) and math.isfinite(com_x + com_y + spin)
