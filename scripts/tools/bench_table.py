"""Prints what scripts/tools/bench.sh measured as a Markdown table, with ratios within the run."""

import json
import os
import platform
from pathlib import Path

TARGET = Path(os.environ.get("CARGO_TARGET_DIR", Path(__file__).resolve().parents[2] / "target"))


def estimate(*path: str) -> float:
    """Criterion's mean of one benchmark in seconds."""
    file = TARGET.joinpath("criterion", *path, "new", "estimates.json")
    return json.loads(file.read_text())["mean"]["point_estimate"] * 1e-9


def processor() -> str:
    """The processor's name as Linux tells it, with what it calls the clock."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    found = {key.strip(): value.strip() for key, _, value in (line.partition(":") for line in lines)}
    return f"{found.get('model name', platform.machine())}, {float(found.get('cpu MHz', 0)):.0f} MHz"


def main() -> None:
    """Reads the three results and prints the table."""
    fmu = json.loads((TARGET / "bench" / "fmu.json").read_text())
    peer = json.loads((TARGET / "bench" / "numpy.json").read_text())
    states, drive = "16 golden wrenches", "60 s drive on clayed soil"
    wrench = estimate(states, "from scratch") / 16
    jacobian = estimate(states, "from scratch with Jacobian") / 16
    near = estimate(states, "from the neighbourhood") / 16
    free, steps = estimate(drive, "free run"), estimate(drive, "steps of 10 ms")
    seconds = fmu["simulated_seconds"]
    rows = [
        ("wrench, 8 wheels, from scratch, mean of the golden states", f"{wrench * 1e6:.1f} us"),
        ("the same with its Jacobian", f"{jacobian * 1e6:.1f} us"),
        ("the same from a neighbouring state", f"{near * 1e6:.1f} us"),
        ("60 s drive on clayed soil, free run", f"{seconds / free:.0f} times real time"),
        ("the same in steps of 10 ms", f"{seconds / steps:.0f} times real time"),
        ("the same through the FMU from C", f"{seconds / fmu['drive_seconds']:.0f} times real time"),
        ("FMU calls around doStep (set, set derivatives, get)", f"{fmu['calls_nanoseconds']:.0f} ns"),
        ("peak memory of that C program", f"{fmu['peak_kilobytes'] / 1024:.1f} MB"),
        ("NumPy: one wrench, as a ratio", f"{peer['wrench_seconds'] / wrench:.0f} times longer"),
        ("SciPy: the drive, as a ratio", f"{peer['drive_seconds'] / free:.0f} times longer"),
    ]
    print(f"\nMachine: {processor()}, {platform.system()} {platform.release()}\n")
    print("| what | measured |\n|---|---|")
    for name, value in rows:
        print(f"| {name} | {value} |")
    plain = estimate("effects", "none asked for")
    drive_plain = estimate("effects", "10 s drive, none asked for")
    print("\n| effects | wrench | as a ratio | 10 s drive, as a ratio |\n|---|---|---|---|")
    for name in ("none asked for", "all off", "one on", "every one on"):
        one, ten = estimate("effects", name), estimate("effects", f"10 s drive, {name}")
        print(f"| {name} | {one * 1e6:.1f} us | {one / plain:.2f} | {ten / drive_plain:.2f} |")
    derived = estimate("effects", "10 s drive with its derivatives by the soil")
    print(f"| none, with the drive's derivatives by the soil | | | {derived / drive_plain:.1f} |")
    print("\n| quadrature nodes per wheel | wrench |\n|---|---|")
    for nodes in (16, 64, 256):
        print(f"| {nodes} | {estimate('wrench by nodes', str(nodes)) * 1e6:.1f} us |")
    print("\n| wheel rows | wrench |\n|---|---|")
    for count in (2, 3, 4, 8, 16):
        print(f"| {count} | {estimate('wrench by rows', str(count)) * 1e6:.1f} us |")
    print("\n| eight lanes at once | each |\n|---|---|")
    for name, folder in (("exp", "exp"), ("1/sqrt", "1_sqrt"), ("pow", "pow")):
        print(f"| {name} | {estimate('1000 x 8 lanes', folder) * 1e6:.1f} ns |")


if __name__ == "__main__":
    main()
