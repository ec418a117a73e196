"""An agent (PPO) learns to drive a slalom on dry sand: trains it, compares it with a scripted driver, and draws both.

Writes slalom.png and policy.npz (the network's parameters) into --output. The same seed gives the same agent.
"""

import argparse
import os
import time
from pathlib import Path

# Small networks gain nothing from more threads; this counts before JAX is loaded.
os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false")

import gymnasium
import numpy as np

from .drawing import draw
from .drivers import Driver, Lap, lap, scripted, straight
from .environment import FMU, GATES
from .training import train

STEPS = 60_000
JUDGED = range(1_000_000, 1_000_050)  # seeds of the courses on which drivers are compared


def tell(name: str, laps: list[Lap]) -> None:
    """One line on a driver."""
    finished = [lap.seconds for lap in laps if lap.finished]
    seconds = f", in {np.mean(finished):.1f} s" if finished else ""
    print(f"{name:>9}: {len(finished)} of {len(laps)} courses finished{seconds}; gates passed {np.mean([lap.passed for lap in laps]):.2f} "
          f"of {GATES}, reward {np.mean([lap.reward for lap in laps]):.1f}")


def main() -> None:
    """Reads the arguments, trains, compares, draws."""
    parser = argparse.ArgumentParser(prog="controllers.sh slalom", description=__doc__)
    add = parser.add_argument
    add("--fmu", type=Path, default=FMU, help="the vehicle [default: target/ugv.fmu]")
    add("--steps", type=int, default=STEPS, metavar="N", help="of training [default: %(default)s]")
    add("--seed", type=int, default=1, metavar="N", help="of training [default: %(default)s]")
    add("--output", type=Path, default=FMU.parent / "controllers", metavar="DIR", help="[default: target/controllers]")
    arguments = parser.parse_args()
    if not arguments.fmu.is_file():
        parser.error(f"{arguments.fmu} is not there; build it with scripts/package.sh")

    def make() -> gymnasium.Env:
        return gymnasium.make("UgvSlalom-v0", fmu=arguments.fmu)

    begun, cpu = time.monotonic(), time.process_time()
    trained = train(make, arguments.steps, arguments.seed)
    print(f"{arguments.steps} steps, {len(trained.episodes)} episodes, in {time.monotonic() - begun:.0f} s "
          f"({time.process_time() - cpu:.0f} s of processor time)")
    environment = make()
    drivers: dict[str, Driver] = {"straight": straight, "untrained": trained.before, "trained": trained.after, "scripted": scripted}
    laps = {name: [lap(environment, driver, seed) for seed in JUDGED] for name, driver in drivers.items()}
    environment.close()
    for name, driven in laps.items():
        tell(name, driven)
    arguments.output.mkdir(parents=True, exist_ok=True)
    np.savez(arguments.output / "policy.npz", **trained.parameters)
    shown = {name: laps[name][0] for name in ("untrained", "trained", "scripted")}
    draw(trained.episodes, shown).savefig(arguments.output / "slalom.png", dpi=100)
    print(f"{arguments.output / 'slalom.png'}: drawn")


if __name__ == "__main__":
    main()
