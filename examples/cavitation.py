"""What a film that may cavitate does to pressure and load (FMPy, with the FMU of FMI 2.0).

    pip install fmpy matplotlib
    cargo run --release               # writes the FMU
    python examples/cavitation.py     # some ten seconds; writes cavitation.png

Below a cavitation pressure the film cavitates instead of pulling: gas or vapour fills a part of the gap, and the fluid that is left is
carried along until the film forms again. Three cavitation pressures above ambient are compared with a film that never cavitates.
"""

from start import FMU, needs, options, tell

needs("numpy", "fmpy", "matplotlib")

import numpy as np
from fmpy import simulate_fmu

DEPTHS = 1e-6 * np.arange(-10, 11)  # m, a full film throughout
PRESSURES = [None, -2000.0, -500.0, 0.0]  # Pa; None never cavitates
STATIONS = range(1, 102)
OUTPUTS = ["penetration_depth", "load", "minimum_film_thickness", "minimum_fluid_pressure", "cavitated_length"]


def sweep(fmu, pressure, depths, parameters):
    times = np.arange(len(depths), dtype=float)
    signal = np.array(list(zip(times, depths)), dtype=[("time", float), ("penetration_depth", float)])
    start = {"penetration_depth": float(depths[0]), "cavitation": pressure is not None} | parameters
    if pressure is not None:
        start["cavitation_pressure"] = pressure
    profiles = [f"{name}[{i}]" for name in ("position", "fluid_pressure") for i in STATIONS]
    # FMPy holds an input during a step: results at a time belong to the input one step before.
    run = dict(start_values=start, input=signal, output=OUTPUTS + profiles, output_interval=1, stop_time=times[-1] + 1)
    return simulate_fmu(fmu, **run)[1:]


def draw(results, middle, picture):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (profile, load) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for (pressure, result), color in zip(results.items(), ["black", "#0072B2", "#009E73", "#D55E00"]):
        label = "never tears" if pressure is None else f"tears at {pressure:.0f} Pa"
        row = result[middle]
        x, p = (np.array([row[f"{name}[{i}]"] for i in STATIONS]) for name in ("position", "fluid_pressure"))
        profile.plot(1e3 * x, 1e-3 * p, color=color, label=label, linewidth=1.2)
        load.semilogy(1e6 * result["penetration_depth"], result["load"], color=color, label=label, linewidth=1.2)
    depth = 1e6 * next(iter(results.values()))["penetration_depth"][middle]
    profile.set(xlim=(-4, 4), xlabel="x [mm]", ylabel="fluid pressure [kPa]", title=f"penetration depth {depth:.0f} µm")
    load.set(xlabel="penetration depth [µm]", ylabel="load [N/m]", title="load")
    for axis in (profile, load):
        axis.grid(alpha=0.3)
        axis.legend(frameon=False, fontsize=8)
    figure.savefig(picture, dpi=150)
    plt.close(figure)


def main(fmu=FMU, picture="cavitation.png", depths=DEPTHS, parameters=None):
    results = {}
    for done, pressure in enumerate(PRESSURES, 1):
        results[pressure] = sweep(fmu, pressure, depths, parameters or {})
        tell(done, len(PRESSURES))
    middle = len(depths) // 2
    for pressure, result in results.items():
        row = result[middle]
        name = "never tears" if pressure is None else f"tears at {pressure:.0f} Pa"
        print(
            f"{name:16} load {row['load']:7.3f} N/m, least film {1e6 * row['minimum_film_thickness']:.3f} um, "
            f"least pressure {row['minimum_fluid_pressure']:8.1f} Pa, cavitated over {1e3 * row['cavitated_length']:.2f} mm"
        )
    if picture:
        draw(results, middle, picture)
    return results


if __name__ == "__main__":
    main(**options(__doc__, picture="cavitation.png"))
