#!/usr/bin/env python3
"""What calls of fmi2DoStep cost: over a cycle of walking, and over a stream of slowly changing inputs at 1 kHz.

    cargo run --release
    python3 benches/do_step.py [--fmu FMU] [--coarse 40x3] [--steps 200] [--only WORDS] [--instances 8]

Needs FMPy (tests/fmi/requirements.txt). Each row is a run of so many communication steps on the default mesh and on a coarse one:
median and worst time of a call (and the time that 99 % stay below), the time of the processor beside that of the clock (on a busy machine the former says more), and
Newton iterations. Of the coarse mesh the largest errors of load, friction and depth or film against the default one are printed,
relative to the largest value of the run. No derivatives are asked for.
"""
import argparse
import concurrent.futures
import os
import pathlib
import shutil
import statistics
import sys
import time

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "examples"))
import gait  # noqa: E402: its cycle of walking
from start import joint_case  # noqa: E402

OUTPUTS = ["load", "upper_friction_force", "minimum_film_thickness", "penetration_depth_result", "newton_iterations"]


class Contact:
    """An instance, initialised with these parameters and inputs."""

    def __init__(self, folder, description, parameters, inputs):
        self.types = {variable.name: variable.type for variable in description.modelVariables}
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        identifier = description.coSimulation.modelIdentifier
        self.slave = FMU2Slave(guid=description.guid, unzipDirectory=folder, modelIdentifier=identifier)
        start = time.perf_counter()
        self.slave.instantiate()
        for name, value in parameters.items():
            put = self.slave.setReal if self.types[name] == "Real" else self.slave.setInteger
            put([self.references[name]], [value])
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.set(inputs)
        self.slave.exitInitializationMode()
        self.initialised = time.perf_counter() - start
        self.time = 0.0

    def set(self, inputs):
        self.slave.setReal([self.references[name] for name in inputs], list(inputs.values()))

    def step(self, length, inputs, rates=None):
        """Seconds of clock and processor for the call alone."""
        self.set(inputs)
        if rates:
            self.slave.setRealInputDerivatives([self.references[name] for name in rates], [1] * len(rates), list(rates.values()))
        clock, processor = time.perf_counter(), time.process_time()
        self.slave.doStep(self.time, length)
        spent = time.perf_counter() - clock, time.process_time() - processor
        self.time += length
        return spent

    def get(self, name):
        read = self.slave.getReal if self.types[name] == "Real" else self.slave.getInteger
        return read([self.references[name]])[0]

    def free(self):
        self.slave.terminate()
        self.slave.freeInstance()


def walking(steps):
    """Inputs at the communication points of a cycle of walking under load, and the length of a step."""
    times, load, speed = gait.cycle(steps, 25.0)
    return [{"applied_load": load[i], "sliding_speed": speed[i]} for i in range(steps + 1)], times[1]


def stream(middle):
    """Inputs at 1 kHz: the depth goes up and down by 5 microns once a second, the speed by a tenth in 1.4 s."""

    def points(steps):
        def at(i):
            depth, speed = gait.np.sin(2e-3 * gait.np.pi * i), gait.np.sin(2e-3 * gait.np.pi * i / 1.4)
            return {"penetration_depth": middle + 5e-6 * depth, "sliding_speed": 0.2 + 0.02 * speed}

        return [at(i) for i in range(steps + 1)], 1e-3

    return points


def loaded(steps):
    """Inputs at 1 kHz: the load goes up and down by a fifth once a second."""
    return [{"applied_load": 25 + 5 * gait.np.sin(2e-3 * gait.np.pi * i), "sliding_speed": 0.2} for i in range(steps + 1)], 1e-3


def body_weight(steps):
    """Inputs at 1 kHz: load and speed as in a second of walking, 5 to 55 kN/m and 0.05 to 0.15 m/s."""

    def at(i):
        turn = 2e-3 * gait.np.pi * i
        return {"applied_load": 30e3 + 25e3 * gait.np.sin(turn), "sliding_speed": 0.1 + 0.05 * gait.np.cos(turn)}

    return [at(i) for i in range(steps + 1)], 1e-3


HIP = joint_case("hip") | {"preset": 4}
QUASI_STEADY, TRANSIENT, DEPTH, LOAD = {"time_integration": 1}, {"time_integration": 2}, {"control": 1}, {"control": 2}
RUNS = {
    "1 kHz, film, quasi-steady": (stream(0.0), QUASI_STEADY | DEPTH),
    "1 kHz, contact, quasi-steady": (stream(25e-6), QUASI_STEADY | DEPTH),
    "1 kHz, load, quasi-steady": (loaded, QUASI_STEADY | LOAD),
    "1 kHz, film, transient": (stream(0.0), TRANSIENT | DEPTH),
    "1 kHz, contact, transient": (stream(25e-6), TRANSIENT | DEPTH),
    "1 kHz, load, transient": (loaded, TRANSIENT | LOAD),
    "1 kHz, condyle, body weight": (body_weight, {"preset": 3} | TRANSIENT | LOAD),
    "1 kHz, hip, body weight": (body_weight, HIP | TRANSIENT | LOAD),
    "walking, quasi-steady": (walking, QUASI_STEADY | LOAD),
    "walking, transient": (walking, TRANSIENT | LOAD),
}


def run(contact, points, length):
    """Times of the steps, and the outputs after each. In time the inputs go on linearly; a steady state needs those at the end."""
    spent, results = [], []
    for before, after in zip(points, points[1:]):
        rates = {name: (after[name] - before[name]) / length for name in after}
        spent.append(contact.step(length, before, rates))
        results.append([contact.get(name) for name in OUTPUTS])
    return spent, results


def error(results, exact, k):
    return max(abs(a[k] - b[k]) for a, b in zip(results, exact)) / (max(abs(row[k]) for row in exact) or 1.0)


def resident():
    """Memory of this process [bytes]."""
    return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fmu", default=ROOT / "target/fmu/CartilageLineContact.fmu")
    parser.add_argument("--coarse", default="40x3", help="columns and rows of the coarse mesh")
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--only", default="", help="run what has this in its name")
    parser.add_argument("--instances", type=int, default=8, help="so many at once, on two threads; 0 for none")
    arguments = parser.parse_args()
    description = read_model_description(str(arguments.fmu))
    folder = extract(str(arguments.fmu))
    columns, rows = map(int, arguments.coarse.split("x"))
    meshes = {"default": {}, arguments.coarse: {"mesh.columns": columns, "mesh.rows": rows}}
    print(f"{'':29} {'mesh':>8} {'clock, ms':>25} {'processor, ms':>25} {'iterations':>10}  errors: load, friction, film, depth")
    print(f"{'':29} {'':>8} {'median     99 %    worst':>25} {'median     99 %    worst':>25} {'a step':>10}")
    for name, (points, choices) in RUNS.items():
        if arguments.only not in name:
            continue
        points, length = points(arguments.steps)
        exact = None
        for mesh, parameters in meshes.items():
            contact = Contact(folder, description, parameters | choices, points[0])
            spent, results = run(contact, points, length)
            contact.free()
            columns = []
            for times in zip(*spent):
                last = statistics.quantiles(times, n=100)[-1]
                columns.append(f"{1e3 * statistics.median(times):7.2f} {1e3 * last:8.2f} {1e3 * max(times):8.2f}")
            iterations = statistics.mean(row[-1] for row in results)
            errors = "" if exact is None else "  ".join(f"{error(results, exact, k):7.1e}" for k in range(4))
            exact = exact or results
            print(f"{name:29} {mesh:>8} {columns[0]} {columns[1]} {iterations:10.1f}  {errors}", flush=True)

    if arguments.instances:
        points, length = stream(0.0)(arguments.steps)
        # The small ones first: what they give back would serve the large ones.
        for mesh, parameters in reversed(meshes.items()):
            before = resident()
            contacts = [Contact(folder, description, parameters, points[0]) for _ in range(arguments.instances)]
            memory = (resident() - before) / arguments.instances
            started = statistics.median(contact.initialised for contact in contacts)
            rates = []
            for threads in (1, 2):
                start = time.perf_counter()
                with concurrent.futures.ThreadPoolExecutor(threads) as pool:
                    list(pool.map(lambda contact: run(contact, points, length), contacts))
                rates.append(arguments.instances * arguments.steps / (time.perf_counter() - start))
            for contact in contacts:
                contact.free()
            print(
                f"{arguments.instances} instances, {mesh}: {1e3 * started:.0f} ms to instantiate and initialise, "
                f"{memory / 1e6:.1f} MB each, {rates[0]:.0f} steps a second on one thread, {rates[1]:.0f} on two"
            )
    shutil.rmtree(folder)


if __name__ == "__main__":
    main()
