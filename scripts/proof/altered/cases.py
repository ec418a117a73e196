"""What is concealed in which recording, and how it is told whether it was found."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from judge.estimates import overlap

from . import recordings
from .recordings import Table

STEPS = 12  # on each ground
ASPHALT = 100.0  # s


@dataclass(frozen=True)
class Concealed:
    """A number that the change moves, and where to look for it in an answer."""

    effect: str
    parameter: str
    over: str | None  # the parameter that it is divided by
    off: float
    moves: float  # a factor where it is divided by another, a difference otherwise
    unit: str

    def finding(self, said: dict) -> dict | None:
        """What an answer says of the whole recording."""
        return next((f for f in said["findings"] if f["effect"] == self.effect and not f["local"]), None)

    def value(self, said: dict) -> float:
        """What an answer says of the number; what stands for off where it says nothing."""
        parameters = (self.finding(said) or {"parameters": {}})["parameters"]
        told = [parameters.get(name, {"value": self.off})["value"] for name in (self.parameter, self.over) if name]
        return told[0] / told[1] if self.over else told[0]

    def moved(self, before: dict, after: dict) -> float:
        """By how much it moved."""
        first, then = self.value(before), self.value(after)
        return then / first if self.over else then - first


@dataclass(frozen=True)
class Case:
    """A recording to diagnose; a changed one beside what was said of it unchanged."""

    name: str
    what: str
    make: Callable[[Path], list[Table]]  # parts that are driven one after the other
    before: str | None = None
    concealed: Concealed | None = None


LEFT = Concealed("wheel_radius", "left", "right", 1.0, 1 / 0.95, "left over right")
POSE = Concealed("latency", "pose", None, 0.0, 0.3, "s")
GYRO = Concealed("yaw_rate_bias", "bias", None, 0.0, 0.03, "rad/s")
CHANGES = [
    ("left", "left wheel speeds times 0.95", lambda table: recordings.slower_left(table, 0.95), LEFT),
    ("late", "pose 0.3 s later", lambda table: recordings.late_pose(table, 0.3), POSE),
    ("gyro", "yaw rate plus 0.03 rad/s", lambda table: recordings.biased_gyro(table, 0.03), GYRO),
]


def cases() -> list[Case]:
    """All of them; what others are compared with comes first."""
    every = []
    for stem in ("c05", "c07"):
        every.append(Case(stem, f"{stem}, grass, as recorded", lambda data, stem=stem: [Table.read(data, stem)]))
        for name, what, change, concealed in CHANGES:
            def changed(data: Path, stem: str = stem, change: Callable[[Table], Table] = change) -> list[Table]:
                return [change(Table.read(data, stem))]

            every.append(Case(f"{stem}_{name}", f"{stem}, grass, {what}", changed, stem, concealed))
    return [
        *every,
        Case("gravel_sand", f"{STEPS} steps of s08, gravel, then {STEPS} of s11, wet sand",
             lambda data: [Table.read(data, stem).runs(STEPS) for stem in ("s08", "s11")]),
        Case("grass_asphalt", f"c05, grass, then {ASPHALT:.0f} s of driving of c01, asphalt",
             lambda data: [Table.read(data, "c05"), Table.read(data, "c01").driven(ASPHALT)]),
    ]


Stretch = tuple[int, float, float]  # run, start and end [s]


def _line(stretches: list[Stretch]) -> list[tuple[float, float]]:
    """Stretches of all runs on one line."""
    return [(1e6 * run + start, 1e6 * run + end) for run, start, end in stretches]


def located(said: dict, parts: list[list[Stretch]]) -> float | None:
    """Overlap of what is said to be elsewhere or other with one of the parts, the best; None where nothing is."""
    told = [f["where"] for f in said["findings"] if f["kind"] == "physics" and f["where"] and f["local"]]
    lines = [_line([(w.get("run") or 0, w["start"], w["end"]) for w in where]) for where in told]
    return max((overlap(line, _line(part)) for line in lines for part in parts), default=None)
