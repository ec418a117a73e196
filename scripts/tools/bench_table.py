"""Prints what scripts/tools/bench.sh measured as one Markdown table. Costs are seconds of the processor, and ratios are of one run."""

import json
import math
import os
import platform
from datetime import UTC, datetime
from pathlib import Path

TARGET = Path(os.environ.get("CARGO_TARGET_DIR", Path(__file__).resolve().parents[2] / "target"))
# In the order of the FMU's numbers, from 1.
SOILS = ("dry_sand", "sandy_loam", "clayed_soil", "dry_clay")
NOT_MEASURED = "–"


def processor() -> str:
    """The processor's name as Linux gives it, the number of processors, and the clock."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    found = {key.strip(): value.strip() for key, _, value in (line.partition(":") for line in lines)}
    return f"{found.get('model name', platform.machine())}, {os.cpu_count()} processors, {float(found.get('cpu MHz', 0)):.0f} MHz"


def figures(value: float, unit: str = "") -> str:
    """Three significant figures, without an exponent."""
    digits = max(0, 2 - math.floor(math.log10(abs(value)))) if value else 0
    rounded = round(value, 2 - math.floor(math.log10(abs(value)))) if value else 0.0
    return f"{rounded:.{digits}f}{unit and ' ' + unit}"


def pose(end: list[float]) -> str:
    """Final position and heading."""
    x, y, heading = end
    return f"{x:.3f}, {y:.3f}, {heading:.4f}"


class Table:
    """Rows of a name and one cell for each soil, or one for all of them."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def head(self, name: str) -> None:
        """Names the rows that follow."""
        self.lines.append(f"| **{name}** |" + " |" * len(SOILS))

    def row(self, name: str, cells: list[str]) -> None:
        """Adds a row; what there is for one soil stands in its column."""
        self.lines.append(f"| {name} | {' | '.join(cells)} |")

    def one(self, name: str, cell: str, soil: str | None = "clayed_soil") -> None:
        """A row with a cell in the column of one soil, or in the first column if it concerns none or all."""
        column = SOILS.index(soil) if soil else 0
        self.row(name, [cell if index == column else "" for index in range(len(SOILS))])


def model_rows(table: Table, model: dict) -> None:
    """Wrench, Jacobian, and derivatives of a drive."""
    of = [model["soils"][soil] for soil in SOILS]
    table.head("the model, in Rust")
    table.row("golden states", [f"{soil['golden_states']:.0f}" for soil in of])
    for name, key in (("wrench of 8 wheels from scratch, mean of the golden states", "wrench"),
                      ("its Jacobian", "jacobian"), ("the wrench from a neighbouring state", "near")):
        table.row(name, [figures(1e6 * soil[key], "us") for soil in of])
    table.row("drive in steps of 100 ms: evaluations of the forces, Jacobians", [f"{s['evaluations']}, {s['jacobians']}" for s in of])
    rates = [model["wheels"] * s["evaluations"] / s["drives"]["100"] for s in of]
    table.row("wheels in balance per second and core (8 × evaluations / time of the drive)", [f"{figures(1e-6 * rate)} × 10^6" for rate in rates])
    table.row(f"drive with derivatives by {of[0]['directions']} parameters and the initial state, ratio to the plain drive",
              [figures(s["derivatives"] / s["drives"]["100"], "×") for s in of])


def fmu_rows(table: Table, fmu: list[dict], model: dict) -> None:
    """The drive through the FMU."""
    seconds = model["drive_seconds"]
    table.head("the drive through the FMU, from C")
    for parts in (0.1, 0.01, 0.001):
        of = [next(f for f in fmu if f["terrain"] == number and math.isclose(f["step"], parts)) for number in range(1, len(SOILS) + 1)]
        steps = f"steps of {1e3 * parts:.0f} ms"
        table.row(f"{steps}: times real time", [figures(seconds / f["drive"]) for f in of])
        table.row(f"{steps}: mean step; worst step", [f"{figures(1e6 * f['mean_step'])}; {figures(1e6 * f['worst_step'], 'us')}" for f in of])
        table.row(f"{steps}: ratio to the same steps in Rust",
                  [figures(f["drive"] / model["soils"][soil]["drives"][f"{1e3 * parts:.0f}"], "×") for soil, f in zip(SOILS, of, strict=True)])
        table.row(f"{steps}: end x [m], y [m], heading [rad]", [pose(f["end"]) for f in of])
    table.row("calls around `doStep` (set, set derivatives, get six outputs)", [figures(1e9 * min(f["calls"] for f in fmu if f["terrain"] == n), "ns") for n in range(1, 5)])
    table.one("peak memory of the C program", figures(max(f["peak_kilobytes"] for f in fmu) / 1024, "MB"), None)


def peer_rows(table: Table, peer: dict, model: dict) -> None:
    """The model in NumPy, as ratios."""
    versions = peer["versions"]
    table.head(f"the same model in NumPy {versions['numpy']} and SciPy {versions['scipy']} (LSODA)")
    pairs = [(peer["soils"][soil], model["soils"][soil]) for soil in SOILS]
    table.row("wrench, ratio", [figures(p["wrench"] / m["wrench"], "×") for p, m in pairs])
    table.row("drive, ratio to steps of 100 ms in Rust",
              [figures(p["drive"] / m["drives"]["100"], "×") if "drive" in p else p["error"] for p, m in pairs])
    table.row("end x [m], y [m], heading [rad]", [pose(p["end"]) if "end" in p else NOT_MEASURED for p, _ in pairs])


def batch_rows(table: Table, batch: dict) -> None:
    """Batches beside one drive after the other."""
    alone, together = batch["alone"], batch["together"]
    members = f"{batch['members']} vehicles on the four soils, {batch['seconds']:.0f} s of the drive each"
    table.head(f"batches: {members}")
    table.one("one after the other: rollouts per second of the processor", figures(batch["members"] / alone["processor"]), None)
    table.one("in a batch: the same", figures(batch["members"] / together["processor"]), None)
    table.one(f"in a batch: speed-up on the clock with {batch['threads']} threads", figures(alone["clock"] / together["clock"], "×"), None)


def effect_rows(table: Table, effects: list[dict]) -> None:
    """Ratios of wrench and drive with effects on."""
    table.head("effects on: wrench; drive, ratios to none")
    for effect in effects:
        memory = f", {effect['memory']} states" if effect["memory"] else ""
        acts = {"": "", "both": " (all)"}.get(effect["acts"], f" ({effect['acts']}{memory})")
        drive = figures(effect["drive"], "×") if effect["drive"] else effect["error"]
        table.one(f"{effect['name'].replace('_', ' ')}{acts}", f"{figures(effect['wrench'], '×')}; {drive}")


def size_rows(table: Table, model: dict) -> None:
    """What bounds the speed."""
    table.head("a wrench by its size")
    for name, key in (("quadrature nodes of a wheel", "nodes"), ("wheel rows", "rows")):
        sizes, costs = zip(*model[key], strict=True)
        table.one(f"{', '.join(map(str, sizes))} {name}", f"{', '.join(figures(1e6 * cost) for cost in costs)} us")
    names, costs = zip(*model["lanes"], strict=True)
    table.one(f"eight lanes of {', '.join(names)}", f"{', '.join(figures(1e9 * cost) for cost in costs)} ns", None)


def main() -> None:
    """Reads the results and prints the table."""
    folder = TARGET / "bench"
    model = json.loads((folder / "model.json").read_text())
    fmu = [json.loads(line) for line in (folder / "fmu.jsonl").read_text().splitlines()]
    peer = json.loads((folder / "numpy.json").read_text())
    table = Table()
    model_rows(table, model)
    fmu_rows(table, fmu, model)
    peer_rows(table, peer, model)
    batch_rows(table, model["batch"])
    effect_rows(table, model["effects"])
    size_rows(table, model)
    print(f"Machine: {processor()}, {platform.system()} {platform.release()}; {datetime.now(UTC):%-d %B %Y}; "
          f"load {os.getloadavg()[2]:.1f} over 15 minutes\n")
    print(f"| what | {' | '.join(SOILS)} |\n|---|{'---|' * len(SOILS)}")
    print("\n".join(table.lines))


if __name__ == "__main__":
    main()
