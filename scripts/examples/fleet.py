#!/usr/bin/env python3
"""Runs `ugv diagnose`, `ugv fit` or `ugv score` on a fleet of recordings on Dask workers.

Tool and recordings are shipped to the workers, which need neither. OUT/answers/NAME holds each recording's answer as the tool wrote it,
OUT/fleet.parquet one row per recording. What has an answer is not done again: the same command goes on from where it was cut off.
"""

import argparse
import hashlib
import json
import os
import shutil
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Any

from scale import cluster, table
from scale.tool import ANSWERS, Answer, Fleet, Recording

import pyarrow as pa

sys.path.append(str(Path(__file__).resolve().parents[1]))

from proof.judge import files

TARGET = Path(os.environ.get("CARGO_TARGET_DIR", Path(__file__).resolve().parents[2] / "target"))
RUN = "run.json"  # how an answer came about
LOST = "its workers ended one after the other; it may need more memory than they have"
GONE = "its answer is not there, or is broken; the same command asks for it again"
TYPES = {"error": pa.string(), "verdict": pa.string(), "statement": pa.string(), "names": pa.list_(pa.string()),
         "probabilities": pa.list_(pa.float64())}  # of columns whose values may all be missing or empty
COSTS = ("cpu_seconds", "wall_seconds", "peak_mb")
EPILOG = """\
examples:
  target/venv/bin/python scripts/examples/fleet.py recordings/ --out target/fleet
  target/venv/bin/python scripts/examples/fleet.py monday/*.csv --command score --out target/scores --scheduler tcp://10.0.0.1:8786
  target/venv/bin/python scripts/examples/fleet.py recordings/ --command fit --out target/fits -- --terrain dry_sand --starts 0

NAME.json beside NAME.csv travels with it. What stands behind -- goes to the tool; files named there must be on the workers.
"""


@dataclass(frozen=True)
class Place:
    """Where a recording is, and where its answer goes."""

    name: str
    path: Path
    folder: Path
    mark: str  # fingerprint of the recording, of what is done with it and of the tool

    def is_done(self) -> bool:
        """Whether this very recording has an answer by this very tool."""
        return (files.load(self.folder / RUN) or {}).get("mark") == self.mark

    def save(self, answer: Answer | cluster.Lost) -> None:
        """Writes an answer beside its place, and renames it. One that was lost is looked for again the next time."""
        if isinstance(answer, cluster.Lost):
            files.save(self.folder / RUN, {"status": "lost", "error": LOST, **dict.fromkeys(COSTS)})
            return
        part = self.folder.with_name(self.folder.name + ".part")
        shutil.rmtree(part, ignore_errors=True)
        part.mkdir(parents=True)
        for name, content in answer.files.items():
            (part / name).write_bytes(content)
        told = {"mark": self.mark, "status": answer.status, "error": answer.error, "cpu_seconds": round(answer.cpu_seconds, 3),
                "wall_seconds": round(answer.wall_seconds, 3), "peak_mb": answer.peak_mb and round(answer.peak_mb, 1)}
        files.save(part / RUN, told)
        shutil.rmtree(self.folder, ignore_errors=True)
        os.replace(part, self.folder)


def found(given: list[Path]) -> Iterator[tuple[str, Path]]:
    """Names and paths of the recordings in files and folders."""
    for path in given:
        if path.is_dir():
            yield from ((str(inside.relative_to(path).with_suffix("")), inside) for inside in sorted(path.rglob("*.csv")))
        elif path.is_file():
            yield path.stem, path
        else:
            sys.exit(f"fleet: {path} is not there")


def places(given: list[Path], out: Path, fleet: Fleet) -> list[Place]:
    """All recordings, by name."""
    named: dict[str, Path] = {}
    for name, path in found(given):
        if name in named:
            sys.exit(f"fleet: {named[name]} and {path} have the same name; rename one, or give the folder above both")
        named[name] = path
    if not named:
        sys.exit(f"fleet: no recording (*.csv) in {', '.join(map(str, given))}")
    check_apart(named)
    return [Place(name, path, out / "answers" / name, mark(path, fleet)) for name, path in sorted(named.items())]


def check_apart(named: dict[str, Path]) -> None:
    """Ends where the folder of an answer is within another's, or where another is written: each would delete the other."""
    for name, path in named.items():
        for place in (name, *map(str, PurePath(name).parents)):
            if others := ({place, place.removesuffix(".part")} - {name}) & named.keys():
                sys.exit(f"fleet: the answers to {named[min(others)]} and {path} would be in each other's way; rename one")


def mark(path: Path, fleet: Fleet) -> str:
    """Fingerprint of a recording, of what stands beside it, and of the job."""
    beside = path.with_suffix(".json")
    content = [path.read_bytes(), beside.read_bytes() if beside.is_file() else b"", path.stem.encode(), fleet.name.encode()]
    return hashlib.sha256(b"".join(hashlib.sha256(part).digest() for part in content)).hexdigest()[:16]


def told(command: str, answer: dict, recording: str) -> dict[str, Any]:
    """What a row of the table says of an answer about a recording."""
    if command == "fit":
        return of_fit(answer, recording)
    return {"diagnose": of_diagnosis, "score": of_score}[command](answer)


def of_diagnosis(answer: dict) -> dict[str, Any]:
    """Verdict, names with probabilities, and errors on data not fitted."""
    findings, held_out = answer["findings"], (answer.get("fit") or {}).get("held_out") or {}
    row: dict[str, Any] = {"verdict": answer["verdict"], "statement": answer["statement"]}
    row["names"] = [finding["effect"] for finding in findings]
    row["probabilities"] = [finding["probability"] for finding in findings]
    row["seconds"] = answer["account"]["seconds"]
    for model in ("nominal", "retuned", "augmented"):
        for key in ("position_rmse_m", "heading_rmse_rad"):
            row[f"{model}_{key}"] = (held_out.get(model) or {}).get(key)
    return row


def of_fit(answer: dict, recording: str) -> dict[str, Any]:
    """Each parameter with its interval; those of the recording's sensors under the same names for all recordings."""
    row: dict[str, Any] = {"converged": answer["converged"], "seconds": answer["data"]["seconds"]}
    for parameter in answer["parameters"]:
        name = parameter["name"].removeprefix(f"{recording}.")
        row |= {name + end: parameter[key] for end, key in (("", "value"), ("_low", "low"), ("_high", "high"))}
    return row


def of_score(answer: dict) -> dict[str, Any]:
    """Windows, and each model's median errors with their intervals."""
    recording = answer["recordings"][0]
    row: dict[str, Any] = {"horizon_s": answer["horizon_s"], "windows": recording["windows"], "judged": recording["judged"]}
    for model in recording["models"]:
        for what in ("position_m", "heading_rad"):
            median = (model[what] or {}).get("median") or {}
            name = f"{model['model']}_{what}"
            row |= {name: median.get("value"), f"{name}_low": median.get("low"), f"{name}_high": median.get("high")}
    return row


def row(place: Place, command: str) -> dict[str, Any]:
    """A recording's row: how it went, what was told, what it cost."""
    run = files.load(place.folder / RUN) or {"status": "lost", "error": GONE, **dict.fromkeys(COSTS)}
    answer = files.load(place.folder / ANSWERS[command]) if run["status"] == "done" else None
    result: dict[str, Any] = {"recording": place.name, "status": run["status"], "error": run["error"] or None}
    result |= told(command, answer, place.path.stem) if answer else {}
    return result | {key: run[key] for key in COSTS}


def write_table(path: Path, rows: list[dict[str, Any]], metadata: dict[str, str]) -> None:
    """One row per recording; null where a recording has nothing to tell. What it cost comes last."""
    costs = list(rows[0])[-3:]
    names = [name for name in dict.fromkeys(name for row in rows for name in row) if name not in costs]
    table.write(path, {name: column(name, [row.get(name) for row in rows]) for name in [*names, *costs]}, metadata)


def column(name: str, values: list[Any]) -> pa.Array:
    """A column, of the same type also where no recording has anything to tell."""
    if name in TYPES:
        return pa.array(values, TYPES[name])
    array = pa.array(values)  # of None alone it has no type
    return array.cast(pa.float64()) if pa.types.is_null(array.type) else array


def parse(words: list[str]) -> tuple[argparse.Namespace, list[str]]:
    """The command line, and what of it goes to the tool."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0], epilog=EPILOG,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("recordings", type=Path, nargs="+", metavar="REC", help="recordings (*.csv), or folders of them")
    add("--command", choices=ANSWERS, default="diagnose", help="what is asked of each [default: diagnose]")
    add("--out", type=Path, required=True, metavar="DIR", help="folder of the answers; made if it is not there")
    add("--model", type=Path, metavar="FILE.json", help="model to begin with, as `ugv model` prints it; shipped to the workers")
    add("--tool", type=Path, default=TARGET / "release" / "ugv", help="the tool to ship [default: target/release/ugv]")
    add("--pages", action="store_true", help="keep report.html of a diagnosis (100 kB) beside its JSON files")
    add("--limit", type=float, default=3600.0, metavar="S", help="seconds that a recording may take [default: 3600]")
    add("--quiet", action="store_true", help="no progress")
    cluster.add_arguments(parser)
    own = words.index("--") if "--" in words else len(words)
    arguments = parser.parse_args(words[:own])
    for path, remedy in ((arguments.tool, "build it with scripts/package.sh, or name another with --tool"), (arguments.model, "")):
        if path and not path.is_file():
            parser.error(f"{path} is not there; {remedy}".rstrip("; "))
    return arguments, words[own + 1:]


def main() -> None:
    """Reads the arguments, asks the tool, writes, and prints a line."""
    arguments, passed = parse(sys.argv[1:])
    kept = [".json", *([".html"] if arguments.pages else [])]
    model = arguments.model.read_bytes() if arguments.model else None
    fleet = Fleet(arguments.tool.read_bytes(), arguments.command, passed, model, kept, arguments.limit)
    all_places = places(arguments.recordings, arguments.out, fleet)
    left = [place for place in all_places if not place.is_done()]
    if len(left) < len(all_places) and not arguments.quiet:
        print(f"fleet: {len(all_places) - len(left)} of {len(all_places)} have an answer already", file=sys.stderr)
    if left:
        pieces = (Recording.read(place.name, place.path) for place in left)
        answers = cluster.do_all(arguments, fleet, pieces)
        try:
            for number, answer in cluster.with_progress("fleet", answers, len(left), arguments.quiet):
                left[number].save(answer)
        except RuntimeError as error:
            sys.exit(f"fleet: {error}; what is done is kept, the same command goes on from here")
        except KeyboardInterrupt:
            print("\nfleet: interrupted; the same command goes on from here", file=sys.stderr)
            sys.exit(130)
    rows = [row(place, arguments.command) for place in all_places]
    made_of = {"command": arguments.command, "arguments": passed, "tool": files.fingerprint(arguments.tool)}
    write_table(arguments.out / "fleet.parquet", rows, {"ugv-fleet/1": json.dumps(made_of)})
    done = sum(row["status"] == "done" for row in rows)
    cost = sum(row["cpu_seconds"] or 0.0 for row in rows)
    print(f"{len(rows)} recordings, {done} answered, {cost:.1f} s of processor time, at most {max(row['peak_mb'] or 0.0 for row in rows):.0f} MB; "
          f"{arguments.out / 'fleet.parquet'}")


if __name__ == "__main__":
    main()
