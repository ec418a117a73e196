"""Command line: `scripts/prove.sh draw --out CASES --cases N --seed S`."""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
import time
from pathlib import Path

from .cases import case_name, is_complete, try_case, write_json
from .families import FAMILIES, MIXES

EPILOG = """\
A set is a folder: set.json, one folder per case (drive.csv and drive.json; second.* in some look-alike cases;
unseen.* for the score), and sealed/CASE.json with the truth. The same seed gives the same bytes whatever --jobs,
--first and --cases are; a case that is complete is left as it is, so a run that was cut off goes on where it stopped.

examples:
  scripts/prove.sh draw --out target/cases --cases 300 --seed 7 --jobs 2
  scripts/prove.sh draw --out hidden --cases 10 --seed 1 --family absorbed
  scripts/prove.sh draw --out others --cases 24 --seed 46 --mix other
"""


def _arguments(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="prove.sh draw", description="Make test recordings of skid-steer vehicles with physics that a model left out.",
        epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", required=True, type=Path, metavar="CASES", help="folder of the set; made if it is not there")
    parser.add_argument("--cases", type=int, default=300, metavar="N", help="how many [default: 300]")
    parser.add_argument("--first", type=int, default=0, metavar="K", help="number of the first of them [default: 0]")
    parser.add_argument("--seed", type=int, default=1, metavar="S", help="seed of everything random, 0 or more [default: 1]")
    parser.add_argument("--family", choices=FAMILIES, metavar="F",
                        help=f"only this family: {', '.join(FAMILIES)} [default: those of the mix]")
    parser.add_argument("--mix", choices=MIXES, default="usual", metavar="M",
                        help="usual, or other: mechanisms by other formulas than the catalogue's, and other noise [default: usual]")
    parser.add_argument("--pivots", action="store_true",
                        help="a second recording of turns on the spot in every case that has none (second.csv)")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="processes, 1 or 2 [default: 1]")
    arguments = parser.parse_args(argv)
    if arguments.cases < 1:
        parser.error(f"--cases {arguments.cases} makes nothing; give 1 or more")
    if arguments.first < 0:
        parser.error(f"--first {arguments.first} is negative; give 0 or more")
    if arguments.first + arguments.cases > 10000:
        parser.error(f"--first {arguments.first} --cases {arguments.cases} is more than names of four digits hold; end at 9999 or before")
    if arguments.seed < 0:
        parser.error(f"--seed {arguments.seed} is negative; give 0 or more")
    if arguments.jobs not in (1, 2):
        parser.error(f"--jobs {arguments.jobs} is not 1 or 2; give one of them")
    if arguments.out.exists() and not arguments.out.is_dir():
        parser.error(f"--out {arguments.out} is a file; give a folder")
    try:
        (arguments.out / "sealed").mkdir(parents=True, exist_ok=True)
    except OSError as error:
        parser.error(f"--out {arguments.out} cannot be made ({error.strerror}); give a folder that can be written")
    if others := _others(arguments):
        parser.error(f"--out {arguments.out} holds other cases ({others}); take another --out")
    return arguments


def _others(a: argparse.Namespace) -> str:
    """Which cases a folder holds, where they are not those that are asked for. Older sets do not tell their family."""
    try:
        held = json.loads((a.out / "set.json").read_text())
    except (OSError, json.JSONDecodeError):
        return ""
    mix = held.get("mix", "usual")
    if (held.get("seed"), held.get("family", a.family), mix) == (a.seed, a.family, _mix(a)):
        return ""
    everything = "all families" if mix == "usual" else f"all families of the mix {mix}"
    return f"seed {held.get('seed')}" + (f", {held['family'] or everything}" if "family" in held else "")


def _mix(a: argparse.Namespace) -> str:
    """The mix that cases are of; one family is of any."""
    return "usual" if a.family else a.mix


def main(argv: list[str] | None = None) -> int:
    """0 done, 1 some cases failed, 2 wrong arguments."""
    a = _arguments(argv)
    wanted = range(a.first, a.first + a.cases)
    mix = {} if _mix(a) == "usual" else {"mix": _mix(a)}
    write_json(a.out / "set.json", {"format": "ugv-proof-set/1", "seed": a.seed, "family": a.family, **mix,
                                    "cases": [case_name(i) for i in wanted]})
    tasks = [(a.out, a.seed, i, a.family, a.pivots, _mix(a)) for i in wanted
             if not is_complete(a.out, i, a.pivots)]
    if len(tasks) < a.cases:
        print(f"generator: {a.cases - len(tasks)} of {a.cases} cases are there already", file=sys.stderr)
    begin, failed = time.monotonic(), 0
    pool = multiprocessing.get_context("spawn").Pool(a.jobs) if a.jobs > 1 and len(tasks) > 1 else None
    try:
        done = pool.imap_unordered(try_case, tasks) if pool else map(try_case, tasks)
        for count, (index, error) in enumerate(done, 1):
            failed += bool(error)
            if error:
                print(f"generator: {case_name(index)} failed: {error}", file=sys.stderr)
            left = (time.monotonic() - begin) / count * (len(tasks) - count)
            print(f"generator: {count} of {len(tasks)}, {left / 60:.1f} min left", file=sys.stderr)
    finally:
        if pool:
            pool.terminate()
    if failed:
        print(f"generator: {failed} cases failed; run the command again with another --seed and another --out", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
