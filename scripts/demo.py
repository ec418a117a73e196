#!/usr/bin/env python3
"""Drives target/ugv.fmu through fmpy as the paper does, and leaves target/demo/index.html.

The manoeuvre is of the kind of Fig. 3 in T. H. Tran, N. M. Kwok, S. Scheding, Q. P. Ha, "Dynamic
Modelling of Wheel-Terrain Interaction of a UGV", IEEE CASE 2007: straight ahead from rest, then a
right turn, on four terrains with the same wheel speeds. What the paper finds is checked one by one.
"""

import argparse
import html
import io
import re
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import path_follower
from path_follower import TERRAINS, running

# Wheel speeds, linear in between: time [s], left [rad/s], right [rad/s].
TURN, SETTLED, END = 4.0, 5.0, 6.0
MANOEUVRE = np.array([(0, 0, 0), (TURN, 12, 12), (SETTLED, 12, 5), (END, 12, 5)], dtype=float)
STEP = 0.02  # s
STARTED = 0.2  # s from which on the resistances are compared: the wheels roll by then

LABELS = {
    "dry_sand": "Dry sand",
    "sandy_loam": "Sandy loam",
    "clayed_soil": "Clayed soil",
    "dry_clay": "Dry clay",
}
# Readable on white and on black.
COLORS = {
    "dry_sand": "#d97706",
    "sandy_loam": "#0d9f6e",
    "clayed_soil": "#3b82f6",
    "dry_clay": "#d946a6",
}
INK = "#0f0e0d"  # stands for the text colour, which the page chooses
STYLE = {
    "svg.hashsalt": "ugv",
    "font.size": 10,
    "text.color": INK,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.titlesize": 10.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#888888",
    "grid.alpha": 0.25,
    "xtick.color": INK,
    "ytick.color": INK,
    "legend.frameon": False,
    "lines.linewidth": 1.8,
}
OUTPUTS = {
    "x": "x",
    "y": "y",
    "heading": "heading",
    "v_x": "v_x",
    "resistance": "rolling_resistance",
    "turning_resistance": "turning_resistance_moment",
    "turning_moment": "turning_moment",
    # The slip ratio (13) is the same for all wheels of a side; 1 is the front left, 2 the front right.
    "slip_left": "wheel[1].longitudinal_slip",
    "slip_right": "wheel[2].longitudinal_slip",
}


@dataclass
class Drive:
    """One drive: the recorded outputs by their names in OUTPUTS, and how long it took."""

    time: np.ndarray
    values: dict[str, np.ndarray]
    seconds: float  # spent in the FMU and in fmpy

    def __getitem__(self, name: str) -> np.ndarray:
        return self.values[name]

    @property
    def distance(self) -> float:
        """Length of the path [m]."""
        return float(np.sum(np.hypot(np.diff(self["x"]), np.diff(self["y"]))))

    @property
    def settled(self) -> np.ndarray:
        """The samples in the turn after the wheel speeds have stopped changing."""
        return self.time >= SETTLED


@dataclass
class Finding:
    """A statement of the paper, whether it holds here, and the numbers that say so."""

    statement: str
    holds: bool
    evidence: str


def wheel_speeds() -> tuple[np.ndarray, np.ndarray]:
    """The samples' times [s], and the wheel speeds there [rad/s], a row per sample."""
    samples = np.linspace(0.0, END, round(END / STEP) + 1)
    sides = [np.interp(samples, MANOEUVRE[:, 0], MANOEUVRE[:, side]) for side in (1, 2)]
    return samples, np.stack(sides, axis=1)


def drive(fmu: Path, terrain: str) -> Drive:
    """Drives the manoeuvre on one terrain, from rest.

    fmpy's simulate_fmu would do, but for its option set_input_derivatives, which fails with two
    inputs (FMPy 0.3.32) and takes each step's slope from the one before: so the loop is here.
    """
    samples, omega = wheel_speeds()
    slopes = np.diff(omega, axis=0) / STEP
    with running(fmu, terrain) as (slave, reference):
        inputs = [reference["omega_left"], reference["omega_right"]]
        outputs = [reference[name] for name in OUTPUTS.values()]
        start = time.perf_counter()
        rows = [slave.getReal(outputs)]
        for now, speeds, slope in zip(samples, omega, slopes, strict=False):
            slave.setReal(inputs, speeds)
            slave.setRealInputDerivatives(inputs, [1, 1], slope)
            slave.doStep(now, STEP)
            rows.append(slave.getReal(outputs))
        seconds = time.perf_counter() - start
    return Drive(samples, dict(zip(OUTPUTS, np.transpose(rows), strict=True)), seconds)


def no_slip(fmu: Path) -> Drive:
    """The path of wheels that roll without slip: the theoretical one of the paper."""
    with running(fmu, "dry_clay") as (slave, reference):
        parameters = [reference[f"vehicle.{name}"] for name in ("wheel_radius", "half_track")]
        radius, half_track = slave.getReal(parameters)
    samples, omega = wheel_speeds()
    speed = radius * omega.mean(axis=1)
    heading = integral(radius * (omega[:, 1] - omega[:, 0]) / (2 * half_track))
    x, y = integral(speed * np.cos(heading)), integral(speed * np.sin(heading))
    return Drive(samples, {"x": x, "y": y, "heading": heading}, 0.0)


def integral(rate: np.ndarray) -> np.ndarray:
    """From the first sample to each, by the trapezoidal rule."""
    return np.concatenate([[0.0], np.cumsum((rate[1:] + rate[:-1]) * STEP / 2)])


def mean(values: np.ndarray) -> float:
    """The mean magnitude."""
    return float(np.mean(np.abs(values)))


def check(drives: dict[str, Drive], ideal: Drive) -> list[Finding]:
    """The paper's findings on these drives."""
    now = ideal.time
    at_turn = int(np.argmax(now >= TURN))

    def each(form: str, values: dict[str, float]) -> str:
        return ", ".join(f"{LABELS[name].lower()} {value:{form}}" for name, value in values.items())

    def ascending(order: list[str], output: str, since: float) -> bool:
        curves = [np.abs(drives[name][output])[now >= since] for name in order]
        return all(np.all(curves[k] < curves[k + 1]) for k in range(len(curves) - 1))

    by_rolling = ["dry_clay", "clayed_soil", "sandy_loam", "dry_sand"]
    by_turning = ["dry_clay", "sandy_loam", "clayed_soil", "dry_sand"]
    by_distance = ["sandy_loam", "clayed_soil", "dry_clay", "dry_sand"]
    distance = {name: drives[name].distance for name in by_distance}
    rolling = {name: mean(drives[name]["resistance"][now >= STARTED]) for name in by_rolling}
    moment = {name: mean(drives[name]["turning_resistance"][now >= SETTLED]) for name in by_turning}
    straight, turn = (now >= 1.0) & (now < TURN), now >= SETTLED
    rise, lowest, shrunk, growth = {}, {}, {}, {}
    for name, d in drives.items():
        rise[name] = 100 * (mean(d["resistance"][turn]) / mean(d["resistance"][straight]) - 1)
        lowest[name] = 100 * d["slip_right"][at_turn:].min()
        shrunk[name] = 100 * (abs(d["slip_right"][-1]) - abs(d["slip_right"][at_turn]))
        growth[name] = 100 * (d["slip_left"][-1] - d["slip_left"][at_turn])
    return [
        Finding(
            "All running distances fall short of the one without slip.",
            max(distance.values()) < ideal.distance,
            f"{each('.2f', distance)} m; without slip {ideal.distance:.2f} m",
        ),
        Finding(
            "The distances decrease from dry sand over dry clay and clayed soil to sandy loam. "
            "(Here as there this depends on the manoeuvre: straight ahead sand slips least, in a "
            "turn clay, so that a longer turn puts clay first.)",
            sorted(distance, key=distance.__getitem__) == by_distance,
            f"{each('.2f', distance)} m",
        ),
        Finding(
            "In the turn the inner wheels' slip shrinks in magnitude ...",
            max(shrunk.values()) < 0,
            f"change from the begin to the end of the turn: {each('+.0f', shrunk)} points",
        ),
        Finding(
            "... and changes sign.",
            max(lowest.values()) < 0,
            f"positive before it, and at its lowest: {each('.0f', lowest)} %",
        ),
        Finding(
            "The outer wheels' slip grows in the turn, most on dry sand.",
            min(growth.values()) > 0 and max(growth, key=growth.__getitem__) == "dry_sand",
            f"by {each('.0f', growth)} points",
        ),
        Finding(
            "Rolling resistance: dry clay < clayed soil < sandy loam < dry sand.",
            ascending(by_rolling, "resistance", STARTED),
            f"at every instant; mean {each('.0f', rolling)} N",
        ),
        Finding(
            "It slightly increases when turning.",
            0 < min(rise.values()) and max(rise.values()) < 5,
            f"by {each('.1f', rise)} %",
        ),
        Finding(
            "Turning resistance moment: dry clay < sandy loam < clayed soil < dry sand.",
            ascending(by_turning, "turning_resistance", SETTLED),
            f"at every instant of the settled turn; mean {each('.0f', moment)} N m",
        ),
    ]


def draw_wheel_speeds(axes: Axes, drives: dict[str, Drive], ideal: Drive) -> None:
    """The input, the same on every terrain."""
    for side, line, label in ((1, "-", "left (outer)"), (2, "--", "right (inner)")):
        axes.plot(MANOEUVRE[:, 0], MANOEUVRE[:, side], line, color="#888888", label=label)
    axes.set(ylabel="rad/s", ylim=(0, None))
    axes.legend(loc="upper left")


def draw_paths(axes: Axes, drives: dict[str, Drive], ideal: Drive) -> None:
    """Fig. 3(a)."""
    axes.plot(ideal["x"], ideal["y"], ":", color="#888888", label="without slip")
    for name, d in drives.items():
        axes.plot(d["x"], d["y"], color=COLORS[name])
        axes.plot(d["x"][-1], d["y"][-1], "o", markersize=4, color=COLORS[name])
    axes.set(xlabel="East (m)", ylabel="North (m)", aspect="equal")
    axes.legend(loc="lower left")


def draw_slips(axes: Axes, drives: dict[str, Drive], ideal: Drive) -> None:
    """Fig. 3(b)."""
    for name, d in drives.items():
        axes.plot(d.time, 100 * d["slip_left"], color=COLORS[name])
        axes.plot(d.time, 100 * d["slip_right"], "--", color=COLORS[name])
    for line, label in (("-", "left (outer)"), ("--", "right (inner)")):
        axes.plot([], [], line, color="#888888", label=label)
    axes.set(ylabel="%")
    axes.legend(loc="lower left")


def draw_rolling_resistance(axes: Axes, drives: dict[str, Drive], ideal: Drive) -> None:
    """Fig. 3(c)."""
    for name, d in drives.items():
        axes.plot(d.time, d["resistance"], color=COLORS[name])
    axes.set(ylabel="N", ylim=(0, None))


def draw_turning_resistance(axes: Axes, drives: dict[str, Drive], ideal: Drive) -> None:
    """Fig. 3(d)."""
    for name, d in drives.items():
        axes.plot(d.time, np.abs(d["turning_resistance"]), color=COLORS[name])
    axes.set(ylabel="N m", ylim=(0, None))


def draw_turning_moment(axes: Axes, drives: dict[str, Drive], ideal: Drive) -> None:
    """What turns the vehicle against that resistance; to the right, as the turn."""
    for name, d in drives.items():
        axes.plot(d.time, -d["turning_moment"], color=COLORS[name])
    axes.set(ylabel="N m")


PANELS = {
    "paths": ("Paths", draw_paths),
    "slips": ("Longitudinal slip ratio", draw_slips),
    "rolling_resistance": ("Rolling resistance", draw_rolling_resistance),
    "turning_resistance": ("Moment of turning resistance, magnitude", draw_turning_resistance),
    "turning_moment": ("Turning moment of the thrust, to the right", draw_turning_moment),
    "wheel_speeds": ("Wheel speeds, the input", draw_wheel_speeds),
}


def draw(names: list[str], drives: dict[str, Drive], ideal: Drive) -> Figure:
    """A picture of the named panels, two in a row, below one legend."""
    columns = min(len(names), 2)
    rows = -(-len(names) // columns)
    figure = Figure(figsize=(4.8 * columns, 0.4 + 3.1 * rows), layout="constrained")
    for position, name in enumerate(names, start=1):
        axes = figure.add_subplot(rows, columns, position)
        title, panel = PANELS[name]
        panel(axes, drives, ideal)
        axes.set_title(title)
        if name != "paths":
            axes.set(xlim=(0, END))
            axes.set_xlabel("Time (s)")
    axes = figure.axes[0]
    lines = [axes.plot([], [], color=COLORS[name], label=LABELS[name])[0] for name in drives]
    if names != ["wheel_speeds"]:
        figure.legend(handles=lines, loc="outside upper center", ncols=len(lines), columnspacing=1)
    return figure


def as_svg(figure: Figure, name: str) -> str:
    """The picture as an SVG element that takes the colour of the text around it."""
    buffer = io.StringIO()
    metadata = {"Date": None, "Creator": None}
    figure.savefig(buffer, format="svg", transparent=True, metadata=metadata)
    svg = buffer.getvalue().replace(INK, "currentColor")
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r'<svg([^>]*?) width="[^"]*"', r"<svg\1", svg, count=1)
    svg = re.sub(r'<svg([^>]*?) height="[^"]*"', r"<svg\1", svg, count=1)
    # Several of them share one page, so their ids must differ.
    return re.sub(r'( id="|href="#|url\(#)', rf"\g<1>{name}-", svg)


def standalone(svg: str) -> str:
    """The SVG element as a file: with colours of its own, by the viewer's scheme."""
    style = (
        "<style>svg{color:#1f2328;background:#fff}"
        "@media(prefers-color-scheme:dark){svg{color:#e6edf3;background:#0d1117}}</style>"
    )
    end_of_tag = svg.index(">") + 1
    return svg[:end_of_tag] + style + svg[end_of_tag:]


def summary(drives: dict[str, Drive], ideal: Drive) -> list[list[str]]:
    """The table: a heading, then a row per terrain."""
    table = [
        [
            "Terrain",
            "Distance",
            "of that without slip",
            "Final heading",
            "Mean rolling resistance",
            "Largest turning resistance",
            "Slip in the turn, inner",
            "outer",
            "Times real time",
        ]
    ]
    for name, d in drives.items():
        turn = d.time >= SETTLED
        table.append(
            [
                LABELS[name],
                f"{d.distance:.2f} m",
                f"{100 * d.distance / ideal.distance:.0f} %",
                f"{np.degrees(d['heading'][-1]):.0f} deg",
                f"{mean(d['resistance'][d.time >= STARTED]):.0f} N",
                f"{np.abs(d['turning_resistance']).max():.0f} N m",
                f"{100 * d['slip_right'][turn].mean():.0f} %",
                f"{100 * d['slip_left'][turn].mean():.0f} %",
                f"{END / d.seconds:.0f}",
            ]
        )
    return table


PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>A skid-steer vehicle on four soils</title>
<style>
:root { color-scheme: light dark; --back: #fff; --text: #1f2328; --line: #8885; --good: #14804a; --bad: #c62828; }
@media (prefers-color-scheme: dark) {
  :root { --back: #0d1117; --text: #e6edf3; --good: #4ac98a; --bad: #ff7b72; }
}
body { font: 16px/1.5 system-ui, sans-serif; color: var(--text); background: var(--back);
  max-width: 68rem; margin: 0 auto; padding: 1rem; }
h1 { line-height: 1.2; }
p, li { max-width: 46rem; }
figure { margin: 0; min-width: 0; }
svg { width: 100%; height: auto; display: block; }
.panels { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 26rem), 1fr)); gap: 1.5rem; }
.table { overflow-x: auto; }
table { border-collapse: collapse; font-size: 0.9rem; }
th, td { border-bottom: 1px solid var(--line); padding: 0.3rem 0.6rem; text-align: right; vertical-align: bottom; }
th:first-child, td:first-child { text-align: left; }
td { white-space: nowrap; }
.eight { max-width: 36rem; }
.findings { list-style: none; padding: 0; }
.findings li { margin-bottom: 0.6rem; }
.findings small { display: block; opacity: 0.8; }
.holds { color: var(--good); }
.fails { color: var(--bad); }
pre { overflow-x: auto; border: 1px solid var(--line); padding: 0.6rem; }
</style>
</head>
<body>
<h1>A skid-steer vehicle on four soils</h1>
<p>The FMU <code>ugv.fmu</code>, driven through fmpy along the kind of manoeuvre that Tran, Kwok, Scheding and Ha
show in Fig.&nbsp;3 of &ldquo;Dynamic Modelling of Wheel-Terrain Interaction of a UGV&rdquo; (IEEE CASE 2007): from rest
straight ahead, up to 12 rad/s in {turn:g} s; then a right turn, the inner wheels slowing to 5 rad/s within a second.
The wheel speeds are the same on all soils; the vehicle weighs 490 kg and has eight wheels. The paper does not print
its wheel speeds, so shapes and orders are to be compared with it, not values.</p>
<div class="table"><table>
{table}
</table></div>
<p>Without slip: {distance:.2f} m, final heading {heading:.0f} deg. Headings count counter-clockwise from the start;
slips are means from {settled:g} s on. Times real time: with fmpy, set, step and get every {step:g} ms.</p>
<div class="panels">
{panels}
</div>
<h2>What the paper finds</h2>
<p>{holding} of {total} statements hold on this run.</p>
<ul class="findings">
{findings}
</ul>
<h2>A controller outside</h2>
<p><code>scripts/path_follower.py</code> steers the FMU around a figure of eight on dry sand, 20 ms per command,
half a metre beside the path at the start. From {eight_from:g} s on it is {rms:.1f} cm beside the path (RMS),
{largest:.1f} cm at most.</p>
<figure class="eight">{eight}</figure>
<h2>Again, or otherwise</h2>
<pre>./scripts/demo.sh                                # all of this
target/venv/bin/python scripts/demo.py           # only the drives and this page
target/venv/bin/python scripts/path_follower.py --terrain dry_clay --laps 2</pre>
<p>The manoeuvre is the table <code>MANOEUVRE</code> in <code>scripts/demo.py</code>.</p>
</body>
</html>
"""


def page(
    drives: dict[str, Drive],
    ideal: Drive,
    findings: list[Finding],
    pictures: dict[str, str],
    eight: np.ndarray,
) -> str:
    """The page, complete in one file."""
    heading, *rows = summary(drives, ideal)
    table = ["<tr>" + "".join(f"<th>{cell}</th>" for cell in heading) + "</tr>"]
    table += ["<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows]
    items = []
    for finding in findings:
        verdict = ("holds", "Holds") if finding.holds else ("fails", "Does not hold")
        items.append(
            f'<li><b class="{verdict[0]}">{verdict[1]}.</b> {html.escape(finding.statement)}'
            f"<small>{html.escape(finding.evidence)}</small></li>"
        )
    rms, largest = path_follower.errors(eight)
    return PAGE.format(
        turn=TURN,
        settled=SETTLED,
        step=1000 * STEP,
        table="\n".join(table),
        distance=ideal.distance,
        heading=np.degrees(ideal["heading"][-1]),
        panels="\n".join(f"<figure>{pictures[name]}</figure>" for name in PANELS),
        holding=sum(finding.holds for finding in findings),
        total=len(findings),
        findings="\n".join(items),
        eight_from=path_follower.SETTLED,
        rms=100 * rms,
        largest=100 * largest,
        eight=pictures["figure_of_eight"],
    )


def main() -> None:
    """Drives, draws, checks, and prints a line per terrain."""
    target = Path(__file__).resolve().parent.parent / "target"
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    add = parser.add_argument
    add("--fmu", type=Path, default=target / "ugv.fmu", help="default: target/ugv.fmu")
    add("--output", type=Path, default=target / "demo", help="folder (default: target/demo)")
    arguments = parser.parse_args()
    if not arguments.fmu.is_file():
        sys.exit(f"demo: {arguments.fmu} is missing; run ./scripts/package.sh first")
    arguments.output.mkdir(parents=True, exist_ok=True)

    ideal = no_slip(arguments.fmu)
    drives = {terrain: drive(arguments.fmu, terrain) for terrain in TERRAINS}
    for terrain, distance, share, heading, rolling, turning, inner, outer, speed in summary(drives, ideal)[1:]:
        print(
            f"{terrain:<11} {distance} ({share} of {ideal.distance:.2f} m without slip), heading {heading},"
            f" rolling resistance {rolling}, turning resistance up to {turning},"
            f" slip in the turn inner {inner}, outer {outer}, {speed} x real time"
        )
    findings = check(drives, ideal)
    print(f"{sum(f.holds for f in findings)} of {len(findings)} of the paper's findings hold")
    for finding in findings:
        if not finding.holds:
            print(f"does not hold: {finding.statement} ({finding.evidence})")

    eight = path_follower.follow(arguments.fmu, "dry_sand")
    with matplotlib.rc_context(STYLE):
        figures = {name: draw([name], drives, ideal) for name in PANELS}
        figures["demo"] = draw(list(PANELS), drives, ideal)
        figures["figure_of_eight"] = path_follower.draw(eight)
        pictures = {name: as_svg(figure, name) for name, figure in figures.items()}
        for name in ("demo", "figure_of_eight"):
            figures[name].savefig(arguments.output / f"{name}.png", dpi=150)
    for name, svg in pictures.items():
        (arguments.output / f"{name}.svg").write_text(standalone(svg), encoding="utf-8")
    index = arguments.output / "index.html"
    index.write_text(page(drives, ideal, findings, pictures, eight), encoding="utf-8")
    print(f"page: {index}; pictures: {arguments.output}/*.png, *.svg")


if __name__ == "__main__":
    main()
