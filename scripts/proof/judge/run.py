"""Runs the tool and its peers on cases, each in a process of its own; what has a result is not redone."""

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

from . import files

PACKAGES = Path(__file__).resolve().parent.parent
ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "NUMBA")}


class Processes:
    """Children, each with a time limit; all of them end when this is stopped."""

    def __init__(self) -> None:
        self.lock, self.running, self.stopped = threading.Lock(), set(), False

    def run(self, command: Sequence[str | Path], limit: float, cwd: Path | None = None) -> tuple[int | str, str]:
        """Exit status or "timeout", and the end of what was said on stderr."""
        environment = os.environ | ONE_THREAD | {"PYTHONPATH": str(PACKAGES)}
        with self.lock:
            if self.stopped:
                raise KeyboardInterrupt
            child = subprocess.Popen([str(part) for part in command], cwd=cwd, env=environment, text=True,
                                     stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True)
            self.running.add(child)
        try:
            said = child.communicate(timeout=limit)[1]
            status: int | str = child.returncode
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            status, said = "timeout", child.communicate()[1]
        finally:
            with self.lock:
                self.running.discard(child)
        if self.stopped:
            raise KeyboardInterrupt
        return status, (said or "")[-2000:]

    def stop(self) -> None:
        """Ends all children."""
        with self.lock:
            self.stopped = True
            for child in self.running:
                if child.poll() is None:
                    os.killpg(child.pid, signal.SIGKILL)


@dataclass(frozen=True)
class Bench:
    """What is common to all cases."""

    tool: Path
    mark: str  # fingerprint of the tool
    cases: Path
    results: Path
    limit: float  # s that a diagnosis may take
    peer_limit: float  # s that anything else may take
    processes: Processes

    def due(self, there: dict) -> bool:
        """Whether a stage's result is to be made again: it failed within a shorter limit, or an earlier judge, which did not
        tell errors by the window, scored it. Before limits were told, what failed by one tells its seconds."""
        if there["status"] == "done":
            return "unseen" in there and "errors" not in there["unseen"]
        return there.get("limit", there.get("seconds", 0.0)) < self.peer_limit

    def stage(self, name: str, stage: str) -> dict:
        """A stage's result, made if it is not there. An answer that is there stays when it is to be scored anew."""
        folder = self.results / name
        path = folder / f"{stage}.json"
        there = files.load(path)
        if there is not None and not self.due(there):
            return there
        command = [sys.executable, "-m", "judge.work", stage, self.cases / name, folder, "--tool", self.tool]
        begin = time.monotonic()
        status, said = self.processes.run(command, self.peer_limit)
        result = files.load(path)
        if status != 0 or result is None:
            last = (said.strip().splitlines() or [""])[-1]
            result = {"status": str(status), "seconds": round(time.monotonic() - begin, 2), "error": last, "limit": self.peer_limit}
            if there is None or there["status"] != "done":
                files.save(path, result)
        return result

    def diagnose(self, name: str) -> dict:
        """The tool's answer; it sees a copy of the recordings given and nothing else."""
        folder = self.results / name
        there = files.load(folder / "answer" / "run.json")
        longer = there is not None and there.get("status") == "timeout" and there.get("limit", self.limit) < self.limit
        if there is not None and there.get("tool") == self.mark and not longer:
            return there
        shutil.rmtree(folder, ignore_errors=True)
        part, given = folder / "answer.part", folder / "given"
        given.mkdir(parents=True)
        drives = [path.stem for path in (self.cases / name).glob("*.csv") if path.stem in ("drive", "second")]
        for stem in sorted(drives):
            for ending in ("csv", "json"):
                shutil.copyfile(self.cases / name / f"{stem}.{ending}", given / f"{stem}.{ending}")
        recordings = [f"{stem}.csv" for stem in sorted(drives)]
        begin = time.monotonic()
        command = [self.tool, "diagnose", *recordings, "--output", part.resolve(), "--jobs", "1", "--within", str(self.limit), "--quiet"]
        status, said = self.processes.run(command, self.limit, given)
        part.mkdir(exist_ok=True)
        if status == 0 and not (files.load(part / "diagnosis.json") or {}).get("verdict"):
            status = "no answer"
        record = {"status": status, "seconds": round(time.monotonic() - begin, 2), "stderr": said, "tool": self.mark, "limit": self.limit}
        files.save(part / "run.json", record)
        shutil.rmtree(given)
        part.rename(folder / "answer")
        return record

    def answer(self, name: str, peers: Sequence[str]) -> str | None:
        """Everything that is done before the truth is opened; what went wrong."""
        record = self.diagnose(name)
        wrong = [] if record["status"] == 0 else [f"{name}: diagnose: {record['status']}: {record['stderr'][-200:]}"]
        stages = ["nominal", "retuned", *(["mended"] if record["status"] == 0 else []), *peers]
        for stage in stages:
            result = self.stage(name, stage)
            if result["status"] != "done":
                wrong.append(f"{name}: {stage}: {result['status']}: {result.get('error', '')}")
        return "\n".join(wrong) or None

    def open(self, name: str) -> str | None:
        """What needs the truth; what went wrong."""
        result = self.stage(name, "oracle")
        return None if result["status"] == "done" else f"{name}: oracle: {result['status']}: {result.get('error', '')}"


def each(label: str, names: Sequence[str], work: Callable[[str], str | None], jobs: int, processes: Processes) -> None:
    """Does a piece of work for each case, and tells how far it is."""
    begin, told = time.monotonic(), sys.stderr
    with ThreadPoolExecutor(jobs) as pool:
        try:
            futures = [pool.submit(work, name) for name in names]
            for count, future in enumerate(as_completed(futures), 1):
                if trouble := future.result():
                    print(f"\r\033[K{trouble}", file=told)
                passed = time.monotonic() - begin
                left = passed / count * (len(names) - count)
                end = "\n" if count == len(names) else ""
                print(f"\r\033[K{label}: {count}/{len(names)}, {passed:.0f} s, {left:.0f} s left", end=end, file=told, flush=True)
        except BaseException:
            processes.stop()
            pool.shutdown(wait=True, cancel_futures=True)
            raise


def resumable(main: Callable[[], None]) -> None:
    """Runs a command that goes on from where it was interrupted, and says so when it is."""
    try:
        main()
    except KeyboardInterrupt:
        print("\nprove: interrupted; the same command goes on from here", file=sys.stderr)
        sys.exit(130)
