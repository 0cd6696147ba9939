"""The FMU behind everything: its variables by name, and instances of it."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from pathlib import Path
from typing import Any, Union

import fmpy
import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from fmpy.simulation import instantiate_fmu

#: A case: a TOML file, or names and values; a name with a dot may also be a mapping within a mapping.
Case = Union[str, Path, Mapping[str, Any], None]

NATIVE = Path(__file__).parent / "native"


class ContactError(Exception):
    """What could not be done: which variable, which value, what is allowed; or where the solver stopped."""


def fmu_path(fmi: int = 2) -> Path:
    """Where the FMU is.

    Parameters
    ----------
    fmi
        2 for FMI 2.0, 3 for FMI 3.0.
    """
    names = {2: "CartilageLineContact.fmu", 3: "CartilageLineContact.fmi3.fmu"}
    if fmi not in names:
        raise ValueError(f"fmi = {fmi} is not allowed: 2 or 3")
    return NATIVE / names[fmi]


@dataclass(frozen=True)
class Variable:
    """What the FMU says of a variable."""

    name: str
    unit: str
    description: str
    #: ``input``, ``output`` or ``parameter``
    causality: str
    #: As in FMI 3.0: ``Float64``, ``Int32``, ``Boolean`` or ``Enumeration``
    type: str
    #: Shape of its value: ``()``, or ``(101,)`` for a profile
    shape: tuple[int, ...]
    references: tuple[int, ...]


@cache
def _description(fmi: int = 3) -> Any:
    return fmpy.read_model_description(str(fmu_path(fmi)))


@cache
def variables() -> dict[str, Variable]:
    """All inputs, outputs and parameters by name, in the order of the FMU."""
    found = {}
    for row in _description().modelVariables:
        if row.causality in ("input", "output", "parameter"):
            shape = tuple(int(dimension.start) for dimension in row.dimensions)
            # FMI 2 has a variable for every station of a profile, one after the other.
            references = tuple(range(row.valueReference, row.valueReference + int(np.prod(shape, dtype=int))))
            unit = row.unit or "1"
            found[row.name] = Variable(row.name, unit, row.description, row.causality, row.type, shape, references)
    return found


@cache
def enumeration(name: str) -> type[IntEnum]:
    """The words of a variable that is a choice, with the numbers that FMI has for them.

    >>> [word.name for word in enumeration("formulation")]
    ['paper', 'consistent']
    """
    for row in _description().modelVariables:
        if row.name == name and row.type == "Enumeration":
            return IntEnum(name, {item.name: int(item.value) for item in row.declaredType.items})
    choices = [row.name for row in variables().values() if row.type == "Enumeration"]
    raise ContactError(f"{name} is not a choice between words; these are: {', '.join(choices)}")


def flat(case: Case, values: Mapping[str, Any]) -> dict[str, Any]:
    """Names and values of a case and of what is set beside it, which wins; what is said of ``both`` bodies comes first."""
    if case is None:
        case = {}
    elif not isinstance(case, Mapping):
        try:
            import tomllib
        except ImportError:  # Python 3.10 and older
            import tomli as tomllib
        case = tomllib.loads(Path(case).read_text(encoding="utf-8"))

    def leaves(prefix: str, mapping: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
        for key, value in mapping.items():
            if isinstance(value, Mapping):
                yield from leaves(f"{prefix}{key}.", value)
            else:
                yield prefix + key, value

    result: dict[str, Any] = {}
    for source in (case, values):
        for name, value in sorted(leaves("", source), key=lambda leaf: not leaf[0].startswith("both.")):
            body = name[len("both.") :] if name.startswith("both.") else None
            for full in [name] if body is None else [f"upper.{body}", f"lower.{body}"]:
                result[full] = value
    if "applied_load" in values and "penetration_depth" not in values:
        result.setdefault("control", "load")
    return result


@cache
def _unpacked() -> tempfile.TemporaryDirectory:
    folder = tempfile.TemporaryDirectory(prefix="cartilage-contact-")
    fmpy.extract(str(fmu_path(2)), unzipdir=folder.name)
    return folder


class Contact:
    """An instance of the FMU of FMI 2.0, which knows slopes of inputs; in its initialization mode."""

    fmu: FMU2Slave

    def __init__(self, values: Mapping[str, Any], start_time: float = 0.0) -> None:
        self.said: list[tuple[int, str]] = []
        self.time = start_time

        def hear(_environment: Any, _instance: bytes, status: int, _category: bytes, message: bytes) -> None:
            self.said.append((status, message.decode()))

        self.fmu = instantiate_fmu(_unpacked().name, _description(2), logger=hear)
        try:
            # A preset gives way to what is set by name, in whatever order.
            for name, value in values.items():
                self.set(name, value)
            self.call(self.fmu.setupExperiment, startTime=start_time)
            self.call(self.fmu.enterInitializationMode)
        except ContactError:
            self.close()
            raise

    def close(self) -> None:
        """Frees the instance."""
        self.fmu.freeInstance()

    def call(self, function: Any, *arguments: Any, **named: Any) -> Any:
        """Calls a function of FMI; what it refuses is raised with what it logged."""
        heard = len(self.said)
        try:
            return function(*arguments, **named)
        except FMICallException as error:
            messages = [message for _, message in self.said[heard:]]
            del self.said[heard:]
            raise ContactError("; ".join(messages) or str(error)) from None

    @property
    def warnings(self) -> list[str]:
        """What was logged as a warning."""
        return [message for status, message in self.said if status == 1]

    def set(self, name: str, value: Any) -> None:
        """Sets an input or a parameter; a choice by its word or its number."""
        variable = variables().get(name)
        if variable is None or variable.causality == "output":
            import difflib

            names = [row.name for row in variables().values() if row.causality != "output"]
            near = difflib.get_close_matches(name, names, 1)
            hint = f"did you mean {near[0]}?" if near else "`cartilage-contact solve --help` lists the names"
            raise ContactError(f"{name} is no input or parameter; {hint}")
        if variable.type == "Enumeration":
            words = enumeration(name)
            if isinstance(value, str) and value not in words.__members__:
                raise ContactError(f"{name} = {value!r} is not allowed: {', '.join(words.__members__)}")
            value = words[value] if isinstance(value, str) else value
        put, convert = {
            "Float64": (self.fmu.setReal, float),
            "Boolean": (self.fmu.setBoolean, bool),
        }.get(variable.type, (self.fmu.setInteger, int))
        self.call(put, variable.references, [convert(value)])

    def start(self) -> None:
        """Solves the steady state of the inputs."""
        self.call(self.fmu.exitInitializationMode)

    def step(self, size: float = 1.0) -> None:
        """Goes on by a step [s]."""
        self.call(self.fmu.doStep, self.time, size)
        self.time += size

    def get(self, name: str) -> Any:
        """A float, an int, a bool, a member of the variable's ``IntEnum``, or an array."""
        variable = variables()[name]
        read = {"Float64": self.fmu.getReal, "Boolean": self.fmu.getBoolean}.get(variable.type, self.fmu.getInteger)
        values = self.call(read, variable.references)
        if variable.shape:
            return np.array(values)
        if variable.type == "Boolean":
            return bool(values[0])
        return enumeration(name)(values[0]) if variable.type == "Enumeration" else values[0]

    def move(self, rates: Mapping[str, float]) -> None:
        """Inputs go on at these rates during the next step [per s]."""
        references = [variables()[name].references[0] for name in rates]
        self.call(self.fmu.setRealInputDerivatives, references, [1] * len(references), list(rates.values()))

    def derivative(self, output: str, by: str) -> Any:
        """Rate of change of a continuous output with an input: a float or an array."""
        unknown, known = variables()[output], variables()[by]
        found = self.call(self.fmu.getDirectionalDerivative, unknown.references, known.references, [1.0])
        return np.array(found) if unknown.shape else found[0]


@cache
def differentiable() -> dict[str, list[str]]:
    """Outputs that have derivatives, and the inputs by which they do."""
    by_reference = {row.valueReference: row.name for row in _description().modelVariables}
    inputs = [row.name for row in variables().values() if row.causality == "input"]
    found = {}
    for unknown in _description().outputs:
        row = variables().get(by_reference[unknown.variable.valueReference])
        if row and row.type == "Float64" and row.name not in ("contact_stiffness", "position"):
            known = {variable.name for variable in unknown.dependencies or []}
            found[row.name] = [name for name in inputs if name in known]
    return found
