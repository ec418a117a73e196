"""Wheel-speed programmes as a person with a joystick drives them."""

from __future__ import annotations

import math

import numpy as np

from .catalogue import SERIES
from .simulator import Drive
from .world import Vehicle

SPEED_STEP = 0.02  # s between the true wheel speeds
SERIES_STEP = 0.05  # s between the random series
STYLES = ("rich", "calm", "short")


def _smooth(values: np.ndarray, time_constant: float) -> np.ndarray:
    """Two first-order lags in a row: what motors make of a joystick."""
    share = 1.0 - math.exp(-SPEED_STEP / time_constant)
    for _ in range(2):
        kept = values[0]
        out = np.empty_like(values)
        for i, value in enumerate(values):
            kept = kept + share * (value - kept)
            out[i] = kept
        values = out
    return values


def _rich(rng: np.random.Generator, top: float, seconds: float) -> list[tuple[float, float, float]]:
    """(seconds, share of the top speed, curvature in units of the tightest) of each piece."""
    pieces: list[tuple[float, float, float]] = []
    side = 1.0 if rng.random() < 0.5 else -1.0
    total = 0.0
    kinds = []
    while total < seconds:
        if not kinds:
            kinds = list(rng.permutation(["straight", "wide", "tight", "wide", "tight", "slalom", "brake", "straight"]))
        kind = kinds.pop()
        speed = rng.uniform(0.35, 1.0)
        if kind == "straight":
            piece = [(rng.uniform(2.0, 4.0), speed, rng.uniform(-0.03, 0.03))]
        elif kind == "wide":
            piece = [(rng.uniform(3.0, 5.0), speed, side * rng.uniform(0.15, 0.4))]
        elif kind == "tight":
            piece = [(rng.uniform(2.0, 4.0), 0.7 * speed, side * rng.uniform(0.5, 1.0))]
        elif kind == "slalom":
            bend = rng.uniform(0.25, 0.6)
            piece = [(rng.uniform(1.2, 2.2), speed, side * bend), (rng.uniform(1.2, 2.2), speed, -side * bend)]
        else:
            piece = [(rng.uniform(0.8, 1.6), rng.uniform(0.0, 0.2), 0.0)]
        if kind != "straight":
            side = -side
        pieces += piece
        total += sum(p[0] for p in piece)
    return pieces


def _calm(rng: np.random.Generator, seconds: float) -> list[tuple[float, float, float]]:
    speed, total = rng.uniform(0.45, 0.8), 0.0
    pieces = []
    while total < seconds:
        length = rng.uniform(4.0, 8.0)
        pieces.append((length, speed * rng.uniform(0.92, 1.08), rng.uniform(-0.25, 0.25)))
        total += length
    return pieces


def _top_speed(rng: np.random.Generator, vehicle: Vehicle) -> float:
    """A driver's top speed [m/s]: longer vehicles are driven faster."""
    return rng.uniform(0.8, 1.25) * (0.9 + 0.9 * math.sqrt(max(vehicle.row_positions)))


def draw_drive(rng: np.random.Generator, vehicle: Vehicle, style: str, loose: float = 1.0) -> Drive:
    """A programme of a style, from rest to rest. loose: how much harder this ground makes the driver steer."""
    if style not in STYLES:
        raise ValueError(f"style {style!r} is unknown; choose one of {', '.join(STYLES)}")
    seconds = rng.uniform(10.0, 15.0) if style == "short" else rng.uniform(35.0, 70.0)
    top = _top_speed(rng, vehicle)
    pieces = _rich(rng, top, seconds - 3.0) if style == "rich" else _calm(rng, seconds - 3.0)
    if style == "rich" and rng.random() < 0.35:
        spin = (1.0 if rng.random() < 0.5 else -1.0) * rng.uniform(0.25, 0.5)
        pieces.insert(int(rng.integers(1, len(pieces))), (rng.uniform(1.5, 3.0), 0.0, spin))
    return _programme(rng, vehicle, pieces, top, loose)


def draw_pivots(rng: np.random.Generator, vehicle: Vehicle, loose: float = 1.0) -> Drive:
    """Turns on the spot, both ways and at three speeds, from rest to rest."""
    top = _top_speed(rng, vehicle)
    spins = rng.permutation([side * speed for side in (-1.0, 1.0) for speed in (0.25, 0.35, 0.5)])
    pieces = [piece for spin in spins for piece in ((rng.uniform(2.0, 3.0), 0.0, float(spin)), (1.0, 0.0, 0.0))]
    return _programme(rng, vehicle, pieces, top, loose)


def _programme(rng: np.random.Generator, vehicle: Vehicle, pieces: list[tuple[float, float, float]], top: float,
               loose: float) -> Drive:
    """The wheel speeds of pieces one after another, from rest to rest."""
    tightest = rng.uniform(0.45, 0.75) / vehicle.half_track
    ahead, around = [np.zeros(int(rng.uniform(0.4, 1.2) / SPEED_STEP))], []
    around.append(np.zeros_like(ahead[0]))
    for length, share, bend in pieces:
        count = int(length / SPEED_STEP)
        v = share * top
        turn = bend * tightest * v if share > 0.0 else bend * top / vehicle.half_track
        if v > 0.0:
            turn = math.copysign(min(abs(turn), 2.0 / v), turn)  # lateral acceleration at most 2 m/s^2
        ahead.append(np.full(count, v))
        around.append(np.full(count, turn))
    ahead.append(np.zeros(int(2.0 / SPEED_STEP)))
    around.append(np.zeros(int(2.0 / SPEED_STEP)))
    quick = rng.uniform(0.15, 0.35)
    wobble = rng.normal(0.0, 0.12, (2, sum(map(len, ahead))))
    v, turn = np.concatenate(ahead), np.concatenate(around)
    v = _smooth(v * (1.0 + wobble[0] * 3.0 * math.sqrt(SPEED_STEP)), quick)
    turn = _smooth(turn * (1.0 + wobble[1] * 3.0 * math.sqrt(SPEED_STEP)), quick)
    widen = loose * rng.uniform(2.2, 3.4)  # a skid-steer vehicle turns less than its wheels would
    most = loose * np.maximum(1.1 * np.abs(v), 0.5 * top)
    difference = np.clip(turn * vehicle.half_track * widen, -most, most)
    speeds = np.stack([v - difference, v + difference], axis=1) / vehicle.wheel_radius
    return Drive(speeds, SPEED_STEP, draw_series(rng, (len(v) - 1) * SPEED_STEP), SERIES_STEP)


def draw_series(rng: np.random.Generator, seconds: float) -> np.ndarray:
    """Wind east and north [m/s]: a mean and gusts of some seconds; and whether a brake sticks (0 to 1)."""
    count = int(seconds / SERIES_STEP) + 2
    series = np.zeros((count, SERIES))
    mean, toward = rng.uniform(4.0, 9.0), rng.uniform(0.0, 2.0 * math.pi)
    keep = math.exp(-SERIES_STEP / rng.uniform(1.5, 4.0))
    for axis in range(2):
        gust = 0.0
        level = mean * (math.cos(toward) if axis == 0 else math.sin(toward))
        for i in range(count):
            gust = keep * gust + math.sqrt(1.0 - keep**2) * rng.normal(0.0, 0.35 * mean)
            series[i, axis] = level + gust
    at = rng.uniform(2.0, 6.0)
    while at < seconds:
        length = rng.uniform(1.5, 4.0)
        begin, end = int(at / SERIES_STEP), min(int((at + length) / SERIES_STEP), count)
        series[begin:end, 2] = 1.0
        at += length + rng.uniform(4.0, 10.0)
    return series
