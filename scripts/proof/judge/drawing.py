"""Pictures of the page, as inline SVG and styled boxes; colours come from the page's style."""

from collections.abc import Sequence

SIZE, EDGE = 320, 44


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
    for b in bins:
        x = _at(b["told"])
        parts.append(f'<path class="line bar" d="M{x:.1f} {_up(b["low"]):.1f}V{_up(b["high"]):.1f}"/>')
        parts.append(f'<circle class="dots" cx="{x:.1f}" cy="{_up(b["right"]):.1f}" r="{3 + min(6.0, b["n"] ** 0.5 / 2):.1f}"/>')
        parts.append(f'<text x="{x:.1f}" y="{_up(1) - 6:.1f}" text-anchor="middle">{b["n"]}</text>')
    parts.append(f'<text x="{_at(0.5):.1f}" y="{SIZE - 8}" text-anchor="middle">probability told</text>')
    parts.append(f'<text transform="translate(11 {_up(0.5):.1f}) rotate(-90)" text-anchor="middle">share right</text>')
    return f'<svg viewBox="0 0 {SIZE} {SIZE}" role="img" aria-label="reliability">{"".join(parts)}</svg>'


def gauge(value: float | None, low: float | None, high: float | None) -> str:
    """A share with its interval, as a bar in a table's cell."""
    if value is None or low is None or high is None:
        return ""
    x, a, b = (100 * max(0.0, min(1.0, v)) for v in (value, low, high))
    return (f'<div class="gauge"><i style="width: {x:.1f}%"></i>'
            f'<b style="left: {a:.1f}%; width: {max(b - a, 0.5):.1f}%"></b></div>')
