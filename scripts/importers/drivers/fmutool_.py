"""fmutool and fmucontainer: a container of the FMU alone, driven by fmpy."""

import subprocess
import sys
from pathlib import Path

import fmpy
import numpy as np
from task import INPUTS, STEP, Task, main


def tool(name: str, *arguments: str, folder: Path) -> None:
    """Runs a tool of this environment; what it says beside INFO is an error."""
    command = [str(Path(sys.executable).parent / name), *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    said = (done.stdout + done.stderr).splitlines()
    if done.returncode or any(line and not line.startswith("INFO") for line in said):
        raise SystemExit("\n".join([f"{name} ends with {done.returncode}", *said]))


def check(task: Task) -> None:
    tool("fmutool", "-input", str(task.fmu), "-check", folder=task.output.parent)


def simulate(task: Task) -> None:
    folder = task.output.parent
    (folder / "container.csv").write_text(f"rule;from_fmu;from_port;to_fmu;to_port\nFMU;{task.fmu.name};;;\n")
    tool("fmucontainer", "-fmu-directory", str(task.fmu.parent), "-auto-parameter", "-container", f"{folder}/container.csv:{STEP}", folder=folder)
    raise SystemExit(sorted(folder.iterdir()))


main(cs=simulate, check=check)
