# %% [markdown]
"""The Stribeck analysis of de Boer et al. (2020), Figure 3, from Python.

Two layers of cartilage slide at 0.2 m/s and are pressed together step by step: from a full film to contact. Run this
file as a script, or cell by cell in an editor that knows `# %%` (Jupyter with jupytext, VS Code, Spyder).

    pip install fmpy matplotlib
    cargo run --release            # writes the FMU
    python examples/stribeck.py    # half a minute; writes stribeck.png

The mesh is coarser than the paper's; `MESH = {}` takes the FMU's own, which is good to a few tenths of a percent of load.
"""

# %%
from start import FMU, needs, options, tell

needs("numpy", "fmpy", "matplotlib")

import numpy as np
from fmpy import simulate_fmu

MESH = {"mesh.columns": 80, "mesh.rows": 6}
DEPTHS = 1e-6 * np.r_[-10:30:1, 30:101:5]  # m; the abscissa of the run, not of the figure
OUTPUTS = [
    "penetration_depth", "load", "fluid_load", "solid_load", "sommerfeld_number", "friction_coefficient",
    "fluid_friction_coefficient", "minimum_film_thickness", "contact_length", "maximum_fluid_pressure",
    "maximum_contact_pressure", "maximum_von_mises_stress",
]  # fmt: skip

# %% [markdown]
# The sweep is one simulation: depth over a time that only counts the steps, because every answer is a steady state.
# FMPy holds an input during a step, so the inputs are given a step earlier than the results are read.


# %%
def sweep(fmu=FMU, mesh=MESH, depths=DEPTHS):
    times = np.arange(len(depths), dtype=float)
    signal = np.array(list(zip(times, depths)), dtype=[("time", float), ("penetration_depth", float)])
    start = {"penetration_depth": float(depths[0])} | mesh
    return simulate_fmu(
        fmu, start_values=start, stop_time=times[-1] + 1, output_interval=1, input=signal, output=OUTPUTS,
        step_finished=lambda time, _: tell(time, times[-1] + 1),
    )[1:]  # fmt: skip


# %% [markdown]
# Friction falls with load as long as there is a film, to a least value just before the surfaces touch, and rises steeply
# after: (a). What fluid and solid carry is in (d).


# %%
def draw(result, picture="stribeck.png"):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    blue, orange, green = "#0072B2", "#D55E00", "#009E73"
    number = result["sommerfeld_number"]

    def plot(axis, name, label, color, factor=1.0, marker="o"):
        values = np.where(result[name] > 0, factor * result[name], np.nan)
        axis.loglog(number, values, color=color, marker=marker, markersize=3, linewidth=1, label=label)

    figure, ((a, b), (c, d)) = plt.subplots(2, 2, figsize=(9, 7), sharex=True, layout="constrained")
    plot(a, "friction_coefficient", "fluid and solid", blue)
    plot(a, "fluid_friction_coefficient", "fluid alone", orange, marker="s")
    a.set_ylabel("(a) friction coefficient [1]")
    plot(b, "minimum_film_thickness", "least film thickness", blue, 1e6)
    plot(b, "contact_length", "contact length", orange, 1e6, "s")
    plot(b, "penetration_depth", "penetration depth, where positive", green, 1e6, "^")
    b.set_ylabel("(b) length [µm]")
    plot(c, "maximum_fluid_pressure", "fluid pressure", blue, 1e-3)
    plot(c, "maximum_contact_pressure", "contact pressure", orange, 1e-3, "s")
    plot(c, "maximum_von_mises_stress", "von Mises stress", green, 1e-3, "^")
    c.set_ylabel("(c) maximum [kPa]")
    plot(d, "fluid_load", "fluid", blue)
    plot(d, "solid_load", "solid", orange, marker="s")
    d.set_ylabel("(d) load [N/m]")
    touching = number[result["solid_load"] > 0]
    for axis in (a, b, c, d):
        if len(touching):
            axis.axvspan(number.min(), touching.max(), color="grey", alpha=0.15, linewidth=0)
        axis.grid(alpha=0.3)
        axis.legend(frameon=False, fontsize=8)
    if len(touching):
        a.text(touching.min() * 1.2, a.get_ylim()[1] * 0.5, "solid contact", fontsize=8, color="dimgrey")
    for axis in (c, d):
        axis.set_xlabel("Sommerfeld number, viscosity × speed / load [1]")
    figure.savefig(picture, dpi=150)
    plt.close(figure)


# %%
def main(fmu=FMU, mesh=MESH, depths=DEPTHS, picture="stribeck.png"):
    result = sweep(fmu, mesh, depths)
    least = result[np.argmin(result["friction_coefficient"])]
    touching = result["penetration_depth"][result["solid_load"] > 0]
    print(f"least friction {least['friction_coefficient']:.4f} at a depth of {1e6 * least['penetration_depth']:.0f} um")
    if len(touching):
        print(f"first solid contact at a depth of {1e6 * touching[0]:.0f} um")
    if picture:
        draw(result, picture)
    return result


if __name__ == "__main__":
    main(**options(__doc__, picture="stribeck.png"))
