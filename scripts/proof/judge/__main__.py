"""Draws cases with a sealed truth, has `ugv diagnose` and its peers answer them, opens the truth, and writes a page.

What has a result is not redone: the same command goes on where it was interrupted. A set may be answered in parts
(--first, --cases), on several machines, and judged together from their answers.jsonl (--answers).
"""

import argparse
import secrets
import signal
import subprocess
import sys
import time
from pathlib import Path

from . import answers, files
from .case import Judged
from .drawing import figure
from .listing import listing
from .page import page
from .peers import NAMES
from .prediction import compared
from .report import NOT_ANSWERING, report
from .run import Bench, Processes, each, resumable
from .tables import tables

ROOT = Path(__file__).resolve().parents[3]


def arguments(given: list[str] | None = None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="prove.sh", description=__doc__)
    parser.add_argument("--cases", type=int, default=300, metavar="N", help="cases to draw [default: 300]")
    parser.add_argument("--first", type=int, default=0, metavar="K", help="number of the first of them [default: 0]")
    parser.add_argument("--seed", type=int, metavar="S", help="seed of the cases [default: a new one]")
    parser.add_argument("--family", action="append", default=[], metavar="F", help="only cases of this family; may be repeated")
    parser.add_argument("--mix", default="usual", metavar="M", help="usual, or other: other formulas than the catalogue's, and other noise [default: usual]")
    parser.add_argument("--out", type=Path, default=ROOT / "target" / "proof", metavar="DIR", help="[default: target/proof]")
    parser.add_argument("--set", type=Path, metavar="CASES", help="judge these cases instead of drawing new ones")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="cases at a time [default: 2]")
    parser.add_argument("--no-peers", action="store_true", help="only ugv")
    parser.add_argument("--peers", default=",".join(NAMES), metavar="NAMES", help="[default: %(default)s]")
    parser.add_argument("--limit", type=float, default=600, metavar="S", help="seconds that one diagnosis may take [default: 600]")
    parser.add_argument("--peer-limit", type=float, metavar="S", help="seconds that each peer and the oracle may take [default: as --limit]")
    parser.add_argument("--page", action="store_true", help="run nothing; judge what has been answered so far, of the cases from --first on")
    parser.add_argument("--answers", type=Path, nargs="+", default=[], metavar="JSONL",
                        help="run nothing; judge the cases of these files (.jsonl or .jsonl.gz) together, parts of one set or several sets")
    parser.add_argument("--tool", type=Path, required=True, help=argparse.SUPPRESS)
    args = parser.parse_args(given)
    args.peer_limit = args.limit if args.peer_limit is None else args.peer_limit
    args.peers = [] if args.no_peers else [name for name in args.peers.split(",") if name]
    if unknown := set(args.peers) - set(NAMES):
        parser.error(f"no such peer: {', '.join(sorted(unknown))}; there are {', '.join(NAMES)}")
    return args


def draw(args: argparse.Namespace) -> tuple[list[Path], int]:
    """Folders of cases, drawn as far as they are not there, and their seed."""
    drawn = files.load(args.out / "drawn.json") or {}
    seed = args.seed if args.seed is not None else drawn.get("seed", secrets.randbelow(2**31))
    wanted = {"seed": seed, "families": sorted(args.family)} | ({"mix": args.mix} if args.mix != "usual" else {})
    if drawn and drawn != wanted:
        sys.exit(f"prove: {args.out} holds other cases (seed {drawn['seed']}); take another --out or remove it")
    files.save(args.out / "drawn.json", wanted)
    cases = args.out / "cases"
    sets = {cases / family: ["--family", family] for family in wanted["families"]} or {cases: ["--mix", args.mix]}
    for folder, family in sets.items():
        if not args.page:
            print(f"prove: {args.cases} cases from {args.first} on, seed {seed} {' '.join(family)}", file=sys.stderr)
            command = [sys.executable, "-m", "generator", "--out", folder, "--first", args.first, "--cases", args.cases,
                       "--seed", seed, "--jobs", min(args.jobs, 2)]
            if subprocess.run(list(map(str, [*command, *family])), check=False).returncode:
                sys.exit("prove: the cases could not be drawn")
    return list(sets), seed


def listed(sets: list[Path], root: Path) -> list[str]:
    """The cases of all sets, by their paths below the root."""
    names = []
    for folder in sets:
        told = files.load(folder / "set.json")
        if told is None:
            sys.exit(f"prove: {folder / 'set.json'} is not there or broken")
        names += [str((folder / name).relative_to(root)) for name in told["cases"]]
    return names


def numbered(sets: list[Path], root: Path, wanted: range) -> list[str]:
    """The cases of these numbers that are there with their truths, by their paths below the root."""
    names = (str((folder / path.stem).relative_to(root)) for folder in sets for path in sorted((folder / "sealed").glob("case_*.json")))
    return [name for name in names if int(name.rpartition("_")[2]) in wanted]


def claim(out: Path, folder: Path) -> None:
    """Results in a folder belong to one set of cases: refuses those of another. Older sets do not tell their family."""
    described, known = files.load(folder / "set.json") or {}, files.load(out / "judged.json") or {}
    own = {"seed": None} | {key: described[key] for key in ("seed", "family", "mix") if key in described}
    if any(known.get(key, value) != value for key, value in own.items()):
        theirs, ours = (f"{of['seed']}" + (f" and family {of['family']}" if of.get("family") else "") for of in (known, own))
        sys.exit(f"prove: {out} holds answers to other cases (seed {theirs}, these are of {ours}); take another --out or remove it")
    files.save(out / "judged.json", known | own)


def sealed(case: Path) -> dict:
    """A case's truth."""
    truth = files.load(case.parent / "sealed" / f"{case.name}.json")
    return truth or sys.exit(f"prove: no truth of {case}")


def judged(name: str, truth: dict, results: Path, own: str) -> Judged:
    """What the tool ("mended"), or a peer, made of a case."""
    folder = results / name
    stages = {key: files.load(folder / f"{key}.json") or {} for key in ("nominal", "retuned", "oracle", own)}
    unseen = compared({"own" if key == own else key: stage.get("unseen") for key, stage in stages.items()})
    oracle = stages["oracle"].get("status", "not run")
    if own in NOT_ANSWERING:
        unseen[own] = unseen["own"]
    if own == "mended":
        run = files.load(folder / "answer" / "run.json") or {}
        said = files.load(folder / "answer" / "diagnosis.json") if run.get("status") == 0 else None
        return Judged(name, truth, said, unseen, run.get("seconds"), run.get("status", "not run"), oracle)
    return Judged(name, truth, stages[own].get("answer"), unseen, stages[own].get("seconds"), stages[own].get("status", "not run"), oracle)


def answered(args: argparse.Namespace) -> tuple[dict[str, list[Judged]], dict]:
    """Draws cases, has them answered, opens the truths: everyone's answers, and how they came about."""
    sets, seed = ([args.set], None) if args.set else draw(args)
    if args.set:
        claim(args.out, args.set)
    root = (args.set or args.out / "cases").resolve()
    folders, results = [folder.resolve() for folder in sets], (args.out / "results").resolve()
    some = args.page and not args.set
    names = numbered(folders, root, range(args.first, args.first + args.cases)) if some else listed(folders, root)
    processes = Processes()
    tool = args.tool.resolve()
    bench = Bench(tool, files.fingerprint(tool), root, results, args.limit, args.peer_limit, processes)
    begin = time.time()
    if not args.page:
        each("answers", names, lambda name: bench.answer(name, args.peers), args.jobs, processes)
        each("oracle", names, bench.open, args.jobs, processes)
    done = [name for name in names if (results / name / "answer" / "run.json").exists()]
    if not done:
        sys.exit("prove: nothing has been answered yet")
    truths = {name: sealed(root / name) for name in done}
    methods = ["mended", *NOT_ANSWERING, *args.peers]
    everyone = {own: [judged(name, truth, results, own) for name, truth in truths.items()] for own in methods}
    tools = {(files.load(results / name / "answer" / "run.json") or {}).get("tool", "unknown") for name in done}
    seeds = sorted({truth["seed"] for truth in truths.values()}) if seed is None else [seed]
    return everyone, {"seed": seeds, "drawn": len(names), "answered": len(done), "tool": sorted(tools), "limit_s": args.limit,
                      "took_s": round(time.time() - begin)}


def main() -> None:
    args = arguments()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    files.make_folder(args.out)
    everyone, facts = answers.load(args.answers) if args.answers else answered(args)
    summary = report(everyone, facts)
    if not args.answers:
        files.write(args.out / "answers.jsonl", answers.lines(everyone, facts))
    files.save(args.out / "proof.json", summary)
    files.write(args.out / "cases.csv", listing(summary["cases"]))
    files.write(args.out / "proof.svg", figure(everyone["mended"], summary["reliability"]))
    files.write(args.out / "proof.md", tables(summary))
    files.write(args.out / "proof.html", page(everyone["mended"], summary, linked=not args.answers))
    print(f"prove: {args.out / 'proof.html'}", file=sys.stderr)


if __name__ == "__main__":
    resumable(main)
