#!/usr/bin/env python3
"""Rollouts per second from Python: in one batched call, one by one, and through fmpy; in one run.

Needs ./scripts/python.sh and ./scripts/package.sh. Prints a table for docs/contributing/benchmarks.md.
"""

import argparse
import time
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave

import ugv_terrain as ugv

ROOT = Path(__file__).resolve().parents[2]


def wheels(seconds: float, step: float) -> tuple[np.ndarray, np.ndarray]:
    time = np.arange(0.0, seconds + 0.5 * step, step)
    left = 5.0 + 2.0 * np.sin(0.5 * time)
    return time, np.column_stack([left, 5.0 - 2.0 * np.sin(0.3 * time)])


def through_fmpy(fmu: Path, time: np.ndarray, omega: np.ndarray, count: int) -> None:
    description = fmpy.read_model_description(fmu)
    folder = fmpy.extract(fmu)
    names = {variable.name: variable.valueReference for variable in description.modelVariables}
    inputs = [names["omega_left"], names["omega_right"]]
    outputs = [names[name] for name in ugv.STATES]
    slave = FMU2Slave(guid=description.guid, unzipDirectory=folder, instanceName="bench",
                      modelIdentifier=description.coSimulation.modelIdentifier)
    slave.instantiate()
    for _ in range(count):
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.setReal(inputs, omega[0])
        slave.exitInitializationMode()
        for row in range(len(time) - 1):
            slave.setReal(inputs, omega[row])
            slave.doStep(time[row], time[row + 1] - time[row])
            slave.getReal(outputs)
        slave.reset()
    slave.freeInstance()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--drives", type=int, default=64, help="drives in a batch [default: %(default)s]")
    parser.add_argument("--seconds", type=float, default=10.0, help="length of a drive [default: %(default)s]")
    parser.add_argument("--fmu", type=Path, default=ROOT / "target" / "ugv.fmu", help="[default: target/ugv.fmu]")
    args = parser.parse_args()
    time_, omega = wheels(args.seconds, 0.05)
    model = ugv.Model()  # clayed soil, the FMU's default

    def batched() -> None:
        ugv.rollout([model] * args.drives, time_, omega)

    def one_by_one() -> None:
        for _ in range(args.drives):
            ugv.rollout(model, time_, omega)

    def step_by_step() -> None:
        for _ in range(args.drives):
            simulation = ugv.Simulation(model)
            for row in range(len(time_) - 1):
                simulation.step(time_[row + 1] - time_[row], *omega[row])

    def fmu() -> None:
        through_fmpy(args.fmu, time_, omega, args.drives)

    ways = {
        "`rollout`, one call for all": batched,
        "`rollout`, one by one": one_by_one,
        "`Simulation.step`": step_by_step,
        "the FMU through fmpy": fmu,
    }
    rates = {}
    for name, way in ways.items():
        way()
        begin = time.perf_counter()
        way()
        rates[name] = args.drives / (time.perf_counter() - begin)
    print(f"| drives of {args.seconds:g} s at 20 Hz | per second | over fmpy |\n|---|---|---|")
    for name, rate in rates.items():
        print(f"| {name} | {rate:.0f} | {rate / rates['the FMU through fmpy']:.1f} |")


if __name__ == "__main__":
    main()
