"""What the tests of the FMU share. Run by `cargo test --release --test python`, which names the FMU in `FMU`."""

import os
from contextlib import contextmanager

import pytest
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

# A mesh on which a solution takes a few milliseconds. These tests are about the FMU, not about the numbers.
COARSE = {"mesh.columns": 16, "mesh.rows": 2}


@pytest.fixture(scope="session")
def fmu():
    return os.environ["FMU"]


@pytest.fixture(scope="session")
def description(fmu):
    return read_model_description(fmu)


@pytest.fixture(scope="session")
def folder(fmu, tmp_path_factory):
    return extract(fmu, unzipdir=str(tmp_path_factory.mktemp("unpacked")))


@pytest.fixture(scope="session")
def instantiate(folder, description):
    """Makes a Slave; use as a context manager, which frees the instance."""

    @contextmanager
    def make(name="contact", unpacked=folder, initialized=True):
        slave = Slave(name, unpacked, description)
        try:
            if initialized:
                slave.fmu.enterInitializationMode()
                slave.fmu.exitInitializationMode()
            yield slave
        finally:
            slave.fmu.freeInstance()

    return make


class Slave:
    """An instance whose variables are known by name, on a coarse mesh."""

    def __init__(self, name, folder, description):
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.types = {v.name: v.type for v in description.modelVariables}
        self.outputs = [v.name for v in description.modelVariables if v.causality == "output" and v.type == "Real"]
        self.time = 0.0
        self.fmu = FMU2Slave(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.fmu.instantiate()
        self.fmu.setupExperiment(startTime=0.0)
        self.set(**COARSE)

    def set(self, **values):
        for name, value in values.items():
            setter = self.fmu.setReal if self.types[name] == "Real" else self.fmu.setInteger
            setter([self.references[name]], [value])

    def get(self, *names):
        values = self.fmu.getReal([self.references[name] for name in names])
        return values[0] if len(names) == 1 else values

    def everything(self):
        return self.get(*self.outputs)

    def step(self, size=0.1, **inputs):
        self.set(**inputs)
        self.fmu.doStep(self.time, size)
        self.time += size

    def derivative(self, unknown, known):
        return self.fmu.getDirectionalDerivative([self.references[unknown]], [self.references[known]], [1.0])[0]
