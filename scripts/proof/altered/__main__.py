"""Conceals a change of our own in real recordings, has `ugv diagnose` answer them, and tells what it made of it.

What has an answer is not asked again: the same command goes on where it was interrupted.
"""

import argparse
import os
import shutil
import signal
import sys
from pathlib import Path

from judge import files
from judge.run import Processes, each, resumable

from .cases import Case, cases, located
from .recordings import joined, stretches

ROOT = Path(__file__).resolve().parents[3]
RUN = "run.json"  # which tool gave an answer


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="prove.sh altered", description=__doc__)
    parser.add_argument("--data", type=Path, default=Path(os.environ.get("UGV_DATA", ROOT.parent / "shared" / "data")), metavar="DIR",
                        help="has recordings/ [default: $UGV_DATA or ../shared/data beside the project]")
    parser.add_argument("--out", type=Path, default=ROOT / "target" / "altered", metavar="DIR", help="[default: target/altered]")
    parser.add_argument("--only", action="append", default=[], metavar="CASE", help="only these; may be repeated")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="recordings at a time [default: 2]")
    parser.add_argument("--limit", type=float, default=1800, metavar="S", help="seconds that one may take [default: 1800]")
    parser.add_argument("--tool", type=Path, required=True, help=argparse.SUPPRESS)
    args = parser.parse_args()
    known = [case.name for case in cases()]
    if unknown := [name for name in args.only if name not in known]:
        parser.error(f"--only {unknown[0]}: no such case; there are {', '.join(known)}")
    return args


def answered(out: Path, mark: str) -> dict | None:
    """What this very tool said of a case."""
    told = files.load(out / "answer" / RUN) or {}
    return files.load(out / "answer" / "diagnosis.json") if told.get("tool") == mark else None


def short(said: dict) -> str:
    """What an answer found, with probabilities."""
    found = [f"{f['effect']}{' here and there' if f['local'] else ''} {100 * f['probability']:.0f} %" for f in said["findings"]]
    return ", ".join(found) or said["verdict"]


def judged(case: Case, data: Path, answers: dict[str, dict]) -> dict:
    """A case with what was said of it."""
    said = answers[case.name]
    errors = said["fit"]["held_out"] or {}
    held = {key: errors[key]["position_rmse_m"] for key in ("nominal", "retuned", "augmented") if key in errors}
    result = {"case": case.name, "what": case.what, "verdict": said["verdict"], "said": short(said), "position_m": held}
    if case.concealed and case.before in answers:
        finding = case.concealed.finding(said)
        moved = case.concealed.moved(answers[case.before], said)
        result |= {"effect": case.concealed.effect, "found": finding is not None,
                   "probability": finding["probability"] if finding else 0.0, "moved": moved,
                   "truth": case.concealed.moves, "unit": case.concealed.unit}
    parts = case.make(data)
    if len(parts) > 1:
        result["overlap"] = located(said, stretches(parts))
    return result


def row(result: dict) -> str:
    """A line of the table."""
    metres = ", ".join(f"{value:.2g}" for value in result["position_m"].values())
    told = "–"
    if "moved" in result:
        told = f"{result['moved']:.3f} of {result['truth']:.3f} {result['unit']}" if result["found"] else f"{result['effect']} not found"
    elif result.get("overlap") is not None:
        told = f"overlap {result['overlap']:.2f}"
    return f"| {result['what']} | {result['verdict']}: {result['said']} | {told} | {metres} |"


def main() -> None:
    args = arguments()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    data = args.data / "recordings"
    if not data.is_dir():
        sys.exit(f"prove: {data} is not there: skipped (UGV_DATA names the folder that holds recordings/)")
    files.make_folder(args.out)
    chosen = [case for case in cases() if not args.only or case.name in args.only]
    processes, tool = Processes(), args.tool.resolve()
    mark = files.fingerprint(tool)

    def answer(name: str) -> str | None:
        out = (args.out / name).resolve()
        if answered(out, mark):
            return None
        shutil.rmtree(out / "answer", ignore_errors=True)
        case = next(case for case in chosen if case.name == name)
        joined(case.make(data)).write(out / f"{name}.csv")
        status, said = processes.run([tool, "diagnose", f"{name}.csv", "--output", "answer", "--jobs", "1", "--quiet"], args.limit, out)
        if status != 0:
            return f"{name}: {status}: {said[-200:]}"
        files.save(out / "answer" / RUN, {"tool": mark})
        return None

    each("altered", [case.name for case in chosen], answer, args.jobs, processes)
    # Also of those that were not asked for now: what moved is told against the recording unchanged.
    answers = {case.name: said for case in cases() if (said := answered(args.out / case.name, mark))}
    results = [judged(case, data, answers) for case in cases() if case.name in answers]
    files.save(args.out / "altered.json", {"format": "ugv-altered/1", "tool": mark, "cases": results})
    lines = ["| recording | answer | moved by | position on data not fitted \\[m\\] |", "|---|---|---|---|", *map(row, results)]
    files.write(args.out / "altered.md", "\n".join(lines) + "\n")
    print("\n".join(lines))
    if missing := [case.name for case in chosen if case.name not in answers]:
        sys.exit(f"prove: no answer to {', '.join(missing)}; the same command asks again")


if __name__ == "__main__":
    resumable(main)
