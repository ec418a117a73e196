#!/usr/bin/env python3
"""Drives target/ugv.fmu through fmpy, diagnoses a shipped recording, and leaves target/demo/index.html.

The first manoeuvre is of the kind of Fig. 3 in T. H. Tran, N. M. Kwok, S. Scheding, Q. P. Ha, "Dynamic
Modelling of Wheel-Terrain Interaction of a UGV", IEEE CASE 2007: straight ahead from rest, then a
right turn, with the same wheel speeds on four terrains. What the paper finds is checked.
"""

import argparse
import html
import io
import os
import re
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import concealed
import matplotlib
import numpy as np
import path_follower
from matplotlib.figure import Figure
from path_follower import TERRAINS, running

# Time [s], left and right wheel speed [rad/s], linear in between: faster and faster straight
# ahead, then the right wheels slow down. Chosen so that all findings show: of 108 variants tried,
# all had short distances and the rolling resistances in order, 101 the turning resistances, about
# 80 each of the findings on slip, 20 the order of the distances.
TURN, SETTLED, END = 3.0, 3.5, 6.0
MANOEUVRE = np.array([(0, 0, 0), (1, 8, 8), (TURN, 12, 12), (SETTLED, 12, 7), (END, 12, 7)], float)
STEP = 0.02  # s
ROLLING = 0.2  # s from which on the rolling resistances are compared: the wheels roll by then

OUTPUTS = {
    "x": "x",
    "y": "y",
    "heading": "heading",
    "v_x": "v_x",
    "rolling": "rolling_resistance",
    "turning": "turning_resistance_moment",
    "thrust": "turning_moment",
    "slip_left": "wheel[1].longitudinal_slip",  # (13), equal for all wheels of a side
    "slip_right": "wheel[2].longitudinal_slip",
}
# The panels of the picture: title, unit, factor to it, outputs (the second one dashed). A right
# turn is negative in the model; the paper shows magnitudes.
PANELS = {
    "paths": ("Paths", "North (m)", 1, []),
    "wheel_speeds": ("Wheel speeds, on all terrains", "rad/s", 1, ["omega_left", "omega_right"]),
    "slips": ("Longitudinal slip ratio", "%", 100, ["slip_left", "slip_right"]),
    "rolling_resistance": ("Rolling resistance", "N", 1, ["rolling"]),
    "turning_resistance": ("Moment of turning resistance", "N m", -1, ["turning"]),
    "turning_moment": ("Turning moment of the thrust, to the right", "N m", -1, ["thrust"]),
}
GREY = "#888888"
COLORS = {  # readable on white and on black
    "dry_sand": "#d97706",
    "sandy_loam": "#0d9f6e",
    "clayed_soil": "#3b82f6",
    "dry_clay": "#d946a6",
}
INK = "#0f0e0d"  # stands for the colour of text, which the page chooses
STYLE = {
    "svg.hashsalt": "ugv",
    "axes.prop_cycle": matplotlib.cycler(color=[COLORS["clayed_soil"], COLORS["dry_sand"]]),
    "axes.titlesize": 10.5,
    "axes.grid": True,
    "grid.color": GREY,
    "grid.alpha": 0.25,
    "legend.frameon": False,
    "lines.linewidth": 1.8,
    **dict.fromkeys(
        ["text.color", "axes.edgecolor", "axes.labelcolor", "xtick.color", "ytick.color"], INK
    ),
}


@dataclass
class Drive:
    """What one drive recorded, by the names of OUTPUTS, and how long it took."""

    time: np.ndarray
    values: dict[str, np.ndarray]
    seconds: float = 0.0  # spent in the FMU and in fmpy

    def __getitem__(self, name: str) -> np.ndarray:
        return self.values[name]

    @property
    def distance(self) -> float:
        """Length of the path [m]."""
        return float(np.sum(np.hypot(np.diff(self["x"]), np.diff(self["y"]))))

    def mean(self, name: str, since: float, until: float = END) -> float:
        """Mean of an output from one time to another."""
        return float(self[name][(self.time >= since) & (self.time <= until)].mean())


def wheel_speeds() -> tuple[np.ndarray, np.ndarray]:
    """The samples' times [s] and the wheel speeds there [rad/s], a row per sample."""
    samples = np.linspace(0.0, END, round(END / STEP) + 1)
    sides = [np.interp(samples, MANOEUVRE[:, 0], MANOEUVRE[:, side]) for side in (1, 2)]
    return samples, np.stack(sides, axis=1)


def drive(fmu: Path, terrain: str) -> Drive:
    """The manoeuvre on one terrain, from rest, wheel speeds linear within each step.

    In FMPy 0.3.32 simulate_fmu(..., set_input_derivatives=True) refuses to run with two inputs,
    and takes the slope at a sample from the step before it; hence the loop.
    """
    samples, omega = wheel_speeds()
    slopes = np.diff(omega, axis=0) / STEP
    with running(fmu, terrain) as (slave, reference):
        inputs = [reference["omega_left"], reference["omega_right"]]
        outputs = [reference[name] for name in OUTPUTS.values()]
        start = time.perf_counter()
        rows = [slave.getReal(outputs)]
        for k, slope in enumerate(slopes):
            slave.setReal(inputs, omega[k])
            slave.setRealInputDerivatives(inputs, [1, 1], slope)
            slave.doStep(samples[k], STEP)
            rows.append(slave.getReal(outputs))
        seconds = time.perf_counter() - start
    values = dict(zip(OUTPUTS, np.transpose(rows), strict=True))
    values["omega_left"], values["omega_right"] = omega.T
    return Drive(samples, values, seconds)


def no_slip(fmu: Path) -> Drive:
    """The drive of wheels that roll without slip: the theoretical one of the paper."""

    def integral(rate: np.ndarray) -> np.ndarray:
        return np.concatenate([[0.0], np.cumsum((rate[1:] + rate[:-1]) * STEP / 2)])

    with running(fmu, "dry_clay") as (slave, reference):
        parameters = [reference[f"vehicle.{name}"] for name in ("wheel_radius", "half_track")]
        radius, half_track = slave.getReal(parameters)
    samples, omega = wheel_speeds()
    speed = radius * omega.mean(axis=1)
    heading = integral(radius * (omega[:, 1] - omega[:, 0]) / (2 * half_track))
    x, y = integral(speed * np.cos(heading)), integral(speed * np.sin(heading))
    return Drive(samples, {"x": x, "y": y, "heading": heading})


@dataclass
class Finding:
    """A statement of the paper, whether it holds here, and the numbers that say so."""

    statement: str
    holds: bool
    evidence: str


def label(terrain: str) -> str:
    """The terrain's name as text."""
    return terrain.replace("_", " ")


def check(drives: dict[str, Drive], ideal: Drive) -> list[Finding]:
    """The paper's findings on these drives."""
    turn = int(np.argmax(ideal.time >= TURN))

    def ascending(order: list[str], output: str, since: float) -> bool:
        curves = [np.abs(drives[name][output])[ideal.time >= since] for name in order]
        return bool(np.all(np.diff(curves, axis=0) > 0))

    def each(form: str, values: dict[str, float]) -> str:
        return ", ".join(f"{label(name)} {value:{form}}" for name, value in values.items())

    distance = {name: d.distance for name, d in drives.items()}
    before = {name: 100 * d["slip_right"][turn] for name, d in drives.items()}
    lowest = {name: 100 * d["slip_right"][turn:].min() for name, d in drives.items()}
    after = {name: 100 * d["slip_right"][-1] for name, d in drives.items()}
    growth = {n: 100 * (d["slip_left"][-1] - d["slip_left"][turn]) for n, d in drives.items()}
    rolling = {name: d.mean("rolling", ROLLING) for name, d in drives.items()}
    straight = {name: d.mean("rolling", ROLLING, TURN) for name, d in drives.items()}
    rise = {n: 100 * (d.mean("rolling", SETTLED) / straight[n] - 1) for n, d in drives.items()}
    turning = {name: -d.mean("turning", SETTLED) for name, d in drives.items()}
    by_distance = ["sandy_loam", "clayed_soil", "dry_clay", "dry_sand"]
    by_rolling = ["dry_clay", "clayed_soil", "sandy_loam", "dry_sand"]
    by_turning = ["dry_clay", "sandy_loam", "clayed_soil", "dry_sand"]
    return [
        Finding(
            "All distances fall short of the one without slip.",
            max(distance.values()) < ideal.distance,
            f"{each('.2f', distance)}; without slip {ideal.distance:.2f} m",
        ),
        Finding(
            "They decrease from dry sand over dry clay and clayed soil to sandy loam.",
            sorted(distance, key=distance.__getitem__) == by_distance,
            f"{each('.2f', distance)} m",
        ),
        Finding(
            "Inner wheels: in the turn their slip shrinks in magnitude.",
            all(abs(after[name]) < abs(before[name]) for name in drives),
            f"when the turn begins {each('.0f', before)} %; at the end {each('+.0f', after)} %",
        ),
        Finding(
            "Inner wheels: their slip changes sign.",
            min(before.values()) > 0 > max(lowest.values()),
            f"above zero before the turn; at its lowest {each('.0f', lowest)} %",
        ),
        Finding(
            "Outer wheels: in the turn their slip grows, most on dry sand.",
            min(growth.values()) > 0 and max(growth, key=growth.__getitem__) == "dry_sand",
            f"by {each('.0f', growth)} percentage points",
        ),
        Finding(
            "Rolling resistance: dry clay < clayed soil < sandy loam < dry sand.",
            ascending(by_rolling, "rolling", ROLLING),
            f"at every instant; mean {each('.0f', rolling)} N",
        ),
        Finding(
            "Rolling resistance increases slightly (here: by less than 5 %) when turning.",
            min(rise.values()) > 0 and max(rise.values()) < 5,
            f"by {each('.1f', rise)} %",
        ),
        Finding(
            "Turning resistance: dry clay < sandy loam < clayed soil < dry sand.",
            ascending(by_turning, "turning", SETTLED),
            f"at every instant of the settled turn; mean {each('.0f', turning)} N m",
        ),
    ]


def draw(names: list[str], drives: dict[str, Drive], ideal: Drive) -> Figure:
    """A picture of the named panels, at most two in a row, below one legend."""
    columns = min(len(names), 2)
    low = ("paths", "wheel_speeds")
    heights = [2.3 if name in low else 3.1 for name in names[::columns]]
    figure = Figure(figsize=(4.8 * columns, 0.4 + sum(heights)), layout="constrained")
    grid = figure.add_gridspec(len(heights), columns, height_ratios=heights)
    for cell, name in zip(grid, names, strict=True):
        axes = figure.add_subplot(cell)
        title, unit, factor, outputs = PANELS[name]
        axes.set(title=title, ylabel=unit)
        if name == "paths":
            axes.plot(ideal["x"], ideal["y"], ":", color=GREY, label="without slip")
            for terrain, d in drives.items():
                axes.plot(d["x"], d["y"], color=COLORS[terrain])
            axes.set(xlabel="East (m)", aspect="equal")
        else:
            for terrain, d in drives.items():
                color = GREY if name == "wheel_speeds" else COLORS[terrain]
                for output, line in zip(outputs, ("-", "--"), strict=False):
                    axes.plot(d.time, factor * d[output], line, color=color)
            for line, text in zip(("-", "--"), ("left (outer)", "right (inner)"), strict=True):
                if len(outputs) == 2:
                    axes.plot([], [], line, color=GREY, label=text)
            axes.set(xlabel="Time (s)", xlim=(0, END))
        if axes.get_legend_handles_labels()[1]:
            axes.legend(loc="lower right" if name == "wheel_speeds" else "lower left")
    keys = [axes.plot([], [], color=COLORS[t], label=label(t).capitalize())[0] for t in drives]
    if names != ["wheel_speeds"]:
        place = {"loc": "outside upper center", "ncols": 4, "columnspacing": 1, "handlelength": 1.2}
        figure.legend(handles=keys, **place)
    return figure


def as_svg(figure: Figure, name: str) -> str:
    """The picture as an SVG element that takes the colour of the text around it."""
    buffer = io.StringIO()
    metadata = {"Date": None, "Creator": None}
    figure.savefig(buffer, format="svg", transparent=True, metadata=metadata)
    svg = buffer.getvalue().replace(INK, "currentColor")
    tag, content = svg[svg.index("<svg") :].split(">", 1)
    tag = re.sub(r' (width|height)="[^"]*"', "", tag) + f' role="img" aria-label="{name}"'
    # Several of them share one page, so their ids must differ.
    return f"{tag}>" + re.sub(r'( id="|href="#|url\(#)', rf"\g<1>{name}-", content)


def standalone(svg: str) -> str:
    """The SVG element as a file with colours of its own, by the viewer's scheme."""
    tag, content = svg.split(">", 1)
    dark = "@media(prefers-color-scheme:dark){svg{color:#e6edf3;background:#0d1117}}"
    return f"{tag}><style>svg{{color:#1f2328;background:#fff}}{dark}</style>{content}"


def summary(drives: dict[str, Drive], ideal: Drive) -> dict[str, list[str]]:
    """By heading, a text per terrain."""
    every = drives.values()
    shares = [100 * d.distance / ideal.distance for d in every]
    return {
        "Terrain": [label(name) for name in drives],
        "Distance": [f"{d.distance:.2f} m" for d in every],
        "of that without slip": [f"{share:.0f} %" for share in shares],
        "Final heading": [f"{np.degrees(d['heading'][-1]):.0f}°" for d in every],
        "Mean rolling resistance": [f"{d.mean('rolling', ROLLING):.0f} N" for d in every],
        "Largest turning resistance": [f"{np.abs(d['turning']).max():.0f} N m" for d in every],
        "Inner wheels' slip": [f"{round(100 * d.mean('slip_right', SETTLED))} %" for d in every],
        "Outer wheels' slip": [f"{round(100 * d.mean('slip_left', SETTLED))} %" for d in every],
        "Times real time": [f"{END / d.seconds:.0f}" for d in every],
    }


CSS = """
:root { color-scheme: light dark; --back: #fff; --text: #1f2328; --good: #14804a; --bad: #c62828; }
@media (prefers-color-scheme: dark) {
  :root { --back: #0d1117; --text: #e6edf3; --good: #4ac98a; --bad: #ff7b72; }
}
body { font: 16px/1.5 system-ui, sans-serif; color: var(--text); background: var(--back);
  max-width: 68rem; margin: 0 auto; padding: 1rem; }
p, li { max-width: 46rem; }
figure { margin: 0; min-width: 0; }
svg { width: 100%; height: auto; display: block; }
.panels { display: grid; gap: 1.5rem;
  grid-template-columns: repeat(auto-fit, minmax(min(100%, 26rem), 1fr)); }
table { border-collapse: collapse; font-size: 0.9rem; }
th, td { border-bottom: 1px solid #8885; padding: 0.3rem clamp(0.2rem, 1.5vw, 1rem); }
th { text-align: left; font-weight: normal; }
td { text-align: right; }
tr:first-child > * { font-weight: bold; vertical-align: bottom; }
pre { white-space: pre-wrap; }
blockquote { margin-left: 0; padding-left: 1rem; border-left: 3px solid var(--good); max-width: 46rem; }
ul { list-style: none; padding: 0; }
li { margin-bottom: 0.6rem; }
small { display: block; opacity: 0.8; }
b { color: var(--good); }
b.fails { color: var(--bad); }
.eight { max-width: 34rem; }
"""
PRODUCT = (
    "It simulates a skid-steer vehicle on soil, and finds from a recording which physics the simulation leaves out."
)
DIAGNOSIS = """<h2>What did the model leave out?</h2>
<p>{scene} <code>ugv diagnose</code> gets two recordings of it: {length:.0f} s of wheel speeds, position, heading and
yaw rate. The soil that it starts from is wrong, and nothing mentions the tow. After {seconds:.0f} s on this machine it
answers:</p>
<blockquote>{statement}</blockquote>
<p>{measured} <a href="diagnosis/report.html">The whole report</a> shows the candidates, the residuals and the map.</p>
<p>Then the wheel speeds of a drive that the tool has not seen move two FMUs. After {drive:.0f} s the given one is
{given:.2f} m from the recorded position, the mended one {mended:.2f} m (RMS over the drive: {given_rms:.2f} m and
{mended_rms:.2f} m).</p>
<figure class="eight">
{picture}
</figure>
<p>The recordings come from an independent simulator, <code>scripts/prove.sh draw</code>; they lie in
<code>scripts/examples/recordings</code>. For your own: <code>target/release/ugv diagnose rec.csv --vehicle mine.json</code>.</p>
"""
PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>ugv-terrain: what it does</title>
<style>{css}</style>
</head>
<body>
<h1>ugv-terrain</h1>
<p><strong>{product}</strong></p>
<h2>A skid-steer vehicle on four soils</h2>
<p>The FMU <code>ugv.fmu</code>, driven through fmpy along the kind of manoeuvre that Tran, Kwok,
Scheding and Ha show in Fig.&nbsp;3 of &ldquo;Dynamic Modelling of Wheel-Terrain Interaction of a
UGV&rdquo; (IEEE CASE 2007): from rest straight ahead for {turn:g} s, then a right turn. The wheel
speeds are the same on all soils. The paper does not print its own, so compare shapes and orders
with it, not values.</p>
<table>
{table}
</table>
<p>Without slip: {distance:.2f} m and {heading:.0f}°, counter-clockwise positive. Slips: means from
{settled:g} s on. Times real time: through fmpy, with set, step and get every {step:g} ms.</p>
<div class="panels">
{panels}
</div>
<h3>What the paper finds</h3>
<p>{holding} of {total} statements hold here. The wheel speeds were chosen so that they can be seen:
with others the short distances and the order of the rolling resistances stay, that of the turning
resistances nearly always, while the slips and the order of the distances depend on the
manoeuvre.</p>
<ul>
{findings}
</ul>
<h2>A controller outside</h2>
<p><code>scripts/examples/path_follower.py</code> reads the pose, sets the wheel speeds every 20 ms, and so
steers the FMU around a figure of eight on dry sand. It starts half a metre beside the path; from
{from_then:g} s on it is {rms:.1f} cm (RMS) and at most {largest:.1f} cm off it.</p>
<figure class="eight">
{eight}
</figure>
{diagnosis}
<h2>Run it again</h2>
<p>All of this from a fresh machine; this page alone; the controller on another soil:</p>
<pre>./scripts/demo.sh
target/venv/bin/python scripts/examples/demo.py
target/venv/bin/python scripts/examples/path_follower.py --terrain dry_clay --laps 2</pre>
<p>The wheel speeds are the table <code>MANOEUVRE</code> in <code>scripts/examples/demo.py</code>.</p>
</body>
</html>
"""


def diagnosis_section(answer: concealed.Answer, picture: str) -> str:
    """What the tool finds in the shipped recordings, and what that is worth."""
    given, mended = answer.followed
    vehicle, effect = answer.truth["vehicle_numbers"], answer.effect
    force = effect["parameters"]["force"]
    measured = "It does not name the tow."
    if answer.finding and answer.finding["effect"] == effect["effect"]:
        found = answer.finding["parameters"]["force"]
        measured = (
            f"The force that it finds is {found['value']:.0f} N, with 90 % probability between "
            f"{found['low']:.0f} N and {found['high']:.0f} N."
        )
    return DIAGNOSIS.format(
        scene=f"A vehicle of {vehicle['mass']:.0f} kg tows a load with {force:.0f} N over {label(answer.truth['ground'])}.",
        length=answer.length,
        seconds=answer.seconds,
        statement=html.escape(answer.said["statement"]),
        measured=measured,
        drive=given.seconds,
        given=given.last,
        mended=mended.last,
        given_rms=given.rms,
        mended_rms=mended.rms,
        picture=picture,
    )


def page(
    drives: dict[str, Drive],
    ideal: Drive,
    findings: list[Finding],
    eight: np.ndarray,
    answer: concealed.Answer,
    pictures: dict[str, str],
) -> str:
    """The page, all in one file."""
    table = [
        f"<tr><th>{heading}</th>" + "".join(f"<td>{text}</td>" for text in texts) + "</tr>"
        for heading, texts in summary(drives, ideal).items()
    ]
    items = [
        ("<li><b>Holds.</b> " if finding.holds else '<li><b class="fails">Does not hold.</b> ')
        + f"{html.escape(finding.statement)}<small>{html.escape(finding.evidence)}</small></li>"
        for finding in findings
    ]
    rms, largest = path_follower.errors(eight)
    return PAGE.format(
        css=CSS,
        turn=TURN,
        table="\n".join(table),
        distance=ideal.distance,
        heading=np.degrees(ideal["heading"][-1]),
        settled=SETTLED,
        step=1000 * STEP,
        panels="\n".join(f"<figure>{pictures[name]}</figure>" for name in PANELS),
        holding=sum(finding.holds for finding in findings),
        total=len(findings),
        findings="\n".join(items),
        from_then=path_follower.SETTLED,
        rms=100 * rms,
        largest=100 * largest,
        eight=pictures["figure_of_eight"],
        product=PRODUCT,
        diagnosis=diagnosis_section(answer, pictures["follow"]),
    )


def main() -> None:
    """Drives, checks, diagnoses, draws, and prints what comes of it."""
    root = Path(__file__).resolve().parents[2]
    target = Path(os.environ.get("CARGO_TARGET_DIR", root / "target"))
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    add = parser.add_argument
    add("--fmu", type=Path, default=target / "ugv.fmu", help="default: target/ugv.fmu")
    add("--tool", type=Path, default=target / "release" / "ugv", help="default: target/release/ugv")
    add("--output", type=Path, default=target / "demo", help="folder (default: target/demo)")
    arguments = parser.parse_args()
    for path in (arguments.fmu, arguments.tool):
        if not path.is_file():
            sys.exit(f"demo: {path} is missing; run ./scripts/package.sh first")

    ideal = no_slip(arguments.fmu)
    drives = {terrain: drive(arguments.fmu, terrain) for terrain in TERRAINS}
    findings = check(drives, ideal)
    for texts in zip(*summary(drives, ideal).values(), strict=True):
        name, distance, share, heading, rolling, turning, inner, outer, speed = texts
        print(
            f"{name:<11}  {distance} ({share} of {ideal.distance:.2f} m), heading {heading}", end=""
        )
        print(f", rolling resistance {rolling}, turning resistance up to {turning}", end="")
        print(f", slip inner {inner} outer {outer}, {speed} x real time")
    print(f"{sum(f.holds for f in findings)} of {len(findings)} of the paper's findings hold")
    for finding in findings:
        if not finding.holds:
            print(f"does not hold: {finding.statement} ({finding.evidence})")

    arguments.output.mkdir(parents=True, exist_ok=True)
    eight = path_follower.follow(arguments.fmu, "dry_sand")
    with matplotlib.rc_context(STYLE):
        figures = {name: draw([name], drives, ideal) for name in PANELS}
        figures["demo"] = draw(list(PANELS), drives, ideal)
        figures["figure_of_eight"] = path_follower.draw(eight)
        answer = concealed.diagnose(arguments.tool.resolve(), arguments.output)
        figures["follow"] = answer.figure
        for name in ("demo", "figure_of_eight", "follow"):
            figures[name].savefig(arguments.output / f"{name}.png", dpi=150)
        pictures = {name: as_svg(figure, name) for name, figure in figures.items()}
    for name, svg in pictures.items():
        (arguments.output / f"{name}.svg").write_text(standalone(svg), encoding="utf-8")
    index = arguments.output / "index.html"
    index.write_text(page(drives, ideal, findings, eight, answer, pictures), encoding="utf-8")
    print(f"{answer.said['statement']} ({answer.seconds:.0f} s)")
    print(*answer.followed, sep="\n")
    print(f"pictures: {arguments.output}/*.png, *.svg; page: {index}")


if __name__ == "__main__":
    main()
