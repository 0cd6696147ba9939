"""What the tests of the FMUs share.

Run by `cargo test --release --test python`, which names the FMU of FMI 2.0 in `FMU` and that of FMI 3.0 in `FMU3`.
"""

import os
from contextlib import contextmanager

import pytest
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave, fmi2Integer, fmi2Real, fmi2ValueReference
from fmpy.fmi3 import FMU3Slave

# A mesh on which a solution takes a few milliseconds. These tests are about the FMU, not about the numbers.
COARSE = {"mesh.columns": 16, "mesh.rows": 2}


@pytest.fixture(scope="session")
def fmu2():
    return os.environ["FMU"]


@pytest.fixture(scope="session")
def fmu3():
    return os.environ["FMU3"]


@pytest.fixture(scope="session", params=["FMU", "FMU3"])
def fmu(request):
    """Each FMU in turn: what is tested with it holds for both."""
    return os.environ[request.param]


@pytest.fixture(scope="session")
def description(fmu):
    return read_model_description(fmu)


@pytest.fixture(scope="session")
def folder(fmu, tmp_path_factory):
    return extract(fmu, unzipdir=str(tmp_path_factory.mktemp("unpacked")))


@pytest.fixture(scope="session")
def instantiate(folder, description):
    return maker(folder, description)


@pytest.fixture(scope="session", params=["FMU", "FMU3"])
def instantiate_again(request, tmp_path_factory):
    """As `instantiate`, whatever version that has: all four pairs in turn."""
    fmu = os.environ[request.param]
    return maker(extract(fmu, unzipdir=str(tmp_path_factory.mktemp("again"))), read_model_description(fmu))


def maker(folder, description):
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
    """An instance whose variables are known by name, on a coarse mesh, whatever the version of FMI."""

    def __init__(self, name, folder, description):
        self.variables = {v.name: v for v in description.modelVariables}
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        reals = ("Real", "Float64")
        self.outputs = [v.name for v in description.modelVariables if v.causality == "output" and v.type in reals]
        self.time = 0.0
        self.version = 3 if description.fmiVersion.startswith("3") else 2
        kind = FMU3Slave if self.version == 3 else FMU2Slave
        self.fmu = kind(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.begin()

    def begin(self, **parameters):
        self.fmu.instantiate()
        self.time = 0.0
        self.set(**{**COARSE, **parameters})
        if self.version == 2:
            self.fmu.setupExperiment(startTime=0.0)

    def end(self):
        free = self.fmu.fmi3FreeInstance if self.version == 3 else self.fmu.fmi2FreeInstance
        free(self.fmu.component)

    def set(self, **values):
        for name, value in values.items():
            kind = self.variables[name].type
            if kind == "Enumeration":
                kind = "Int64" if self.version == 3 else "Integer"
            getattr(self.fmu, f"set{kind}")([self.references[name]], [value])

    def get(self, *names):
        references = [self.references[name] for name in names]
        if self.version == 2:
            values = self.fmu.getReal(references)
        else:
            lengths = [int(d.start) for name in names for d in self.variables[name].dimensions]
            values = self.fmu.getFloat64(references, len(names) - len(lengths) + sum(lengths))
        return values[0] if len(names) == 1 else values

    def everything(self):
        return self.get(*self.outputs)

    def step(self, size=0.1, **inputs):
        self.set(**inputs)
        self.fmu.doStep(self.time, size)
        self.time += size

    def derivative(self, unknown, known):
        return self.fmu.getDirectionalDerivative([self.references[unknown]], [self.references[known]], [1.0])[0]

    def rate(self, output):
        if self.version == 3:
            return self.fmu.getOutputDerivatives([self.references[output]], [1])[0]
        references, orders = (fmi2ValueReference * 1)(self.references[output]), (fmi2Integer * 1)(1)
        values = (fmi2Real * 1)()
        self.fmu.fmi2GetRealOutputDerivatives(self.fmu.component, references, 1, orders, values)
        return values[0]

    def save(self):
        return self.fmu.getFMUState() if self.version == 3 else self.fmu.getFMUstate()

    def restore(self, state):
        (self.fmu.setFMUState if self.version == 3 else self.fmu.setFMUstate)(state)

    def drop(self, state):
        (self.fmu.freeFMUState if self.version == 3 else self.fmu.freeFMUstate)(state)

    def to_bytes(self, state):
        return (self.fmu.serializeFMUState if self.version == 3 else self.fmu.serializeFMUstate)(state)

    def from_bytes(self, data):
        return (self.fmu.deserializeFMUState if self.version == 3 else self.fmu.deSerializeFMUstate)(data)
