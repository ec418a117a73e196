"""Predictions of an unseen recording by the generator with the true soil and effects: the model that one would have who
knows another formula than the catalogue's. Its errors are those of the sensors alone."""

import math
from pathlib import Path

import numpy as np

from generator.cases import OVER
from generator.catalogue import I
from generator.contact import bounded_rate
from generator.simulator import PLAIN, Drive, Setup, Undrivable, begin, drive_on, make_world
from generator.simulator import Window as Place
from generator.stepper import LAGS
from generator.world import Soil, Vehicle

from .prediction import errors
from .recording import Recording, Window

STEP = 0.02  # s between the wheel speeds
TOLERANCE = 1e-4  # m/s and rad/s, of a step


def true_setup(truth: dict) -> Setup:
    """Vehicle, soil and effects of the unseen drive."""
    numbers = truth["vehicle_numbers"]
    vehicle = Vehicle(**numbers | {"row_positions": tuple(numbers["row_positions"])})
    effects, places = {}, {}
    for effect in truth["effects"]:
        name, values = effect["effect"], dict(effect["parameters"])
        if "over" in values:
            values["over"] = OVER.index(values["over"])
        formulas = truth.get("formula") or {}
        effects[name] = values | ({"formula": formulas[name]} if name in formulas else {})
        if window := (effect.get("windows") or {}).get("unseen"):
            places[name] = Place(window["kind"], tuple(window["numbers"]))
    return Setup(vehicle, Soil(**truth["true_terrain"]), effects, places)


def predict(setup: Setup, window: Window) -> tuple[float, float] | None:
    """Place at the window's end; None where the vehicle cannot drive on."""
    seconds = float(window.time[-1])
    grid = np.arange(math.ceil(seconds / STEP) + 1) * STEP
    drive = Drive(np.stack([np.interp(grid, window.time, side) for side in (window.left, window.right)], 1), STEP)
    state = window.initial
    world = make_world(setup, drive, PLAIN)
    snapshot = begin(world, (state.x, state.y, state.heading), (state.v_x, state.v_y, state.yaw_rate))
    for i in range(setup.vehicle.wheels):  # the shear of a vehicle that has driven so for a while
        omega = drive.speeds[0, i % 2]
        left = world.p[I.half_track] * (1.0 if i % 2 == 0 else -1.0)
        ahead = world.p[I.row0 + i // 2] - world.p[I.com_offset]
        motion = (state.v_x - state.yaw_rate * left, state.v_y + state.yaw_rate * ahead, state.yaw_rate, world.p[I.wheel_radius] * omega)
        snapshot.state[LAGS + 4 * i : LAGS + 4 * i + 4] = np.array(motion) / bounded_rate(omega)
    try:
        path = drive_on(world, snapshot, 0.0, seconds, TOLERANCE)
    except Undrivable:
        return None
    return float(path[-1, 0]), float(path[-1, 1])


def on_unseen(recording: Path, truth: dict) -> dict:
    """Errors on the windows of a recording."""
    setup = true_setup(truth)
    return errors(Recording(recording).windows(), lambda window: predict(setup, window))
