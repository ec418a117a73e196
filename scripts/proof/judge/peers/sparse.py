"""Sparse regression on differentiated residuals (SINDy with control, by pySINDy).

The re-tuned model drives windows of the recordings given; the residual velocities e = recorded - model (ahead,
sideways, turning) follow de/dt = Theta(e, u) xi, with u the model's velocities, the rims' speed over the ground and the
heading, and Theta of e itself and the polynomials of u up to the first or second degree (with e squared too it runs away). de/dt
is by smoothed finite differences, xi by sequentially thresholded least squares on columns of the same size. Degree and
threshold are those that predict best the last third of the recordings given, which was not learned from then; "no terms"
is one of the choices. On the unseen drive e is integrated from zero along the re-tuned model's motion. It counts as
having detected something where the chosen law takes a tenth off the error of that third; it tells no names.
"""

import json
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pysindy

from .residual import (
    LEAST,
    STEP,
    TIMES,
    Residuals,
    Track,
    learn,
    nothing,
    on_unseen,
    rmse,
)

CHOICES = [(degree, threshold) for degree in (1, 2) for threshold in (0.1, 0.2, 0.4, 0.8)]
SMOOTHING = 15  # samples
RIDGE = 1.0
LARGEST = 3.0  # m/s, rad/s: a residual beyond has run away


def train(some: Sequence[Track], degree: int, threshold: float) -> Residuals | None:
    """A sparse law of the residual's change; None where no term is left."""
    scale = np.concatenate([track.residual for track in some]).std(0) + 1e-9
    everything = np.concatenate([track.features for track in some])
    mean, spread = everything.mean(0), everything.std(0) + 1e-9
    parts = [pysindy.PolynomialLibrary(degree=1, include_bias=False), pysindy.PolynomialLibrary(degree=degree)]
    library = pysindy.GeneralizedLibrary(parts, inputs_per_library=[range(3), range(3, 3 + len(mean))])
    optimizer = pysindy.STLSQ(threshold=threshold, alpha=RIDGE)
    law = pysindy.SINDy(optimizer, library, pysindy.SmoothedFiniteDifference(smoother_kws={"window_length": SMOOTHING}))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        law.fit([track.residual / scale for track in some], t=STEP, u=[(track.features - mean) / spread for track in some])
    if not np.any(law.coefficients()):
        return None

    def residuals(new: Sequence[Track]) -> list[np.ndarray]:
        """Integrates all windows at once, by the midpoint rule."""
        if not new:
            return []
        control = (np.array([track.features for track in new]) - mean) / spread
        state = np.zeros((len(new), len(TIMES), 3))

        def rate(e: np.ndarray, u: np.ndarray) -> np.ndarray:
            return law.predict(e, u=u)

        for k in range(len(TIMES) - 1):
            now = state[:, k]
            middle = now + STEP / 2 * np.asarray(rate(now, control[:, k]))
            change = np.asarray(rate(middle, (control[:, k] + control[:, k + 1]) / 2))
            limit = LARGEST / scale
            state[:, k + 1] = np.clip(np.nan_to_num(now + STEP * change), -limit, limit)
        return list(state * scale)

    return residuals


def sparse(tool: Path, given: list[Path], unseen: Path, model: Path, _said: dict | None = None) -> dict:
    """The peer's answer, and its errors on the unseen recording."""
    vehicle = json.loads(model.read_text())["vehicle"]
    learning, choosing = learn(tool, given, model, vehicle)
    before = rmse(choosing, nothing(choosing))
    best, choice = before, None
    for tried in CHOICES if learning and choosing else ():
        law = train(learning, *tried)
        if law is not None and (error := rmse(choosing, law(choosing))) < best:
            best, choice = error, tried
    law = None if choice is None else train([*learning, *choosing], *choice)
    verdict = "unknown_physics" if law is not None and best < LEAST * before else "nothing_missing"
    return {"answer": {"verdict": verdict}, "unseen": on_unseen(tool, unseen, model, vehicle, law or nothing)}
