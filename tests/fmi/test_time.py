"""The FMUs in time and under a given load, as scripts use them."""

import numpy as np
import pytest
from conftest import COARSE
from fmpy import simulate_fmu

IN_TIME = {**COARSE, "time_integration": 2}


def run(fmu, columns, rows, **options):
    inputs = np.array(rows, dtype=[(name, float) for name in ("time", *columns)])
    return simulate_fmu(fmu, input=inputs, stop_time=rows[-1][0], **options)


def test_a_given_load_is_carried_and_the_depth_follows(fmu):
    rows = [(0.0, 20.0, 0.2), (0.1, 40.0, 0.2), (0.2, 40.0, -0.2)]
    outputs = ["load", "applied_load", "penetration_depth_result", "minimum_film_thickness", "upper_friction_force"]
    result = run(
        fmu, ["applied_load", "sliding_speed"], rows, output=outputs, output_interval=0.01,
        start_values={**IN_TIME, "control": 2, "applied_load": 20.0},
    )
    # FMPy holds inputs during a step: what is carried at its end was given at its start.
    given = np.interp(result["time"], [0, 0.1, 0.2], [20, 40, 40])
    assert result["load"][1:] == pytest.approx(given[:-1], rel=1e-5)
    assert result["penetration_depth_result"][10] > result["penetration_depth_result"][0]
    # Where the surfaces stand still for a moment the bodies sink, but far less than to the dry contact of a steady state.
    assert 0 < result["penetration_depth_result"][15] - result["penetration_depth_result"][10] < 5e-6
    assert result["upper_friction_force"][0] > 0 > result["upper_friction_force"][-1]


def test_the_depth_follows_the_approach_speed_and_squeezes_the_film(fmu):
    rows = [(0.0, 2e-4), (0.05, 2e-4)]
    options = {"output": ["penetration_depth_result", "load"], "output_interval": 0.01}
    start = {**IN_TIME, "sliding_speed": 0.0, "approach_speed": 2e-4}
    result = run(fmu, ["approach_speed"], rows, start_values=start, **options)
    assert result["penetration_depth_result"] == pytest.approx(-10e-6 + 2e-4 * result["time"], abs=1e-12)
    assert np.all(np.diff(result["load"]) > 0)


def test_rates_of_outputs_are_those_of_the_motion(instantiate):
    with instantiate(initialized=False) as contact:
        contact.set(time_integration=2)
        contact.fmu.enterInitializationMode()
        contact.fmu.exitInitializationMode()
        contact.step(0.02, approach_speed=1e-4)
        names = ["load", "minimum_film_thickness", "maximum_fluid_pressure"]
        rates = [contact.rate(name) for name in names]
        before = contact.get(*names)
        contact.step(2e-5)
        for name, rate, old, new in zip(names, rates, before, contact.get(*names)):
            assert (new - old) / 2e-5 == pytest.approx(rate, rel=2e-2), name


def test_a_tunable_parameter_changes_during_a_run(fmu):
    """A master gives it like an input; the state at the end is that of a run that had it from the start."""
    parameters = {**COARSE, "penetration_depth": 0.0}
    rows = [(0.0, 1e-3), (0.5, 1e-3), (0.5, 2e-3), (1.0, 2e-3)]
    tuned = run(fmu, ["viscosity"], rows, output=["load"], output_interval=0.25, start_values=parameters)["load"]
    first, last = (
        simulate_fmu(fmu, stop_time=0.25, output_interval=0.25, output=["load"], start_values={**parameters, "viscosity": value})
        for value in (1e-3, 2e-3)
    )
    assert tuned[:3] == pytest.approx(3 * [first["load"][-1]], rel=1e-6)
    assert tuned[3:] == pytest.approx(2 * [last["load"][-1]], rel=1e-6)
    assert last["load"][-1] > 1.3 * first["load"][-1]
