"""The libraries for other platforms against linux64's, under emulators; the workflow for all.

Of an FMU that `scripts/package.sh --platforms all` made; with another, or without wine or qemu,
tests are skipped.
"""

import json
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

import fmpy
import numpy as np
import pytest
from fmpy.util import add_remoting
from fmi3_support import fmi3, fmi3_path
from fmu_support import REPOSITORY, fmu, fmu_path, scratch
from ruamel.yaml import YAML

# Of the largest absolute value of a variable, or of 1: libraries of C round powers and sines
# differently in the last bit; 4e-15 was seen.
TOLERANCE = 1e-9
WINE = Path("/usr/lib/wine")
ARM_SYSTEM = Path("/usr/aarch64-linux-gnu")
ROW = re.compile(r"[0-9a-f]{16}( [0-9a-f]{16})*")
WORKFLOW = REPOSITORY / ".github" / "workflows" / "fmu.yml"


@dataclass(frozen=True)
class Driven:
    """An FMU, and the program that drives its library."""

    source: str
    path: Callable[[], Path]
    folder: Callable[[], Path]
    # What a platform is called.
    names: dict[str, str]
    # What the program on a platform is told: resources, token, and what to read.
    task: Callable[[str], list[str]]

    def library(self, platform: str) -> Path:
        """The FMU's library for a platform; skips the test where it has none."""
        name = self.names.get(platform, platform)
        found = list((self.folder() / "binaries" / name).glob("ugv.*"))
        if not found:
            raise unittest.SkipTest(
                f"{self.path()} has no library for {name}; build it with --platforms all"
            )
        return found[0]


def task_2(_platform: str) -> list[str]:
    """Reads all outputs; the resources as a URI, which is the same everywhere."""
    return [fmu().resources, fmu().description.guid, *map(str, fmu().references(fmu().outputs))]


def task_3(platform: str) -> list[str]:
    """Reads all outputs, arrays included; the resources as a path, which wine has on drive Z."""
    outputs = fmi3().outputs
    values = sum(map(fmi3().size, outputs))
    references = map(str, fmi3().references(outputs))
    resources = ("Z:" if platform == "win64" else "") + fmi3().resources
    return [resources, fmi3().description.guid, str(values), *references]


VERSIONS = {
    "FMI 2.0": Driven("drive.c", fmu_path, lambda: fmu().folder, {}, task_2),
    "FMI 3.0": Driven(
        "drive_3.c",
        fmi3_path,
        lambda: fmi3().folder,
        {"linux64": "x86_64-linux", "win64": "x86_64-windows"},
        task_3,
    ),
}


def needs(program: str | Path, package: str) -> str:
    """A program's path; skips the test where it is missing."""
    path = shutil.which(program)
    if path is None:
        raise unittest.SkipTest(f"{program} is missing (Debian: apt-get install {package})")
    return path


def host(source: str, compiler: str, package: str) -> Path:
    """The program that drives a library, compiled for a platform."""
    program = Path(tempfile.mkdtemp(dir=scratch())) / "fmu_drive.exe"
    command = [needs(compiler, package), "-std=c11", "-O1", "-Wall", "-Wextra", "-Werror"]
    command += ["-Wno-unused-function", "-I", str(Path(fmpy.__file__).parent / "c-code")]
    command += [str(REPOSITORY / "tests" / "fmu" / source), "-o", str(program), "-lm"]
    command += [] if "mingw" in compiler else ["-ldl"]
    subprocess.run(command, check=True)
    return program


def driven(version: str, runner: Sequence[str], program: Path, platform: str) -> np.ndarray:
    """What the program reads: a row for each step, the time and all outputs."""
    about = VERSIONS[version]
    command = [*runner, str(program), str(about.library(platform)), *about.task(platform)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(f"{command}: status {done.returncode}\n{done.stderr}")
    return np.array(
        [[float(number) for number in line.split()] for line in done.stdout.splitlines()]
    )


def stepped(path: Path) -> np.ndarray:
    """What fmpy reads of an FMU in a process of its own: a row for each step."""
    operations: list[list[object]] = [["start", {"terrain": 1, "initial.v_x": 0.3}]]
    for left, right in [(3.0, 3.0), (8.0, 5.0), (-3.0, 3.0), (0.0, 0.0)]:
        operations += [["speeds", left, right]] + 25 * [["step", 0.02]]
    task = {"fmu": str(path), "drives": [{"read": fmu().outputs, "do": operations}]}
    done = subprocess.run(
        [sys.executable, str(Path(__file__).with_name("step_fmu.py"))],
        env=os.environ | {"TMPDIR": str(scratch())},
        input=json.dumps(task),
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        timeout=120,
        check=True,
    )
    # What the server says gets in between.
    rows = [line.split() for line in done.stdout.splitlines() if ROW.fullmatch(line)]
    bits = [[bytes.fromhex(number) for number in row] for row in rows]
    return np.array([[struct.unpack(">d", number)[0] for number in row] for row in bits])


def farthest(one: np.ndarray, other: np.ndarray) -> float:
    """The largest difference, of the column's largest absolute value or of 1."""
    return float(np.max(np.abs(one - other) / np.maximum(1.0, np.abs(one).max(axis=0))))


@pytest.mark.nightly
class Elsewhere(unittest.TestCase):
    """One manoeuvre on every platform."""

    wine: mock._patch_dict

    @classmethod
    def setUpClass(cls) -> None:
        # fmpy's server is told of a file that its client keeps locked, and ends when it can open it; root
        # always can. Without that file it runs until wine ends.
        folder = tempfile.mkdtemp(dir=scratch())
        shim = Path(folder) / "wine64"
        shim.write_text(f'#!/bin/sh\nexec {WINE}/wine64 "$1" "$2"\n')
        shim.chmod(0o755)
        settings = {
            "PATH": os.pathsep.join([folder, str(WINE), os.environ["PATH"]]),
            "WINEPREFIX": tempfile.mkdtemp(dir=scratch()),
            "WINEDEBUG": "-all",
            # It would offer to install these two.
            "WINEDLLOVERRIDES": "mscoree,mshtml=",
        }
        environment = mock.patch.dict(os.environ, settings)
        environment.start()
        cls.addClassCleanup(environment.stop)

    def start_wine(self) -> str:
        """Sets up a folder of its own for wine, in which a server runs until the tests end."""
        wine, server = needs(WINE / "wine64", "wine64"), needs(WINE / "wineserver", "wine64")
        subprocess.run([wine, "wineboot", "--init"], capture_output=True, check=True)
        self.addClassCleanup(subprocess.run, [server, "--kill"], check=False)
        return wine

    def agree(self, native: np.ndarray, other: np.ndarray, platform: str) -> None:
        """Asserts that a platform's numbers are those of linux64."""
        self.assertEqual(native.shape, other.shape)
        self.assertTrue(np.isfinite(native).all())
        difference = farthest(native, other)
        print(f"\n{platform}: {len(other)} rows, differs from linux64 by {difference:.1e} at most")
        self.assertLess(difference, TOLERANCE)

    def compare(
        self, version: str, runner: Sequence[str], compiler: Sequence[str], platform: str
    ) -> None:
        """Drives a platform's library in a runner and linux64's beside it."""
        source = VERSIONS[version].source
        native = driven(version, [], host(source, "gcc", "gcc"), "linux64")
        self.assertGreater(len(native), 400)
        self.assertGreater(np.abs(native[:, 1]).max(), 1.0)
        other = driven(version, runner, host(source, *compiler), platform)
        self.agree(native, other, f"{platform}, {version}")

    def test_aarch64_gives_the_numbers_of_linux64(self) -> None:
        for about in VERSIONS.values():
            about.library("aarch64-linux")
        runner = [needs("qemu-aarch64", "qemu-user"), "-L", str(ARM_SYSTEM)]
        compiler = "aarch64-linux-gnu-gcc", "gcc-aarch64-linux-gnu libc6-dev-arm64-cross"
        for version in VERSIONS:
            self.compare(version, runner, compiler, "aarch64-linux")

    def test_win64_gives_the_numbers_of_linux64(self) -> None:
        for about in VERSIONS.values():
            about.library("win64")
        runner = [self.start_wine()]
        compiler = "x86_64-w64-mingw32-gcc", "gcc-mingw-w64-x86-64-win32"
        for version in VERSIONS:
            self.compare(version, runner, compiler, "win64")

    def test_fmpy_drives_win64_as_linux64(self) -> None:
        VERSIONS["FMI 2.0"].library("win64")
        self.start_wine()
        windows = Path(tempfile.mkdtemp(dir=scratch())) / "windows.fmu"
        with zipfile.ZipFile(fmu_path()) as whole, zipfile.ZipFile(windows, "w") as part:
            for name in whole.namelist():
                if not name.startswith("binaries/") or name.startswith("binaries/win64/"):
                    part.writestr(name, whole.read(name))
        # Starts a server under wine64 and talks to it.
        add_remoting(str(windows), "linux64", "win64")
        native = stepped(fmu_path())
        # The client gives up when wine takes long to start.
        for attempt in range(3):
            try:
                remote = stepped(windows)
                break
            except subprocess.SubprocessError:
                if attempt == 2:
                    raise
        self.agree(native, remote, "win64, by fmpy")


class Workflow(unittest.TestCase):
    """The workflow that makes the FMU of all platforms."""

    def test_what_it_calls_is_there(self) -> None:
        workflow = YAML(typ="safe").load(WORKFLOW.read_text())
        jobs = workflow["jobs"]
        steps = [step for job in jobs.values() for step in job["steps"]]
        for job in jobs.values():
            needed = job.get("needs", [])
            self.assertLessEqual({needed} if isinstance(needed, str) else set(needed), set(jobs))
        commands = "\n".join(step["run"] for step in steps if "run" in step)
        scripts = set(re.findall(r"\./scripts/[\w./]+", commands))
        self.assertIn("./scripts/package.sh", scripts)
        for script in scripts:
            self.assertTrue(os.access(REPOSITORY / script, os.X_OK), script)
        for module in re.findall(r"[\w/.]+\.py\b", commands):
            self.assertTrue((REPOSITORY / module).is_file(), module)
        # As the tests here have it.
        self.assertEqual(workflow["env"]["FMPY"], f"fmpy=={fmpy.__version__}")

    def test_merged_files_come_from_the_jobs_before(self) -> None:
        jobs = YAML(typ="safe").load(WORKFLOW.read_text())["jobs"]
        (merge,) = [
            step["run"] for step in jobs["merge"]["steps"] if "--merge" in step.get("run", "")
        ]
        merged = set(re.findall(r"\S+\.fmu", merge.split("--output")[0]))
        written = [step for name in jobs["merge"]["needs"] for step in jobs[name]["steps"]]
        self.assertEqual(
            merged, {step["with"]["path"] for step in written if "upload" in step.get("uses", "")}
        )


if __name__ == "__main__":
    unittest.main()
