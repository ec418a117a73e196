"""Has every importer drive the FMU through the same manoeuvre, and compares what comes out with the library itself.

Each importer has a separate virtual environment below target/importers, with the versions of scripts/tools/importers/requirements.
One that cannot be installed, or fails, is told and does not stop the others. Exit status: 0 when all that was asked for gave what
is expected of it, 1 when something did not, 2 for wrong arguments.
"""

import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from pathlib import Path

import task
from comparison import Deviation, Unfit, compare, read
from runs import FMI_2, IMPORTERS, RUNS, Run

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
TARGET = ROOT / "target"  # of the virtual environments, as scripts/setup.sh has it
BUILT = Path(os.environ.get("CARGO_TARGET_DIR", TARGET))
MARKS = ("<!-- written by scripts/tools/importers.sh -->", "<!-- end -->")
NOT_RUN = "not run"
LAST_LINES = 12  # of what a failing importer said


@dataclass(frozen=True)
class Result:
    """What came of a run."""

    run: Run
    version: str
    deviations: dict[str, Deviation] = field(default_factory=dict)
    failure: str = ""

    @property
    def expected(self) -> bool:
        """Whether it is what the run expects."""
        run = self.run
        if run.fault:
            return re.search(run.fault, self.failure) is not None
        if self.failure:
            return False
        if run.wrong_by:
            return max(deviation.share for deviation in self.deviations.values()) >= run.wrong_by
        return all(deviation.share <= run.allowed[group] for group, deviation in self.deviations.items())

    @property
    def verdict(self) -> str:
        """One or two words."""
        if self.failure == NOT_RUN:
            return NOT_RUN
        if self.run.fault or self.run.wrong_by:
            return "importer's fault" if self.expected else "NOT AS DESCRIBED"
        return "passed" if self.expected else "FAILED"

    @property
    def finding(self) -> str:
        """The deviations, or why there are none."""
        if self.failure == NOT_RUN:
            return ""
        if self.failure:
            return "refused" if self.run.fault and self.expected else "failed"
        if self.run.check_only:
            return "no complaint"
        worst = max(self.deviations.values(), key=lambda deviation: deviation.share)
        if len(set(self.run.allowed.values())) == 1 or self.run.wrong_by:
            return str(worst)
        return "; ".join(f"{group} {deviation}" for group, deviation in self.deviations.items())

    def cells(self) -> list[str]:
        """The row of the table."""
        run = self.run
        allowed = "" if run.fault or run.wrong_by or run.check_only else "; ".join(f"{share:g}" for share in dict.fromkeys(run.allowed.values()))
        return [run.importer, self.version, run.interface, run.what, self.finding, allowed, self.verdict]


HEADER = ["importer", "version", "interface", "what it did", "largest deviation", "allowed", "verdict"]


def markdown(results: Iterable[Result]) -> str:
    """The table."""
    rows = [HEADER, ["---"] * len(HEADER), *(result.cells() for result in results)]
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def say(text: str) -> None:
    print(f"importers: {text}", file=sys.stderr, flush=True)


def run_command(command: list[object], **options: object) -> str:
    """Runs a program; why it failed, or nothing."""
    try:
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, errors="replace", check=False, **options)
    except subprocess.TimeoutExpired as late:
        return f"not done after {late.timeout:.0f} s"
    except OSError as error:
        return str(error)
    if done.returncode == 0:
        return ""
    lines = (done.stdout + done.stderr).strip().splitlines()[-LAST_LINES:]
    return "\n".join([*lines, f"(exit status {done.returncode})"])


def install(name: str) -> str:
    """Sets up an importer, unless it is there as it should be; why that failed, or nothing."""
    folder, importer = TARGET / "importers" / name, IMPORTERS[name]
    stamp = f"{sys.version}\n{importer.pinned(HERE)}"
    if (folder / "stamp").is_file() and (folder / "stamp").read_text() == stamp:
        return ""
    say(f"installing {name}")
    for command, environment in importer.install(HERE, folder, TARGET):
        # From here, as cargo reads .cargo/config.toml of the folder that it is called in.
        if failure := run_command(command, cwd=ROOT, env=os.environ | environment):
            return failure
    (folder / "stamp").write_text(stamp)
    return ""


def drive(run: Run, fmus: dict[str, Path], scratch: Path, limit: float) -> tuple[Path, str]:
    """Has an importer drive: where the motion is, and why it failed, or nothing."""
    folder = scratch / run.name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    fmu = Path(shutil.copy(fmus[run.fmu], folder / "ugv.fmu"))
    output = folder / "motion.csv"
    program = IMPORTERS[run.importer].program(HERE, TARGET / "importers" / run.importer)
    command = [*program, run.drive, fmu, scratch / run.start, output]
    failure = run_command(command, cwd=folder, timeout=limit, env=os.environ | {"PYTHONPATH": str(HERE), "TMPDIR": str(folder)})
    if not failure and not run.check_only and not output.is_file():
        failure = f"{output} was not written"
    return output, failure


def identity(run: Run, fmus: dict[str, Path], scratch: Path) -> str:
    """Changes with whatever a run's result may depend on."""
    texts = [repr(run), IMPORTERS[run.importer].pinned(HERE)]
    files = [fmus[run.fmu], scratch / run.start / "motion.csv", scratch / run.start / "start.json", HERE / "task.py", HERE / "comparison.py"]
    files += [path for path in IMPORTERS[run.importer].program(HERE, TARGET / "importers" / run.importer)[1:] if Path(path).suffix == ".py"]
    digest = hashlib.sha256("\n".join(texts).encode())
    for path in files:
        digest.update(Path(path).read_bytes())
    return digest.hexdigest()


def remembered(run: Run, scratch: Path, key: str) -> Result | None:
    """The result of an earlier run of the very same."""
    try:
        told = json.loads((scratch / run.name / "result.json").read_text())
        deviations = {group: Deviation(**found) for group, found in told["deviations"].items()}
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return Result(run, IMPORTERS[run.importer].version(HERE), deviations, told["failure"]) if told["key"] == key else None


def remember(result: Result, scratch: Path, key: str) -> None:
    """Keeps a result for the next time, if it is what is expected: what is not is tried again."""
    if result.expected:
        deviations = {group: asdict(found) for group, found in result.deviations.items()}
        told = {"key": key, "deviations": deviations, "failure": result.failure}
        (scratch / result.run.name / "result.json").write_text(json.dumps(told))


def judged(run: Run, fmus: dict[str, Path], scratch: Path, limit: float) -> Result:
    """A run and its comparison."""
    version = IMPORTERS[run.importer].version(HERE)
    if failure := install(run.importer):
        return Result(run, version, failure=f"cannot be installed:\n{failure}")
    motion, failure = drive(run, fmus, scratch, limit)
    if failure or run.check_only:
        return Result(run, version, failure=failure)
    try:
        native = read(scratch / run.start / "motion.csv", run.side)
        return Result(run, version, compare(read(motion), native, run.first, run.omitted))
    except Unfit as error:
        return Result(run, version, failure=str(error))


def prepare(scratch: Path, native: Path) -> None:
    """Writes the manoeuvre, and has the library drive it."""
    for name, start in task.starts().items():
        folder = scratch / name
        folder.mkdir(parents=True, exist_ok=True)
        rows = ["time,omega_left,omega_right", *(",".join(map(repr, row)) for row in task.manoeuvre())]
        (folder / "drive.csv").write_text("\n".join(rows) + "\n")
        (folder / "start.json").write_text(json.dumps(start))
        command = [native, folder / "drive.csv", folder / "start.json", folder / "motion.csv"]
        if failure := run_command(command):
            sys.exit(f"importers: the library itself cannot drive:\n{failure}")


def results_of_all(results: list[Result], fmus: dict[str, Path], scratch: Path) -> list[Result]:
    """Results of every run, in the order of the table: new ones, earlier ones, or that it was not run."""
    new, found = {result.run.name: result for result in results}, []
    for run in RUNS:
        earlier = new.get(run.name) or remembered(run, scratch, identity(run, fmus, scratch))
        found.append(earlier or Result(run, IMPORTERS[run.importer].version(HERE), failure=NOT_RUN))
    return found


def write_page(page: Path, table: str) -> None:
    """Puts the table between the page's marks."""
    text = page.read_text(encoding="utf-8")
    before, begin, rest = text.partition(MARKS[0])
    _, end, after = rest.partition(MARKS[1])
    if not begin or not end:
        sys.exit(f"importers: {page} lacks the lines {MARKS[0]} and {MARKS[1]}, between which the table belongs")
    beside = page.with_name(f".{page.name}")
    beside.write_text(f"{before}{begin}\n\n{table}\n{end}{after}", encoding="utf-8")
    beside.replace(page)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="importers.sh", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("names", nargs="*", metavar="NAME", help=f"importers to run, of {', '.join(IMPORTERS)} [default: all]")
    add("--fmu", type=Path, default=BUILT / "ugv.fmu", help="FMU of FMI 2.0 [default: target/ugv.fmu]")
    add("--fmu3", type=Path, default=BUILT / "ugv-fmi3.fmu", help="the same of FMI 3.0 [default: target/ugv-fmi3.fmu]")
    add("--limit", type=float, default=900, metavar="S", help="seconds that one drive may take [default: 900]")
    add("--again", action="store_true", help="also run what gave the expected with the same FMU, importer and driver before")
    add("--page", type=Path, help="Markdown page to put the table into, between its marks; of importers that are not run, with what they gave before")
    add("--native", type=Path, required=True, help=argparse.SUPPRESS)
    args = parser.parse_args()
    if unknown := set(args.names) - set(IMPORTERS):
        parser.error(f"no such importer: {', '.join(sorted(unknown))}; there are {', '.join(IMPORTERS)}")
    for path in (args.fmu, args.fmu3, args.native):
        if not path.is_file():
            parser.error(f"{path} is not there; scripts/package.sh builds the FMUs")
    return args


def main() -> int:
    """Runs what is asked for, and prints the table."""
    args = arguments()
    scratch = TARGET / "importers" / "drives"
    prepare(scratch, args.native.resolve())
    fmus = {FMI_2: args.fmu.resolve(), "3.0": args.fmu3.resolve()}
    runs = [run for run in RUNS if not args.names or run.importer in args.names]
    results, begun = [], time.monotonic()
    for number, run in enumerate(runs, 1):
        key = identity(run, fmus, scratch)
        result = None if args.again else remembered(run, scratch, key)
        if result is None:
            result = judged(run, fmus, scratch, args.limit)
            remember(result, scratch, key)
        results.append(result)
        left = (time.monotonic() - begun) / number * (len(runs) - number)
        say(f"{number}/{len(runs)} {run.name}: {result.verdict}, {result.finding}; about {left:.0f} s left")
        if result.failure:
            say("\n  ".join(["it said:", *result.failure.splitlines()]))
    table = markdown(results)
    print(table)
    if args.page:
        write_page(args.page, markdown(results_of_all(results, fmus, scratch)))
    return int(any(not result.expected for result in results))


if __name__ == "__main__":
    sys.exit(main())
