#!/usr/bin/env python3
"""Runs an unpacked SSP with libcosim, and writes outputs after every step as CSV: libcosim.py FOLDER STEPS STEP OUTPUT NAME...

For a Python that has libcosimpy, and nothing else of this package (requirements.txt beside this file).
"""

import csv
import sys
from pathlib import Path

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver

NANOSECONDS = 1_000_000_000


def main() -> None:
    """Reads the arguments, steps, writes."""
    folder, steps, step, output, *names = sys.argv[1:]
    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_ssp_file(folder, round(float(step) * NANOSECONDS))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    places = []
    for name in names:
        component, _, variable = name.partition(".")
        index = execution.slave_index_from_instance_name(component)
        known = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
        places.append((index, known[variable]))
    with Path(output).open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["time", *names])
        for k in range(1, int(steps) + 1):
            if not execution.step():
                sys.exit(f"libcosim: step {k} failed")
            writer.writerow([k * float(step), *(observer.last_real_values(index, [reference])[0] for index, reference in places)])


if __name__ == "__main__":
    main()
