#!/usr/bin/env python3
"""Compares what `ugv diagnose` says of cases with the truth that the example diagnosis_cases wrote beside them.

    cargo run --release --example diagnosis_cases -- --out CASES --cases 100 --seed 1
    scripts/score_diagnosis.py CASES RESULTS --run target/release/ugv --jobs 2

--run diagnoses the cases that have no result yet; without it only the table is printed. Columns:
noth .. none      how often each verdict was given (none: no result)
detect            share of cases that are told that something is missing
first, set, two   truth named first; first or in the set that it is said to be ambiguous with; among the first two
p(truth)          mean probability of the truth
IoU               overlap of the located seconds with the true ones, median
error, cover      of the parameters, median relative to the effect's strength; share within the 90 % interval
held-out          position error of the augmented model over the re-tuned one's, as diagnosed, median
unseen            position error of model.json over the nominal one's on the unseen drive, median
right             share of cases with an answer that the truth allows; the others are listed below
"""

import argparse
import json
import statistics
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

VERDICTS = ["nothing_missing", "missing_physics", "sensor", "ambiguous", "unknown_physics", "insufficient_data"]
SILENT, NOTHING = {"nothing_missing", "insufficient_data"}, {"nothing_missing", "nothing missing", "nothing"}


def load(path: Path) -> dict | None:
    """A JSON file; None where it is missing."""
    return json.loads(path.read_text()) if path.exists() else None


def diagnose(tool: str, cases: Path, results: Path, name: str, limit: float) -> str | None:
    """Diagnoses a case and scores its model on the unseen drive; what went wrong."""
    out = results / name
    out.mkdir(parents=True, exist_ok=True)
    drives = sorted(map(str, (cases / name).glob("drive*.csv")))
    begin = time.monotonic()
    try:
        done = subprocess.run([tool, "diagnose", *drives, "--out", str(out), "--quiet"],
                              capture_output=True, text=True, timeout=limit)
        status, said = done.returncode, done.stderr
    except subprocess.TimeoutExpired:
        status, said = "timeout", ""
    record = {"status": status, "seconds": round(time.monotonic() - begin, 2), "stderr": said[-2000:]}
    (out / "run.json").write_text(json.dumps(record))
    if status == 0 and (out / "model.json").exists():
        command = [tool, "score", cases / name / "unseen.csv", "--model", out / "model.json"]
        subprocess.run([*command, "--json", out / "unseen.json", "--quiet"], capture_output=True, check=False)
    last = (said.strip().splitlines() or [""])[-1]
    return None if status == 0 else f"{name}: status {status}: {last}"


def run(tool: str, cases: Path, results: Path, names: list[str], jobs: int, limit: float) -> None:
    """Diagnoses what has no result yet."""
    todo = [name for name in names if not (results / name / "run.json").exists()]
    begin = time.monotonic()
    with ThreadPoolExecutor(jobs) as pool:
        futures = [pool.submit(diagnose, tool, cases, results, name, limit) for name in todo]
        for count, future in enumerate(as_completed(futures), 1):
            if trouble := future.result():
                print(f"\r\033[K{trouble}", file=sys.stderr)
            passed = time.monotonic() - begin
            left = passed / count * (len(todo) - count)
            end = "\n" if count == len(todo) else ""
            print(f"\r\033[K{count}/{len(todo)} cases, {passed:.0f} s, {left:.0f} s to go", end=end, file=sys.stderr)


def overlap(found: list, true: list) -> float:
    """Intersection over union of two lists of intervals."""
    edges = sorted({edge for pair in found + true for edge in pair})
    both = either = 0.0
    for start, end in zip(edges, edges[1:]):
        inside = [any(a <= start and end <= b for a, b in pairs) for pairs in (found, true)]
        both += (end - start) * all(inside)
        either += (end - start) * any(inside)
    return both / either if either else 0.0


def parameters(truth: dict, finding: dict) -> list[tuple[float, bool]]:
    """Error relative to the effect's strength, and whether the interval holds the truth, for each of its switches."""
    true, told = truth["parameters"], finding.get("parameters") or {}
    strength = max((min(abs(true[name] - off), abs(true[name])) for name, off in truth["off"].items()), default=0)
    names = [name for name in truth["off"] if name in told and strength]
    return [(abs(told[name]["value"] - true[name]) / strength, told[name]["low"] <= true[name] <= told[name]["high"])
            for name in names]


def ratio(above: object, below: object) -> float | None:
    return above / below if above is not None and below else None


class Case:
    """One case, judged."""

    def __init__(self, truth: dict, out: Path) -> None:
        self.truth, self.name, self.family = truth, truth["case"], truth["family"]
        said = load(out / "diagnosis.json") or {}
        self.verdict = said.get("verdict", "none")
        effects = truth["effects"]
        self.names = [e["effect"] if e["kind"] != "outside" else "unknown" for e in effects] or ["nothing_missing"]
        findings = said.get("findings") or []
        ranked = sorted(said.get("candidates") or [], key=lambda c: -(c.get("probability") or 0))
        told = [f["effect"] for f in findings] + [c["effect"] for c in ranked]
        silent = ["nothing_missing"] if self.verdict in SILENT else []
        self.told = told = silent + [name for name in dict.fromkeys(told) if name not in NOTHING]
        self.group = set(told[:1]).union(*(f.get("ambiguous_with") or [] for f in findings[:1]))
        self.first = told[:1] != [] and told[0] in self.names
        self.set = bool(self.group & set(self.names))
        self.two = bool(set(told[:2]) & set(self.names)) if len(self.names) < 2 else set(told[:2]) == set(self.names)
        self.detected = self.verdict not in SILENT | {"none"}
        p = {("nothing_missing" if c["effect"] in NOTHING else c["effect"]): c.get("probability") or 0 for c in ranked}
        p.setdefault("nothing_missing", max(0.0, 1 - sum(p.values())))
        self.p = min(1.0, sum(p.get(name, 0) for name in self.names)) if ranked else None
        top = max(p, key=p.get) if ranked else None
        self.claim = (p[top], top in self.names) if ranked else None
        self.locate(findings)
        held = (said.get("fit") or {}).get("held_out") or {}
        error = [(held.get(key) or {}).get("position_rmse_m") for key in ("augmented", "retuned")]
        self.held_out = ratio(*error)
        self.unseen = self.on_unseen(load(out / "unseen.json"))
        self.seconds = (load(out / "run.json") or {}).get("seconds")
        self.signal = truth["signal_left"]
        self.kind = truth["variant"] if self.family == "lookalike" else " + ".join(e["effect"] for e in effects)

    def locate(self, findings: list) -> None:
        """Overlap of the interval, and the parameters' errors."""
        self.overlap, self.errors = None, []
        right = {f["effect"]: f for f in findings if f["effect"] in self.names}
        for act in self.truth["drives"]["drive"]["acts"]:
            best = right.get(act["effect"]) or (findings[0] if findings else {})
            where = [w for w in best.get("where") or [] if w.get("recording", "drive") == "drive" and "start" in w]
            self.overlap = overlap([[w["start"], w["end"]] for w in where], act["intervals"])
        for effect in self.truth["effects"]:
            if effect["effect"] in right:
                self.errors += parameters(effect, right[effect["effect"]])

    @staticmethod
    def on_unseen(scores: dict | None) -> float | None:
        """Position error of the model over the nominal one's."""
        models = {m["model"]: m for r in (scores or {}).get("recordings", [])[:1] for m in r["models"]}
        return ratio(*(((models.get(key) or {}).get("position_m") or {}).get("rmse", {}).get("value")
                       for key in ("given_model", "nominal_soil")))

    @property
    def right(self) -> bool:
        """Whether the answer is one that the truth allows."""
        if self.verdict not in self.truth["expected"]:
            return False
        if "two recordings" in self.truth["variant"]:
            return self.first and len(self.group) == 1
        return self.verdict in {"nothing_missing", "insufficient_data", "unknown_physics"} or self.set

    def line(self) -> str:
        """What was told of it, and what would have been right."""
        truth = ", ".join(f"{e['effect']} ({e['size']})" for e in self.truth["effects"]) or "nothing"
        told = ", ".join(self.told[:2]) + (f" of {sorted(self.group)}" if len(self.group) > 1 else "")
        p = "" if self.p is None else f", p(truth) {self.p:.2f}"
        where = f"{self.name} {self.family} {self.truth['variant']}".strip()
        return f"  {where}: {truth}, signal {self.signal:.1f}; told {self.verdict}: {told}{p}"


def share(values: list) -> str:
    return f"{100 * sum(values) / len(values):.0f} %" if values else "-"


def middle(values: list) -> str:
    values = [v for v in values if v is not None]
    return f"{statistics.median(values):.2f}" if values else "-"


def row(label: str, cases: list[Case]) -> str:
    counts = Counter(case.verdict for case in cases)
    verdicts = "".join(f"{counts[v] or '.':>5}" for v in [*VERDICTS, "none"])
    p = [case.p for case in cases if case.p is not None]
    errors = [pair for case in cases for pair in case.errors]
    cells = [share([c.detected for c in cases]), share([c.first for c in cases]), share([c.set for c in cases]),
             share([c.two for c in cases]), f"{statistics.mean(p):.2f}" if p else "-",
             middle([c.overlap for c in cases]), middle([e for e, _ in errors]), share([c for _, c in errors]),
             middle([c.held_out for c in cases]), middle([c.unseen for c in cases]), share([c.right for c in cases])]
    return f"{label[:40]:<41}{len(cases):>4}{verdicts} " + "".join(f"{cell:>9}" for cell in cells)


def calibration(cases: list[Case]) -> float:
    """Mean distance of the first answer's probability from how often it is right, in ten bins."""
    claims = [case.claim for case in cases if case.claim]
    bins = [[c for c in claims if min(9, int(10 * c[0])) == k] for k in range(10)]
    return sum(abs(sum(p - right for p, right in b)) for b in bins) / max(1, len(claims))


def report(cases: list[Case]) -> None:
    heads = ["detect", "first", "set", "two", "p(truth)", "IoU", "error", "cover", "held-out", "unseen", "right"]
    print(f"{'':<41}{'n':>4}" + "".join(f"{s:>5}" for s in [v[:4] for v in VERDICTS] + ["none"]) + " " + "".join(f"{h:>9}" for h in heads))
    for family in dict.fromkeys(case.family for case in cases):
        own = [case for case in cases if case.family == family]
        print(row(family, own))
        kinds = sorted({case.kind for case in own})
        for kind in kinds if len(kinds) > 1 else []:
            print(row("  " + (kind or "nothing"), [case for case in own if case.kind == kind]))
    print(row("all", cases))
    told = [case for case in cases if case.verdict != "none"]
    nothing = [case for case in told if case.family == "nothing"]
    print(f"\nfalse alarms: {share([c.detected for c in nothing])} of {len(nothing)}")
    plain = [case for case in told if case.signal >= 8 and case.family not in {"nothing", "poor"}]
    print(f"detection where the signal left is 8 or more: {share([c.detected for c in plain])} of {len(plain)}")
    named = [case for case in plain if case.family in {"single", "sensor", "local", "terrain_change"} and "unknown" not in case.names]
    print(f"of these named first / first two: {share([c.first for c in named])} / {share([c.two for c in named])} of {len(named)}")
    print(f"calibration error: {calibration(told):.3f}")
    alike = [case for case in told if case.family == "lookalike" and case.detected]
    print(f"look-alikes: size of the set {statistics.mean([len(c.group) for c in alike] or [0]):.1f}; truth in it "
          f"{share([c.set for c in alike])}; resolved with a second recording "
          f"{share([c.right for c in alike if 'two' in c.kind])}")
    outside = [case for case in told if "unknown" in case.names]
    wrong = [case.verdict in {"missing_physics", "sensor"} and not case.first for case in outside]
    print(f"outside of the catalogue, wrongly named: {share(wrong)} of {len(outside)}")
    seconds = sorted(case.seconds for case in cases if case.seconds)
    if seconds:
        print(f"seconds: median {statistics.median(seconds):.1f}, longest {seconds[-1]:.1f}")
    print("\nnot right:")
    for case in cases:
        if not case.right:
            print(case.line())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", type=Path, help="folder with CASE/ and CASE.truth.json")
    parser.add_argument("results", type=Path, help="folder with CASE/diagnosis.json")
    parser.add_argument("--run", metavar="UGV", help="diagnose what has no result yet with this binary")
    parser.add_argument("--jobs", type=int, default=2, help="diagnoses at a time [default: 2]")
    parser.add_argument("--limit", type=float, default=600, help="seconds that one may take [default: 600]")
    parser.add_argument("--family", help="only cases of this family")
    args = parser.parse_args()
    truths = [load(path) for path in sorted(args.cases.glob("*.truth.json"))]
    truths = [truth for truth in truths if truth and args.family in (None, truth["family"])]
    if not truths:
        sys.exit(f"{args.cases}: no such *.truth.json")
    if args.run:
        run(args.run, args.cases, args.results, [truth["case"] for truth in truths], args.jobs, args.limit)
    report([Case(truth, args.results / truth["case"]) for truth in truths])


if __name__ == "__main__":
    main()
