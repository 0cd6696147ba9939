"""A population of virtual knees on Dask: how much do permeability, modulus, thickness and viscosity matter?

Every knee is one instance of the FMU: the lateral side of examples/knee.toml with tissue and fluid of its own, under the largest load
of walking at a body weight of 750 N, swept over sliding speed. Knees that cannot be solved are kept with their message instead of
ending the run, and states that warn are counted; knees that are in the results already are not run again, so the same command
resumes a run that was interrupted.

    pip install fmpy "dask[distributed]" pyarrow matplotlib      # and tomli before Python 3.11
    cargo run --release                                          # writes the FMU
    python examples/population.py --knees 100                    # all cores of this machine
    python examples/population.py --knees 1000 --scheduler tcp://head:8786

On a cluster the FMU and the results have to be on a disk that all workers see. Writes `population/knee_*.parquet`, one
file a knee, and `population.png`.

Drawn uniformly, permeability and viscosity in their logarithms; both layers of a knee are alike:

| quantity | range | source |
|---|---|---|
| aggregate modulus | 0.48 to 1.58 MPa, Poisson's ratio 0 to 0.10 | human tibial plateau, PMC2858459; Athanasiou et al. 1991 as later papers quote it |
| hydraulic permeability | 1.18e-15 to 7.6e-15 m4/(N s) | Athanasiou et al. 1991 as later papers quote it; published biphasic test case |
| thickness | 1.78 to 2.3 mm | as permeability |
| viscosity of the film | 1e-3 to 1e-2 Pa s | assumed: water to synovial fluid at the high shear of a thin film |
"""

import io
import os
import tempfile
import time
from contextlib import redirect_stdout
from functools import cache
from pathlib import Path

from start import FMU, TOML, joint_case, needs, options, set_values, tell

needs("numpy", "fmpy", "dask", "distributed", "pyarrow", "matplotlib", TOML)

import numpy as np
import pyarrow
import pyarrow.parquet
from dask.distributed import Client, LocalCluster, as_completed
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

# N/m: 2.61 body weights on the knee, 0.4 of them on its lateral side, 25 mm wide (docs/gait.md).
LOAD = 0.4 * 2.61 * 750 / 0.025
SPEEDS = np.geomspace(0.1, 1e-3, 6)  # m/s
OUTPUTS = [
    "penetration_depth_result", "load", "friction_coefficient", "sommerfeld_number", "minimum_film_thickness", "film_parameter",
    "fluid_load_support",
]  # fmt: skip
#: Beside the case of the knee. The femur rolls back by 5.2 mm in 58 degrees, so that the tibia's surface moves at 0.16 of its speed.
NUMERICS = {
    "control": "load", "slide_to_roll_ratio": 0.72, "mesh.columns": 48, "mesh.rows": 6,
    # Far below the slowest speed, so that boundary friction is mobilised in full.
    "friction_regularisation_speed": 1e-5,
}  # fmt: skip


def draw_knee(number: int) -> dict:
    """The same knee for the same number, whatever the size of the population."""
    random = np.random.default_rng([2020, number])
    modulus, poisson = random.uniform(0.48e6, 1.58e6), random.uniform(0.0, 0.10)
    hydraulic = np.exp(random.uniform(np.log(1.18e-15), np.log(7.6e-15)))
    viscosity = np.exp(random.uniform(np.log(1e-3), np.log(1e-2)))
    return {
        "shear_modulus": modulus * (1 - 2 * poisson) / (2 * (1 - poisson)),
        "bulk_modulus": modulus * (1 + poisson) / (3 * (1 - poisson)),
        # Of the water in the pores, so that permeability over viscosity is what tests on tissue measure.
        "permeability": hydraulic * 1e-3,
        "thickness": random.uniform(1.78e-3, 2.3e-3),
        "viscosity": viscosity,
    }


def memory() -> float:
    """The most memory that this process has had so far [MB], where the system says it."""
    try:
        import resource
    except ImportError:
        return float("nan")
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


@cache
def unpacked(fmu: str) -> tempfile.TemporaryDirectory:
    """The FMU, unpacked once a process: a library that is loaded from another folder is another one, and takes its memory again."""
    folder = tempfile.TemporaryDirectory()
    extract(fmu, unzipdir=folder.name)
    return folder


def run_knee(number: int, fmu: str, folder: str, numerics: dict, speeds) -> tuple[int, str]:
    """Sweeps one knee and writes its file; returns its number and what went wrong, if anything."""
    knee, rows, log, begin = draw_knee(number), [], io.StringIO(), time.process_time()
    # FMPy prints what the FMU logs: warnings, why a call was refused or a step not done.
    with redirect_stdout(log):
        description = read_model_description(fmu)
        references = {variable.name: variable.valueReference for variable in description.modelVariables}
        contact = FMU2Slave(
            guid=description.guid, unzipDirectory=unpacked(fmu).name, modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=f"knee {number}",
        )  # fmt: skip
        problem = ""
        try:
            contact.instantiate()
            tissue = {f"{body}.{name}": value for body in ("upper", "lower") for name, value in knee.items()
                      if name != "viscosity"}  # fmt: skip
            start = {"viscosity": knee["viscosity"], "applied_load": LOAD, "sliding_speed": float(speeds[0])}
            set_values(contact, description, joint_case("knee") | tissue | start | numerics)
            contact.setupExperiment(startTime=0.0)
            contact.enterInitializationMode()
            contact.exitInitializationMode()
            for step, speed in enumerate(speeds):
                contact.setReal([references["sliding_speed"]], [float(speed)])
                contact.doStep(float(step), 1.0)
                values = contact.getReal([references[name] for name in OUTPUTS])
                resolved = bool(contact.getBoolean([references["well_resolved"]])[0])
                rows.append(dict(zip(OUTPUTS, values)) | {"well_resolved": resolved, "sliding_speed": float(speed)})
        except Exception as error:
            problem = f"{error} {log.getvalue()}".strip()
        finally:
            contact.freeInstance()
    # A knee without a single answer has one row without results, so that it is neither lost nor run again.
    rows = rows or [dict.fromkeys(OUTPUTS, float("nan")) | {"well_resolved": False, "sliding_speed": float("nan")}]
    cost = {"processor_seconds": time.process_time() - begin, "memory": memory()}
    table = pyarrow.Table.from_pylist([{"knee": number, **knee, **row, **cost, "problem": problem} for row in rows])
    unfinished = Path(folder) / f"knee_{number:05}.parquet.unfinished"
    pyarrow.parquet.write_table(table, unfinished)
    unfinished.rename(unfinished.with_suffix(""))
    return number, problem


def main(knees=100, fmu=FMU, folder="population", picture="population.png", scheduler=None, workers=None,
         numerics=None, speeds=SPEEDS):  # fmt: skip
    """The results as a table, a row a knee and speed; also those of knees that failed half way."""
    fmu, folder = str(Path(fmu).resolve()), Path(folder).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    missing = [number for number in range(knees) if not (folder / f"knee_{number:05}.parquet").exists()]
    print(f"{knees - len(missing)} knees are there, {len(missing)} to run")
    if missing:
        cluster = None if scheduler else LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
        with Client(scheduler or cluster) as client:
            settings = NUMERICS | (numerics or {})
            futures = client.map(
                run_knee, missing, fmu=fmu, folder=str(folder), numerics=settings, speeds=list(speeds), pure=False
            )
            for done, future in enumerate(as_completed(futures), 1):
                if future.status == "error":
                    print("a worker failed:", future.exception())
                elif future.result()[1]:
                    print("knee {}: {}".format(*future.result()))
                tell(done, len(missing))
        if cluster:
            cluster.close()
    files = [folder / f"knee_{number:05}.parquet" for number in range(knees)]
    tables = [pyarrow.parquet.read_table(file) for file in files if file.exists()]
    if not tables:
        raise SystemExit("no knee was run: see what the workers say above")
    table = pyarrow.concat_tables(tables)
    summarise(table)
    if picture:
        draw(table, picture)
    return table


def summarise(table):
    """Prints what failed and what it cost, and friction and fluid load support at each speed."""
    rows = table.to_pylist()
    knees = {row["knee"]: row for row in rows}
    failed = [knee for knee, row in knees.items() if row["problem"]]
    good = [row for row in rows if not row["problem"]]
    warned = sum(not row["well_resolved"] for row in good)
    print(f"{len(knees)} knees, {len(failed)} of them with a problem; {warned} of {len(good)} states with a warning of their resolution")
    seconds = np.mean([row["processor_seconds"] for row in knees.values()])
    size = [row["memory"] for row in knees.values()]
    print(f"{seconds:.1f} s of processor time a knee, {3600 / seconds:.0f} knees an hour and core; largest memory of a worker "
          f"{min(size):.0f} MB after its first knees, {max(size):.0f} MB in the end")  # fmt: skip
    print("sliding speed [mm/s]   friction coefficient: 5th, 50th, 95th percentile   fluid load support: the same")
    for speed in sorted({row["sliding_speed"] for row in good}, reverse=True):
        here = [row for row in good if row["sliding_speed"] == speed]
        friction, support = (
            np.percentile([row[name] for row in here], [5, 50, 95]) for name in ("friction_coefficient", "fluid_load_support")
        )
        numbers = "   ".join(f"{value:.4f}" for value in friction)
        print(f"{1e3 * speed:20.2f}   {numbers:>50}   {'   '.join(f'{value:.3f}' for value in support)}")


def draw(table, picture):
    """Friction and fluid load support over sliding speed: a line a knee, and percentiles over all knees."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    rows = [row for row in table.to_pylist() if not row["problem"]]
    failed = len({row["knee"] for row in table.select(["knee", "problem"]).to_pylist() if row["problem"]})
    knees = {}
    for row in rows:
        knees.setdefault(row["knee"], []).append((1e3 * row["sliding_speed"], row["friction_coefficient"], row["fluid_load_support"]))
    curves = [np.array(sorted(curve)) for curve in knees.values()]
    whole = np.array([curve for curve in curves if len(curve) == max(map(len, curves))])
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained")
    for axis, column, label in zip(axes, (1, 2), ("friction coefficient [1]", "fluid load support [1]")):
        for curve in curves:
            axis.plot(curve[:, 0], curve[:, column], color="grey", linewidth=0.4, alpha=min(0.6, 100 / len(curves)))
        p5, p25, p50, p75, p95 = np.percentile(whole[:, :, column], [5, 25, 50, 75, 95], axis=0)
        axis.fill_between(whole[0, :, 0], p5, p95, color="#56B4E9", alpha=0.4, label="5th to 95th percentile")
        axis.fill_between(whole[0, :, 0], p25, p75, color="#0072B2", alpha=0.5, label="25th to 75th percentile")
        axis.plot(whole[0, :, 0], p50, color="black", linewidth=2, label="median")
        axis.set_xscale("log")
        axis.set_xlabel("sliding speed [mm/s]")
        axis.set_ylabel(label)
        axis.grid(alpha=0.3, which="both")
    axes[0].legend(frameon=False)
    title = f"{len(curves)} virtual knees under {LOAD / 1e3:.1f} kN/m"
    figure.suptitle(title + (f"; {failed} more failed" if failed else ""), x=0.01, ha="left")
    figure.savefig(picture, dpi=150)
    plt.close(figure)


if __name__ == "__main__":
    chosen = options(
        __doc__, knees=100, folder="population", picture="population.png", scheduler=None, workers=os.cpu_count()
    )
    main(**chosen)
