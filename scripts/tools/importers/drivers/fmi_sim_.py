"""fmi-sim: the tool, with the wheel speeds in a file."""

import csv
import os
import subprocess
import sys

from task import STEP, Task, main

TOOL = sys.argv.pop(1)


def literal(value: float | bool) -> str:
    return str(value).lower() if isinstance(value, bool) else repr(value)


def simulate(task: Task, interface: str, **more: str) -> None:
    folder = task.output.parent
    inputs, result = folder / "inputs.csv", folder / "result.csv"
    with inputs.open("w", newline="") as file:
        csv.writer(file).writerows([["time", *(variable.name for variable in task.inputs)], *task.drive])
    start = [f"--init-values={name}={literal(value)}" for name, value in task.start.items()]
    times = ["-s", "0", "-f", str(task.drive[-1][0]), "--output-interval", str(STEP), "--step", str(STEP)]
    command = [TOOL, "--model", str(task.fmu), "-i", str(inputs), "-o", str(result), interface, *times, *start]
    quiet = os.environ | {"RUST_BACKTRACE": "0"}
    done = subprocess.run(command, cwd=folder, env=quiet, capture_output=True, text=True, errors="replace", check=False)
    if done.returncode:
        sys.exit(f"{done.stdout[-1000:]}{done.stderr[-3000:]}")
    with result.open(newline="") as file:
        rows = list(csv.DictReader(file))
    names = [variable.name for variable in task.outputs]
    task.write([row["time"], *(row[name] for name in names)] for row in rows)


main(cs=lambda task: simulate(task, "co-simulation"))
