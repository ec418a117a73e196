"""Everything that was counted, as proof.json (format ugv-proof/1)."""

from collections.abc import Sequence

from .case import Judged
from .metrics import confusion, metrics, reliability

NOT_ANSWERING = {"nominal": "as given", "retuned": "soil re-tuned"}  # peers that only predict
PEER_KEYS = ["false_alarms", "detection", "first", "two", "p_truth", "calibration", "parameter_error", "coverage", "misnamed", "exact", "false_names",
             "in_set", "set_size", "mechanism", "mechanism_outside", "sure_wrong", "extra_names"]
DETECTING = ["false_alarms", "detection"]
PREDICTING = ["gain", "gain_outside", "harm"]


def one(case: Judged) -> dict:
    """A case, for the list of all of them."""
    return {
        "case": case.name, "family": case.family, "variant": case.truth.get("variant", ""), "right": case.right,
        "truth": case.true_short, "names": case.names, "expected": case.truth["expected"], "signal_left": case.signal,
        "plain": case.plain, "identifiable": case.identifiable, "first": case.first, "two": case.two, "exact": case.exact,
        "false_names": case.false_names, "formula": [f"{effect} {number}" for effect, number in (case.truth.get("formula") or {}).items()],
        "in_set": case.in_set, "set_size": len(case.group) if case.detected else None, "mechanism": case.true_mechanisms,
        "told_mechanism": case.told_mechanisms, "right_mechanism": case.right_mechanism, "sure_wrong": case.sure_and_wrong,
        "extra_names": case.extra_names,
        "verdict": case.verdict, "told": case.short, "p_truth": case.p_truth if case.answered else None,
        "claim": case.claim[0] if case.claim else None, "located": case.located, "gain": case.gain, "unseen_m": case.unseen,
        "parameters": [{"name": n, "error": e, "held": h} for n, e, h in case.parameters],
        "seconds": case.seconds, "status": case.status,
    }


def report(everyone: dict[str, Sequence[Judged]], facts: dict) -> dict:
    """proof.json."""
    own = everyone["mended"]
    families = {family: [case for case in own if case.family == family] for family in sorted({c.family for c in own})}
    peers = {}
    for name, cases in everyone.items():
        answering = any(case.answered for case in cases)
        naming = any(case.probabilities for case in cases)
        keys = [*PREDICTING, "seconds"] + (PEER_KEYS if naming else DETECTING if answering else [])
        peers["ugv diagnose" if name == "mended" else NOT_ANSWERING.get(name, name)] = [
            m.json() for m in metrics(cases) if m.key in keys
        ]
    return {
        "format": "ugv-proof/1", **facts,
        "metrics": [m.json() for m in metrics(own)],
        "families": {family: [m.json() for m in metrics(cases)] for family, cases in families.items()},
        "peers": peers,
        "reliability": reliability(own),
        "confusion": {true: dict(told) for true, told in sorted(confusion(own).items())},
        "cases": [one(case) for case in own],
    }
