#!/usr/bin/env python3
"""Fits the soil to one half of every recording in UGV_DATA, scores it on the other, prints Markdown tables.

What docs/explanation/recordings.md shows. Needs target/release/ugv (./scripts/package.sh); takes some minutes.
"""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
TOOL = TARGET / "release" / "ugv"
DATA = Path(os.environ.get("UGV_DATA", ROOT.parent / "shared" / "data"))
OUT = TARGET / "recordings"
MODELS = {
    "no_slip": "no-slip",
    "two_parameter": "two-parameter",
    "three_parameter": "three-parameter",
    "nominal_soil": "nominal soil",
    "given_model": "fitted soil",
}


def run(*arguments: object, check: bool = True) -> bool:
    """Runs the tool; whether it succeeded."""
    command = [TOOL, *map(str, arguments), "--quiet"]
    return subprocess.run(command, check=check, capture_output=True, text=True).returncode == 0


def value(estimate: object) -> float:
    """The value of an estimate, which is told with its interval."""
    return estimate["value"] if isinstance(estimate, dict) else estimate


def cell(model: dict) -> str:
    """Median and 95th percentile of both errors."""
    if not model.get("position_m"):
        return "not fitted"
    metres, radians = model["position_m"], model["heading_rad"]
    return (
        f"{value(metres['median']):.2f} / {value(metres['p95']):.2f}, "
        f"{value(radians['median']):.3f} / {value(radians['p95']):.2f}"
    )


def soil(report: dict) -> str:
    """The fitted soil and the delays, with 90 % intervals."""
    parts = []
    for parameter in report["parameters"]:
        name, unit = parameter["name"].split(".")[-1], parameter["unit"]
        low, high = parameter["low"], parameter["high"]
        parts.append(f"{name} {low:.3g} .. {high:.3g} {unit}")
    return "; ".join(parts)


def report(recording: Path) -> tuple[str, str]:
    """A row of each table: the errors, and the soil. A star marks what is too short to be parted."""
    model, fitted, score = (OUT / f"{recording.stem}.{kind}.json" for kind in ("model", "fit", "score"))
    start = time.perf_counter()
    fit = ("fit", recording, "--starts", 0, "--output", model, "--json", fitted, "--force")
    parted = run(*fit, "--half", check=False) or not run(*fit)
    seconds = time.perf_counter() - start
    run("score", recording, "--model", model, "--json", score, "--force")
    scored = json.loads(score.read_text())["recordings"][0]
    cells = {entry["model"]: cell(entry) for entry in scored["models"]}
    row = " | ".join(cells.get(name, "") for name in MODELS)
    label = recording.stem.replace("_warthog", "").split("_2024")[0] + ("" if parted else "*")
    return (
        f"| {label} ({scored['judged']}) | {row} | {seconds:.0f} s |",
        f"| {label} | {soil(json.loads(fitted.read_text()))} |",
    )


def main() -> None:
    """Both folders, in the order of their names."""
    if not DATA.is_dir():
        sys.exit(f"recordings_report: skipped, there is no {DATA} (UGV_DATA)")
    OUT.mkdir(parents=True, exist_ok=True)
    for folder in ("recordings", "multibody"):
        rows = [report(path) for path in sorted((DATA / folder).glob("*.csv"))]
        print(f"\n### {folder}\n\n| recording (windows) | {' | '.join(MODELS.values())} | fit |")
        print("|---|" + "---|" * (len(MODELS) + 1))
        print("\n".join(errors for errors, _ in rows))
        print("\n| recording | 90 % intervals |\n|---|---|")
        print("\n".join(found for _, found in rows))


if __name__ == "__main__":
    main()
