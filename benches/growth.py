#!/usr/bin/env python3
"""Draws how the time of a Newton iteration and the memory grow with the mesh: docs/growth.png.

    cargo build --release --example growth
    python3 benches/growth.py [--threads 1] [--seconds 1] [--table growth.csv] [--picture docs/growth.png]

Needs matplotlib. With --table it draws that file, where it is there, and writes it otherwise.
"""
import argparse
import csv
import io
import pathlib
import subprocess

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[1]
PARTS = [("factorise_s", "tangent and factorisation", "o"), ("residual_s", "residual", "s"), ("solve_s", "solution", "^")]
SERIES = [("columns", "8 rows, 25 to 800 columns"), ("rows", "100 columns, 2 to 32 rows"), ("both", "25 x 2 to 400 x 32")]


def measured(threads, seconds):
    command = [ROOT / "target/release/examples/growth", f"--threads={threads}", f"--seconds={seconds}"]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=1.0, help="each part of each mesh is repeated for so long")
    parser.add_argument("--table", type=pathlib.Path)
    parser.add_argument("--picture", type=pathlib.Path, default=ROOT / "docs/growth.png")
    arguments = parser.parse_args()
    if arguments.table and arguments.table.exists():
        text = arguments.table.read_text()
    else:
        text = measured(arguments.threads, arguments.seconds)
        if arguments.table:
            arguments.table.write_text(text)
    print(text)
    rows = list(csv.DictReader(io.StringIO(text)))
    figure, panels = plt.subplots(2, 3, figsize=(11, 6.5), sharey="row", layout="constrained")
    for (above, below), (growing, title) in zip(panels.T, SERIES):
        of_mesh = [row for row in rows if row["growing"] == growing]
        unknowns = [int(row["unknowns"]) for row in of_mesh]
        for part, label, marker in PARTS:
            above.loglog(unknowns, [1e3 * float(row[part]) for row in of_mesh], marker + "-", label=label)
        megabytes = [8e-6 * int(row["factor_entries"]) for row in of_mesh]
        below.loglog(unknowns, megabytes, "o-", color="black", label="factors")
        for axis, start in [(above, 1e3 * float(of_mesh[0]["factorise_s"])), (below, megabytes[0])]:
            for power, style in [(1, ":"), (1.5, "--")]:
                line = [start * (n / unknowns[0]) ** power for n in unknowns]
                axis.loglog(unknowns, line, style, color="grey", linewidth=1, label=f"unknowns to the {power}")
            axis.grid(alpha=0.3)
            axis.set_xlim(500, 2e5)
        above.set_title(title, fontsize=10)
        below.set_xlabel("unknowns")
    panels[0, 0].set_ylabel("time [ms]")
    panels[1, 0].set_ylabel("memory [MB]")
    for axis in panels[:, 0]:
        axis.legend(frameon=False, fontsize=8, loc="upper left")
    figure.savefig(arguments.picture, dpi=120)


if __name__ == "__main__":
    main()
