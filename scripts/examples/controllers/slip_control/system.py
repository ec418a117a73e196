"""The system that is simulated, and its file: driver, controller and vehicle, connected (SSP 1.0)."""

from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

import fmpy

from .blocks import BASE_UNITS, DRIVER, SLIP_CONTROL, build, write_archive

NAMESPACES = {part: f"http://ssp-standard.org/SSP1/SystemStructure{name}" for part, name in
              (("ssd", "Description"), ("ssc", "Common"), ("ssv", "ParameterValues"))}
STEP, STOP = 0.01, 20.0  # s
SAND_FROM = 5.0  # m ahead of the start
NO_LIMIT = 1.0
DRY_SAND = 1  # of the FMU's terrains

# A slope of 3 deg; firm dry sand that gets looser after 5 m (softer by half, less friction), and whose sinkage grows
# with slip: where wheels that spin dig themselves in, and wheels that do not get through.
GROUND = {"effects.grade.slope_east": 0.05, "effects.slip_sinkage.sinkage_growth": 1.0,
          "effects.terrain_change.position": SAND_FROM, "effects.terrain_change.friction_factor": 0.8,
          "effects.terrain_change.stiffness_factor": 0.5}
DEMAND = {"speed": 1.5, "acceleration": 0.5}  # m/s, m/s^2; straight ahead


@dataclass(frozen=True)
class Component:
    """An FMU of the system: its connectors that are used, and parameters other than its own starts."""

    name: str
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    integers: dict[str, int] = field(default_factory=dict)
    reals: dict[str, float] = field(default_factory=dict)

    @property
    def source(self) -> str:
        """The FMU in the archive."""
        return f"resources/{self.name}.fmu"


UGV_OUTPUTS = ("x", "y", "heading", "v_x", "yaw_rate", "wheel[1].longitudinal_slip", "wheel[2].longitudinal_slip", "wheel[1].sinkage")
CONNECTIONS = (
    ("driver.speed_demand", "slip_control.speed_demand"), ("driver.yaw_rate_demand", "slip_control.yaw_rate_demand"),
    ("slip_control.omega_left", "ugv.omega_left"), ("slip_control.omega_right", "ugv.omega_right"),
    ("ugv.v_x", "slip_control.v_x"), ("ugv.yaw_rate", "slip_control.yaw_rate"),
)  # fmt: skip


@dataclass(frozen=True)
class Setting:
    """What is set in the system's FMUs."""

    slip_limit: float
    ground: dict[str, float] = field(default_factory=lambda: GROUND)
    demand: dict[str, float] = field(default_factory=lambda: DEMAND)


def components(setting: Setting, ugv: Path) -> tuple[Component, ...]:
    """The FMUs, left to right, with everything that is set."""
    # The terrain is an enumeration, which some tools do not set: it stays out for an FMU that starts with dry sand.
    starts = {v.name: v.start for v in fmpy.read_model_description(str(ugv)).modelVariables}
    terrain = {} if int(starts["terrain"]) == DRY_SAND else {"terrain": DRY_SAND}
    return (
        Component("driver", outputs=("speed_demand", "yaw_rate_demand"), reals=setting.demand),
        Component("slip_control", ("speed_demand", "yaw_rate_demand", "v_x", "yaw_rate"), ("omega_left", "omega_right"),
                  reals={"slip_limit": setting.slip_limit}),
        Component("ugv", ("omega_left", "omega_right"), UGV_OUTPUTS, terrain, setting.ground),
    )  # fmt: skip


def split(connector: str) -> tuple[str, str]:
    """Component and variable of `component.variable`."""
    component, _, variable = connector.partition(".")
    return component, variable


def units(fmu: Path) -> dict[str, str]:
    """Units of an FMU's variables by name."""
    return {v.name: v.unit or "1" for v in fmpy.read_model_description(str(fmu)).modelVariables}


def add_connectors(element: ElementTree.Element, component: Component, unit: dict[str, str]) -> None:
    """Connectors: inputs down the left edge, outputs down the right one."""
    connectors = ElementTree.SubElement(element, "ssd:Connectors")
    for kind, names, x in (("input", component.inputs, 0.0), ("output", component.outputs, 1.0)):
        for place, name in enumerate(names, start=1):
            connector = ElementTree.SubElement(connectors, "ssd:Connector", name=name, kind=kind)
            ElementTree.SubElement(connector, "ssc:Real", unit=unit[name])
            ElementTree.SubElement(connector, "ssd:ConnectorGeometry", x=str(x), y=str(round(1 - place / (len(names) + 1), 3)))


def add_parameters(element: ElementTree.Element, component: Component, unit: dict[str, str]) -> None:
    """Start values, in the structure itself."""
    binding = ElementTree.SubElement(ElementTree.SubElement(element, "ssd:ParameterBindings"), "ssd:ParameterBinding")
    values = ElementTree.SubElement(binding, "ssd:ParameterValues")
    given = ElementTree.SubElement(values, "ssv:ParameterSet", version="1.0", name="initialValues")
    parameters = ElementTree.SubElement(given, "ssv:Parameters")
    for name, number in component.integers.items():
        ElementTree.SubElement(ElementTree.SubElement(parameters, "ssv:Parameter", name=name), "ssv:Integer", value=str(number))
    for name, value in component.reals.items():
        parameter = ElementTree.SubElement(parameters, "ssv:Parameter", name=name)
        ElementTree.SubElement(parameter, "ssv:Real", value=repr(float(value)), unit=unit[name])


def structure(parts: tuple[Component, ...], fmus: dict[str, Path]) -> bytes:
    """SystemStructure.ssd."""
    spaces = {f"xmlns:{part}": space for part, space in NAMESPACES.items()}
    root = ElementTree.Element("ssd:SystemStructureDescription", spaces, version="1.0", name="Slip-limited speed control")
    system = ElementTree.SubElement(root, "ssd:System", name="system")
    elements, used = ElementTree.SubElement(system, "ssd:Elements"), set()
    for place, component in enumerate(parts):
        unit = units(fmus[component.name])
        element = ElementTree.SubElement(elements, "ssd:Component", name=component.name, source=component.source,
                                         type="application/x-fmu-sharedlibrary")
        add_connectors(element, component, unit)
        corners = {"x1": 50 * place, "y1": 0, "x2": 50 * place + 30, "y2": 40}
        ElementTree.SubElement(element, "ssd:ElementGeometry", {key: f"{value}.0" for key, value in corners.items()})
        add_parameters(element, component, unit)
        used |= {unit[name] for name in (*component.inputs, *component.outputs, *component.reals)}
    connections = ElementTree.SubElement(system, "ssd:Connections")
    for start, end in CONNECTIONS:
        (from_element, from_name), (to_element, to_name) = split(start), split(end)
        ElementTree.SubElement(connections, "ssd:Connection", startElement=from_element, startConnector=from_name,
                               endElement=to_element, endConnector=to_name)
    known = ElementTree.SubElement(root, "ssd:Units")
    for name in sorted(used):
        unit = ElementTree.SubElement(known, "ssc:Unit", name=name)
        ElementTree.SubElement(unit, "ssc:BaseUnit", {base: str(power) for base, power in BASE_UNITS[name].items()})
    ElementTree.SubElement(root, "ssd:DefaultExperiment", startTime="0.0", stopTime=str(STOP))
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)


def build_ssp(path: Path, ugv: Path, setting: Setting) -> None:
    """Compiles the blocks and writes the system to `path`."""
    fmus = {"ugv": ugv}
    for block in (DRIVER, SLIP_CONTROL):
        fmus[block.name] = path.parent / f"{block.name}.fmu"
        build(block, fmus[block.name])
    parts = components(setting, ugv)
    files = {"SystemStructure.ssd": structure(parts, fmus)}
    write_archive(path, files | {part.source: fmus[part.name].read_bytes() for part in parts})
