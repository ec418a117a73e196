"""The importers, where they come from, and what each is made to do."""

import re
import sys
from dataclasses import dataclass
from pathlib import Path

from comparison import FORCES, MOTION

FMI_2, FMI_3 = "2.0", "3.0"
Command = tuple[list[object], dict[str, str]]  # a program with its arguments, and its environment


@dataclass(frozen=True)
class Importer:
    """A Python package and what it needs, pinned in requirements/NAME.txt."""

    name: str
    package: str

    def pinned(self, here: Path) -> str:
        """What determines the installation."""
        return (here / "requirements" / f"{self.name}.txt").read_text()

    def version(self, here: Path) -> str:
        """The importer's version."""
        found = re.search(rf"^{re.escape(self.package)}==(\S+)$", self.pinned(here), re.MULTILINE)
        return found[1] if found else "unknown"

    def install(self, here: Path, folder: Path, target: Path) -> list[Command]:
        """The commands that install it."""
        pip = [folder / "bin" / "python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--only-binary=:all:"]
        return [([sys.executable, "-m", "venv", "--clear", folder], {}), ([*pip, "-r", here / "requirements" / f"{self.name}.txt"], {})]

    def program(self, here: Path, folder: Path) -> list[object]:
        """What drives with it."""
        return [folder / "bin" / "python", here / "drivers" / f"{self.name.replace('-', '_')}_.py"]


@dataclass(frozen=True)
class CargoTool(Importer):
    """A tool from crates.io; bindgen in it needs what scripts/setup.sh installs."""

    release: str

    def pinned(self, here: Path) -> str:
        return f"{self.package} {self.release}"

    def version(self, here: Path) -> str:
        return self.release

    def install(self, here: Path, folder: Path, target: Path) -> list[Command]:
        venv = target / "venv"
        environment = {"LIBCLANG_PATH": venv / "libclang", "CLANG_PATH": venv / "include-finder", "CARGO_TARGET_DIR": folder / "build"}
        command = ["cargo", "install", "--quiet", "--locked", "--version", self.release, "--root", folder, self.package]
        return [(command, {name: str(path) for name, path in environment.items()})]

    def program(self, here: Path, folder: Path) -> list[object]:
        return [sys.executable, here / "drivers" / f"{self.name.replace('-', '_')}_.py", folder / "bin" / self.package]


@dataclass(frozen=True)
class Crate(Importer):
    """A crate, behind a program of ours with a Cargo.lock of its own."""

    def pinned(self, here: Path) -> str:
        crate = here / self.package.replace("-", "_")
        return "\n".join(file.read_text() for file in (crate / "Cargo.lock", crate / "src" / "main.rs"))

    def version(self, here: Path) -> str:
        found = re.search(rf'^name = "{self.package}"\nversion = "([^"]+)"', self.pinned(here), re.MULTILINE)
        return found[1] if found else "unknown"

    def install(self, here: Path, folder: Path, target: Path) -> list[Command]:
        manifest = here / self.package.replace("-", "_") / "Cargo.toml"
        return [(["cargo", "build", "--quiet", "--locked", "--release", "--manifest-path", manifest, "--target-dir", folder], {})]

    def program(self, here: Path, folder: Path) -> list[object]:
        return [folder / "release" / "drive"]


# What may differ from the library, as a share of each output's largest value (or of 1).
SAME_BITS = 0.0
# Steps whose times an importer adds up are off by rounding; the integrator passes that on.
ROUNDING = 1e-11
# The observations of a Gymnasium environment are single precision.
SINGLE = 1e-7
# With another integrator: the library's own error control (5e-4 m/s, 5e-4 rad/s on this drive), and what forces and
# accelerations make of that near a standstill, where they follow the velocity of the slip most steeply.
INTEGRATED = {MOTION: 1e-3, FORCES: 0.1}


@dataclass(frozen=True)
class Run:
    """What an importer is made to do, and what is expected of it."""

    importer: str
    drive: str  # one of the driver's drives
    fmu: str  # version of FMI
    interface: str
    what: str = "all outputs"
    tolerance: float | dict[str, float] = SAME_BITS
    side: str = "end"  # outputs are those at the end of a step, or at the `begin` of the next one, with its inputs
    start: str = "all"  # start values: all, `plain` without the enumeration, or `reals` alone
    first: int = 0  # of the library's rows to compare
    omitted: int = 0  # outputs that it does not read
    fault: str = ""  # how an importer that cannot do it fails (a regular expression)
    wrong_by: float = 0.0  # the deviation that an importer's fault makes at least
    check_only: bool = False  # nothing to compare

    @property
    def name(self) -> str:
        """Names the run's folder."""
        return f"{self.importer}-{self.drive}-{self.fmu}-{self.start}"

    @property
    def allowed(self) -> dict[str, float]:
        """The tolerance of each group of outputs."""
        return self.tolerance if isinstance(self.tolerance, dict) else {MOTION: self.tolerance, FORCES: self.tolerance}


PACKAGES = [
    Importer("fmpy", "FMPy"),
    Importer("ssp", "FMPy"),
    Importer("fmutool", "fmu_manipulation_toolbox"),
    Importer("libcosimpy", "libcosimpy"),
    Importer("fmuloader", "fmuloader"),
    CargoTool("fmi-sim", "fmi-sim", "0.7.0"),
    Crate("fmi-rs", "fmi-rs"),
    Importer("casadi", "casadi"),
    Importer("pathsim-fmi", "pathsim-fmi"),
    Importer("fmugym", "fmugym"),
    Importer("sofirpy", "sofirpy"),
]
IMPORTERS = {importer.name: importer for importer in PACKAGES}

CS_2, CS_3, ME_2, ME_3 = "CS 2.0", "CS 3.0", "ME 2.0", "ME 3.0"
ENUMERATION = "start value of type Enumeration"
ARRAYS = "outputs that are arrays"
IN_ARRAYS = 64  # of the outputs
SCALARS = f"{78 - IN_ARRAYS} outputs that are no arrays"
PLAIN = "all outputs; start values but the enumeration"
REALS = "start values of type Real"

RUNS = [
    Run("fmpy", "cs", FMI_2, CS_2, tolerance=ROUNDING),
    Run("fmpy", "cs", FMI_3, CS_3, tolerance=ROUNDING),
    Run("fmpy", "me", FMI_2, ME_2, tolerance=INTEGRATED, side="begin"),
    Run("fmpy", "me", FMI_3, ME_3, tolerance=INTEGRATED, side="begin"),
    Run("ssp", "cs", FMI_2, CS_2, tolerance=ROUNDING, first=1),
    Run("ssp", "inputs", FMI_2, CS_2, what="inputs as they are given", wrong_by=0.1, first=1),
    Run("ssp", "times", FMI_2, CS_2, what="times as given", wrong_by=0.1),
    Run("fmutool", "check", FMI_2, "2.0", what="`fmutool -check`", check_only=True),
    Run("fmutool", "check", FMI_3, "3.0", what="`fmutool -check`", check_only=True),
    Run("fmutool", "cs", FMI_2, CS_2, what="container of `fmucontainer`, all outputs", tolerance=ROUNDING),
    Run("fmutool", "arrays", FMI_2, CS_2, what="container without a complaint", fault="Cannot expose FMI-2 array aggregate"),
    Run("libcosimpy", "cs", FMI_2, CS_2, what=PLAIN, start="plain", first=1),
    Run("libcosimpy", "enumeration", FMI_2, CS_2, what=ENUMERATION, fault="refuses the start value of terrain"),
    Run("libcosimpy", "enumeration", FMI_3, CS_3, what="any FMU of FMI 3.0", fault=r"exit status -11"),
    Run("fmuloader", "cs", FMI_2, CS_2),
    Run("fmuloader", "cs3", FMI_3, CS_3, what=SCALARS, omitted=IN_ARRAYS),
    Run("fmuloader", "cs3_arrays", FMI_3, CS_3, what=ARRAYS, fault="fmi3GetFloat64 returned ERROR"),
    Run("fmi-sim", "cs", FMI_2, CS_2, tolerance=ROUNDING),
    Run("fmi-sim", "cs", FMI_3, CS_3, what="any variable with a unit", fault='unknown field "unit"'),
    Run("fmi-rs", "cs", FMI_2, CS_2, tolerance=ROUNDING),
    Run("fmi-rs", "cs", FMI_3, CS_3, tolerance=ROUNDING),
    Run("casadi", "me", FMI_2, ME_2, tolerance=INTEGRATED, first=1),
    Run("casadi", "me3", FMI_3, ME_3, what=f"pose and velocities; {REALS}", tolerance=INTEGRATED, start="reals", first=1, omitted=61),
    Run("casadi", "me3", FMI_3, ME_3, what=ENUMERATION, fault="FmuInternal::set_values failed"),
    Run("casadi", "me3", FMI_3, ME_3, what="start value of type Boolean", start="plain", fault="fmu3.cpp:[0-9]+: Broken"),
    Run("casadi", "me3_outputs", FMI_3, ME_3, what=ARRAYS, start="reals", fault="Evaluation failed"),
    Run("pathsim-fmi", "cs", FMI_2, CS_2, tolerance=ROUNDING, first=1),
    Run("pathsim-fmi", "early", FMI_2, CS_2, what="times as given", wrong_by=0.1),
    Run("pathsim-fmi", "me", FMI_2, ME_2, tolerance=INTEGRATED, first=1),
    Run("pathsim-fmi", "enumeration", FMI_2, CS_2, what=ENUMERATION, fault="Unsupported variable type: Enumeration"),
    Run("pathsim-fmi", "cs", FMI_3, CS_3, what=ARRAYS, fault="fmi3GetFloat64 failed"),
    Run("fmugym", "cs", FMI_2, CS_2, what=f"all outputs; {REALS}", start="reals", tolerance=SINGLE),
    Run("fmugym", "cs", FMI_3, CS_3, what=f"{SCALARS}; {REALS}", start="reals", omitted=IN_ARRAYS, tolerance=SINGLE),
    Run("fmugym", "cs_arrays", FMI_3, CS_3, what=ARRAYS, start="reals", fault="fmi3GetFloat64 failed"),
    Run("fmugym", "random", FMI_2, CS_2, what="random start values", start="reals", fault="no attribute 'init_states'"),
    Run("fmugym", "cs", FMI_2, CS_2, what="start values that are not Real", fault="fmi2SetReal failed"),
    Run("sofirpy", "cs", FMI_2, CS_2, tolerance=ROUNDING, side="begin"),
]
