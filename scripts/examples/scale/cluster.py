"""Spreads pieces of work over Dask workers, or does them one after the other.

What all pieces have in common (the FMU, the tool) is a job: it is shipped to each worker once, under a name made of its
content. A piece is small, depends on nothing but itself and the job, and its result is fetched as soon as it is there: when a
worker is lost, nothing is lost but the pieces that it had not finished, and Dask gives them to another.
"""

import argparse
import logging
import sys
import tempfile
import time
import zipfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import Any, Protocol

import dask
from distributed import CancelledError, Client, KilledWorker, LocalCluster, WorkerPlugin, as_completed, get_worker

IN_FLIGHT = 4  # pieces per worker thread that are on their way: none waits for work, and the scheduler holds few
COUNT_EVERY = 2.0  # s between two counts of the workers, who may come and go
LOST = 3  # workers that a piece may take down before it is given up
PACKAGE = Path(__file__).resolve().parent
PATIENCE = 60  # s to wait for the first worker


class Job(Protocol):
    """What all pieces of work have in common."""

    name: str  # changes when the content changes

    def setup(self, folder: Path) -> None:
        """Makes it ready in a process, with a folder of its own."""

    def do(self, piece: Any) -> Any:
        """Does one piece; may be called from several threads."""


class Lost:
    """Stands for the result of a piece that took one worker after the other down with it."""


class Shipped(WorkerPlugin):
    """A job on a worker; those that join later get it as well."""

    idempotent = True

    def __init__(self, job: Job) -> None:
        self.job, self.name = job, job.name

    def setup(self, worker: Any) -> None:
        self.job.setup(Path(worker.local_directory) / self.name)


def _do(name: str, piece: Any) -> Any:
    """One piece, on a worker."""
    return get_worker().plugins[name].job.do(piece)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Where the work is done."""
    where = parser.add_argument_group("where the work is done").add_mutually_exclusive_group()
    where.add_argument("--scheduler", metavar="tcp://HOST:PORT",
                       help="a Dask scheduler whose workers have Python %d.%d and the packages that scripts/setup.sh scale installs "
                            "[default: workers on this machine]" % sys.version_info[:2])
    where.add_argument("--workers", type=at_least_one, metavar="N", help="processes on this machine [default: one per processor]")
    where.add_argument("--serial", action="store_true", help="in this process, one after the other, without Dask")


def at_least_one(text: str) -> int:
    """A count."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"found `{text}`, expected 1 or more")
    return int(text)


@contextmanager
def connected(scheduler: str | None, workers: int | None) -> Iterator[Client]:
    """A client of the scheduler, or of workers on this machine that live as long as it does."""
    if scheduler:
        try:
            client = Client(scheduler, timeout=PATIENCE)
            logging.getLogger("distributed").setLevel(logging.CRITICAL)
        except (OSError, ValueError, TimeoutError) as error:
            sys.exit(f"no scheduler answers at {scheduler} ({error}); start one with: dask scheduler")
        with client:
            try:
                client.wait_for_workers(1, timeout=PATIENCE)
            except TimeoutError:
                sys.exit(f"the scheduler at {scheduler} has no workers; start some with: dask worker {scheduler} --nthreads 1")
            upload_sources(client)
            yield client
        return
    # A lost worker is told by what follows; Dask's own words about it fill the screen.
    dask.config.set({"distributed.scheduler.allowed-failures": LOST})
    with (LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=":0", silence_logs=logging.CRITICAL) as cluster,
          Client(cluster) as client):
        yield client


def upload_sources(client: Client) -> None:
    """Gives this package to the scheduler and to its workers, which need none of these files; those that join later get it as well."""
    with tempfile.TemporaryDirectory() as folder:
        archive = Path(folder) / f"{PACKAGE.name}.zip"
        with zipfile.ZipFile(archive, "w") as files:
            for path in sorted(PACKAGE.glob("*.py")):
                files.write(path, path.relative_to(PACKAGE.parent))
        client.upload_file(str(archive))


def spread(client: Client, job: Job, pieces: Iterable[Any]) -> Iterator[tuple[int, Any]]:
    """Number and result of each piece, in the order in which they are done."""
    client.register_plugin(Shipped(job))
    left = enumerate(pieces)
    numbers: dict[str, int] = {}
    running = as_completed()
    threads, asked = 1, -COUNT_EVERY

    def fill() -> None:
        nonlocal threads, asked
        if time.monotonic() - asked > COUNT_EVERY:
            threads, asked = max(1, sum(client.nthreads().values())), time.monotonic()
        for number, piece in islice(left, max(0, IN_FLIGHT * threads - len(numbers))):
            future = client.submit(_do, job.name, piece, pure=False)
            numbers[future.key] = number
            running.add(future)

    fill()
    for future in running:
        number = numbers.pop(future.key)
        try:
            result = future.result()
        except KilledWorker:
            result = Lost()
        except CancelledError:
            raise RuntimeError("the scheduler is lost") from None
        yield number, result
        fill()


def one_by_one(job: Job, pieces: Iterable[Any]) -> Iterator[tuple[int, Any]]:
    """The same in this process, in order."""
    with tempfile.TemporaryDirectory() as folder:
        job.setup(Path(folder) / job.name)
        for number, piece in enumerate(pieces):
            yield number, job.do(piece)


def do_all(arguments: argparse.Namespace, job: Job, pieces: Iterable[Any]) -> Iterator[tuple[int, Any]]:
    """Number and result of each piece, wherever the arguments want it done."""
    if arguments.serial:
        yield from one_by_one(job, pieces)
        return
    with connected(arguments.scheduler, arguments.workers) as client:
        yield from spread(client, job, pieces)


def with_progress(label: str, results: Iterator[tuple[int, Any]], count: int, quiet: bool) -> Iterator[tuple[int, Any]]:
    """Tells how far it is, and how long it takes still."""
    begin = time.monotonic()
    for done, result in enumerate(results, 1):
        yield result
        if not quiet:
            passed = time.monotonic() - begin
            end = "\n" if done == count else ""
            print(f"\r\033[K{label}: {done}/{count}, {passed:.0f} s, {passed / done * (count - done):.0f} s left", end=end,
                  file=sys.stderr, flush=True)
