#!/usr/bin/env python3
"""Runs this project's sweep and the same model written with NGSolve side by side, and prints the ratio of their times.

    cargo build --release --example sweep
    python3 benches/compare_ngsolve.py PYTHON PEER [--mesh 100x8] [--threads 1] [--from -10] [--to 0] [--rounds 1]

PYTHON is an interpreter that has NGSolve and MKL, PEER the NGSolve program. Both solve one mirror-symmetric body without
boundary friction on the tissue, on the same graded mesh and at the same depths, a micron apart. Each stops by its own rule, this
project where the next update would be below a millionth, the peer where the last was below 1 Pa and 0.1 nm. What to look at is
the time of a point: this project keeps a factorisation over iterations and points, so that it takes more iterations, most of
which cost little; the peer factorises in each. Runs alternate, so that a busy machine is busy for both. Of the peer only its
Newton iterations are counted; of this project everything between two inputs, the outputs included.
"""
import argparse
import json
import pathlib
import re
import subprocess
import tempfile

FASTEST = ["--reuse", "--condense", "--ordering", "metis", "--refine", "2", "--realcompile"]
SWEEP = pathlib.Path(__file__).resolve().parents[1] / "target/release/examples/sweep"


def ours(mesh, grading, first, last, threads):
    command = [SWEEP, f"--mesh={mesh}", f"--grading={grading}", f"--from={first}", f"--to={last}", f"--threads={threads}"]
    output = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    loads = [float(line.split()[1]) for line in output.splitlines() if not line.startswith("#")]
    seconds, iterations = re.search(r"# ([\d.]+) s, (\d+) iterations", output).groups()
    return loads, float(seconds), int(iterations)


def theirs(python, peer, mesh, grading, first, last, threads):
    depths = ",".join(str(depth) for depth in range(first, last + 1))
    grade = ["--uniform"] if grading == "0,0" else ["--grade", grading]
    with tempfile.TemporaryDirectory() as folder:
        result = pathlib.Path(folder) / "peer.json"
        command = [python, peer, "--mesh", mesh, *grade, f"--d={depths}", "--threads", str(threads), "--json", result, *FASTEST]
        subprocess.run(command, check=True, capture_output=True)
        run = json.loads(result.read_text())
    seconds = sum(sum(times) for times in run["T"].values())
    return [row["L"] for row in run["rows"]], seconds, len(run["T"]["asm"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("python")
    parser.add_argument("peer")
    parser.add_argument("--mesh", default="100x8")
    parser.add_argument("--grading", default="2.5,2.0", help="along the surface, through the thickness; 0,0 is uniform")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--from", dest="first", type=int, default=-10, help="first depth [micron]")
    parser.add_argument("--to", dest="last", type=int, default=0, help="last depth [micron]")
    parser.add_argument("--rounds", type=int, default=1)
    arguments = parser.parse_args()
    case = (arguments.mesh, arguments.grading, arguments.first, arguments.last, arguments.threads)
    print(f"mesh {arguments.mesh}, grading {arguments.grading}, {arguments.threads} threads")
    best = [float("inf")] * 2
    for _ in range(arguments.rounds):
        runs = [ours(*case), theirs(arguments.python, arguments.peer, *case)]
        for k, (name, (_, seconds, iterations)) in enumerate(zip(["this project", "NGSolve"], runs)):
            print(f"  {name:13} {seconds:8.3f} s, {iterations:4} iterations, {seconds / iterations:.5f} s each", flush=True)
            best[k] = min(best[k], seconds)
        difference = max(abs(a / b - 1) for a, b in zip(runs[0][0], runs[1][0]))
        print(f"  loads differ by {difference:.1e} at most; times a point by a factor of {runs[1][1] / runs[0][1]:.2f}")
    points = arguments.last - arguments.first + 1
    print(f"fastest points: {best[0] / points:.5f} s and {best[1] / points:.5f} s, ratio {best[1] / best[0]:.2f}")


if __name__ == "__main__":
    main()
