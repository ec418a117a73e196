"""Two small FMUs for co-simulation written in C: their variables, their description, and their compilation."""

import shutil
import subprocess
import tempfile
import uuid
import zipfile
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import fmpy

HERE = Path(__file__).resolve().parent
HEADERS = Path(fmpy.__file__).parent / "c-code"  # the standard's own
NAMESPACE = uuid.UUID("6f5f4c1e-3c1b-5b1f-9d0c-4a7f0c0a9e55")  # of the blocks' guids
MADE = "2026-11-22T00:00:00Z"  # fixed: the same source gives the same bytes
FLAGS = ["-std=gnu11", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror", "-Wno-unused-parameter",
         "-shared", "-fPIC", "-fvisibility=hidden"]
BASE_UNITS = {"1": {}, "m": {"m": 1}, "s": {"s": 1}, "m/s": {"m": 1, "s": -1}, "m/s2": {"m": 1, "s": -2},
              "rad": {"rad": 1}, "rad/s": {"rad": 1, "s": -1}, "1/s": {"s": -1},
              "N": {"kg": 1, "m": 1, "s": -2}, "N.m": {"kg": 1, "m": 2, "s": -2}}
UNBOUNDED = 1e9  # of values that any number may be


@dataclass(frozen=True)
class Variable:
    """A variable of type Real; its value reference is its place among the block's variables."""

    name: str
    causality: str
    unit: str
    description: str
    start: float = 0.0
    least: float = -UNBOUNDED
    most: float = UNBOUNDED


@dataclass(frozen=True)
class Block:
    """A block: `name`.c and its variables."""

    name: str
    description: str
    variables: tuple[Variable, ...]


SLIP_CONTROL = Block("slip_control", "Speed and yaw rate of a skid-steer vehicle with a limit on the wheels' slip", (
    Variable("speed_demand", "input", "m/s", "Speed ahead that is wanted"),
    Variable("yaw_rate_demand", "input", "rad/s", "Yaw rate that is wanted, counter-clockwise"),
    Variable("v_x", "input", "m/s", "Speed ahead of the vehicle"),
    Variable("yaw_rate", "input", "rad/s", "Yaw rate of the vehicle"),
    Variable("omega_left", "output", "rad/s", "Speed of the left wheels"),
    Variable("omega_right", "output", "rad/s", "Speed of the right wheels"),
    Variable("slip_limit", "parameter", "1", "Longitudinal slip that driving wheels shall not exceed; 1: no limit", 0.2, 0.0, 1.0),
    Variable("creep_speed", "parameter", "m/s", "Wheel speed over ground allowed whatever the slip, to start from rest", 0.1, 0.0),
    Variable("gain", "parameter", "1", "Wheel speed for each m/s that a side is too slow", 0.5, 0.0),
    Variable("integral_gain", "parameter", "1/s", "The same, growing with time", 1.0, 0.0),
    Variable("omega_limit", "parameter", "rad/s", "Largest wheel speed", 20.0, 0.0),
    Variable("wheel_radius", "parameter", "m", "Radius of the wheels", 0.25, 1e-3),
    Variable("half_track", "parameter", "m", "Half the distance between left and right wheels", 0.61, 0.0),
    Variable("integral_left", "local", "m/s", "What the left wheels' integral adds"),
    Variable("integral_right", "local", "m/s", "What the right wheels' integral adds"),
))  # fmt: skip
DRIVER = Block("driver", "A driver who wants some speed, and later a turn", (
    Variable("speed_demand", "output", "m/s", "Speed ahead that is wanted"),
    Variable("yaw_rate_demand", "output", "rad/s", "Yaw rate that is wanted, counter-clockwise"),
    Variable("speed", "parameter", "m/s", "Speed that is wanted in the end", 1.5),
    Variable("acceleration", "parameter", "m/s2", "Rise of the speed that is wanted", 0.5, 0.0),
    Variable("turn_rate", "parameter", "rad/s", "Yaw rate that is wanted during the turn"),
    Variable("turn_from", "parameter", "s", "Begin of the turn"),
    Variable("turn_until", "parameter", "s", "End of the turn"),
))  # fmt: skip


def header(block: Block, guid: str) -> str:
    """variables.h: the names of a block's variables as indices, its starts and bounds."""
    def column(field: str) -> str:
        return ", ".join(repr(float(getattr(v, field))) for v in block.variables)

    names = ", ".join(v.name for v in block.variables)
    arrays = [f"static const double {array}[] __attribute__((unused)) = {{{column(field)}}};"
              for array, field in (("STARTS", "start"), ("LEAST", "least"), ("MOST", "most"))]
    return "\n".join([f'#define GUID "{guid}"', f"enum {{{names}, VARIABLES}};", *arrays, ""])


def description(block: Block, guid: str) -> bytes:
    """modelDescription.xml."""
    root = ElementTree.Element("fmiModelDescription", fmiVersion="2.0", modelName=block.name, guid=guid,
                               description=block.description, generationDateAndTime=MADE)
    ElementTree.SubElement(root, "CoSimulation", modelIdentifier=block.name, canHandleVariableCommunicationStepSize="true",
                           canNotUseMemoryManagementFunctions="true", canGetAndSetFMUstate="true")
    units = ElementTree.SubElement(root, "UnitDefinitions")
    for name in dict.fromkeys(v.unit for v in block.variables):
        unit = ElementTree.SubElement(units, "Unit", name=name)
        ElementTree.SubElement(unit, "BaseUnit", {base: str(power) for base, power in BASE_UNITS[name].items()})
    categories = ElementTree.SubElement(root, "LogCategories")
    ElementTree.SubElement(categories, "Category", name="logStatusError")
    variables = ElementTree.SubElement(root, "ModelVariables")
    for reference, v in enumerate(block.variables):
        kind = {"parameter": {"variability": "fixed"}, "output": {"initial": "exact"}, "local": {"initial": "exact"}}
        # A block speaks at the end of a step; between steps nothing of it changes.
        changes = {"variability": "discrete"} if v.causality in ("output", "local") else {}
        scalar = ElementTree.SubElement(variables, "ScalarVariable", name=v.name, valueReference=str(reference),
                                        description=v.description, causality=v.causality,
                                        **kind.get(v.causality, {}), **changes)
        bounds = {"min": v.least} if v.least > -UNBOUNDED else {}
        bounds |= {"max": v.most} if v.most < UNBOUNDED else {}
        ElementTree.SubElement(scalar, "Real", {key: repr(float(value)) for key, value in bounds.items()},
                               unit=v.unit, start=repr(float(v.start)))
    structure = ElementTree.SubElement(root, "ModelStructure")
    outputs = ElementTree.SubElement(structure, "Outputs")
    for index, v in enumerate(block.variables, start=1):
        if v.causality == "output":
            ElementTree.SubElement(outputs, "Unknown", index=str(index), dependencies="")
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)


def compile_block(block: Block, guid: str, library: Path) -> None:
    """Compiles a block's shared library."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if not compiler:
        raise SystemExit("slip_control: no C compiler; install one (Debian: apt-get install gcc libc6-dev)")
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "variables.h").write_text(header(block, guid), encoding="ascii")
        sources = [str(HERE / "block.c"), str(HERE / f"{block.name}.c")]
        command = [compiler, *FLAGS, f"-I{folder}", f"-I{HEADERS}", *sources, "-o", str(library), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"slip_control: {block.name}.c does not compile:\n{done.stderr}")


def build(block: Block, path: Path) -> None:
    """Writes a block's FMU for this platform."""
    sources = [(HERE / name).read_text() for name in ("block.c", "block.h", f"{block.name}.c")]
    guid = str(uuid.uuid5(NAMESPACE, repr(block) + "".join(sources)))
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / f"{block.name}{fmpy.sharedLibraryExtension}"
        compile_block(block, guid, library)
        files = {"modelDescription.xml": description(block, guid), f"binaries/{fmpy.platform}/{library.name}": library.read_bytes()}
    write_archive(path, files)


def write_archive(path: Path, files: dict[str, bytes]) -> None:
    """Writes a ZIP archive beside `path`, then renames it."""
    part = path.with_name(path.name + ".part")
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name, (2026, 11, 22, 0, 0, 0)), content, zipfile.ZIP_DEFLATED)
    part.replace(path)
