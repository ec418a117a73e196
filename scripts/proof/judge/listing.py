"""Every case in one line of CSV, to be published beside the figures."""

import csv
import io
from collections.abc import Sequence

COLUMNS = ("case", "family", "variant", "truth", "signal_left", "plain", "identifiable", "expected", "verdict", "told", "right", "exact", "first", "two", "false_names",
           "claim", "p_truth", "located", "gain", "formula", "in_set", "set_size", "mechanism", "told_mechanism", "right_mechanism", "sure_wrong",
           "extra_names")
UNSEEN = ("nominal", "retuned", "own", "oracle")  # models whose position error on the unseen drive is listed, m


def cell(value: object) -> str:
    """A value as it is listed: numbers to three digits, nothing where there is none."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.3g}"
    return " or ".join(value) if isinstance(value, list) else str(value)


def listing(cases: Sequence[dict]) -> str:
    """cases.csv, from the cases of proof.json."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow([*COLUMNS, *(f"unseen_{key}_m" for key in UNSEEN), "parameters", "seconds"])
    for one in cases:
        errors = [one["unseen_m"].get(key) for key in UNSEEN]
        told = "; ".join(f"{p['name']} off by {p['error']:.3g}, {'held' if p['held'] else 'not held'}" for p in one["parameters"])
        table.writerow([cell(value) for value in (*(one[key] for key in COLUMNS), *errors, told, one["seconds"])])
    return text.getvalue()
