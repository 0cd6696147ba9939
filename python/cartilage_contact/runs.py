"""One state, many states, and runs in time."""

from __future__ import annotations

import csv
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from .command import program
from .model import Case, Contact, ContactError, Variable, differentiable, flat, variables

if TYPE_CHECKING:
    import pandas
    import xarray

#: ``True`` for a line on standard error, or a function of how many are done and of how many
Progress = Union[bool, Callable[[int, int], None]]

#: Below this a gauge pressure is less than that of nothing [Pa].
VACUUM = -101325.0


class State(Mapping[str, Any]):
    """One solved state: inputs and outputs by name, in SI units.

    Values are floats, ints, members of an ``IntEnum`` for choices, and arrays of shape (101,) for profiles along x.
    """

    def __init__(self, contact: Contact, derivatives: bool) -> None:
        rows = [row for row in variables().values() if row.causality != "parameter"]
        self._values = {row.name: contact.get(row.name) for row in rows}
        #: Units by name; ``"1"`` where there is none.
        self.units = {row.name: row.unit for row in rows}
        #: What is doubtful about the state, in words.
        self.warnings: tuple[str, ...] = (*contact.warnings, *_doubts(self._values, contact))
        #: Derivatives of continuous outputs: ``state.derivatives["load", "penetration_depth"]``, in SI units.
        self.derivatives: dict[tuple[str, str], Any] = {}
        if derivatives:
            for output, inputs in differentiable().items():
                for name in inputs:
                    self.derivatives[output, name] = contact.derivative(output, name)

    def __getitem__(self, name: str) -> Any:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        lines = []
        for name, value in self._values.items():
            shown = f"array of {len(value)}" if isinstance(value, np.ndarray) else getattr(value, "name", f"{value:.6g}")
            lines.append(f"{name:28} {shown:>16} {self.units[name]}")
        return "\n".join([*lines, *(f"warning: {text}" for text in self.warnings)])


def _doubts(values: Mapping[str, Any], contact: Contact) -> list[str]:
    suction = values["minimum_fluid_pressure"]
    if suction < VACUUM and not contact.get("cavitation"):
        text = f"the fluid pulls with {-suction:.3g} Pa, more than a vacuum of 1e5 Pa: a film would cavitate (cavitation=True)"
        return [text]
    return []


class Table(Mapping[str, np.ndarray]):
    """Columns by name: arrays with one row a state, in SI units; profiles have the shape (rows, 101), choices are words."""

    def __init__(self, columns: Mapping[str, Any], warnings: Sequence[str] = ()) -> None:
        self._columns = {name: np.asarray(values) for name, values in columns.items()}
        known = variables()
        #: Units by name; ``"1"`` where there is none.
        self.units = {name: known[name].unit if name in known else "1" for name in self._columns}
        self.units.update({name: "s" for name in ("time",) if name in self._columns})
        #: Which states were not found and why; their rows hold NaN.
        self.warnings = tuple(warnings)

    def __getitem__(self, name: str) -> np.ndarray:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        rows = len(next(iter(self._columns.values()), ()))
        return f"Table of {rows} rows: {', '.join(self._columns)}"

    def to_dataframe(self) -> pandas.DataFrame:
        """The columns that are no profiles as a pandas frame, with the units in ``frame.attrs["units"]``."""
        import pandas

        frame = pandas.DataFrame({name: values for name, values in self.items() if values.ndim == 1})
        frame.attrs["units"] = {name: self.units[name] for name in frame.columns}
        return frame

    def to_xarray(self) -> xarray.Dataset:
        """All columns as an xarray data set over ``row`` and ``station``, with the units as attributes."""
        import xarray

        dimensions = ("row", "station")
        return xarray.Dataset(
            {name: (dimensions[: v.ndim], v, {"units": self.units[name]}) for name, v in self.items()}
        )


def solve(case: Case = None, *, derivatives: bool = False, **values: Any) -> State:
    """One steady state.

    Parameters
    ----------
    case
        A case file (TOML) or a mapping; what it does not say keeps its default, the case of de Boer et al. (2020).
    derivatives
        Also find the derivatives of the continuous outputs with respect to the inputs.
    **values
        Inputs and parameters by name, in SI units; they win over the case. ``both={"thickness": 1e-3}`` sets the two bodies.
        An ``applied_load`` without a ``penetration_depth`` finds the depth that carries it.

    Examples
    --------
    >>> state = solve(applied_load=20.0, mesh={"columns": 40, "rows": 3}, derivatives=True)
    >>> round(state["load"], 3)
    20.0
    >>> state.derivatives["penetration_depth_result", "applied_load"] > 0
    True
    """
    contact = Contact(flat(case, values))
    try:
        contact.start()
        return State(contact, derivatives)
    finally:
        contact.close()


class _Counter:
    """Tells how far a run is, from whichever thread."""

    def __init__(self, progress: Progress, total: int) -> None:
        self.progress, self.total, self.done, self.lock = progress, total, 0, Lock()

    def one_more(self) -> None:
        with self.lock:
            self.done += 1
            if callable(self.progress):
                self.progress(self.done, self.total)
            elif self.progress:
                end = "\n" if self.done == self.total else ""
                print(f"\r{self.done} of {self.total} states", end=end, file=sys.stderr, flush=True)


def sweep(
    case: Case = None,
    *,
    depths: Iterable[float],
    speeds: Optional[Iterable[float]] = None,
    threads: Optional[int] = None,
    progress: Progress = False,
    **values: Any,
) -> Table:
    """Steady states over penetration depth and sliding speed.

    Parameters
    ----------
    case, **values
        As for :func:`solve`.
    depths
        Penetration depths [m].
    speeds
        Sliding speeds [m/s]; by default that of the case.
    threads
        By default one a processor.
    progress
        ``True`` for a line on standard error, or a function of how many are done and of how many.

    Returns
    -------
    Table
        One row a state, speed by speed and from apart to pressed; a state that was not found has NaN in its row and a warning.
    """
    fixed = flat(case, values)
    depths = sorted(set(map(float, depths)))
    speeds = [None] if speeds is None else sorted(set(map(float, speeds)))
    threads = threads or os.cpu_count() or 1
    # Consecutive depths are found from each other; few are not worth starting anew.
    parts = min(-(-threads // len(speeds)), max(1, len(depths) // 4))
    chunks = [chunk.tolist() for chunk in np.array_split(depths, parts)]
    jobs = [(speed, chunk) for speed in speeds for chunk in chunks]
    counter = _Counter(progress, len(depths) * len(speeds))
    rows = [row for row in variables().values() if row.causality != "parameter"]

    def run(job: tuple[Optional[float], list[float]]) -> tuple[list[dict[str, Any]], list[str]]:
        speed, chunk = job
        start = {**fixed, **({} if speed is None else {"sliding_speed": speed})}
        contact, found, failures = None, [], []
        try:
            for depth in chunk:
                try:
                    if contact is None:
                        contact = Contact({**start, "penetration_depth": depth})
                        contact.start()
                    else:
                        contact.set("penetration_depth", depth)
                        contact.step()
                    found.append({row.name: contact.get(row.name) for row in rows})
                except ContactError as error:
                    given = {"penetration_depth": depth, "sliding_speed": np.nan if speed is None else speed}
                    found.append({row.name: given.get(row.name, _nothing(row)) for row in rows})
                    failures.append(f"penetration_depth = {depth:g} m: {error}")
                    # FMI 2 has no way on after a failed step but to restore a state.
                    if contact is not None:
                        contact.close()
                        contact = None
                counter.one_more()
        finally:
            if contact is not None:
                contact.close()
        return found, failures

    with ThreadPoolExecutor(threads) as pool:
        results = list(pool.map(run, jobs))
    found = [row for rows_of_job, _ in results for row in rows_of_job]
    columns = {row.name: [_plain(state[row.name]) for state in found] for row in rows}
    return Table(columns, [text for _, failures in results for text in failures])


def _nothing(row: Variable) -> Any:
    return np.full(row.shape, np.nan) if row.type == "Float64" else "" if row.type == "Enumeration" else 0


def _plain(value: Any) -> Any:
    return getattr(value, "name", value)


def simulate(
    inputs: Mapping[str, Sequence[float]],
    case: Case = None,
    *,
    output: Optional[Sequence[str]] = None,
    output_interval: Optional[float] = None,
    progress: Progress = False,
    **values: Any,
) -> Table:
    """A run in time whose inputs are linear between their points.

    FMPy's own ``simulate_fmu`` holds an input during a step, so that a ramp ends one step before its end. Here the FMU is given the
    slopes too (``fmi2SetRealInputDerivatives``).

    Parameters
    ----------
    inputs
        ``time`` [s], ascending, and inputs by name, all of equal length; a step never goes past one of these times.
    case, **values
        As for :func:`solve`; ``time_integration="transient"`` for squeeze films and poroelastic memory.
    output
        Names of what is recorded; by default the inputs and all scalar outputs.
    output_interval
        Longest step [s]; by default a hundredth of the run.
    progress
        ``True`` for a line on standard error, or a function of how many are done and of how many.

    Returns
    -------
    Table
        ``time`` and the outputs, one row a communication point.
    """
    given = {name: np.asarray(column, dtype=float) for name, column in inputs.items()}
    points = given.pop("time", np.zeros(0))
    if len(points) < 2 or (np.diff(points) <= 0).any() or any(column.shape != points.shape for column in given.values()):
        raise ContactError("inputs need the column time, ascending, and columns of the same length")
    interval = output_interval or (points[-1] - points[0]) / 100
    times = [points[0]]
    for start, stop in zip(points[:-1], points[1:]):
        steps = max(1, int(np.ceil((stop - start) / interval * (1 - 1e-9))))
        times.extend(np.linspace(start, stop, steps + 1)[1:])
    at = {name: np.interp(times, points, column) for name, column in given.items()}
    names = output or [row.name for row in variables().values() if row.causality != "parameter" and not row.shape]
    counter = _Counter(progress, len(times))

    contact = Contact(flat(case, values), start_time=float(points[0]))
    rows = []
    try:
        for step, time in enumerate(times):
            if step == 0:
                for name, column in at.items():
                    contact.set(name, column[0])
                contact.start()
            else:
                size = time - times[step - 1]
                for name, column in at.items():
                    contact.set(name, column[step - 1])
                contact.move({name: (column[step] - column[step - 1]) / size for name, column in at.items()})
                contact.step(size)
            rows.append([_plain(contact.get(name)) for name in names])
            counter.one_more()
    finally:
        contact.close()
    columns = {"time": times, **{name: list(column) for name, column in zip(names, zip(*rows))}}
    return Table(columns, contact.warnings)


def gait(
    case: Case = None,
    *,
    history: Union[str, Path, Mapping[str, Sequence[float]], None] = None,
    peak_load: Optional[float] = None,
    body_weight: Optional[float] = None,
    steps: int = 100,
    cycles: int = 10,
    progress: bool = False,
    **values: Any,
) -> Table:
    """A walking cycle under load control, in time until it repeats, and quasi-steady beside that.

    Runs ``cartilage-contact gait``, whose help says what the cycle is.

    Parameters
    ----------
    case, **values
        As for :func:`solve`.
    history
        One cycle of your own: a CSV or OpenSim file, or columns ``time`` [s], ``sliding_speed`` [m/s] and ``applied_load`` [N/m]; the
        other columns that the command knows will do as well.
    peak_load
        Largest load of the published cycle per unit depth [N/m], in place of a body weight.
    body_weight
        Body weight [N]; 750 unless given. The case is then the joint "hip" unless one is named.
    steps
        Communication steps a cycle.
    cycles
        Most cycles in time.
    progress
        Show the command's bar.

    Returns
    -------
    Table
        One row a communication point; the column ``time_integration`` says whether in time or quasi-steady.
    """
    with tempfile.TemporaryDirectory() as folder:
        arguments = ["gait", "--output", folder, "--steps", str(steps), "--cycles", str(cycles)]
        if history is not None and isinstance(history, Mapping):
            path = Path(folder) / "history.csv"
            with path.open("w", newline="") as file:
                writer = csv.writer(file)
                writer.writerow(history)
                writer.writerows(zip(*history.values()))
            history = path
        options = {"--history": history, "--peak-load": peak_load, "--body-weight": body_weight}
        for flag, value in options.items():
            if value is not None:
                arguments += [flag, str(value)]
        for name, value in flat(case, values).items():
            text = str(value).lower() if isinstance(value, bool) else getattr(value, "name", str(value))
            arguments += ["--set", f"{name}={text}"]
        done = subprocess.run(
            [program(), *arguments],
            stdout=subprocess.DEVNULL,
            stderr=None if progress else subprocess.PIPE,
            text=True,
        )
        if done.returncode != 0:
            raise ContactError((done.stderr or "the command failed").strip().removeprefix("error: "))
        with (Path(folder) / "gait.csv").open(newline="") as file:
            rows = list(csv.reader(file))
    columns: dict[str, Any] = {}
    for name, *cells in zip(*rows):
        try:
            columns[name] = [float(cell) for cell in cells]
        except ValueError:
            columns[name] = cells
    return Table(columns)
