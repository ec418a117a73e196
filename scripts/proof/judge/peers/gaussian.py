"""Gaussian process on the residual velocities.

The re-tuned model drives windows of the recordings given; what its velocities lack of the recorded ones (ahead,
sideways, turning) becomes three Gaussian processes (scikit-learn; squared exponential with a length for each feature,
white noise, lengths by maximum likelihood) of the model's velocities, the rims' speed over the ground and the heading.
On the unseen drive their mean is added to the re-tuned model's velocities and integrated. It is used only where it
predicts the last third of the recordings given, which it has not learned from then, better than no residual does; where
it takes a tenth off that error, it counts as having detected something. It tells no names.
"""

import json
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

from .residual import (
    FEATURES,
    LEAST,
    SETTLING,
    TIMES,
    Residuals,
    Track,
    learn,
    nothing,
    on_unseen,
    rmse,
)

POINTS = 250


def train(some: Sequence[Track]) -> Residuals:
    """Three processes learned from tracks."""
    late = TIMES >= SETTLING
    inputs = np.concatenate([track.features[late] for track in some])
    outputs = np.concatenate([track.residual[late] for track in some])
    pick = np.linspace(0, len(inputs) - 1, min(POINTS, len(inputs))).astype(int)
    mean, scale = inputs.mean(0), inputs.std(0) + 1e-9
    models = []
    for column in range(outputs.shape[1]):
        spread = outputs[:, column].std() + 1e-9
        kernel = ConstantKernel(0.5) * RBF(np.ones(len(FEATURES)), (0.2, 100.0)) + WhiteKernel(0.5)
        process = GaussianProcessRegressor(kernel, random_state=1)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            process.fit((inputs[pick] - mean) / scale, outputs[pick, column] / spread)
        models.append((process, spread))

    def residuals(new: Sequence[Track]) -> list[np.ndarray]:
        return [np.column_stack([spread * process.predict((track.features - mean) / scale) for process, spread in models])
                for track in new]

    return residuals


def gaussian(tool: Path, given: list[Path], unseen: Path, model: Path, _said: dict | None = None) -> dict:
    """The peer's answer, and its errors on the unseen recording."""
    vehicle = json.loads(model.read_text())["vehicle"]
    learning, choosing = learn(tool, given, model, vehicle)
    before = rmse(choosing, nothing(choosing))
    after = rmse(choosing, train(learning)(choosing)) if learning and choosing else before
    residuals = train([*learning, *choosing]) if after < before else nothing
    verdict = "unknown_physics" if after < LEAST * before else "nothing_missing"
    return {"answer": {"verdict": verdict}, "unseen": on_unseen(tool, unseen, model, vehicle, residuals)}
