"""A joint in MuJoCo whose cartilage contact is the FMU: the same motion with an explicit and an implicit master.

A femoral condyle of 0.8 kg lies on a tibial plateau between collateral and cruciate ligaments. Gravity presses it down and
a motor flexes it. MuJoCo moves the bodies with its own contacts off; FMPy runs the contact between them:

    kinematics -> penetration depth, surface speeds -> FMU -> forces and moment -> both bodies

Forces are exchanged once a communication step and held in between, while MuJoCo takes steps of 50 microseconds.

- The explicit master applies the forces of the last exchange. That lag takes k h / 2 from the damping c of the joint (k
  stiffness of the contact, h communication step), so it is stable below h = 2 c / k only. The FMU is quasi-steady and has
  no damping of its own: c is that of the ligaments.
- The implicit master finds the forces that belong to the end of the step, by Newton's method: both sides go back to the
  beginning of the step (`fmi2SetFMUstate`, `mj_setState`); the slopes of the forces come from the FMU
  (`fmi2GetDirectionalDerivative`), those of the motion from two more runs of MuJoCo.

Once a cycle the flexion slows down so much that the film breaks: the joint passes from a full film into solid contact and
out of it again.

Mass, ligaments and their damping (a sixth of critical) are assumed, not measured; change them in `JOINT`. At the speeds of
this motion the mesh of 60 x 4 elements gives depth within 1 %, friction within 2.5 % and contact length within 10 %
(0.4 mm where contact begins) of one of 100 x 6.

    pip install fmpy mujoco matplotlib
    cargo run --release                   # writes the FMU
    python examples/joint_mujoco.py       # prints the table, writes joint_mujoco.png; some minutes
"""

import math
import tempfile

from start import FMU, needs, options, tell

needs("numpy", "fmpy", "mujoco", "matplotlib")

import mujoco
import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

RADIUS = 0.1  # m, of both surfaces: the paper's
INPUTS = ["penetration_depth", "sliding_speed", "slide_to_roll_ratio"]
FORCES = ["upper_force_y", "upper_force_x", "upper_moment"]
PARAMETERS = {
    "width": 0.03, "viscosity": 0.01, "mesh.columns": 60, "mesh.rows": 4, "boundary_friction_loads_tissue": False,
}  # fmt: skip

JOINT = """
<mujoco>
  <option timestep="5e-5" gravity="0 0 -9.81"> <flag contact="disable"/> </option>
  <worldbody>
    <body name="tibia" pos="0 0 -0.1"> <geom type="cylinder" size="0.1 0.015" euler="90 0 0" mass="0"/>
      <site name="medial" pos="0 -0.03 0.05"/>   <site name="lateral" pos="0 0.03 0.05"/>
      <site name="anterior" pos="0.1 0 0.1"/>    <site name="posterior" pos="-0.1 0 0.1"/>
    </body>
    <body name="femur" pos="0 0 0.1">
      <joint name="glide" type="slide" axis="1 0 0"/> <joint name="lift" type="slide" axis="0 0 1"/>
      <site name="axis"/> <site name="axis_medial" pos="0 -0.03 0"/> <site name="axis_lateral" pos="0 0.03 0"/>
      <inertial pos="0 0 0" mass="0.3" diaginertia="1e-3 1e-3 1e-3"/>
      <body name="condyle"> <joint name="flexion" type="hinge" axis="0 -1 0"/>
        <geom type="cylinder" size="0.1 0.015" euler="90 0 0" mass="0.5"/>
      </body>
    </body>
  </worldbody>
  <tendon>
    <spatial name="medial" stiffness="5e3" damping="50"> <site site="medial"/> <site site="axis_medial"/> </spatial>
    <spatial name="lateral" stiffness="5e3" damping="50"> <site site="lateral"/> <site site="axis_lateral"/> </spatial>
    <spatial name="anterior" stiffness="1e4" damping="100"> <site site="anterior"/> <site site="axis"/> </spatial>
    <spatial name="posterior" stiffness="1e4" damping="100"> <site site="posterior"/> <site site="axis"/> </spatial>
  </tendon>
  <actuator> <velocity joint="flexion" kv="20"/> </actuator>
</mujoco>
"""


SPEEDS = {"full film": 2.0, "solid contact": 0.3}  # rad/s


def flexion_speed(time: float, period: float = 0.2) -> float:
    """rad/s: never at rest, because the contact is steady at every instant and its friction turns with the speed."""
    return 1.65 + 1.35 * math.cos(2 * math.pi * time / period)


class Joint:
    """The bodies. Forces of the contact: normal force on the condyle and friction against its motion."""

    def __init__(self, speed=flexion_speed):
        self.model = mujoco.MjModel.from_xml_string(JOINT)
        self.data = mujoco.MjData(self.model)
        self.speed = speed
        self.data.qvel[2] = self.speed(0)
        mujoco.mj_forward(self.model, self.data)

    def state(self):
        state = np.empty(mujoco.mj_stateSize(self.model, mujoco.mjtState.mjSTATE_INTEGRATION))
        mujoco.mj_getState(self.model, self.data, state, mujoco.mjtState.mjSTATE_INTEGRATION)
        return state

    def restore(self, state):
        mujoco.mj_setState(self.model, self.data, state, mujoco.mjtState.mjSTATE_INTEGRATION)

    def normal(self):
        """From the centre of the tibial surface to that of the condyle, with their distance."""
        glide, lift = self.data.qpos[:2]
        distance = math.hypot(glide, 2 * RADIUS + lift)
        return np.array([glide, 2 * RADIUS + lift]) / distance, distance

    def inputs(self):
        """Depth, sum of the surface speeds and their ratio, seen from the point of contact, which moves half as fast."""
        normal, distance = self.normal()
        glide = self.data.qvel[0] * normal[1] - self.data.qvel[1] * normal[0]
        upper, lower = RADIUS * self.data.qvel[2] + glide / 2, -glide / 2
        return np.array([2 * RADIUS - distance, upper + lower, (upper - lower) / (upper + lower)])

    def step(self, size: float, forces):
        """One communication step under constant forces; returns what the FMU needs to know at its end."""
        normal, distance = self.normal()
        tangent = np.array([normal[1], -normal[0]])
        self.data.qfrc_applied[:2] = forces[0] * normal + forces[1] * tangent
        # From the middle of the contact to the centre of the condyle.
        self.data.qfrc_applied[2] = forces[2] + forces[1] * distance / 2
        self.data.ctrl[0] = self.speed(self.data.time + size)
        mujoco.mj_step(self.model, self.data, nstep=round(size / self.model.opt.timestep))
        return self.inputs()


class Contact:
    """The FMU: inputs in, forces out."""

    def __init__(self, folder: str, description, parameters: dict):
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        model = description.coSimulation.modelIdentifier
        self.fmu = FMU2Slave(
            guid=description.guid, unzipDirectory=folder, modelIdentifier=model, instanceName="contact"
        )
        self.fmu.instantiate()
        self.fmu.setupExperiment(startTime=0.0)
        setters = {bool: self.fmu.setBoolean, int: self.fmu.setInteger, float: self.fmu.setReal}
        for name, value in parameters.items():
            setters[type(value)]([self.references[name]], [value])
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.time = 0.0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.fmu.terminate()
        self.fmu.freeInstance()

    def get(self, *names):
        return np.array(self.fmu.getReal([self.references[name] for name in names]))

    def step(self, size: float, inputs):
        self.fmu.setReal([self.references[name] for name in INPUTS], list(inputs))
        self.fmu.doStep(self.time, size)
        self.time += size
        return self.get(*FORCES)

    def slopes(self):
        """Forces by inputs, a column an input."""
        forces, inputs = ([self.references[name] for name in names] for names in (FORCES, INPUTS))
        return np.column_stack([self.fmu.getDirectionalDerivative(forces, [input], [1.0]) for input in inputs])


def settle(joint: Joint, contact: Contact):
    """Lowers the condyle until the contact carries its weight; returns the forces."""
    weight = 9.81 * joint.model.body_mass.sum()
    depth = -1e-5
    for _ in range(60):
        _, speed, ratio = joint.inputs()
        forces = contact.step(0.01, [depth, speed, ratio])
        change = (weight - forces[0]) / contact.slopes()[0, 0]
        depth += float(np.clip(change, -5e-6, 5e-6))
        if abs(change) < 1e-10:
            break
    joint.data.qpos[1] = -depth
    return forces


def explicit_step(joint: Joint, contact: Contact, size: float, forces):
    return contact.step(size, joint.step(size, forces)), 1


def implicit_step(joint: Joint, contact: Contact, size: float, forces):
    """Newton's method for the forces at the end of the step."""
    scale = (abs(forces[0]) + 1.0) * np.array([1.0, 1.0, RADIUS])
    motion, state, time = joint.state(), contact.fmu.getFMUstate(), contact.time
    try:
        for iteration in range(1, 16):
            by_force = np.empty((3, 3))
            joint.restore(motion)
            inputs = joint.step(size, forces)
            for column, change in enumerate(np.diag(1e-3 * scale)):
                joint.restore(motion)
                by_force[:, column] = (joint.step(size, forces + change) - inputs) / change[column]
            if iteration > 1:
                contact.fmu.setFMUstate(state)
                contact.time = time
            found = contact.step(size, inputs)
            jacobian = contact.slopes() @ by_force - np.eye(3)
            change = np.linalg.solve(jacobian, forces - found)
            if np.abs(change / scale).max() < 1e-4:
                joint.restore(motion)
                joint.step(size, forces)
                return found, iteration
            # No more than 5 microns a Newton step: the FMU follows small changes much faster than leaps.
            depth = abs(by_force[0] @ change)
            forces = forces + change * min(1.0, 5e-6 / max(depth, 1e-30))
        raise RuntimeError(f"the step of {size} s did not converge")
    finally:
        contact.fmu.freeFMUstate(state)


def run(make_contact, master, size: float, duration: float, speed=flexion_speed, push: float = 0.0):
    """Rows of time, depth, forces along and across the normal, moment and contact length; the number of solutions; the stiffness at rest.

    Stops where a master fails. `push`: extra depth at the start.
    """
    joint, rows, solutions = Joint(speed), [], 0
    with make_contact() as contact:
        forces = settle(joint, contact)
        stiffness = float(contact.get("contact_stiffness")[0])
        joint.data.qpos[1] -= push
        rows.append((0.0, joint.inputs()[0], *forces, *contact.get("contact_length")))
        try:
            for index in range(round(duration / size)):
                forces, count = master(joint, contact, size, forces)
                solutions += count
                rows.append(((index + 1) * size, joint.inputs()[0], *forces, *contact.get("contact_length")))
                if not abs(rows[-1][1] - rows[0][1]) < 1e-4:
                    break
        except (FMICallException, RuntimeError):
            pass
    return np.array(rows), solutions, stiffness


def is_stable(make_contact, master, size: float, speed: float, push: float = 0.5e-6, steps: int = 150) -> bool:
    """At constant flexion speed, pushed half a micron deeper than at rest: has the disturbance become smaller?"""
    rows, _, _ = run(make_contact, master, size, steps * size, lambda _: speed, push)
    return len(rows) == steps + 1 and np.ptp(rows[-steps // 3 :, 1]) < np.ptp(rows[: steps // 3, 1])


def main(
    fmu=FMU, picture="joint_mujoco.png", parameters=None, duration=0.2, small=2e-4, large=2.5e-3,
    explicit_sizes=(6e-4, 7e-4, 8e-4, 9e-4, 1e-3, 1.1e-3, 1.2e-3, 1.3e-3), implicit_sizes=(1e-3, 5e-3, 2e-2),
):  # fmt: skip
    """For each of `SPEEDS` the largest stable step of each master among those tried and the estimate 2c/k [s]; the motions.

    `duration` is that of the motions, one cycle of flexion.
    """
    description = read_model_description(fmu)
    damping, masters = vertical_damping(), {"explicit": explicit_step, "implicit": implicit_step}
    with tempfile.TemporaryDirectory() as folder:
        extract(fmu, unzipdir=folder)

        def make_contact():
            return Contact(folder, description, PARAMETERS | (parameters or {}))

        def flexion(time):
            return flexion_speed(time, duration)

        runs = {
            "explicit, small": run(make_contact, explicit_step, small, duration, flexion),
            "explicit, large": run(make_contact, explicit_step, large, duration, flexion),
            "implicit, large": run(make_contact, implicit_step, large, duration, flexion),
        }
        stable = {}
        for regime, speed in SPEEDS.items():
            stiffness = run(make_contact, explicit_step, small, 0.0, lambda _: speed)[2]
            stable[regime] = {"limit": 2 * damping / stiffness, "stiffness": stiffness}
            for name, sizes in [("explicit", explicit_sizes), ("implicit", implicit_sizes)]:
                good = [size for size in sizes if is_stable(make_contact, masters[name], size, speed)]
                stable[regime][name] = max(good, default=0.0)
                tell(2 * list(SPEEDS).index(regime) + (1 if name == "explicit" else 2), 2 * len(SPEEDS))
    print(f"damping of the ligaments c {damping:.3g} N s/m; largest stable step tried [ms]:")
    print("regime          contact stiffness k [N/m]   2 c / k   explicit   implicit")
    for regime, row in stable.items():
        steps = (1e3 * row[name] for name in ("limit", "explicit", "implicit"))
        print("{:15} {:25.3g}   {:7.2f}   {:8.2f}   {:8.2f}".format(regime, row["stiffness"], *steps))
    print(f"tried up to {1e3 * max(explicit_sizes):g} ms explicitly, {1e3 * max(implicit_sizes):g} ms implicitly")
    for name, (rows, solutions, _) in runs.items():
        end = f"to {1e3 * rows[-1, 0]:.1f} ms, contact length up to {1e3 * rows[:, 5].max():.2f} mm"
        print(f"{name}: {len(rows) - 1} steps, {solutions} solutions of the contact, {end}")
    if picture:
        draw(picture, runs, {"small": small, "large": large}, 9.81 * Joint().model.body_mass.sum())
    return {"stable": stable, "runs": runs}


def vertical_damping() -> float:
    """N s/m: of all ligaments, along the lift of the femur."""
    joint = Joint()
    jacobian = np.zeros((joint.model.ntendon, joint.model.nv))
    for row in range(joint.model.ntendon):
        before = joint.data.ten_length[row]
        joint.data.qpos[1] = 1e-6
        mujoco.mj_forward(joint.model, joint.data)
        jacobian[row, 1] = (joint.data.ten_length[row] - before) / 1e-6
        joint.data.qpos[1] = 0.0
        mujoco.mj_forward(joint.model, joint.data)
    return float((joint.model.tendon_damping.reshape(joint.model.ntendon, -1)[:, 0] * jacobian[:, 1] ** 2).sum())


def draw(picture, runs, sizes, weight):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    style = {
        "explicit, small": dict(color="#0072B2", linewidth=3, alpha=0.6),
        "explicit, large": dict(color="#D55E00", linewidth=1.2, marker="x", markersize=4),
        "implicit, large": dict(color="black", linestyle="none", marker="o", markersize=4, markerfacecolor="white"),
    }
    figure, axes = plt.subplots(4, 1, figsize=(7.5, 9), sharex=True, layout="constrained")
    for name, (rows, _, _) in runs.items():
        master, which = name.split(", ")
        label = f"{master}, {1e3 * sizes[which]:g} ms"
        for axis, values in zip(axes, (1e6 * rows[:, 1], rows[:, 2], rows[:, 3], 1e3 * rows[:, 5])):
            axis.plot(1e3 * rows[:, 0], values, label=label, **style[name])
    for axis, column, factor in zip(axes, (1, 2, 3, 5), (1e6, 1, 1, 1e3)):
        good = factor * runs["explicit, small"][0][:, column]
        middle, half = (good.max() + good.min()) / 2, 0.75 * np.ptp(good) + 0.05 * abs(good).max()
        axis.set_ylim(middle - half, middle + half)
        axis.grid(alpha=0.3)
    axes[1].axhline(weight, color="grey", linewidth=0.8, linestyle="--")
    axes[1].annotate("weight", (1, weight), xycoords=("axes fraction", "data"), xytext=(4, 0), textcoords="offset points",
                     va="center", color="grey")  # fmt: skip
    for axis, label in zip(axes, ("penetration depth [µm]", "normal force [N]", "force along the surface [N]", "contact length [mm]")):
        axis.set_ylabel(label)
    axes[3].set_xlabel("time [ms]")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=3, frameon=False)
    figure.savefig(picture, dpi=150)
    plt.close(figure)


if __name__ == "__main__":
    main(**options(__doc__, picture="joint_mujoco.png", duration=0.2))
