"""A recording with a concealed effect: diagnosed by the tool, and the mended FMU beside the given one on an unseen drive.

The recordings are those of scripts/examples/recordings; what their simulator added is in truth.json there, which the tool does not get.
"""

import json
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

import follow_recording
from follow_recording import Followed
from matplotlib.figure import Figure

RECORDINGS = Path(__file__).resolve().parent / "recordings"
DIAGNOSED = ("drive", "second")  # what the tool gets
UNSEEN = "unseen"  # what the FMUs drive
SECONDS = 60.0  # of that


@dataclass
class Answer:
    """What the tool found, and what follows from it."""

    said: dict  # diagnosis.json
    truth: dict
    seconds: float  # that the diagnosis took
    length: float  # s, of the recordings
    followed: list[Followed]  # the given FMU, the mended one
    figure: Figure

    @property
    def finding(self) -> dict | None:
        """The likeliest effect, if one was found."""
        return next(iter(self.said["findings"]), None)

    @property
    def effect(self) -> dict:
        """What the simulator added."""
        (effect,) = self.truth["effects"]
        return effect


def diagnose(tool: Path, output: Path) -> Answer:
    """Diagnoses, packages both models and drives them; all files go below the output folder."""
    output.mkdir(parents=True, exist_ok=True)
    recordings = [RECORDINGS / f"{name}.csv" for name in DIAGNOSED]
    start = time.perf_counter()
    run(tool, "diagnose", *recordings, "--output", output / "diagnosis", "--force", "--within", "none", "--quiet")
    seconds = time.perf_counter() - start
    given = recordings[0].with_suffix(".json")
    run(tool, "package", "--vehicle", given, "--terrain", given, "--output", output / "given.fmu", "--force")
    run(tool, "package", "--model", output / "diagnosis" / "model.json", "--output", output / "mended.fmu", "--force")
    unseen = RECORDINGS / f"{UNSEEN}.csv"
    figure, followed = follow_recording.follow(unseen, [output / "given.fmu", output / "mended.fmu"], SECONDS)
    length = sum(float(path.read_text().splitlines()[-1].partition(",")[0]) for path in recordings)
    said, truth = (json.loads(path.read_text()) for path in (output / "diagnosis" / "diagnosis.json", RECORDINGS / "truth.json"))
    return Answer(said, truth, seconds, length, followed, figure)


def run(tool: Path, *words: str | Path) -> None:
    """Runs the tool, which must succeed."""
    subprocess.run([tool, *words], check=True, stdout=subprocess.DEVNULL)
