"""The importers, where they come from, and what each is made to do."""

import re
import sys
from dataclasses import dataclass
from pathlib import Path

FMI_2, FMI_3 = "2.0", "3.0"
SAME_BITS = 0.0
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
        return [([sys.executable, "-m", "venv", folder], {}), ([*pip, "-r", here / "requirements" / f"{self.name}.txt"], {})]

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


@dataclass(frozen=True)
class Run:
    """What an importer is made to do, and what is expected of it."""

    importer: str
    drive: str  # one of the driver's drives
    fmu: str  # version of FMI
    interface: str
    what: str = "all outputs"
    tolerance: float = SAME_BITS
    why: str = ""  # the tolerance's reason
    side: str = "end"  # whether outputs are read at the end of a step, or after the inputs of the next one are set
    start: str = "all"  # start values: all, `plain` without the enumeration, or `reals` alone
    first: int = 0  # of the library's rows to compare
    omitted: int = 0  # outputs that it does not read
    fault: str = ""  # what an importer that cannot do it says (a regular expression)
    check_only: bool = False  # nothing to compare

    @property
    def name(self) -> str:
        """Names the run's folder."""
        return f"{self.importer}-{self.drive}-{self.fmu}"


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

RUNS = [
    Run("fmpy", "cs", FMI_2, "CS 2.0"),
    Run("fmpy", "cs", FMI_3, "CS 3.0"),
    Run("fmpy", "me", FMI_2, "ME 2.0", tolerance=1e-3),
    Run("fmpy", "me", FMI_3, "ME 3.0", tolerance=1e-3),
    Run("ssp", "cs", FMI_2, "CS 2.0"),
    Run("fmutool", "check", FMI_2, "2.0", what="`fmutool -check`", check_only=True),
    Run("fmutool", "check", FMI_3, "3.0", what="`fmutool -check`", check_only=True),
    Run("fmutool", "cs", FMI_2, "CS 2.0", what="container"),
    Run("libcosimpy", "cs", FMI_2, "CS 2.0", start="plain", first=1),
    Run("libcosimpy", "enumeration", FMI_2, "CS 2.0", what="a start value of type Enumeration", fault="refuses the start value of terrain"),
    Run("fmuloader", "cs", FMI_2, "CS 2.0"),
    Run("fmuloader", "cs3", FMI_3, "CS 3.0", omitted=56),
    Run("fmuloader", "cs3_arrays", FMI_3, "CS 3.0", what="arrays", fault="."),
    Run("fmi-sim", "cs", FMI_2, "CS 2.0"),
    Run("fmi-sim", "cs", FMI_3, "CS 3.0"),
    Run("fmi-rs", "cs", FMI_2, "CS 2.0"),
    Run("fmi-rs", "cs", FMI_3, "CS 3.0"),
    Run("casadi", "me", FMI_2, "ME 2.0", tolerance=1e-3, first=1),
    Run("casadi", "me3", FMI_3, "ME 3.0", tolerance=1e-3, first=1),
    Run("casadi", "me3_outputs", FMI_3, "ME 3.0", what="arrays", fault="."),
    Run("pathsim-fmi", "cs", FMI_2, "CS 2.0"),
    Run("pathsim-fmi", "cs", FMI_3, "CS 3.0"),
    Run("pathsim-fmi", "me", FMI_2, "ME 2.0", tolerance=1e-3),
    Run("pathsim-fmi", "enumeration", FMI_2, "CS 2.0", what="a start value of type Enumeration", fault="Unsupported variable type: Enumeration"),
    Run("fmugym", "cs", FMI_2, "CS 2.0", start="reals", tolerance=1e-7),
    Run("fmugym", "cs", FMI_3, "CS 3.0", start="reals", omitted=56, tolerance=1e-7),
    Run("fmugym", "cs_arrays", FMI_3, "CS 3.0", what="arrays", start="reals", fault="."),
    Run("fmugym", "random", FMI_2, "CS 2.0", what="random start values", start="reals", fault="init_states"),
    Run("sofirpy", "cs", FMI_2, "CS 2.0", side="begin"),
]
