"""The contact of one wheel: equations (2) to (18) by Gauss-Legendre on panels that end where the integrand breaks."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

SLIP_SPEED = 1e-3  # m/s: below, the direction of the shear stress fades
OMEGA_MIN = 0.05  # rad/s: bounds the contact time
BLEND_SPEED = 0.01  # m/s: below, the leading side passes from front to rear


def rule(theta_nodes: int, width_nodes: int) -> np.ndarray:
    """Nodes and weights: rows u, w along a panel 0..1, and y / b, w across the width; counts in the last column.

    Along a panel Gauss-Legendre in t, u = 10 t^3 - 15 t^4 + 6 t^5: the nodes gather at both ends, which takes the
    singularity of z^n where the stress begins, and lets panels shrink to nothing without a jump of the sum.
    """
    t, w = np.polynomial.legendre.leggauss(theta_nodes)
    t, w = (t + 1.0) / 2.0, w / 2.0
    y, v = np.polynomial.legendre.leggauss(width_nodes)
    table = np.zeros((4, max(theta_nodes, width_nodes) + 1))
    table[0, :theta_nodes] = t**3 * (10.0 - 15.0 * t + 6.0 * t**2)
    table[1, :theta_nodes] = 30.0 * (t * (1.0 - t)) ** 2 * w
    table[2, :width_nodes], table[3, :width_nodes] = y / 2.0, v / 2.0
    table[0, -1], table[2, -1] = theta_nodes, width_nodes
    return table


@njit(cache=True)
def bounded_rate(omega: float) -> float:
    """|omega| bounded by OMEGA_MIN, smooth below twice that."""
    size = abs(omega)
    if size >= 2.0 * OMEGA_MIN:
        return size
    return OMEGA_MIN + size * size / (4.0 * OMEGA_MIN)


@njit(cache=True)
def smooth_step(u: float) -> float:
    """Quintic from 0 at -1 to 1 at 1."""
    t = min(max(0.5 * (u + 1.0), 0.0), 1.0)
    return t * t * t * (10.0 + t * (6.0 * t - 15.0))


@njit(cache=True, fastmath={"reassoc", "contract", "nsz", "arcp"}, error_model="numpy")
def contact(theta_1, motion, lag, soil, shape, table, out):
    """Forces of a wheel that travels ahead.

    motion: V_X, V_Y of the wheel's centre, Omega, speed of the rim r omega.
    lag: the same four over |omega|, or what the shear remembers of them; (14) is linear in them.
    soil: k, n, c, tan phi, K, z_p, z_m, K_e (rut: plastic depth, greatest depth, stiffness of reloading),
          K_Y / K_X, strength ratio, friction lost to slip speed, that speed.
    shape: radius, width, theta_2 / theta_1, theta_m's place between exit and entry.
    out: F_X, F_Y, F_Z, moment about the wheel's centre, compaction resistance.
    """
    k, n, c, tan_phi, shear_k = soil[0], soil[1], soil[2], soil[3], soil[4]
    z_p, z_m, k_e = soil[5], soil[6], soil[7]
    across, strength, polish, polish_speed = soil[8], soil[9], soil[10], soil[11]
    r, b = shape[0], shape[1]
    v_x, v_y, yaw, rim = motion[0], motion[1], motion[2], motion[3]
    theta_0 = -shape[2] * theta_1
    theta_m = theta_0 + shape[3] * (theta_1 - theta_0)
    ratio = (theta_1 - theta_m) / max(theta_m - theta_0, 1e-12)
    cos_1, sin_1, sin2_1, cos2_1 = math.cos(theta_1), math.sin(theta_1), math.sin(2 * theta_1), math.cos(2 * theta_1)

    edges = np.empty(5)
    edges[0], edges[1], edges[2] = theta_0, theta_m, theta_1
    panels = 2
    if v_x > abs(rim):  # the slip along the rim changes its sign where V_X cos theta = r omega
        flip = math.acos(rim / v_x)
        for at in (-flip, flip):
            if theta_0 < at < theta_1:
                i = panels + 1
                while edges[i - 1] > at:
                    edges[i] = edges[i - 1]
                    i -= 1
                edges[i] = at
                panels += 1

    f_x, f_y, f_z, m_z, resistance = 0.0, 0.0, 0.0, 0.0, 0.0
    nodes, widths = int(table[0, -1]), int(table[2, -1])
    for panel in range(panels):
        low, high = edges[panel], edges[panel + 1]
        for node in range(nodes):
            theta, weight = low + (high - low) * table[0, node], table[1, node]
            area = weight * (high - low) * r * b
            sin_t, cos_t = math.sin(theta), math.cos(theta)
            pressed = cos_t if theta >= theta_m else math.cos(theta_1 - (theta - theta_0) * ratio)
            z = z_p + r * max(pressed - cos_1, 0.0)
            sigma = k_e * (z - z_p) if z < z_m else k * z**n
            limit = c + sigma * tan_phi
            # (14) per unit of each velocity
            on_x = 0.5 * (theta_1 - theta) + 0.25 * (sin2_1 - 2.0 * sin_t * cos_t)
            on_rim = sin_1 - sin_t
            on_z = 0.25 * (2.0 * cos_t * cos_t - 1.0 - cos2_1)
            rim_z = cos_1 - cos_t
            j_y = (lag[1] * (theta_1 - theta) + r * lag[2] * (cos_t - cos_1)) / across
            slip_y = v_y + yaw * r * sin_t
            f_x -= area * sigma * sin_t
            f_z += area * sigma * cos_t
            resistance += area * sigma * sin_t
            for i in range(widths):
                y = b * table[2, i]
                local_x = lag[0] - lag[2] * y
                j_x = local_x * on_x - lag[3] * on_rim
                j_z = local_x * on_z + lag[3] * rim_z
                j = math.sqrt(j_x * j_x + j_y * j_y + j_z * j_z)
                along = (v_x - yaw * y) * cos_t - rim
                speed2 = along * along + slip_y * slip_y
                top = limit
                if polish > 0.0:
                    top = c + sigma * tan_phi * (1.0 - polish * (1.0 - math.exp(-math.sqrt(speed2) / polish_speed)))
                tau = area * table[3, i] * top * (1.0 - math.exp(-j / shear_k))
                tau /= math.sqrt(speed2 + SLIP_SPEED * SLIP_SPEED)
                tau_x = -tau * along * cos_t
                tau_y = -tau * slip_y * strength
                f_x += tau_x
                f_y += tau_y
                f_z -= tau * along * sin_t
                m_z += r * sin_t * tau_y - y * tau_x
    out[0], out[1], out[2], out[3], out[4] = f_x, f_y, f_z, m_z, resistance


@njit(cache=True)
def wheel_forces(theta_1, motion, lag, soil, shape, table, out, scratch):
    """Forces of a wheel travelling either way: the contact mirrors front to back, and blends near standstill."""
    ahead = smooth_step(motion[0] / BLEND_SPEED)
    out[:5] = 0.0
    turned = scratch[0:4]
    turned_lag = scratch[4:8]
    part = scratch[8:13]
    if ahead > 0.0:
        contact(theta_1, motion, lag, soil, shape, table, part)
        for i in range(5):
            out[i] += ahead * part[i]
    if ahead < 1.0:
        for i in range(4):
            sign = 1.0 if i == 1 else -1.0
            turned[i] = sign * motion[i]
            turned_lag[i] = sign * lag[i]
        contact(theta_1, turned, turned_lag, soil, shape, table, part)
        part[0], part[3], part[4] = -part[0], -part[3], -part[4]
        for i in range(5):
            out[i] += (1.0 - ahead) * part[i]
