"""A hip or knee under body weight in MuJoCo, with the FMU as its cartilage: the same motion with an explicit and an implicit master.

The body stands on the joint: its mass presses the upper bone onto the lower one along a guide with a damper for muscles and
ligaments, a motor swings the upper bone to and fro as in walking, and a heel strike adds once more the body's weight for 40 ms.
MuJoCo moves the bodies; FMPy runs the contact between them:

    kinematics -> rate of the depth, surface speed -> FMU -> force and moment -> both bones

Case and tissue are those of examples/hip.toml or knee.toml; the FMU runs in time: film and tissue need it to be squeezed and drained.
Forces are exchanged once a communication step and held in between, while MuJoCo takes steps of 50 microseconds.

- The explicit master applies the forces of the last exchange. That lag takes k h / 2 from the damping c (k stiffness of the
  contact, h communication step), so that it is stable below h = 2 c / k, unless the contact damps by itself.
- The implicit master finds the forces that belong to the end of the step, by Newton's method: both sides go back to the
  beginning of the step (`fmi2SetFMUstate`, `mj_setState`); the slopes of the forces come from the FMU
  (`fmi2GetDirectionalDerivative`), those of the motion from two more runs of MuJoCo.

Beside them the same motion on a penalty contact, a spring as stiff as the cartilage at rest with a friction coefficient of 0.01, and
explicitly too: what does the soft tissue add?

The damper (a twentieth of critical), the swing and the heel strike are assumed, not measured: change them below.

    pip install fmpy mujoco matplotlib    # and tomli before Python 3.11
    cargo run --release                   # writes the FMU
    python examples/joint_mujoco.py       # prints the table, writes joint_mujoco.png; some minutes
    python examples/joint_mujoco.py --joint knee --load 300
"""

import math
import tempfile

from start import FMU, TOML, joint_case, needs, options, set_values, tell

needs("numpy", "fmpy", "mujoco", "matplotlib", TOML)

import mujoco
import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

INPUTS = ["approach_speed", "sliding_speed"]
FORCES = ["upper_force_y", "upper_force_x", "upper_moment"]
#: Beside the case: a coarse mesh, for speed.
PARAMETERS = {"time_integration": "transient", "mesh.columns": 48, "mesh.rows": 6}
DAMPING = 0.05  # of critical
PERIOD = 1.0  # s, of the swing
SWING = math.radians(21.5)  # to either side of the middle
STRIKE = (0.05, 0.04, 1.0)  # s, s, body weights: begin, length and height of the heel strike
FRICTION = 0.01  # of the penalty contact
LEAP = 5e-5  # m: a Newton step of the implicit master changes depth by no more, for the FMU follows small changes much faster

JOINT = """
<mujoco>
  <option timestep="5e-5" gravity="0 0 -9.81"> <flag contact="disable"/> </option>
  <worldbody>
    <body name="body">
      <joint name="lift" type="slide" axis="0 0 1" damping="{damping}"/>
      <inertial pos="0 0 0" mass="{mass}" diaginertia="1 1 1"/>
      <body name="bone"> <joint name="flexion" type="hinge" axis="0 -1 0"/>
        <inertial pos="0 0 0" mass="0.1" diaginertia="0.5 0.5 0.5"/>
      </body>
    </body>
  </worldbody>
  <actuator> <velocity joint="flexion" kv="200"/> </actuator>
</mujoco>
"""


def swing(time: float) -> float:
    """rad/s: begins fast, turns after a quarter of the period."""
    return SWING * 2 * math.pi / PERIOD * math.cos(2 * math.pi * time / PERIOD)


class Joint:
    """The bodies. `damping` [N s/m] of the guide; the surface of the upper bone is `radius` [m] from its axis."""

    def __init__(self, load: float, radius: float, damping: float, speed=swing):
        self.model = mujoco.MjModel.from_xml_string(JOINT.format(mass=load / 9.81 - 0.1, damping=damping))
        self.data = mujoco.MjData(self.model)
        self.load, self.radius, self.speed = load, radius, speed
        self.data.qvel[1] = self.speed(0)
        mujoco.mj_forward(self.model, self.data)

    def state(self):
        state = np.empty(mujoco.mj_stateSize(self.model, mujoco.mjtState.mjSTATE_INTEGRATION))
        mujoco.mj_getState(self.model, self.data, state, mujoco.mjtState.mjSTATE_INTEGRATION)
        return state

    def restore(self, state):
        mujoco.mj_setState(self.model, self.data, state, mujoco.mjtState.mjSTATE_INTEGRATION)

    def depth(self) -> float:
        return -self.data.qpos[0]

    def sliding(self) -> float:
        """The other surface is at rest."""
        return self.radius * self.data.qvel[1]

    def step(self, size: float, forces, strikes=True):
        """One communication step under constant forces; returns what the FMU needs to know of it."""
        before = self.depth()
        begin, length, height = STRIKE
        middle = (self.data.time + size / 2 - begin) / length
        strike = self.load * height * math.sin(math.pi * middle) if strikes and 0 < middle < 1 else 0.0
        self.data.qfrc_applied[0] = forces[0] - strike
        # From the middle of the contact to the axis.
        self.data.qfrc_applied[1] = forces[2] + forces[1] * (self.radius - before / 2)
        self.data.ctrl[0] = self.speed(self.data.time + size)
        mujoco.mj_step(self.model, self.data, nstep=round(size / self.model.opt.timestep))
        return np.array([(self.depth() - before) / size, self.sliding()])


class Cartilage:
    """The FMU: inputs in, forces out."""

    def __init__(self, folder: str, description, parameters: dict, state=None):
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        model = description.coSimulation.modelIdentifier
        self.fmu = FMU2Slave(
            guid=description.guid, unzipDirectory=folder, modelIdentifier=model, instanceName="contact"
        )
        self.fmu.instantiate()
        self.fmu.setupExperiment(startTime=0.0)
        set_values(self.fmu, description, parameters)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.time = 0.0
        if state is not None:
            self.restore(state)
            # From here on the upper bone slides on the one at rest.
            self.set({"slide_to_roll_ratio": 1.0})

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.fmu.terminate()
        self.fmu.freeInstance()

    def set(self, values):
        self.fmu.setReal([self.references[name] for name in values], list(values.values()))

    def state(self) -> bytes:
        state = self.fmu.getFMUstate()
        found = self.fmu.serializeFMUstate(state)
        self.fmu.freeFMUstate(state)
        return found

    def restore(self, found: bytes):
        state = self.fmu.deSerializeFMUstate(found)
        self.fmu.setFMUstate(state)
        self.fmu.freeFMUstate(state)

    def get(self, *names):
        return np.array(self.fmu.getReal([self.references[name] for name in names]))

    def step(self, size: float, inputs):
        self.set(dict(zip(INPUTS, map(float, inputs))))
        self.fmu.doStep(self.time, size)
        self.time += size
        return self.get(*FORCES)

    def slopes(self):
        """Forces by inputs, a column an input."""
        forces, inputs = ([self.references[name] for name in names] for names in (FORCES, INPUTS))
        return np.column_stack([self.fmu.getDirectionalDerivative(forces, [input], [1.0]) for input in inputs])

    def forces(self):
        return self.get(*FORCES)

    def film(self):
        return self.get("minimum_film_thickness", "fluid_load_support")


class Spring:
    """A penalty contact of this stiffness [N/m] that carries this load at this depth, with friction."""

    def __init__(self, stiffness: float, load: float, depth: float):
        self.constant, self.load, self.at = stiffness, load, depth
        self.now, self.speed = depth, 1.0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def step(self, size: float, inputs):
        self.now += size * inputs[0]
        self.speed = inputs[1]
        return self.forces()

    def forces(self):
        normal = max(self.load + self.constant * (self.now - self.at), 0.0)
        return np.array([normal, -FRICTION * normal * math.tanh(self.speed / 1e-3), 0.0])

    def film(self):
        return np.array([np.nan, np.nan])


def explicit_step(joint: Joint, contact, size: float, forces, strikes=True):
    return contact.step(size, joint.step(size, forces, strikes)), 1


def implicit_step(joint: Joint, contact, size: float, forces, strikes=True):
    """Newton's method for the forces at the end of the step."""
    scale = (abs(forces[0]) + 1.0) * np.array([1.0, 1.0, joint.radius])
    motion, state, time = joint.state(), contact.fmu.getFMUstate(), contact.time
    try:
        for iteration in range(1, 16):
            by_force = np.empty((len(INPUTS), 3))
            joint.restore(motion)
            inputs = joint.step(size, forces, strikes)
            for column, change in enumerate(np.diag(1e-3 * scale)):
                joint.restore(motion)
                by_force[:, column] = (joint.step(size, forces + change, strikes) - inputs) / change[column]
            if iteration == 1:
                # Under the forces of before the bones may run into each other: a first guess that keeps them apart.
                move = float(np.clip(size * inputs[0], -LEAP, LEAP))
                forces = forces + np.array([(move / size - inputs[0]) / by_force[0, 0], 0.0, 0.0])
                joint.restore(motion)
                inputs = joint.step(size, forces, strikes)
            else:
                contact.fmu.setFMUstate(state)
                contact.time = time
            found = contact.step(size, inputs)
            jacobian = contact.slopes() @ by_force - np.eye(3)
            change = np.linalg.solve(jacobian, forces - found)
            if np.abs(change / scale).max() < 1e-4:
                joint.restore(motion)
                joint.step(size, forces, strikes)
                return found, iteration
            depth = abs(size * by_force[0] @ change)
            forces = forces + change * min(1.0, LEAP / max(depth, 1e-30))
        raise RuntimeError(f"the step of {size} s did not converge")
    finally:
        contact.fmu.freeFMUstate(state)


class Setting:
    """What all runs share."""

    def __init__(self, fmu, folder, joint: str, load: float, parameters: dict):
        extract(fmu, unzipdir=folder)
        self.folder, self.description = folder, read_model_description(fmu)
        self.parameters = joint_case(joint) | PARAMETERS | parameters
        self.load, self.radius = load, abs(self.parameters["upper.outer_radius"])
        # The steady state of surfaces that move alike, because one at rest has none but that of drained tissue.
        start = {"sliding_speed": self.radius * swing(0), "slide_to_roll_ratio": 0.0, "applied_load": load / self.parameters["width"]}
        with Cartilage(folder, self.description, self.parameters | start | {"control": "load"}) as contact:
            self.depth = float(contact.get("penetration_depth_result")[0])
        start |= {"control": "depth", "penetration_depth": self.depth}
        with Cartilage(folder, self.description, self.parameters | start) as contact:
            self.start = contact.state()
            contact.step(1e-3, [0.0, self.radius * swing(0)])
            self.stiffness = float(contact.get("contact_stiffness")[0])
        # Every other contact takes over that state; its own start is a light one, at touch.
        self.parameters |= {"control": "depth", "penetration_depth": 0.0}
        self.damping = 2 * DAMPING * math.sqrt(self.stiffness * load / 9.81)

    def joint(self, speed):
        joint = Joint(self.load, self.radius, self.damping, speed)
        joint.data.qpos[0] = -self.depth
        return joint

    def cartilage(self):
        return Cartilage(self.folder, self.description, self.parameters, self.start)

    def spring(self):
        return Spring(self.stiffness, self.load, self.depth)


def run(setting: Setting, contact, master, size: float, duration: float, speed=swing, push: float = 0.0, hear=None):
    """Rows of time, depth, normal force, moment about the axis, least film and fluid load support; the number of solutions; and why it ended
    early, where it did: a master failed, or the bones left the contact.

    `push`: a speed towards the other bone at the start [m/s], in place of the heel strike.
    """
    joint, rows, solutions, ended = setting.joint(speed), [], 0, ""

    def note(time, forces):
        moment = forces[2] + forces[1] * (joint.radius - joint.depth() / 2)
        rows.append((time, joint.depth(), forces[0], moment, *contact.film()))

    with contact:
        forces = contact.forces()
        joint.data.qvel[0] = -push
        note(0.0, forces)
        try:
            for index in range(round(duration / size)):
                forces, count = master(joint, contact, size, forces, strikes=push == 0)
                solutions += count
                note((index + 1) * size, forces)
                # Twice as deep as at the start, or apart.
                if not abs(rows[-1][1] - rows[0][1]) < rows[0][1]:
                    ended = f"{1e6 * rows[-1][1]:.0f} microns deep"
                    break
                if hear:
                    hear(index + 1, round(duration / size))
        except (FMICallException, RuntimeError) as error:
            ended = str(error)
    return np.array(rows), solutions, ended


def is_stable(setting: Setting, contact, master, size: float) -> bool:
    """At a constant speed, pushed by 2 mm/s: has the vibration of the force become smaller?"""
    period = 2 * math.pi * math.sqrt(setting.load / 9.81 / setting.stiffness)
    # A third holds a whole vibration, of a few large steps or of many small ones.
    third = max(12, math.ceil(period / size))
    rows, _, ended = run(setting, contact, master, size, 3 * third * size, lambda _: swing(0), 2e-3)
    # Beside the slow creep of the tissue: second differences.
    shake = abs(np.diff(rows[:, 2], 2))
    return not ended and shake[-third:].max() < shake[:third].max()


def main(
    fmu=FMU, picture="joint_mujoco.png", joint="hip", load=750.0, parameters=None, duration=0.3, small=5e-4, large=5e-3,
    explicit_sizes=(0.5e-3, 1e-3, 1.5e-3, 2e-3, 3e-3, 4e-3), implicit_sizes=(5e-3, 2e-2),
):  # fmt: skip
    """The largest stable step of each master among those tried, the estimate 2c/k [s], and the motions.

    `load` is the weight that the joint carries [N], `duration` that of the motions [s].
    """
    masters = {"explicit": explicit_step, "implicit": implicit_step}
    with tempfile.TemporaryDirectory() as folder:
        setting = Setting(fmu, folder, joint, load, parameters or {})
        runs = {}
        for name, make, master, size in [
            ("cartilage, explicit", setting.cartilage, explicit_step, small),
            ("cartilage, implicit", setting.cartilage, implicit_step, large),
            ("penalty, explicit", setting.spring, explicit_step, 2e-4),
        ]:
            runs[name] = run(setting, make(), master, size, duration, hear=lambda i, n, name=name: tell(i, n, f"{name}: "))
        stable = {"limit": 2 * setting.damping / setting.stiffness}
        tries = [(name, size) for name, sizes in (("explicit", explicit_sizes), ("implicit", implicit_sizes)) for size in sizes]
        good = {"explicit": [], "implicit": [], "penalty": []}
        for index, (name, size) in enumerate(tries):
            if is_stable(setting, setting.cartilage(), masters[name], size):
                good[name].append(size)
            if name == "explicit" and is_stable(setting, setting.spring(), explicit_step, size):
                good["penalty"].append(size)
            tell(index + 1, len(tries), "largest steps: ")
        stable |= {name: max(sizes, default=0.0) for name, sizes in good.items()}
    stiffness, mass = setting.stiffness, load / 9.81
    print(f"{joint}: {mass:.1f} kg at {1e6 * setting.depth:.0f} microns, damping {setting.damping:.3g} N s/m")
    print("contact stiffness k [N/m]   2 c / k [ms]   largest stable step [ms]: explicit   implicit   penalty, explicit")
    steps = (1e3 * stable[name] for name in ("limit", "explicit", "implicit", "penalty"))
    print("{:25.3g}   {:12.2f}   {:34.2f}   {:8.2f}   {:17.2f}".format(stiffness, *steps))
    print(f"tried: {', '.join(f'{1e3 * size:g}' for size in explicit_sizes)} ms explicitly, "
          f"{', '.join(f'{1e3 * size:g}' for size in implicit_sizes)} ms implicitly")  # fmt: skip
    for name, (rows, solutions, ended) in runs.items():
        moment = 1e3 * abs(rows[:, 3]).max()
        if ended:
            print(f"{name}: ended at {rows[-1, 0]:g} s: {ended}")
        print(f"{name}: {len(rows) - 1} steps, {solutions} solutions, largest force {rows[:, 2].max():.0f} N, deepest "
              f"{1e6 * rows[:, 1].max():.0f} microns, {shake_after(rows)}"
              f"largest moment of friction {moment:.1f} N mm")  # fmt: skip
    if picture:
        draw(picture, runs, f"{joint.capitalize()}, {load:g} N, and a heel strike", {"explicit": small, "implicit": large})
    return {"stable": stable, "runs": runs, "stiffness": stiffness}


def shake_after(rows) -> str:
    """Half the range of the normal force from 40 ms after the heel strike on, for as long as the motion lasts, 40 ms at most."""
    end = STRIKE[0] + STRIKE[1]
    after = rows[(rows[:, 0] >= end + 0.04) & (rows[:, 0] <= end + 0.08), 2]
    return f"vibration after the strike {np.ptp(after) / 2:.1f} N, " if len(after) > 1 else ""


def draw(picture, runs, title, sizes):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    style = {
        "cartilage, explicit": dict(color="#0072B2", linewidth=3, alpha=0.6),
        "cartilage, implicit": dict(color="black", linestyle="none", marker="o", markersize=4, markerfacecolor="white"),
        "penalty, explicit": dict(color="#D55E00", linewidth=1),
    }
    figure, axes = plt.subplots(4, 1, figsize=(7.5, 9), sharex=True, layout="constrained")
    for name, (rows, *_) in runs.items():
        contact, master = name.split(", ")
        label = name if contact == "penalty" else f"{name}, {1e3 * sizes[master]:g} ms"
        columns = (1e6 * rows[:, 1], rows[:, 2], 1e3 * rows[:, 3], rows[:, 5])
        for axis, values in zip(axes, columns):
            axis.plot(1e3 * rows[:, 0], values, label=label, **style[name])
    labels = ("penetration depth [µm]", "normal force [N]", "moment of friction [N mm]", "fluid load support [1]")
    for axis, label in zip(axes, labels):
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
        axis.axvspan(1e3 * STRIKE[0], 1e3 * (STRIKE[0] + STRIKE[1]), color="grey", alpha=0.15, linewidth=0)
    axes[3].set_xlabel("time [ms]; shaded: heel strike")
    figure.suptitle(title, x=0.01, ha="left")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False)
    figure.savefig(picture, dpi=150)
    plt.close(figure)


if __name__ == "__main__":
    main(**options(__doc__, picture="joint_mujoco.png", joint="hip", load=750.0, duration=0.3))
