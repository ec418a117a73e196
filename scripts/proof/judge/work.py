"""One piece of work on one case, in a process of its own: `python -m judge.work STAGE CASE RESULT --tool UGV`."""

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from . import files, prediction, simulated
from .noise import floor
from .oracle import fit, knowable, oracle
from .peers import NAMES, peer
from .recording import PERFECT, Sensors


@dataclass(frozen=True)
class Task:
    """Where a case and its results are."""

    tool: Path
    case: Path  # folder with the recordings
    result: Path  # folder with what the tool and the peers made of them
    kept: dict = field(default_factory=dict)  # this result as an earlier judge scored it: only its errors are made anew

    @property
    def given(self) -> list[Path]:
        """The recordings that may be learned from."""
        return [path for name in ("drive", "second") if (path := self.case / f"{name}.csv").exists()]

    @property
    def unseen(self) -> Path:
        """The recording that none of them may learn from."""
        return self.case / "unseen.csv"

    def score(self, model: Path, sensors: Sensors = PERFECT) -> dict:
        """Errors of a model on the unseen recording."""
        return {"unseen": prediction.on_unseen(self.tool, model, self.unseen, sensors)}


def nominal(task: Task) -> dict:
    """The model as the sidecar tells it."""
    model = task.result / "nominal_model.json"
    prediction.nominal_model(task.tool, task.given[0], model)
    return task.score(model)


def retuned(task: Task) -> dict:
    """The soil fitted, nothing added."""
    model = task.result / "retuned_model.json"
    if not (task.kept and model.exists()):
        fit(task.tool, task.given, model)
    return task.score(model)


def mended(task: Task) -> dict:
    """The model that the tool wrote, with what it told of the sensors."""
    answer = task.result / "answer"
    said = files.load(answer / "diagnosis.json") or {}
    return task.score(answer / "model.json", prediction.told_sensors(said.get("findings") or []))


def knowing(task: Task) -> dict:
    """The oracle; outside of the catalogue, what noise alone would be charged with. The only one that opens the truth."""
    truth = files.load(task.case.parent / "sealed" / f"{task.case.name}.json")
    if truth is None:
        raise FileNotFoundError(f"no truth of {task.case.name}")
    if "unknown" in truth["names"] and "channels" in truth["noise"]:
        return {"kind": "noise", "unseen": floor(task.unseen, truth["noise"]["channels"])}
    if not knowable(truth):
        return {"kind": "none"}
    if truth.get("formula"):  # no model of the tool has it: the generator itself predicts
        return {"kind": "simulated", "unseen": simulated.on_unseen(task.unseen, truth)}
    model = task.result / "oracle_model.json"
    return {"kind": "fit"} | task.score(model, oracle(task.tool, task.given, truth, model))


BASE: dict[str, Callable[[Task], dict]] = {"nominal": nominal, "retuned": retuned, "mended": mended, "oracle": knowing}


def answer(name: str, task: Task) -> dict:
    """A peer's answer and its errors on the unseen recording; it begins with the re-tuned model."""
    return peer(name)(task.tool, task.given, task.unseen, task.result / "retuned_model.json", task.kept.get("answer"))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("stage", choices=[*BASE, *NAMES])
    parser.add_argument("case", type=Path)
    parser.add_argument("result", type=Path)
    parser.add_argument("--tool", type=Path, required=True)
    args = parser.parse_args()
    path = args.result / f"{args.stage}.json"
    there = files.load(path) or {}
    task = Task(args.tool, args.case, args.result, there if there.get("status") == "done" else {})
    begin = time.monotonic()
    result = BASE[args.stage](task) if args.stage in BASE else answer(args.stage, task)
    result = {"status": "done", "seconds": round(time.monotonic() - begin, 2), **result}
    files.save(path, task.kept | {"unseen": result["unseen"]} if task.kept else result)


if __name__ == "__main__":
    main()
