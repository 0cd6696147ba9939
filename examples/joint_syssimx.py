"""The body of `joint_opensim.py` and the FMU as two components of a SysSimX system.

SysSimX calls the FMU through FMPy and orders the two components by itself: first the body, then the contact, whose outputs
depend on the depth at once. This is the explicit master again, stable below h = 2 c / k.

    pip install "syssimx[fmu,opensim]"
    cargo run --release                   # writes the FMU
    python examples/joint_syssimx.py      # prints the last states and the range of depth
"""

from start import FMU, needs, options

needs("numpy", "fmpy", "opensim", "syssimx")

import numpy as np
from joint_opensim import PARAMETERS, Motion
from syssimx import Connection, CoSimComponent, PortSpec, PortType, System
from syssimx.components.fmu import FMUComponent
from syssimx.system.algorithms.gauss_seidel import GaussSeidelAlgorithm


class Femur(CoSimComponent):
    """Force in, depth out."""

    def __init__(self):
        super().__init__("femur")
        self.input_specs["force"] = PortSpec(name="force", type=PortType.REAL, direction="in", unit="N")
        self.output_specs["depth"] = PortSpec(name="depth", type=PortType.REAL, direction="out", unit="m")
        self.direct_feedthrough = {"depth": set()}

    def _initialize_component(self, t0: float):
        self.motion = Motion()

    def _do_step_internal(self, t: float, dt: float):
        if dt > 0:
            self.motion.step(t + dt, self.inputs["force"].get(as_unit="N").magnitude)

    def _update_output_states(self, t=None, event_names=None):
        self.outputs["depth"].set(self.motion.depth(), t)


class Contact(FMUComponent):
    """SysSimX settles a system by steps of size zero, which FMI 2.0 does not allow: initialization mode has solved already."""

    def _do_step_internal(self, t: float, dt: float):
        if dt > 0:
            super()._do_step_internal(t, dt)


def main(fmu=FMU, exchange=5e-4, duration=0.06, parameters=PARAMETERS, sliding_speed=0.2):
    """Times [s], depths [m] and normal forces [N]."""
    femur, contact = Femur(), Contact("contact", fmu)
    contact.set_parameters(**parameters)
    # An input without a connection is 0 in SysSimX, whatever its start value is.
    contact.inputs["sliding_speed"].set(sliding_speed)
    system = System("joint")
    system.add_component(femur)
    system.add_component(contact)
    system.add_connection(Connection("femur", "depth", "contact", "penetration_depth"))
    system.add_connection(Connection("contact", "normal_force", "femur", "force"))
    system.set_algorithm(GaussSeidelAlgorithm())
    system.initialize(t0=0.0)
    result = system.run(t0=0.0, tf=duration, dt=exchange)
    times, depths = result["femur"][0], result["femur"][1]["depth"]
    forces = result["contact"][1]["normal_force"]
    system.reset()
    return times, depths, forces


if __name__ == "__main__":
    chosen = options(__doc__, duration=0.06)
    for exchange in (5e-4, 1e-3):
        times, depths, forces = main(exchange=exchange, **chosen)
        third = len(depths) // 3
        first, last = 1e6 * np.ptp(depths[:third]), 1e6 * np.ptp(depths[-third:])
        print(f"{1e3 * exchange:g} ms: range of depth {first:.2f} µm in the first third, {last:.2f} µm in the last;", end=" ")
        print(f"at {times[-1]:.3f} s {1e6 * depths[-1]:.3f} µm, {forces[-1]:.3f} N")
