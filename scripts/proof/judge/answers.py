"""Answers beside the truths, a case in a line: what is judged, to be kept, published, and judged together with more.

The first line tells how they came about (format ugv-proof-answers/1): seeds, tools, limits. Every other line is a case: its
truth, and what each method told of it.
"""

import gzip
import json
import sys
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path

from .case import Judged

FORMAT = "ugv-proof-answers/1"
FINDING = ("effect", "probability", "ambiguous_with", "parameters", "where")
CANDIDATE = ("effect", "probability")
CLAIM = ("level", "name", "probability")
KEPT = ("said", "unseen", "seconds", "status", "oracle")


def told(said: dict | None) -> dict | None:
    """Of an answer, what is judged and shown."""
    if said is None:
        return None

    def picked(key: str, wanted: Sequence[str]) -> list[dict]:
        return [{name: one[name] for name in wanted if name in one} for one in said.get(key) or []]

    claims = {"claims": picked("claims", CLAIM)} if "claims" in said else {}
    return {"verdict": said.get("verdict"), "statement": said.get("statement"), "findings": picked("findings", FINDING),
            "candidates": picked("candidates", CANDIDATE), **claims}


def lines(everyone: Mapping[str, Sequence[Judged]], facts: dict) -> str:
    """answers.jsonl."""
    out = [{"format": FORMAT, **facts, "methods": list(everyone)}]
    for cases in zip(*everyone.values(), strict=True):
        by_method = {method: {key: getattr(case, key) for key in KEPT} for method, case in zip(everyone, cases, strict=True)}
        for one in by_method.values():
            one["said"] = told(one["said"])
        out.append({"case": cases[0].name, "truth": cases[0].truth, "methods": by_method})
    return "".join(json.dumps(line, allow_nan=False, separators=(",", ":")) + "\n" for line in out)


def text(path: Path) -> str:
    """What a file says, compressed (.gz) or not."""
    return gzip.decompress(path.read_bytes()).decode() if path.suffix == ".gz" else path.read_text()


def load(paths: Sequence[Path]) -> tuple[dict[str, list[Judged]], dict]:
    """Everyone's answers to the cases of all files, and how they came about."""
    everyone: dict[str, list[Judged]] = {}
    facts: dict = {"seed": [], "drawn": 0, "answered": 0, "tool": [], "limit_s": None, "took_s": 0}
    seen: dict[tuple[int, str], Path] = {}
    for path in paths:
        try:
            head, *rest = map(json.loads, text(path).splitlines())
        except (OSError, EOFError, zlib.error, ValueError) as error:
            sys.exit(f"prove: {path} cannot be read ({error}); give an answers.jsonl that prove.sh has written")
        if head.get("format") != FORMAT:
            sys.exit(f"prove: {path} is not of the format {FORMAT}; give an answers.jsonl that prove.sh has written")
        everyone = everyone or {method: [] for method in head["methods"]}
        if set(everyone) != set(head["methods"]):
            sys.exit(f"prove: {path} has answers of {', '.join(head['methods'])}, the others of {', '.join(everyone)}; give files of the same peers")
        if facts["limit_s"] not in (None, head["limit_s"]):
            sys.exit(f"prove: {path} had a limit of {head['limit_s']:g} s, the others {facts['limit_s']:g} s; give files of one limit")
        for key in ("seed", "tool"):
            facts[key] = sorted({*facts[key], *head[key]})
        for key in ("drawn", "answered", "took_s"):
            facts[key] += head[key]
        facts["limit_s"] = head["limit_s"]
        for line in rest:
            key = line["truth"]["seed"], line["case"]
            if key in seen:
                sys.exit(f"prove: {line['case']} of seed {key[0]} is in {seen[key]} and in {path}; give each case once")
            seen[key] = path
            for method, one in line["methods"].items():
                everyone[method].append(Judged(line["case"], line["truth"], **one))
    return everyone, facts
