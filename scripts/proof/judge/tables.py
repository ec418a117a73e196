"""The page's tables in Markdown, to be published beside other sets'."""

from collections.abc import Sequence

from .page import FAMILY_KEYS, SHORT, number, target


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table; bars within cells are escaped."""
    lines = [head, ["---"] * len(head), *rows]
    return "".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |\n" for line in lines)


def measured(metric: dict) -> str:
    """A metric's value with its interval; in bold where it falls short of its target."""
    value = number(metric["value"], metric["unit"])
    shown = f"**{value}**" if metric["met"] is False else value
    return shown if metric["value"] is None else f"{shown} ({number(metric['low'], metric['unit'])} to {number(metric['high'], metric['unit'])})"


def across(label: str, rows: dict[str, list[dict]], keys: Sequence[str]) -> str:
    """One row of metrics for each family or method."""
    body = []
    for name, metrics in rows.items():
        own = {metric["key"]: metric for metric in metrics}
        values = ((own[key]["value"], own[key]["unit"], own[key]["n"]) if key in own else (None, "", 0) for key in keys)
        body.append([name, *("" if value is None else f"{number(value, unit)} of {n}" for value, unit, n in values)])
    return table([label, *(SHORT[key] for key in keys)], body)


def tables(summed: dict) -> str:
    """proof.md."""
    metrics = [[m["label"], target(m), measured(m), str(m["n"]), m["note"]] for m in summed["metrics"]]
    told = {metric["key"] for rows in summed["peers"].values() for metric in rows}
    judged = [m["met"] for m in summed["metrics"] if m["met"] is not None]
    return "\n".join([
        f"Seed {' and '.join(map(str, summed['seed']))}: {summed['answered']} of {summed['drawn']} cases answered by {' and '.join(summed['tool'])}; "
        f"{sum(judged)} of {len(judged)} targets met.\n",
        table(["metric", "target", "measured (90 % interval)", "cases", "of which"], metrics),
        across("family", summed["families"], FAMILY_KEYS),
        across("method", summed["peers"], [key for key in SHORT if key in told]),
    ])
