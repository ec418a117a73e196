"""Pictures of the page, as inline SVG and styled boxes; colours come from the page's style."""

import math
from collections.abc import Sequence
from html import escape

from .case import PLAIN, Judged

SIZE, EDGE = 320, 50
DIGIT = 8  # width, with what parts numbers
WIDE = 360  # of the picture of all cases
SEEN = (1.0, 3000.0)  # its signals in sigma; less stands at its left edge
STANDALONE = """text { font: 12px system-ui, sans-serif; fill: #59636e; } .grid { stroke: #d8dee4; fill: none; }
.even { stroke: #59636e; stroke-dasharray: 4 4; fill: none; } .bar { stroke: #2563a8; stroke-width: 2; fill: none; } .dots { fill: #2563a8; }
.right { fill: #2563a8; fill-opacity: .55; } .wrong { fill: none; stroke: #b3261e; stroke-width: 1.6; }"""


def _at(p: float) -> float:
    return EDGE + p * (SIZE - EDGE - 26)


def _up(p: float) -> float:
    return SIZE - _at(p)


def reliability(bins: Sequence[dict]) -> str:
    """How sure the tool was against how often it was right, with 90 % intervals and counts."""
    parts = []
    for tick in (0.0, 0.25, 0.5, 0.75, 1.0):
        x, y = _at(tick), _up(tick)
        parts.append(f'<path class="grid" d="M{x:.1f} {_up(0):.1f}V{_up(1):.1f}M{_at(0):.1f} {y:.1f}H{_at(1):.1f}"/>')
        parts.append(f'<text x="{x:.1f}" y="{_up(0) + 16:.1f}" text-anchor="middle">{tick:g}</text>')
        parts.append(f'<text x="{_at(0) - 6:.1f}" y="{y + 4:.1f}" text-anchor="end">{tick:g}</text>')
    parts.append(f'<path class="line even" d="M{_at(0):.1f} {_up(0):.1f}L{_at(1):.1f} {_up(1):.1f}"/>')
    free, is_raised = 0.0, False
    for b in bins:
        x = _at(b["told"])
        parts.append(f'<path class="line bar" d="M{x:.1f} {_up(b["low"]):.1f}V{_up(b["high"]):.1f}"/>')
        parts.append(f'<circle class="dots" cx="{x:.1f}" cy="{_up(b["right"]):.1f}" r="{3 + min(6.0, b["n"] ** 0.5 / 2):.1f}"/>')
        begins, ends = (x + side * DIGIT * len(str(b["n"])) / 2 for side in (-1, 1))
        is_raised = begins < free and not is_raised  # above a neighbour that is close
        free = max(free, ends)
        parts.append(f'<text x="{x:.1f}" y="{_up(1) - (17 if is_raised else 6):.1f}" text-anchor="middle">{b["n"]}</text>')
    parts.append(f'<text x="{_at(0.5):.1f}" y="{SIZE - 8}" text-anchor="middle">probability told</text>')
    parts.append(f'<text transform="translate(11 {_up(0.5):.1f}) rotate(-90)" text-anchor="middle">share right</text>')
    return f'<svg viewBox="0 0 {SIZE} {SIZE}" role="img" aria-label="reliability">{"".join(parts)}</svg>'


def _along(signal: float) -> float:
    """Place of a signal on a logarithmic axis."""
    low, high = SEEN
    return math.log(max(low, min(high, signal)) / low) / math.log(high / low)


def signals(cases: Sequence[Judged]) -> str:
    """How much there was to see of every case, and the probability that was told of the truth; rings are not allowed answers."""
    left, right = EDGE + 48, WIDE - 12
    across = [left + _along(signal) * (right - left) for signal in (1, PLAIN, 30, 100, 300, 1000)]
    none, top, bottom = EDGE + 18, _up(1), _up(0)
    parts = []
    for tick in (0.0, 0.25, 0.5, 0.75, 1.0):
        parts.append(f'<path class="grid" d="M{EDGE} {_up(tick):.1f}H{right:.1f}"/>')
        parts.append(f'<text x="{EDGE - 6}" y="{_up(tick) + 4:.1f}" text-anchor="end">{tick:g}</text>')
    for x, label in zip(across, ("1", "8", "30", "100", "300", "1000"), strict=True):
        kind = "line even" if label == f"{PLAIN:g}" else "grid"
        parts.append(f'<path class="{kind}" d="M{x:.1f} {bottom:.1f}V{top:.1f}"/>')
        parts.append(f'<text x="{x:.1f}" y="{bottom + 16:.1f}" text-anchor="middle">{label}</text>')
    parts.append(f'<text x="{none}" y="{bottom + 16:.1f}" text-anchor="middle">none</text>')
    for case in sorted(cases, key=lambda case: not case.right):
        x = none if case.signal < SEEN[0] else left + _along(case.signal) * (right - left)
        told = escape(f"{case.name}: {case.true_short}; told {case.short}")
        parts.append(f'<circle class="{"right" if case.right else "wrong"}" cx="{x:.1f}" cy="{_up(case.p_truth):.1f}" r="3.5">'
                     f"<title>{told}</title></circle>")
    parts.append(f'<text x="{(left + right) / 2:.1f}" y="{SIZE - 8}" text-anchor="middle">signal left when the soil is re-tuned [sigma]</text>')
    parts.append(f'<text transform="translate(13 {_up(0.5):.1f}) rotate(-90)" text-anchor="middle">probability on the truth</text>')
    return f'<svg viewBox="0 0 {WIDE} {SIZE}" role="img" aria-label="every case">{"".join(parts)}</svg>'


def figure(cases: Sequence[Judged], bins: Sequence[dict]) -> str:
    """proof.svg: every case, and how sure against how often right, side by side."""
    every = signals(cases).replace("<svg", f'<svg width="{WIDE}" height="{SIZE}"', 1)
    sure = reliability(bins).replace("<svg", f'<svg x="{WIDE}" width="{SIZE}" height="{SIZE}"', 1)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDE + SIZE} {SIZE}" width="{WIDE + SIZE}" height="{SIZE}">'
            f'<style>{STANDALONE}</style><rect width="100%" height="100%" fill="#fff"/>{every}{sure}</svg>\n')


def gauge(value: float | None, low: float | None, high: float | None) -> str:
    """A share with its interval, as a bar in a table's cell."""
    if value is None or low is None or high is None:
        return ""
    x, a, b = (100 * max(0.0, min(1.0, v)) for v in (value, low, high))
    return (f'<div class="gauge"><i style="width: {x:.1f}%"></i>'
            f'<b style="left: {a:.1f}%; width: {max(b - a, 0.5):.1f}%"></b></div>')
