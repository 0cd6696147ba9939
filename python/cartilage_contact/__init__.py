"""Lubrication of cartilage on cartilage, from Python.

Everything is in SI units and has the names of the FMU's variables (``cartilage-contact solve --help`` lists them). One state:

>>> import cartilage_contact as cc
>>> state = cc.solve(penetration_depth=12e-6, sliding_speed=0.2, mesh={"columns": 60, "rows": 4})
>>> print(f"{state['load']:.0f} {state.units['load']}")
65 N/m
>>> state["lubrication_regime"].name
'low_friction'
>>> state["fluid_pressure"].shape, state.units["fluid_pressure"]
((101,), 'Pa')
>>> state.warnings
()

Many states, as a table of arrays:

>>> table = cc.sweep(depths=[-5e-6, 0.0, 5e-6], speeds=[0.1, 0.2], mesh={"columns": 40, "rows": 3})
>>> table["load"].shape, table.units["load"]
((6,), 'N/m')

In time, with inputs that are linear between their points, so that this ramp ends at 10 micron:

>>> ramp = {"time": [0, 20], "penetration_depth": [-10e-6, 10e-6]}
>>> press = cc.simulate(ramp, output_interval=4, mesh={"columns": 40, "rows": 3})
>>> [round(1e6 * depth) for depth in press["penetration_depth"]]
[-10, -6, -2, 2, 6, 10]

``fmu_path`` says where the FMUs are, for other tools; ``gait`` walks; the command ``cartilage-contact`` does the rest.
"""

from .model import ContactError, Variable, enumeration, fmu_path, variables
from .runs import State, Table, gait, simulate, solve, sweep

__all__ = [
    "ContactError",
    "State",
    "Table",
    "Variable",
    "enumeration",
    "fmu_path",
    "gait",
    "simulate",
    "solve",
    "sweep",
    "variables",
]
