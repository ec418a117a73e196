"""The page: one file, no scripts, light and dark, for a phone as for a screen."""

from collections.abc import Sequence
from html import escape
from pathlib import Path

from . import drawing
from .case import Judged

STYLE = Path(__file__).with_name("style.css")
FAMILY_KEYS = ["right", "failed", "false_alarms", "detection", "first", "two", "in_set", "set_size", "mechanism",
               "sure_wrong", "extra_names", "p_truth", "calibration", "located", "gain", "seconds"]
SHORT = {
    "right": "allowed", "failed": "no answer", "false_alarms": "false alarms", "detection": "detected", "first": "first",
    "two": "first two", "in_set": "in the set", "set_size": "set size", "mechanism": "class", "mechanism_outside": "class, outside",
    "sure_wrong": "sure and wrong", "extra_names": "further false names", "p_truth": "p(truth)", "calibration": "calibration error", "located": "overlap",
    "parameter_error": "parameter error", "coverage": "coverage", "gain": "gain", "gain_outside": "gain, outside",
    "misnamed": "outside: wrongly named", "exact": "that and nothing else", "false_names": "false names", "harm": "harm", "seconds": "seconds",
}

PEERS = {
    "stepwise": "Stepwise: effects of the catalogue enter a linear regression while that lowers the BIC, all samples counted as independent.",
    "sparse": "Sparse: SINDy with control on the differentiated residual velocities.",
    "gaussian": "Gaussian: a Gaussian process on the residual velocities.",
}


def number(value: float | None, unit: str) -> str:
    """A number as it is read."""
    if value is None:
        return "–"
    if unit == "share":
        return f"{round(100 * value)} %"
    return f"{value:.1f}" if unit in ("s", "number") else f"{value:.3f}"


def target(metric: dict) -> str:
    """What was asked for."""
    wanted = metric["target"]
    if wanted is None:
        return ""
    if wanted["sense"] == "within":
        return f"{100 * wanted['value']:.0f}–{100 * wanted['high']:.0f} %"
    sign = "≥" if wanted["sense"] == "at least" else "≤"
    share = metric["unit"] == "share"
    return f"{sign} {number(wanted['value'], 'share') if share else format(wanted['value'], 'g')}"


def verdict(metric: dict) -> str:
    if metric["met"] is None:
        return ""
    return '<b class="good">pass</b>' if metric["met"] else '<b class="bad">short</b>'


def summary(metrics: Sequence[dict]) -> str:
    """All metrics against their targets."""
    rows = []
    for m in metrics:
        shown = m["unit"] in ("share", "probability")
        span = "" if m["value"] is None else f"{number(m['low'], m['unit'])} to {number(m['high'], m['unit'])}"
        note = f'<div class="soft">{escape(m["note"])}</div>' if m["note"] else ""
        bar = drawing.gauge(m["value"], m["low"], m["high"]) if shown else ""
        rows.append(f'<tr><td>{escape(m["label"])}{note}</td><td class="n">{number(m["value"], m["unit"])}{bar}</td>'
                    f'<td class="n wide soft">{span}</td><td class="n">{m["n"]}</td><td class="n">{escape(target(m))}</td><td>{verdict(m)}</td></tr>')
    head = ('<tr><th>what</th><th class="n">measured</th><th class="n wide">90 % interval</th><th class="n">cases</th>'
            '<th class="n">target</th><th></th></tr>')
    return f'<table class="summary">{head}{"".join(rows)}</table>'


def across(label: str, rows: dict[str, list[dict]], keys: Sequence[str], counts: dict[str, int] | None = None) -> str:
    """One row of metrics for each family or peer."""
    head = "".join(f'<th class="n">{SHORT[key]}</th>' for key in keys)
    body = []
    for name, metrics in rows.items():
        own = {m["key"]: m for m in metrics}
        cells = "".join(cell(own.get(key)) for key in keys)
        count = f'<td class="n">{counts[name]}</td>' if counts else ""
        body.append(f"<tr><th>{escape(name)}</th>{count}{cells}</tr>")
    return (f'<div class="scroll"><table><tr><th>{label}</th>{"<th class=n>cases</th>" if counts else ""}{head}</tr>'
            f"{''.join(body)}</table></div>")


def cell(metric: dict | None) -> str:
    if metric is None or metric["value"] is None:
        return '<td class="n soft">–</td>'
    tone = {True: " good", False: " bad", None: ""}[metric["met"]]
    span = f'{number(metric["low"], metric["unit"])} to {number(metric["high"], metric["unit"])}, {metric["n"]} cases'
    return f'<td class="n{tone}" title="{span}">{number(metric["value"], metric["unit"])}</td>'


def plain(name: str) -> str:
    """A name as it is read."""
    return escape(name.replace("_", " "))


def confusion(table: dict[str, dict[str, int]]) -> str:
    """What was told of each truth."""
    told = sorted({name for row in table.values() for name in row})
    head = "".join(f'<th class="up">{plain(name)}</th>' for name in told)
    rows = []
    right = {"outside": {"unknown", "set with it"}, "two effects": {"one or both of them", "set with it"}}
    for true, row in table.items():
        total = sum(row.values())
        cells = []
        for name in told:
            count = row.get(name, 0)
            hit = " hit" if count and name in right.get(true, {true, "set with it"}) else ""
            shade = f' style="background: rgba(var(--heat), {0.6 * count / total:.2f})"' if count else ""
            cells.append(f'<td class="{hit.strip()}"{shade}>{count or ""}</td>')
        rows.append(f"<tr><th>{plain(true)}</th>{''.join(cells)}</tr>")
    return f'<div class="scroll"><table class="confusion"><tr><th>truth \\ told</th>{head}</tr>{"".join(rows)}</table></div>'


def wanted(case: Judged) -> str:
    """What would have been right."""
    verdicts = " or ".join(v.replace("_", " ") for v in case.truth["expected"])
    names = ", ".join(case.real)
    alone = ", alone: the second recording tells it apart" if case.resolvable else ""
    return verdicts + (f": {names}{alone}" if names else "")


def link(case: Judged, linked: bool) -> str:
    return f'<a href="results/{case.name}/answer/report.html">{case.name}</a>' if linked and case.answered else case.name


def failure(case: Judged, linked: bool) -> str:
    """A case that is not right, told whole."""
    p = f"; probability on the truth {case.p_truth:.2f}" if case.answered else ""
    variant = f", {case.truth['variant']}" if case.truth.get("variant") else ""
    said = (case.said or {}).get("statement")
    statement = f'<p class="soft">“{escape(said)}”</p>' if said else ""
    return (f'<div class="case"><p><b>{link(case, linked)}</b> <span class="soft">{escape(case.family + variant)}, signal left {case.signal:.1f}</span></p>'
            f"<p>Truth: {escape(case.true_short)}</p><p>Told: {escape(case.verdict.replace('_', ' '))}: {escape(case.short)}{p}</p>{statement}"
            f"<p>Right would be: {escape(wanted(case))}</p></div>")


def every(cases: Sequence[Judged], linked: bool) -> str:
    """Every case, one row each, those that are not right first."""
    rows = []
    for case in sorted(cases, key=lambda case: (case.right, case.name)):
        mark = '<b class="good">right</b>' if case.right else '<b class="bad">wrong</b>'
        p = f"{case.p_truth:.2f}" if case.answered else "–"
        rows.append(f"<tr data-case><th>{link(case, linked)}</th><td>{mark}</td><td>{escape(case.family)}</td><td>{escape(case.true_short)}</td>"
                    f'<td class="n">{case.signal:.1f}</td><td>{escape(case.verdict.replace("_", " "))}</td><td>{escape(case.short)}</td>'
                    f'<td class="n">{p}</td><td class="n">{number(case.gain, "share")}</td><td class="n">{number(case.seconds, "s")}</td></tr>')
    head = ("<tr><th>case</th><th></th><th>family</th><th>truth</th><th class=n>signal</th><th>verdict</th><th>told</th>"
            "<th class=n>p(truth)</th><th class=n>gain</th><th class=n>s</th></tr>")
    return f'<div class="scroll"><table>{head}{"".join(rows)}</table></div>'


def page(cases: Sequence[Judged], summed: dict, linked: bool = True) -> str:
    """proof.html; linked: the reports stand beside it."""
    wrong = [case for case in cases if not case.right]
    judged = [m for m in summed["metrics"] if m["met"] is not None]
    passed = sum(m["met"] for m in judged)
    partial = summed["answered"] < summed["drawn"]
    so_far = f' <b class="bad">Only {summed["answered"]} of {summed["drawn"]} cases have been answered so far.</b>' if partial else ""
    counts = {family: sum(case.family == family for case in cases) for family in summed["families"]}
    peer_keys = [key for key in SHORT if any(m["key"] == key for rows in summed["peers"].values() for m in rows)]
    peer_keys = [key for key in peer_keys if key not in ("right", "failed", "located")]
    seed = f" (seed {' and '.join(map(str, summed['seed']))})"
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Proof of ugv diagnose</title><style>{STYLE.read_text()}</style></head><body>
<h1>Proof of <code>ugv diagnose</code></h1>
<p>{len(cases)} cases of an independent simulator{seed}, each truth opened after its case had been answered: {passed} of
{len(judged)} targets met, {len(cases) - len(wrong)} answers right, {len(wrong)} not.{so_far}</p>
<h2>Against the targets</h2>{summary(summed["metrics"])}
<h2>Failures</h2>{"".join(failure(case, linked) for case in wrong) or "<p>None.</p>"}
<h2>How sure it was, and how often right</h2>
<p class="soft">First finding of every case (or “nothing missing”), in ten bins of its probability; bars are 90 % intervals, numbers are cases.</p>
{drawing.reliability(summed["reliability"])}
<h2>What was there to see, and what was told</h2>
<p class="soft">Every case by what re-tuning the soil leaves of its signal, and by the probability that was told of the truth. Rings: answers that are not right.</p>
{drawing.signals(cases)}
<h2>What was told of what</h2>
<p class="soft">Framed: right. “Set”: told as one of several that these data do not tell apart.</p>{confusion(summed["confusion"])}
<h2>By family</h2>{across("family", summed["families"], FAMILY_KEYS, counts)}
<h2>Peers on the same cases</h2>
<p class="soft">Gain: position error four seconds ahead on a drive that none of them saw, as the share of what an oracle that knows the effect gains over
the re-tuned soil. Of a case, they are compared over the same windows, each from the recorded states (less what it says of the sensors); outliers of
the position are left out for all. Peers' seconds are those of their own work and of predicting the unseen drive; that they begin with the
re-tuned soil is not counted. {escape(" ".join(PEERS.values()))}</p>
{across("method", summed["peers"], peer_keys)}
<h2>Every case</h2>{every(cases, linked)}
<p class="soft">Tool {escape(" and ".join(summed["tool"]))}; time limit {summed["limit_s"]:.0f} s a case; numbers in proof.json.</p>
</body></html>
"""
