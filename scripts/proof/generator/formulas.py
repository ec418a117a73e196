"""The same mechanisms by other formulas than the catalogue's: what `formula` 1 and more of an effect do (catalogue.FORMULAS)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .catalogue import I
from .contact import BLEND_SPEED, SLIP_SPEED, smooth_step

FADE = 0.05  # m/s: below, a resistance that does not know the speed fades
SMALL = 0.02  # m/s: below, a power of the speed becomes a line
PEAKS = (0.1, 0.9)  # bounds of the stress peak's place


@njit(cache=True)
def place_in_line(e, i, v_x):
    """How many rows lead the wheel's: 0 for the first of the way it goes."""
    row, last = i // 2, int(e[I.rows]) - 1
    ahead = smooth_step(v_x / BLEND_SPEED)
    return ahead * row + (1.0 - ahead) * (last - row)


@njit(cache=True)
def signed_slip(motion):
    """(r omega - V_X) / max(|r omega|, |V_X|), with the sign of driving, within -1 and 1."""
    slip = (motion[3] - motion[0]) / max(abs(motion[3]), abs(motion[0]), SLIP_SPEED)
    return min(max(slip if motion[3] + motion[0] >= 0.0 else -slip, -1.0), 1.0)


@njit(cache=True)
def changed_soil(e, u, u_body, soil):
    """`terrain_change`: k, n, c, tan phi, K at u, of the wheel, or of the vehicle where it changes as a whole."""
    formula, half = e[I.terrain_change_formula], e[I.terrain_change_transition]
    stiffness, friction = e[I.terrain_change_stiffness_factor], e[I.terrain_change_friction_factor]
    cohesion, modulus = e[I.terrain_change_cohesion_factor], e[I.terrain_change_shear_modulus_factor]
    position = e[I.terrain_change_position]
    if formula < 1.5:
        w = min(max(0.5 + (u - position) / (6.0 * half), 0.0), 1.0)
        soil[0] *= 1.0 + (stiffness - 1.0) * w
        soil[2] *= 1.0 + (cohesion - 1.0) * w
        soil[3] *= 1.0 + (friction - 1.0) * w
        soil[4] *= 1.0 + (modulus - 1.0) * w
    elif formula < 2.5:
        w = 1.0 - math.exp(-max(u_body - position, 0.0) / (2.0 * half))
        soil[0] *= stiffness**w
        soil[2] *= cohesion**w
        soil[3] *= friction**w
        soil[4] *= modulus**w
    else:
        w = smooth_step((u - position) / half)
        soil[1] *= stiffness ** (-0.35 * w)
        soil[3] *= friction**w
        soil[4] *= modulus**w


@njit(cache=True)
def soil_of_side(e, left, soil):
    """`left_right_soil`: k, c, tan phi, K of a side."""
    formula, ratio = e[I.left_right_soil_formula], e[I.left_right_soil_ratio]
    if formula < 1.5:
        weaker = (ratio > 1.0) != left
        share = min(ratio, 1.0 / ratio) if weaker else 1.0
        soil[0], soil[2], soil[3] = soil[0] * share, soil[2] * share, soil[3] * share
    elif formula < 2.5:
        side = ratio if left else 1.0 / ratio
        soil[0], soil[4] = soil[0] * side, soil[4] / math.sqrt(side)
    else:
        side = ratio**0.7 if left else ratio**-0.7
        soil[2], soil[3] = soil[2] * side, soil[3] * side


@njit(cache=True)
def sheared_soil(e, rank, motion, soil):
    """`shear_anisotropy`: c, tan phi, K, and the two ratios of a wheel (soil[8], soil[9])."""
    formula = e[I.shear_anisotropy_formula]
    modulus, strength = e[I.shear_anisotropy_modulus_ratio], e[I.shear_anisotropy_strength_ratio]
    share = 1.0
    if formula < 1.5:
        share = 2.0 * abs(motion[1]) / math.sqrt(motion[0] ** 2 + motion[1] ** 2 + SLIP_SPEED**2)
    elif formula < 2.5:
        share = 1.0 - 0.7 * min(rank, 1.0)
    else:
        soil[2], soil[3] = soil[2] / math.sqrt(strength), soil[3] / math.sqrt(strength)
        soil[4] /= math.sqrt(modulus)
    soil[8] = max(1.0 + (modulus - 1.0) * share, 0.2)
    soil[9] = max(1.0 + (strength - 1.0) * share, 0.2)


@njit(cache=True)
def passed_soil(e, rank, soil):
    """`multipass`: k, c, K of soil that other rows have passed."""
    formula, memory = e[I.multipass_formula], e[I.multipass_memory]
    if 1.5 < formula < 2.5:
        soil[0] *= 1.0 + 3.0 * memory * (1.0 - math.exp(-rank))
    elif formula > 2.5:
        soil[2] *= 1.0 + 0.5 * memory * rank
        soil[4] /= 1.0 + 0.5 * memory * rank


@njit(cache=True)
def exit_share(e, theta_1, slip):
    """`elastic_rebound`: exit angle over entry angle."""
    formula, share = e[I.elastic_rebound_formula], e[I.elastic_rebound_share]
    if formula < 1.5:
        return min(1.4 * share * math.exp(-5.0 * slip), 1.0)
    if formula < 2.5:
        return min(0.3 * share / max(theta_1, 1e-3), 1.0)
    return 0.0


@njit(cache=True)
def peak_place(e, theta_1, p, slip, motion):
    """`stress_peak`: place of the greatest stress between exit and entry."""
    formula, shift, growth = e[I.stress_peak_formula], e[I.stress_peak_a0] - 0.5, e[I.stress_peak_a1]
    if formula < 1.5:
        place = 0.5 + shift * p + growth * slip * slip
    elif formula < 2.5:
        place = 0.5 + shift * (1.0 - slip) + 0.5 * growth * math.tanh(3.0 * slip)
    else:
        place = 0.5 + shift * math.sqrt(theta_1 / 0.4) + growth * signed_slip(motion)
    return min(max(place, PEAKS[0]), PEAKS[1])


@njit(cache=True)
def pressed_tyre(e, radius, load, shape):
    """`tyre_compliance`: fills in radius and width of a tyre under a load."""
    formula = e[I.tyre_compliance_formula]
    flat = load / (e[I.wheel_width] * radius * e[I.tyre_compliance_pressure])
    shape[1] = e[I.wheel_width]
    if formula < 1.5:
        shape[0] = radius * (1.0 + 2.0 * flat)
    elif formula < 2.5:
        shape[0] = radius * (1.0 + flat)
        shape[1] *= 1.0 + 0.5 * flat
    else:
        shape[0] = radius * (1.0 + 0.5 * flat)


@njit(cache=True)
def rate_law(formula, v, p):
    """`rate_dependent_soil`: the speed that the coefficient is multiplied by."""
    if formula < 1.5:
        return v / (v * v + SMALL * SMALL) ** 0.2
    if formula < 2.5:
        return math.copysign(0.3 * math.log(1.0 + abs(v) / 0.1), v)
    return p * v * abs(v) ** 0.3


@njit(cache=True)
def wedges(e, rank, theta_1, radius, motion, soil, out):
    """`bulldozing`: adds to F_X, F_Y and the moment about the wheel's centre."""
    formula, lateral, frontal = e[I.bulldozing_formula], e[I.bulldozing_lateral], e[I.bulldozing_frontal]
    depth, chord = radius * (1.0 - math.cos(theta_1)), radius * math.sin(theta_1)
    root = math.tan(0.25 * math.pi + 0.5 * math.atan(soil[3]))
    passive = 0.5 * e[I.bulldozing_unit_weight] * depth * depth * root * root + 2.0 * soil[2] * depth * root
    speed = math.sqrt(motion[0] ** 2 + motion[1] ** 2 + SLIP_SPEED**2)
    along, across = motion[0] / speed, motion[1] / speed
    if formula < 1.5:
        front = passive * e[I.wheel_width] * math.tanh(motion[0] / FADE)
        side = passive * chord * math.tanh(motion[1] / FADE)
    elif formula < 2.5:
        push = 0.7 * max(out[2], 0.0) * (depth / radius) ** 0.8
        front, side = push * along, push * across
    else:
        share = 1.0 - 0.6 * min(rank, 1.0)
        front = share * passive * e[I.wheel_width] * along * abs(along)
        side = 2.0 * share * passive * chord * across * abs(across)
    out[0] -= frontal * front
    out[1] -= lateral * side
    out[3] -= lateral * side * 0.4 * chord * (2.0 * smooth_step(motion[0] / BLEND_SPEED) - 1.0)


@njit(cache=True)
def wheel_extras(e, rank, load, radius, motion, slip, out):
    """Forces along the wheel of those formulas that act on its resistance out[4] or its tyre: adds to F_X."""
    if e[I.slip_sinkage_formula] > 2.5:
        out[0] -= (e[I.slip_sinkage_sinkage_growth] + e[I.slip_sinkage_exponent_growth]) * slip * out[4]
    if 0.5 < e[I.multipass_formula] < 1.5:
        out[0] += (1.0 - math.exp(-e[I.multipass_memory] * rank)) * out[4]
    if e[I.elastic_rebound_formula] > 2.5:
        out[0] += e[I.elastic_rebound_share] * out[4]
    if e[I.tyre_compliance_formula] > 2.5 and e[I.tyre_compliance_pressure] < 2e6:
        flat = load / (e[I.wheel_width] * radius * e[I.tyre_compliance_pressure])
        out[0] -= 0.05 * load * math.sqrt(flat) * math.tanh(motion[0] / FADE)


@njit(cache=True)
def dragged(e, v, body, total):
    """`drag`: adds F_X, F_Y, M_Z."""
    formula, k, c_x, c_y = e[I.drag_formula], e[I.drag_coefficient], body[1], body[2]
    u_x, u_y = v[0] - v[2] * c_y, v[1] + v[2] * c_x
    if formula < 1.5:
        root = (u_x * u_x + u_y * u_y + SMALL * SMALL) ** 0.25
        total[0] -= k * root * u_x
        total[1] -= k * root * u_y
    elif formula < 2.5:
        total[0] -= k * u_x * (0.6 + 0.5 * abs(u_x))
    else:
        middle = -e[I.com_offset]
        u_m = v[1] + v[2] * middle
        f_y = -2.5 * k * u_m * abs(u_m)
        total[0] -= k * u_x * abs(u_x)
        total[1] += f_y
        total[2] += (middle - c_x) * f_y


@njit(cache=True)
def towed(e, v, body, total):
    """`drawbar`: adds F_X, F_Y, M_Z, and the moments for the loads (X, then Y)."""
    formula, force, c_x, c_y, height = e[I.drawbar_formula], e[I.drawbar_force], body[1], body[2], body[3]
    if formula < 1.5:
        total[0] -= force * math.tanh((v[0] - v[2] * c_y) / FADE)
        return
    x_h = -e[I.drawbar_hitch_behind] - e[I.com_offset]
    h_y = v[1] + v[2] * x_h
    speed = math.sqrt(v[0] * v[0] + h_y * h_y + SMALL * SMALL)
    size = force * speed**0.4
    if formula > 2.5:
        size = force * (0.6 + 0.6 * math.exp(-((speed / 0.3) ** 2)) + 0.25 * speed)
    f_x, f_y = -size * v[0] / speed, -size * h_y / speed
    total[0] += f_x
    total[1] += f_y
    total[2] += (x_h - c_x) * f_y + c_y * f_x
    total[3] += (e[I.drawbar_hitch_height] - height) * f_x
    total[4] += (e[I.drawbar_hitch_height] - height) * f_y


@njit(cache=True)
def relax(e, radius, motion, omega, bounded, h, lag):
    """`transient_shear`: advances by h the velocities over |omega| that the shear remembers."""
    formula, relaxation = e[I.transient_shear_formula], e[I.transient_shear_relaxation]
    rate = 4.0 / relaxation
    if formula < 1.5:
        rate = abs(omega) / (0.4 * relaxation)
    elif formula > 2.5:
        rate = abs(omega) / (0.8 * relaxation)
    keep = math.exp(-rate * h)
    for j in range(4):
        steady = motion[j] / bounded
        held = formula > 2.5 and (j == 0 or j == 3)
        lag[j] = steady if held else keep * lag[j] + (1.0 - keep) * steady
