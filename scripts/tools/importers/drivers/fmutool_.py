"""fmutool and fmucontainer; the container that the latter makes of the FMU alone is driven by fmpy."""

import subprocess
import sys
from pathlib import Path

import fmpy
import numpy as np
from task import INPUTS, STEP, Task, main

# What fmucontainer 2.0 says of elements of arrays in FMI 2.0, which it exposes one by one nevertheless.
ARRAYS = "Cannot expose FMI-2 array aggregate 'ugv.vehicle.row_positions'"


def tool(name: str, *arguments: object, folder: Path, known: str = "INFO") -> None:
    """Runs a tool of this environment; what it says beside INFO, or a known complaint, is an error."""
    command = [str(Path(sys.executable).parent / name), *map(str, arguments)]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    said = (done.stdout + done.stderr).splitlines()
    bad = [line for line in said if line and not line.startswith("INFO") and known not in line]
    if done.returncode or bad:
        sys.exit("\n".join([f"{name} ends with {done.returncode}", *bad]))


def container(task: Task, known: str) -> Path:
    """The container: the FMU with its own names but for the parameters, which begin with `ugv.`."""
    folder = task.output.parent
    (folder / "container.csv").write_text(f"rule;from_fmu;from_port;to_fmu;to_port\nFMU;{task.fmu.name};;;\n")
    options = ("-fmu-directory", task.fmu.parent, "-auto-parameter", "-container", f"{folder / 'container.csv'}:{STEP}")
    tool("fmucontainer", *options, folder=folder, known=known)
    return folder / "container.fmu"


def check(task: Task) -> None:
    tool("fmutool", "-input", task.fmu, "-check", folder=task.output.parent)


def simulate(task: Task) -> None:
    fmu = container(task, known=ARRAYS)
    rows = [sample for begin, length, speeds in task.steps() for sample in ((begin, *speeds), (begin + length, *speeds))]
    signals = np.array(rows, dtype=[(name, float) for name in ("time", *INPUTS)])
    names = [variable.name for variable in task.outputs]
    start = {f"ugv.{name}": value for name, value in task.start.items()}
    result = fmpy.simulate_fmu(str(fmu), start_time=0, stop_time=task.drive[-1][0], output_interval=STEP, input=signals,
                               start_values=start, output=names)
    task.write([row["time"], *(row[name] for name in names)] for row in result)


main(cs=simulate, check=check, arrays=lambda task: container(task, known="INFO"))
