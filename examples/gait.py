"""Cycles of walking with the FMU alone: load and sliding speed are given, film, friction and tissue follow in time.

    pip install fmpy matplotlib
    cargo run --release          # writes the FMU
    python examples/gait.py      # minutes; writes gait.png

The cycle is that of examples/gait_hip.csv under a light load on the tissue of the paper, as of `cartilage-contact gait --peak-load 25
--steps 200`; docs/gait.md says more. Between communication points the inputs go on linearly, by fmi2SetRealInputDerivatives. (FMPy's
simulate_fmu would set the slopes of the interval before.)
"""

import shutil
from pathlib import Path

from start import FMU, needs, options, tell

needs("numpy", "fmpy", "matplotlib")

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

CYCLE = Path(__file__).with_name("gait_hip.csv")  # time [s], force [N], flexion [deg] at equal steps
RADIUS = 0.024  # m, turns flexion into sliding
OUTPUTS = [
    "penetration_depth_result", "fluid_load", "solid_load", "friction_coefficient", "fluid_load_support",
    "minimum_film_thickness", "net_fluid_exudation",
]  # fmt: skip


def cycle(steps, peak_load):
    """Times [s], loads [N/m] and sliding speeds [m/s] at the communication points of one cycle."""
    _, *rows = [line for line in CYCLE.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    times, force, flexion = np.loadtxt(rows, delimiter=",").T
    angle = np.radians(flexion[:-1])
    speed = RADIUS * (np.roll(angle, -1) - np.roll(angle, 1)) / (times[2] - times[0])
    time = np.linspace(0, times[-1], steps + 1)
    load = peak_load / force.max() * np.interp(time, times, force)
    return time, load, np.interp(time, times, np.append(speed, speed[0]))


def walk(fmu, parameters, time_integration, time, load, speed, cycles, tolerance):
    """The last of so many cycles, fewer where one repeats the one before; and how much it differed from that."""
    description = read_model_description(fmu)
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    types = {variable.name: variable.type for variable in description.modelVariables}
    given = [references["applied_load"], references["sliding_speed"]]
    wanted = [references[name] for name in OUTPUTS]
    folder = extract(fmu)
    contact = FMU2Slave(
        guid=description.guid, unzipDirectory=folder, modelIdentifier=description.coSimulation.modelIdentifier
    )
    contact.instantiate()
    # Of both choices the second: transient, and load control.
    choices = {"control": 2, "time_integration": {"quasi_steady": 1, "transient": 2}[time_integration]}
    for name, value in (choices | parameters).items():
        put = contact.setReal if types[name] == "Real" else contact.setInteger
        put([references[name]], [value])
    contact.setupExperiment(startTime=0.0)
    contact.enterInitializationMode()
    # The first instant has no speed, and the steady state of that is one of drained tissue: begin with that of the mean speed.
    start = speed[0] if time_integration == "quasi_steady" else np.sqrt(np.mean(speed**2))
    contact.setReal(given, [load[0], start])
    contact.exitInitializationMode()

    before, change = None, None
    for count in range(cycles):
        states = [contact.getReal(wanted)]
        for i in range(len(time) - 1):
            step = time[i + 1] - time[i]
            contact.setReal(given, [load[i], speed[i]])
            contact.setRealInputDerivatives(given, [1, 1], [(v[i + 1] - v[i]) / step for v in (load, speed)])
            contact.doStep(count * time[-1] + time[i], step)
            states.append(contact.getReal(wanted))
            tell(i + 1, len(time) - 1, f"{time_integration}, cycle {count + 1}: ")
        states = np.array(states)
        if before is not None:
            # Depth, fluid load and solid load, relative to the largest depth and load.
            size = np.array([abs(states[:, 0]).max(), load.max(), load.max()])
            change = float((abs(states - before)[:, :3] / size).max())
            if change < tolerance:
                break
        before = states
    contact.terminate()
    contact.freeInstance()
    shutil.rmtree(folder)
    return dict(zip(OUTPUTS, states.T)), change


def draw(time, load, speed, runs, picture):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(3, 2, figsize=(10, 8), sharex=True, layout="constrained")
    axes = axes.ravel()
    axes[0].plot(time, load, color="black")
    axes[0].set_ylabel("load [N/m]")
    twin = axes[0].twinx()
    twin.plot(time, speed, color="grey", linestyle=":")
    twin.set_ylabel("sliding speed (dotted) [m/s]")
    shown = [
        ("minimum_film_thickness", 1e6, "thinnest film [µm]"),
        ("penetration_depth_result", 1e6, "penetration depth [µm]"),
        ("friction_coefficient", 1, "friction coefficient [1]"),
        ("fluid_load_support", 1, "fluid load support [1]"),
        ("exchange", 1e6, "fluid given off by the tissue [mm²]"),
    ]
    for axis, (name, factor, label) in zip(axes[1:], shown):
        for integration, style in [("quasi_steady", "--"), ("transient", "-")]:
            axis.plot(time, factor * runs[integration][name], style, label=integration.replace("_", "-"))
        axis.set_ylabel(label)
    axes[1].legend(frameon=False)
    for axis in axes:
        axis.grid(alpha=0.3)
    for axis in axes[-2:]:
        axis.set_xlabel("time since heel strike [s]")
    figure.savefig(picture, dpi=150)
    plt.close(figure)


def main(fmu=FMU, parameters=None, peak_load=25.0, steps=200, cycles=10, tolerance=0.01, picture="gait.png"):
    """By kind of time integration, what happens over the last cycle; and the change since the cycle before, all SI."""
    time, load, speed = cycle(steps, peak_load)
    runs = {}
    for integration, most in [("transient", cycles), ("quasi_steady", 1)]:
        run, change = walk(fmu, parameters or {}, integration, time, load, speed, most, tolerance)
        flow = run["net_fluid_exudation"]
        run["exchange"] = np.concatenate([[0.0], np.cumsum((flow[1:] + flow[:-1]) / 2 * np.diff(time))])
        runs[integration] = run
        if change is not None:
            runs["change"] = change
        print(
            f"{integration}: deepest {1e6 * run['penetration_depth_result'].max():.2f} um, "
            f"least fluid load support {run['fluid_load_support'].min():.3f}, "
            f"mean friction coefficient {run['friction_coefficient'].mean():.4f}"
        )
    if "change" in runs:
        periodic = "periodic" if runs["change"] < tolerance else "not periodic"
        print(f"{periodic}: the last cycle differs from the one before by {100 * runs['change']:.2f} % at most")
    if picture:
        draw(time, load, speed, runs, picture)
    return runs | {"time": time, "applied_load": load, "sliding_speed": speed}


if __name__ == "__main__":
    main(**options(__doc__, peak_load=25.0, steps=200, cycles=10, picture="gait.png"))
