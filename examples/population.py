"""A population of virtual knees on Dask: how much do permeability, modulus, thickness and viscosity matter?

Every knee is one instance of the FMU, pressed to one depth and swept over sliding speed. Knees that cannot be solved are
kept with their message instead of ending the run; knees that are in the results already are not run again, so the same
command resumes a run that was interrupted.

    pip install fmpy "dask[distributed]" pyarrow matplotlib
    cargo run --release                                          # writes the FMU
    python examples/population.py --knees 1000                   # all cores of this machine
    python examples/population.py --knees 1000 --scheduler tcp://head:8786

On a cluster the FMU and the results have to be on a disk that all workers see. Writes `population/knee_*.parquet`, one
file a knee, and `population.png`.

A mesh of 240 x 12 elements a body instead of 120 x 6 changes the load of the first ten knees by 1.4 % at most. It changes
friction by 0.4 % in the median; by more where solid contact just begins, since it begins at a slightly other speed.

Drawn uniformly, permeability and viscosity in their logarithms; both layers of a knee are alike:

| quantity | range | source |
|---|---|---|
| aggregate modulus | 0.48 to 1.58 MPa, Poisson's ratio 0 to 0.10 | human tibial plateau, PMC2858459; Athanasiou et al. 1991 as later papers quote it |
| hydraulic permeability | 1.18e-15 to 7.6e-15 m4/(N s) | Athanasiou et al. 1991 as later papers quote it; published biphasic test case |
| thickness | 1.78 to 2.3 mm | as permeability |
| viscosity | 1e-3 to 1e-2 Pa s | assumed: water to synovial fluid at the high shear of a thin film |
"""

import io
import os
import tempfile
from contextlib import redirect_stdout
from pathlib import Path

from start import FMU, needs, options, tell

needs("numpy", "fmpy", "dask", "distributed", "pyarrow", "matplotlib")

import numpy as np
import pyarrow
import pyarrow.parquet
from dask.distributed import Client, LocalCluster, as_completed
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

DEPTH = 10e-6  # m
SPEEDS = np.geomspace(0.03, 1e-4, 9)  # m/s, from thick films to thin ones
OUTPUTS = ["load", "friction_coefficient", "sommerfeld_number", "minimum_film_thickness", "fluid_load_support"]
# Tissue is nearly undrained: a thin boundary layer at its surface, and pressures one order below displacements.
NUMERICS = {
    "formulation": 2, "mesh.columns": 120, "mesh.rows": 6, "mesh.column_grading": 3.0, "mesh.row_grading": 5.0,
    "mesh.pressure_order": 1, "boundary_friction_loads_tissue": False,
    # Far below the slowest speed, so that boundary friction is mobilised in full.
    "friction_regularisation_speed": 1e-6,
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
        # One viscosity serves film and pores, so that permeability over viscosity is what tests on tissue measure.
        "permeability": hydraulic * viscosity,
        "thickness": random.uniform(1.78e-3, 2.3e-3),
        "viscosity": viscosity,
    }


def run_knee(number: int, fmu: str, folder: str, numerics: dict, speeds) -> tuple[int, str]:
    """Sweeps one knee and writes its file; returns its number and what went wrong, if anything."""
    knee, rows, log = draw_knee(number), [], io.StringIO()
    # FMPy prints what the FMU logs: why a call was refused or a step not done.
    with tempfile.TemporaryDirectory() as unpacked, redirect_stdout(log):
        extract(fmu, unzipdir=unpacked)
        description = read_model_description(fmu)
        references = {variable.name: variable.valueReference for variable in description.modelVariables}
        contact = FMU2Slave(
            guid=description.guid, unzipDirectory=unpacked, modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=f"knee {number}",
        )  # fmt: skip
        problem = ""
        try:
            contact.instantiate()
            setters = {bool: contact.setBoolean, int: contact.setInteger}
            tissue = {f"{body}.{name}": value for body in ("upper", "lower") for name, value in knee.items()
                      if name != "viscosity"}  # fmt: skip
            tissue |= {"upper.biot_coefficient": 1.0, "lower.biot_coefficient": 1.0}
            for name, value in ({"viscosity": knee["viscosity"]} | tissue | numerics).items():
                setters.get(type(value), contact.setReal)([references[name]], [value])
            contact.setupExperiment(startTime=0.0)
            # Only the femur slides: boundary friction has a direction.
            contact.setReal([references[name] for name in ("sliding_speed", "slide_to_roll_ratio")], [float(speeds[0]), 1.0])
            contact.enterInitializationMode()
            contact.exitInitializationMode()
            for time, speed in enumerate(speeds):
                inputs = [references["penetration_depth"], references["sliding_speed"]]
                contact.setReal(inputs, [DEPTH, float(speed)])
                contact.doStep(float(time), 1.0)
                values = contact.getReal([references[name] for name in OUTPUTS])
                rows.append(dict(zip(OUTPUTS, values)) | {"sliding_speed": float(speed)})
        except Exception as error:
            problem = f"{error} {log.getvalue()}".strip()
        finally:
            contact.freeInstance()
    # A knee without a single answer has one row without results, so that it is neither lost nor run again.
    rows = rows or [dict.fromkeys([*OUTPUTS, "sliding_speed"], float("nan"))]
    table = pyarrow.Table.from_pylist([{"knee": number, **knee, **row, "problem": problem} for row in rows])
    unfinished = Path(folder) / f"knee_{number:05}.parquet.unfinished"
    pyarrow.parquet.write_table(table, unfinished)
    unfinished.rename(unfinished.with_suffix(""))
    return number, problem


def main(knees=1000, fmu=FMU, folder="population", picture="population.png", scheduler=None, workers=None,
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
    failed = {row["knee"] for row in table.select(["knee", "problem"]).to_pylist() if row["problem"]}
    print(f"{len(set(table['knee'].to_pylist()))} knees, {len(failed)} of them with a problem")
    summarise(table)
    if picture:
        draw(table, picture)
    return table


def summarise(table):
    """Prints friction and the share of knees in solid contact at each speed."""
    rows = [row for row in table.to_pylist() if not row["problem"]]
    print("sliding speed [mm/s]   friction coefficient: 5th, 50th, 95th percentile   in solid contact")
    for speed in sorted({row["sliding_speed"] for row in rows}, reverse=True):
        here = [row for row in rows if row["sliding_speed"] == speed]
        low, middle, high = np.percentile([row["friction_coefficient"] for row in here], [5, 50, 95])
        touching = np.mean([row["minimum_film_thickness"] <= 0 for row in here])
        print(f"{1e3 * speed:20.2f}   {low:34.4f}   {middle:.4f}   {high:.4f}   {touching:16.0%}")


def draw(table, picture):
    """Friction against the Sommerfeld number: a line a knee, and percentiles over all knees."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    rows = [row for row in table.to_pylist() if not row["problem"]]
    knees = {}
    for row in rows:
        knees.setdefault(row["knee"], []).append((row["sommerfeld_number"], row["friction_coefficient"]))
    curves = [np.array(sorted(curve)) for curve in knees.values()]
    low, high = (function(curve[end, 0] for curve in curves) for function, end in ((min, 0), (max, -1)))
    numbers = np.geomspace(low, high, 60)
    friction = np.array([
        np.exp(np.interp(np.log(numbers), np.log(x), np.log(y), left=np.nan, right=np.nan)) for x, y in (c.T for c in curves)
    ])  # fmt: skip
    enough = np.isfinite(friction).sum(axis=0) >= max(2, len(curves) // 5)
    numbers, friction = numbers[enough], friction[:, enough]
    p5, p25, p50, p75, p95 = np.nanpercentile(friction, [5, 25, 50, 75, 95], axis=0)
    figure, axis = plt.subplots(figsize=(7, 4.6), layout="constrained")
    for curve in curves:
        axis.loglog(*curve.T, color="grey", linewidth=0.4, alpha=min(0.5, 100 / len(curves)))
    axis.fill_between(numbers, p5, p95, color="#56B4E9", alpha=0.4, label="5th to 95th percentile")
    axis.fill_between(numbers, p25, p75, color="#0072B2", alpha=0.5, label="25th to 75th percentile")
    axis.loglog(numbers, p50, color="black", linewidth=2, label="median")
    axis.set_xlabel("Sommerfeld number, viscosity × speed / load [1]")
    axis.set_ylabel("friction coefficient [1]")
    axis.set_title(f"{len(curves)} virtual knees, pressed {1e6 * DEPTH:g} µm", loc="left")
    axis.grid(alpha=0.3, which="both")
    axis.legend(frameon=False)
    figure.savefig(picture, dpi=150)
    plt.close(figure)


if __name__ == "__main__":
    chosen = options(
        __doc__, knees=1000, folder="population", picture="population.png", scheduler=None, workers=os.cpu_count()
    )
    main(**chosen)
