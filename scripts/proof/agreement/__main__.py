"""Drives every effect of the catalogue in the generator and in the library, and tells how far the two are apart."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from generator.catalogue import names_of
from generator.simulator import Undrivable
from generator.sizes import draw_effect
from generator.world import SOILS, VEHICLES

from .compare import Difference, Refused, compare, drive_generator, manoeuvre, turning_on_the_spot


def arguments() -> argparse.Namespace:
    """What to compare."""
    parser = argparse.ArgumentParser(prog="prove.sh agree", description=__doc__)
    parser.add_argument("--tool", type=Path, required=True, help="the `ugv` binary")
    parser.add_argument("--effects", nargs="*", default=["nothing", *names_of("physics")], metavar="NAME",
                        help="effects, or `nothing` (all)")
    parser.add_argument("--soils", nargs="*", choices=list(SOILS), default=list(SOILS), help="soils (all)")
    parser.add_argument("--vehicles", nargs="*", choices=list(VEHICLES), default=["tran", "scout", "hexa"],
                        help="vehicles (tran scout hexa)")
    parser.add_argument("--size", type=float, default=1.0, help="1 is typical of a vehicle on a soil (1)")
    parser.add_argument("--shapes", type=int, default=2, help="draws of each effect (2)")
    parser.add_argument("--seconds", type=float, default=30.0, help="length of the drive [s] (30)")
    parser.add_argument("--pivots", action="store_true", help="drive straight and turn on the spot instead of turning both ways")
    parser.add_argument("--each", action="store_true", help="tell every drive, not only each effect")
    chosen = parser.parse_args()
    unknown = set(chosen.effects) - {"nothing", *names_of("physics")}
    if unknown:
        parser.error(f"--effects: {', '.join(sorted(unknown))} is not in the catalogue (docs/reference/effects.md)")
    if chosen.shapes < 1 or not chosen.seconds > 1.0 or not chosen.size > 0.0:
        parser.error("give at least one shape, more than a second and a size above 0")
    return chosen


def spread(numbers: list[float]) -> str:
    """Median and largest."""
    return f"{np.median(numbers):.1e} {max(numbers):.1e}"


def main() -> int:
    """Prints a line for each effect: median and largest difference over its drives."""
    chosen = arguments()
    print("effect, drives, then median and largest: position over the path, heading [rad], both over the effect's")
    plain: dict[tuple[str, str], np.ndarray] = {}
    for effect in chosen.effects:
        found: list[Difference] = []
        for vehicle in chosen.vehicles:
            drive = (turning_on_the_spot if chosen.pivots else manoeuvre)(chosen.seconds, VEHICLES[vehicle].wheel_radius)
            for soil in chosen.soils:
                for shape in range(1 if effect == "nothing" else chosen.shapes):
                    where = f"{effect} {vehicle} {soil} {shape}"
                    try:
                        if (vehicle, soil) not in plain:
                            plain[vehicle, soil] = drive_generator(vehicle, SOILS[soil], {}, drive)
                        path = plain[vehicle, soil]
                        spot = tuple(float(v) for v in path[len(path) // 2, :3])
                        effects = {} if effect == "nothing" else {effect: draw_effect(
                            effect, [1, shape], chosen.size, VEHICLES[vehicle], SOILS[soil], drive.seconds, spot)}
                        found.append(compare(chosen.tool, vehicle, SOILS[soil], effects, drive, path))
                    except (Undrivable, Refused) as error:
                        print(f"{where}: not driven: {error}", file=sys.stderr)
                        continue
                    if chosen.each:
                        one = found[-1]
                        print(f"  {where}: {one.position:.1e}, {one.heading:.1e}, {100 * one.of_effect:.1f} %  {effects}")
        if found:
            shares = [100 * f.of_effect for f in found]
            print(f"{effect}, {len(found)}: {spread([f.position for f in found])}, {spread([f.heading for f in found])}, "
                  f"{np.median(shares):.1f} {max(shares):.1f} %", flush=True)
    return 0


sys.exit(main())
