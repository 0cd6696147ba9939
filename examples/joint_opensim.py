"""A body in OpenSim on the FMU: how often do forces have to be exchanged?

A femoral condyle of 0.8 kg moves along the vertical coordinate of an OpenSim model, with 200 N s/m of damping and no
contact geometry. FMPy runs the contact: the coordinate gives the penetration depth, the normal force goes into a
`CoordinateActuator`. Forces are held between two exchanges, so that the loop is stable below h = 2 c / k only.

    pip install fmpy opensim
    cargo run --release                   # writes the FMU
    python examples/joint_opensim.py      # prints the table; a minute
"""

import tempfile

from start import FMU, needs, options

needs("numpy", "fmpy", "opensim")

import numpy as np
import opensim
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

DEPTH = 2.2e-5  # m, at the start: some microns off the equilibrium
DAMPING = 200.0  # N s/m
PARAMETERS = {"width": 0.03, "viscosity": 0.01, "mesh.columns": 40, "mesh.rows": 3}
opensim.Logger.setLevelString("error")


def joint() -> opensim.Model:
    """A body that moves along x, which is up here; force and motion have the names `contact` and `lift`."""
    model = opensim.Model()
    model.setGravity(opensim.Vec3(-9.81, 0, 0))
    femur = opensim.Body("femur", 0.8, opensim.Vec3(0), opensim.Inertia(1e-3))
    slider = opensim.SliderJoint("slider", model.getGround(), femur)
    slider.updCoordinate().setName("lift")
    ligaments = opensim.SpringGeneralizedForce("lift")
    ligaments.setViscosity(DAMPING)
    force = opensim.CoordinateActuator("lift")
    force.setName("contact")
    force.setOptimalForce(1)
    model.addBody(femur)
    model.addJoint(slider)
    model.addForce(ligaments)
    model.addForce(force)
    return model


class Motion:
    """The model with its state; `force` is held during a step."""

    def __init__(self):
        self.model = joint()
        self.state = self.model.initSystem()
        self.lift = self.model.getCoordinateSet().get("lift")
        self.contact = opensim.CoordinateActuator.safeDownCast(self.model.updForceSet().get("contact"))
        self.contact.overrideActuation(self.state, True)
        self.lift.setValue(self.state, -DEPTH)
        self.manager = opensim.Manager(self.model)
        self.manager.setIntegratorAccuracy(1e-8)

    def step(self, end: float, force: float):
        self.contact.setOverrideActuation(self.state, force)
        # The integrator has to begin anew where a force jumps.
        self.manager.initialize(self.state)
        self.state = self.manager.integrate(end)

    def depth(self) -> float:
        return -self.lift.getValue(self.state)


def run(folder: str, description, exchange: float, duration: float, parameters: dict):
    """Rows of time, depth and normal force; and the stiffness of the contact at the end."""
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    model = description.coSimulation.modelIdentifier
    contact = FMU2Slave(guid=description.guid, unzipDirectory=folder, modelIdentifier=model, instanceName="contact")
    contact.instantiate()
    for name, value in parameters.items():
        (contact.setInteger if isinstance(value, int) else contact.setReal)([references[name]], [value])
    contact.setReal([references["penetration_depth"]], [DEPTH])
    contact.setupExperiment(startTime=0.0)
    contact.enterInitializationMode()
    contact.exitInitializationMode()

    motion, rows = Motion(), []
    (normal,) = contact.getReal([references["normal_force"]])
    for index in range(round(duration / exchange)):
        motion.step((index + 1) * exchange, normal)
        contact.setReal([references["penetration_depth"]], [motion.depth()])
        contact.doStep(index * exchange, exchange)
        (normal,) = contact.getReal([references["normal_force"]])
        rows.append(((index + 1) * exchange, motion.depth(), normal))
    (stiffness,) = contact.getReal([references["contact_stiffness"]])
    contact.terminate()
    contact.freeInstance()
    return np.array(rows), stiffness


def main(fmu=FMU, exchanges=(2e-4, 5e-4, 7e-4, 1e-3, 2e-3), duration=0.06, parameters=PARAMETERS):
    """Range of depth [m] in the first and in the last third of the motion, by time between exchanges [s]."""
    description, ranges, stiffnesses = read_model_description(fmu), {}, []
    with tempfile.TemporaryDirectory() as folder:
        extract(fmu, unzipdir=folder)
        print("exchange [ms]   range of depth, first third [µm]   last third [µm]   normal force at the end [N]")
        for exchange in exchanges:
            rows, stiffness = run(folder, description, exchange, duration, parameters)
            third = len(rows) // 3
            ranges[exchange] = np.ptp(rows[:third, 1]), np.ptp(rows[-third:, 1])
            stiffnesses.append(stiffness)
            first, last = (1e6 * value for value in ranges[exchange])
            print(f"{1e3 * exchange:13.1f}   {first:32.2f}   {last:15.2f}   {rows[-1, 2]:27.2f}")
    print(f"at rest k = {stiffnesses[0]:.3g} N/m and 2 c / k = {1e3 * 2 * DAMPING / stiffnesses[0]:.2f} ms")
    return ranges


if __name__ == "__main__":
    chosen = options(__doc__, duration=0.06)
    print(f"OpenSim {opensim.GetVersion()}")
    main(**chosen)
