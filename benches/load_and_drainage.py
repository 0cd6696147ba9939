#!/usr/bin/env python3
"""Draws how iterations and time of a steady state from rest grow with the load and with the Peclet number: docs/growth_with_load.png.

    cargo build --release
    python3 benches/load_and_drainage.py [--table load_and_drainage.csv] [--picture docs/growth_with_load.png]

Rolling at 0.1 m/s on the automatic mesh. The Peclet number is the time in which a layer drains over that in which it passes the contact:
thickness^2 / (hydraulic permeability * aggregate modulus) over contact length / surface speed; it is varied by the permeability of a hip under 10 kN/m.
Needs matplotlib. With --table it draws that file, where it is there, and writes it otherwise.
"""
import argparse
import csv
import json
import pathlib
import resource
import subprocess

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[1]
PROGRAM = ROOT / "target/release/cartilage-contact"
CASES = {
    "hip": ["--joint", "hip"],
    "knee": ["--joint", "knee"],
    "condyle, one body and its mirror image": ["--preset", "human_femoral_condyle"],
}
LOADS = [100, 300, 1e3, 3e3, 10e3, 20e3, 30e3, 45e3, 60e3]
PERMEABILITIES = [3e-15, 1e-15, 3e-16, 1e-16, 1e-17, 1e-18, 1e-19, 1e-20]
DRAINED = "hip under 10 kN/m"
SPEED = 0.1
# Of examples/hip.toml: thickness, length of the contact under 10 kN/m [m], aggregate modulus [Pa], viscosity in the pores [Pa s].
HIP = (1.7e-3, 10e-3, 0.7e6, 1e-3)


def processor_time():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def solved(series, load, *case, permeability=None):
    before = processor_time()
    more = ["--set", f"both.permeability={permeability}"] if permeability else []
    command = [PROGRAM, "solve", *case, *more, "--applied-load", str(load), "--sliding-speed", str(SPEED), "--json"]
    run = subprocess.run(command, capture_output=True, text=True)
    row = {"series": series, "load": load, "peclet": "", "iterations": "", "seconds": processor_time() - before}
    if permeability:
        thickness, length, modulus, viscosity = HIP
        row["peclet"] = thickness**2 / (permeability / viscosity * modulus) / (length / (0.5 * SPEED))
    if run.returncode == 0:
        row["iterations"] = json.loads(run.stdout)["newton_iterations"]
    else:
        print(run.stderr)
    print(row, flush=True)
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--table", type=pathlib.Path)
    parser.add_argument("--picture", type=pathlib.Path, default=ROOT / "docs/growth_with_load.png")
    arguments = parser.parse_args()
    if arguments.table and arguments.table.exists():
        with arguments.table.open() as file:
            rows = list(csv.DictReader(file))
    else:
        rows = [solved(name, load, *case) for name, case in CASES.items() for load in LOADS]
        rows += [solved(DRAINED, 10e3, *CASES["hip"], permeability=k) for k in PERMEABILITIES]
        if arguments.table:
            with arguments.table.open("w", newline="") as file:
                writer = csv.DictWriter(file, rows[0].keys())
                writer.writeheader()
                writer.writerows(rows)
    rows = [row for row in rows if row["iterations"] != ""]
    figure, panels = plt.subplots(2, 2, figsize=(10, 6.5), sharex="col", sharey="row", layout="constrained")
    for name in [*CASES, DRAINED]:
        axis, scale, over = (1, 1, "peclet") if name == DRAINED else (0, 1e-3, "load")
        of_series = [row for row in rows if row["series"] == name and row[over] not in ("", None)]
        x = [scale * float(row[over]) for row in of_series]
        iterations = [int(row["iterations"]) for row in of_series]
        seconds = [float(row["seconds"]) for row in of_series]
        panels[0, axis].plot(x, iterations, "o-", label=name)
        panels[1, axis].plot(x, [1e3 * s / n for s, n in zip(seconds, iterations)], "o-", label=name)
    panels[0, 0].set_ylabel("iterations from rest")
    panels[1, 0].set_ylabel("processor time an iteration [ms]")
    panels[1, 0].set_xlabel("load [kN/m]")
    panels[1, 1].set_xlabel("Peclet number")
    for axis in panels.flat:
        axis.set_xscale("log")
        axis.set_ylim(bottom=0)
        axis.grid(alpha=0.3)
        axis.legend(frameon=False, fontsize=8)
    figure.savefig(arguments.picture, dpi=120)


if __name__ == "__main__":
    main()
