"""The tool `ugv` on recordings: one recording is one piece of work, in a process of its own, on one thread."""

import hashlib
import os
import subprocess
import tempfile
import time
import zlib
from dataclasses import dataclass, field
from pathlib import Path

ANSWER = "answer"  # folder of what the tool writes
MODEL = "model.json"
RECORDING = "recording"  # folder of what it reads
LOOK = 0.02  # s between two looks at the process
ENDS = {0: "done", 1: "failed", 2: "refused"}  # by the tool's exit status

# What a command writes: the answer first.
COMMANDS = {
    "diagnose": ["--output", ANSWER, "--jobs", "1", "--quiet"],
    "fit": ["--json", f"{ANSWER}/fit.json", "--output", f"{ANSWER}/model.json", "--jobs", "1", "--quiet"],
    "score": ["--json", f"{ANSWER}/score.json", "--quiet"],
}
ANSWERS = {"diagnose": "diagnosis.json", "fit": "fit.json", "score": "score.json"}


@dataclass(frozen=True)
class Recording:
    """A recording as it travels, compressed."""

    name: str
    csv: bytes
    about: bytes | None  # what stands beside it
    stem: str  # what the tool calls it

    @classmethod
    def read(cls, name: str, path: Path) -> "Recording":
        beside = path.with_suffix(".json")
        about = zlib.compress(beside.read_bytes(), 1) if beside.is_file() else None
        return cls(name, zlib.compress(path.read_bytes(), 1), about, path.stem)


@dataclass(frozen=True)
class Answer:
    """What became of a recording."""

    name: str
    status: str  # one of ENDS, "timeout" or "ended by signal N"
    error: str  # what the tool said, empty where it is done
    files: dict[str, bytes]
    cpu_seconds: float
    wall_seconds: float
    peak_mb: float | None  # None where it ended before it was looked at


@dataclass(frozen=True)
class Fleet:
    """A job: a command of the tool, with the same arguments for all recordings."""

    tool: bytes
    command: str
    arguments: list[str]
    model: bytes | None  # to begin with
    kept: list[str]  # endings of the files that travel back
    limit: float  # s
    name: str = field(init=False)

    def __post_init__(self) -> None:
        told = repr((self.command, self.arguments, self.model, self.kept, self.limit)).encode()
        object.__setattr__(self, "name", f"fleet-{hashlib.sha256(self.tool + told).hexdigest()[:16]}")

    def setup(self, folder: Path) -> None:
        folder.mkdir(parents=True)
        (folder / "ugv").write_bytes(self.tool)
        (folder / "ugv").chmod(0o755)
        object.__setattr__(self, "folder", folder)

    def do(self, recording: Recording) -> Answer:
        with tempfile.TemporaryDirectory(dir=self.folder) as name:
            place = Path(name)
            (place / ANSWER).mkdir()
            # Under its own name, which the answers tell, and apart: it may have that of another file here.
            path = place / RECORDING / f"{recording.stem}.csv"
            path.parent.mkdir()
            path.write_bytes(zlib.decompress(recording.csv))
            if recording.about is not None:
                path.with_suffix(".json").write_bytes(zlib.decompress(recording.about))
            words = [str(self.folder / "ugv"), self.command, str(path.relative_to(place)), *COMMANDS[self.command], *self.arguments]
            if self.model is not None:
                (place / MODEL).write_bytes(self.model)
                words += ["--model", MODEL]
            status, said, cost = run(words, place, self.limit)
            found = sorted(path for path in (place / ANSWER).iterdir() if path.suffix in self.kept) if status == "done" else []
            return Answer(recording.name, status, "" if status == "done" else said, {path.name: path.read_bytes() for path in found}, *cost)


def run(words: list[str], place: Path, limit: float) -> tuple[str, str, tuple[float, float, float | None]]:
    """How a process ended, what it said, and what it cost: seconds of processor and of clock, most memory [MB]."""
    begin, peak, status = time.monotonic(), 0.0, None
    with (place / "said").open("wb") as said:
        child = subprocess.Popen(words, cwd=place, env=os.environ | {"RAYON_NUM_THREADS": "1"}, stdin=subprocess.DEVNULL,
                                 stdout=subprocess.DEVNULL, stderr=said)
        while True:
            # Not the kernel's sum at the end: it counts the process that this one was forked from.
            peak = max(peak, high_water(child.pid))
            ended, code, usage = os.wait4(child.pid, os.WNOHANG)
            if ended:
                break
            if time.monotonic() - begin > limit:
                status = "timeout"
                child.kill()
            time.sleep(LOOK)
    child.returncode = os.waitstatus_to_exitcode(code)
    status = status or ENDS.get(child.returncode, f"ended by signal {-child.returncode}")
    text = (place / "said").read_text(errors="replace").strip() or status
    return status, text, (usage.ru_utime + usage.ru_stime, time.monotonic() - begin, peak or None)


def high_water(pid: int) -> float:
    """Most memory that a process has had so far [MB]."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0.0
    told = [line for line in lines if line.startswith("VmHWM:")]
    return int(told[0].split()[1]) / 1024 if told else 0.0
