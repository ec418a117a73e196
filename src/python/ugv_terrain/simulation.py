"""Drives: one step by step, many at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._native import SimulationError
from .description import Model

STATES = ("x", "y", "heading", "v_x", "v_y", "yaw_rate")
"""Columns of a state: east, north [m], heading [rad, counterclockwise from east]; velocity ahead and to the left [m/s],
yaw rate [rad/s, counterclockwise]."""

MAX_LEGEND = 20
"""More paths than this have a legend with `labels` alone."""

_Floats = NDArray[np.float64]


def _array(values: ArrayLike) -> _Floats:
    return np.ascontiguousarray(values, dtype=np.float64)


class Simulation:
    """A drive, step by step. The same calls give the same bits as the tool and the FMU's model.

    >>> drive = Simulation(Model(terrain="dry_sand"))
    >>> state = drive.step(2.0, 8.0, 6.0)
    >>> bool(state[0] > 1.0)
    True
    """

    def __init__(self, model: Model, initial: ArrayLike | None = None) -> None:
        self.model = model
        start = None if initial is None else _array(initial)
        self._native = _native.Simulation(model._native, start)

    @property
    def time(self) -> float:
        """Time since the start [s]."""
        return self._native.time

    @property
    def state(self) -> _Floats:
        """Six numbers: see STATES."""
        return self._native.state

    @state.setter
    def state(self, state: ArrayLike) -> None:
        self._native.state = _array(state)

    def step(
        self,
        seconds: float,
        omega_left: float,
        omega_right: float,
        *,
        rates: tuple[float, float] = (0.0, 0.0),
    ) -> _Floats:
        """Drives on [s] with these wheel speeds [rad/s] at the start, and their rates [rad/s^2]; the new state."""
        return self._native.step(seconds, (omega_left, omega_right), rates)

    def outputs(self) -> dict[str, float]:
        """The FMU's outputs by name, in SI units: slips, loads, sinkages, torques, rolling resistance, turning moment."""
        return self._native.outputs()

    def copy(self) -> Simulation:
        """One that goes on as this would."""
        twin = Simulation.__new__(Simulation)
        twin.model, twin._native = self.model, self._native.copy()
        return twin

    __copy__ = copy

    def __deepcopy__(self, memo: object) -> Simulation:
        return self.copy()


@dataclass(frozen=True)
class Rollout:
    """Drives of one or many models over the same times."""

    time: _Floats
    """(n,) [s]."""
    states: _Floats
    """(n, 6) of one model, (m, n, 6) of many, columns as STATES; NaN where a drive had ended."""
    outputs: dict[str, _Floats]
    """(n,) or (m, n) by name, in SI units."""
    errors: list[str | None]
    """For each model why it ended early, if it did."""

    def __getattr__(self, name: str) -> _Floats:
        if name in STATES:
            return self.states[..., STATES.index(name)]
        raise AttributeError(f"a rollout has no `{name}`")

    def plot(self, axes: Any = None, labels: Sequence[str] | None = None) -> Any:
        """Draws the paths; needs matplotlib. Returns the axes. Several paths have a legend: `labels`, or their places."""
        if axes is None:
            from matplotlib import pyplot

            axes = pyplot.figure().add_subplot()
        paths = self.states.reshape(-1, len(self.time), len(STATES))
        if labels is not None and len(labels) != len(paths):
            raise ValueError(f"{len(labels)} labels for {len(paths)} paths")
        for path, label in zip(paths, labels if labels is not None else map(str, range(len(paths)))):
            axes.plot(path[:, 0], path[:, 1], label=label)
        if labels is not None or 1 < len(paths) <= MAX_LEGEND:
            axes.legend()
        axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
        return axes


def rollout(
    models: Model | Sequence[Model],
    time: ArrayLike,
    omega: ArrayLike,
    *,
    initial: ArrayLike | None = None,
    outputs: Sequence[str] = (),
) -> Rollout:
    """Drives one model or many, on all processors and without the interpreter's lock.

    `time` (n,) [s], increasing; `omega` (n, 2) or (m, n, 2): speeds of the left and right wheels [rad/s], linear between
    the times; `initial` (6,) or (m, 6), at rest at the origin without; `outputs` names of the FMU's outputs. Many drives
    over different wheel speeds with one model: `[model] * m`. The bits are those of `ugv simulate`.

    Raises SimulationError where a single drive cannot go on; of many the others go on, and `errors` says why.
    """
    alone = isinstance(models, Model)
    all_models = [models] if isinstance(models, Model) else list(models)
    count = len(all_models)
    time, speeds = _array(time), _array(omega)
    if time.ndim != 1 or speeds.shape[-2:] != (len(time), 2) or speeds.ndim not in (2, 3):
        raise ValueError(f"omega has shape {speeds.shape} for {time.shape} times: expected (n, 2) or (m, n, 2)")
    if speeds.ndim == 3 and speeds.shape[0] != count:
        raise ValueError(f"omega is for {speeds.shape[0]} models; there are {count}")
    speeds = speeds.reshape(-1, len(time), 2)
    start = np.zeros(6) if initial is None else _array(initial)
    if start.shape not in ((6,), (count, 6)):
        raise ValueError(f"initial has shape {start.shape}: expected (6,) or ({count}, 6)")
    start = np.ascontiguousarray(np.broadcast_to(start, (count, 6)))
    native = [model._native for model in all_models]
    states, values, errors = _native.rollout(native, time, speeds, start, list(outputs))
    if alone:
        if errors[0] is not None:
            raise SimulationError(errors[0])
        states, values = states[0], values[0]
    named = {name: values[..., place] for place, name in enumerate(outputs)}
    return Rollout(time, states, named, errors)


class Batch:
    """Simulations that are stepped together: what a learner needs."""

    def __init__(self, models: Sequence[Model]) -> None:
        self.models = list(models)
        self._native = _native.Batch([model._native for model in self.models])

    def __len__(self) -> int:
        return len(self._native)

    @property
    def states(self) -> _Floats:
        """(m, 6), columns as STATES."""
        return self._native.states()

    def step(self, seconds: float, omega: ArrayLike) -> tuple[_Floats, list[str | None]]:
        """Drives all on [s] with held wheel speeds (m, 2) [rad/s]; the new states, and why some could not go on."""
        speeds = _array(omega)
        if speeds.shape != (len(self), 2):
            raise ValueError(f"omega has shape {speeds.shape}: expected ({len(self)}, 2)")
        return self._native.step(seconds, speeds)

    def restart(self, place: int, initial: ArrayLike = (0.0,) * 6) -> None:
        """Begins one anew, on untouched ground."""
        self._native.restart(place, _array(initial))
