"""FMPy runs both FMUs; libcosim, which knows FMI 2 only, runs that."""

import html
import os
import threading
from pathlib import Path

import numpy as np
import pytest
from conftest import COARSE
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.util import read_csv
from fmpy.validation import validate_fmu

RAMP = np.array([(0.0, -10e-6), (1.0, 5e-6)], dtype=[("time", float), ("penetration_depth", float)])
OUTPUTS = ["load", "penetration_depth", "newton_iterations", "lubrication_regime"]


def simulate(fmu, **options):
    options = {"start_values": COARSE, "stop_time": 1.0, "input": RAMP, "output": OUTPUTS, **options}
    return simulate_fmu(fmu, **options)


def test_the_default_experiment_runs_and_every_output_is_finite(fmu, description):
    result = simulate_fmu(fmu, start_values=COARSE)
    assert len(result) == 11
    assert {v.name for v in description.modelVariables if v.causality == "output"} <= set(result.dtype.names)
    assert all(np.isfinite(result[name]).all() for name in result.dtype.names)


def test_the_default_experiment_with_the_reference_input_presses_and_releases(fmu, folder):
    # The first program of the FMU's page, with its FMU.
    page = Path(folder, "documentation", "index.html").read_text(encoding="utf-8")
    program = html.unescape(page.split("<pre>")[1].split("</pre>")[0])
    found = {}
    exec(program.replace("CartilageLineContact.fmu", Path(fmu).as_posix()), found)
    expected = read_csv(f"{found['reference']}/result.csv")
    assert found["result"]["load"] == pytest.approx(expected["load"], rel=1e-4)
    assert found["result"]["time"] == pytest.approx(expected["time"])
    load = found["result"]["load"]
    assert load.max() > 100 * load[0] and load[-1] == pytest.approx(load[0], rel=1e-4)


def test_a_preset_with_other_values_in_any_order(fmu, description):
    # FMPy sets start values in the order of the description, where the preset comes last.
    (preset,) = (variable for variable in description.modelVariables if variable.name == "preset")
    numbers = {item.name: item.value for item in preset.declaredType.items}
    values = {"preset": numbers["human_normal"], "sliding_speed": 0.1, "upper.thickness": 1.2e-3,
              "penetration_depth": 10e-6, "mesh.columns": 40, "mesh.rows": 4}
    found = {}
    for name, start in {"both": values, "alone": {k: v for k, v in values.items() if k != "upper.thickness"}}.items():
        forth = simulate_fmu(fmu, start_values=start, stop_time=0.1, output=["load", "sliding_speed"])
        back = simulate_fmu(fmu, start_values=dict(reversed(start.items())), stop_time=0.1, output=["load"])
        assert forth["sliding_speed"][-1] == 0.1
        assert forth["load"][-1] == back["load"][-1]
        found[name] = forth["load"][-1]
    assert found["both"] > 1.01 * found["alone"], "a thinner layer is stiffer"
    paper = simulate_fmu(fmu, start_values={"sliding_speed": 0.1, **COARSE}, stop_time=0.1, output=["load"])
    assert abs(found["alone"] / paper["load"][-1] - 1) > 0.01


@pytest.mark.parametrize("which, whole", [("SLIM", "FMU"), ("SLIM3", "FMU3")])
def test_the_slim_fmu_has_real_scalars_only_and_the_same_numbers(which, whole):
    slim, whole = os.environ[which], os.environ[whole]
    assert not validate_fmu(slim)
    description = read_model_description(slim)
    outputs = [variable for variable in description.modelVariables if variable.causality == "output"]
    assert {variable.type for variable in outputs} <= {"Real", "Float64"}
    assert not any(variable.dimensions or "[" in variable.name for variable in description.modelVariables)
    assert {unknown.variable.name for unknown in description.outputs} == {variable.name for variable in outputs}
    narrow, full = (simulate(fmu, output=["load", "friction_coefficient"]) for fmu in (slim, whole))
    assert (narrow == full).all()


def test_load_rises_along_a_ramp(fmu):
    result = simulate(fmu, output_interval=0.1)
    assert (np.diff(result["load"])[1:] > 0).all()
    assert set(result["lubrication_regime"]) <= {1, 2, 3, 4}


def test_results_do_not_depend_on_the_step_size(fmu):
    # FMPy holds an input during a step, so the value at the end of a step is that of the input at its beginning.
    coarse, fine = (simulate(fmu, output_interval=step) for step in (0.25, 0.125))
    for row in coarse[1:]:
        same = fine[np.isclose(fine["penetration_depth"], row["penetration_depth"], atol=1e-12)]
        assert len(same) >= 1
        np.testing.assert_allclose(same["load"], row["load"], rtol=1e-5)


def test_steps_of_different_size_end_on_the_state_of_their_inputs(instantiate):
    with instantiate() as one, instantiate() as other:
        for size, depth in [(0.5, -8e-6), (0.01, -6e-6), (0.3, -5e-6)]:
            one.step(size, penetration_depth=depth)
        other.step(0.81, penetration_depth=-5e-6)
        np.testing.assert_allclose(one.get("load"), other.get("load"), rtol=1e-5)


def test_inputs_of_zero_are_valid(instantiate):
    with instantiate(initialized=False) as contact:
        contact.set(penetration_depth=0.0, sliding_speed=0.0, slide_to_roll_ratio=0.0)
        contact.fmu.enterInitializationMode()
        assert np.isfinite(contact.everything()).all()
        contact.fmu.exitInitializationMode()
        contact.step()
        assert np.isfinite(contact.everything()).all()


def test_outputs_follow_inputs_in_initialization_mode(instantiate):
    with instantiate(initialized=False) as contact:
        contact.fmu.enterInitializationMode()
        loads = []
        for depth in [-9e-6, -7e-6, -9e-6]:
            contact.set(penetration_depth=depth)
            loads.append(contact.get("load"))
        assert loads[1] > loads[0]
        assert loads[2] == pytest.approx(loads[0], rel=1e-5)


def test_a_state_restored_gives_the_same_bits(instantiate):
    with instantiate() as contact:
        contact.step(penetration_depth=-8e-6)
        state, before = contact.save(), contact.everything()
        contact.step(penetration_depth=-4e-6)
        after = contact.everything()
        contact.step(penetration_depth=2e-6, sliding_speed=-0.1)
        contact.restore(state)
        contact.time = 0.1
        assert contact.everything() == before
        contact.step(penetration_depth=-4e-6)
        assert contact.everything() == after
        contact.drop(state)


def test_directional_derivatives_agree_with_differences(instantiate):
    with instantiate() as contact:
        contact.step(penetration_depth=-5e-6, sliding_speed=0.2)
        for known, at, by in [("penetration_depth", -5e-6, 1e-8), ("sliding_speed", 0.2, 1e-4)]:
            slope = contact.derivative("load", known)
            values = []
            for value in (at - by, at + by):
                contact.step(**{known: value})
                values.append(contact.get("load"))
            contact.step(**{known: at})
            assert slope == pytest.approx((values[1] - values[0]) / (2 * by), rel=1e-3)


def test_adjoint_derivatives_are_those_of_the_directional_ones(instantiate):
    with instantiate() as contact:
        if contact.version == 2:
            pytest.skip("FMI 2 has none")
        outputs, inputs = ["load", "upper_friction_force"], ["penetration_depth", "sliding_speed"]
        unknowns, knowns = ([contact.references[name] for name in names] for names in (outputs, inputs))
        columns = contact.fmu.getAdjointDerivative(unknowns, knowns, [2.0, -1.0], nSensitivity=2)
        for name, found in zip(inputs, columns):
            slopes = [contact.derivative(output, name) for output in outputs]
            assert found == pytest.approx(2 * slopes[0] - slopes[1], rel=1e-12)


def test_input_derivatives_are_followed_to_the_end_of_the_step(instantiate):
    with instantiate() as contact:
        if contact.version == 3:
            pytest.skip("FMI 3 has no derivatives of inputs")
    with instantiate() as ramped, instantiate() as direct:
        depth = ramped.references["penetration_depth"]
        ramped.fmu.setRealInputDerivatives([depth], [1], [2e-5])
        ramped.step(0.1)
        direct.step(0.1, penetration_depth=ramped.get("penetration_depth"))
        assert ramped.get("penetration_depth") == pytest.approx(-8e-6, rel=1e-12)
        assert ramped.get("load") == pytest.approx(direct.get("load"), rel=1e-6)
        rate = ramped.fmu.getRealOutputDerivatives([ramped.references["load"]], [1])[0]
        assert rate == pytest.approx(2e-5 * ramped.derivative("load", "penetration_depth"), rel=1e-9)


def run_alone(instantiate, depths):
    with instantiate() as contact:
        found = []
        for depth in depths:
            contact.step(penetration_depth=depth)
            found.append(contact.everything())
        return found


DEPTHS = [-8e-6, -5e-6, -2e-6], [-9e-6, -6e-6, 0.0]


def test_interleaved_instances_do_not_disturb_each_other(instantiate):
    alone = [run_alone(instantiate, depths) for depths in DEPTHS]
    with instantiate("first") as first, instantiate("second") as second:
        found = [[], []]
        for pair in zip(*DEPTHS):
            for contact, depth, list_ in zip((first, second), pair, found):
                contact.step(penetration_depth=depth)
                list_.append(contact.everything())
    assert found == alone


def test_instances_in_two_threads_do_not_disturb_each_other(instantiate):
    alone = [run_alone(instantiate, depths) for depths in DEPTHS]
    found = [None, None]

    def work(index):
        found[index] = run_alone(instantiate, DEPTHS[index])

    threads = [threading.Thread(target=work, args=(index,)) for index in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == alone


def resident():
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))


def test_two_thousand_lives_leave_no_memory_behind(instantiate):
    # One Slave for all of them: FMPy's own objects take memory that is not given back.
    with instantiate() as contact:
        contact.end()

        def live():
            contact.begin(**{"mesh.columns": 8, "mesh.rows": 1, "mesh.pressure_order": 1})
            contact.fmu.enterInitializationMode()
            contact.fmu.exitInitializationMode()
            contact.step()
            state = contact.save()
            contact.restore(state)
            contact.drop(state)
            contact.end()

        for _ in range(200):
            live()
        before = resident()
        for _ in range(2000):
            live()
        grown = resident() - before
        contact.begin()
    assert grown < 1024, f"{grown} KiB more after 2000 lives: {1024 * grown / 2000:.0f} bytes a life"


@pytest.mark.parametrize("name", ["with space", "100%25 %20", "Größe äöü"])
def test_folder_names_do_not_matter(fmu, tmp_path, instantiate, name):
    unpacked = extract(fmu, unzipdir=str(tmp_path / name))
    with instantiate(unpacked=unpacked) as contact:
        contact.step()
        assert np.isfinite(contact.everything()).all()


@pytest.mark.parametrize(
    "name, value", [("penetration_depth", 1.0), ("sliding_speed", float("nan")), ("slide_to_roll_ratio", float("inf"))]
)
def test_a_bad_input_is_refused_and_the_next_good_one_taken(instantiate, name, value):
    with instantiate() as contact:
        before = contact.get(name)
        with pytest.raises(FMICallException):
            contact.step(**{name: value})
        assert contact.get(name) == before
        contact.step(penetration_depth=-8e-6)


def test_a_wrong_token_makes_no_instance(instantiate, description, folder):
    fmu = (FMU3Slave if description.fmiVersion.startswith("3") else FMU2Slave)(
        guid="00000000-0000-0000-0000-000000000000",
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="contact",
    )
    with pytest.raises(Exception, match="[Ii]nstantiat"):
        fmu.instantiate()
    fmu.freeLibrary()


def test_libcosim_runs_it_and_agrees_with_fmpy(fmu, instantiate, description):
    if description.fmiVersion.startswith("3"):
        pytest.skip("libcosim knows FMI 2 only")
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    execution = CosimExecution.from_step_size(step_size=int(0.1e9))
    slave = CosimLocalSlave(fmu_path=fmu, instance_name="contact")
    index = execution.add_local_slave(local_slave=slave)
    for name, value in COARSE.items():
        execution.integer_initial_value(index, references[name], value)
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    execution.add_observer(observer=observer)
    execution.add_manipulator(manipulator=manipulator)
    with instantiate() as contact:
        for depth in [-9e-6, -6e-6, -3e-6]:
            manipulator.slave_real_values(index, [references["penetration_depth"]], [depth])
            assert execution.step()
            contact.step(penetration_depth=depth)
            (load,) = observer.last_real_values(index, [references["load"]])
            assert load == contact.get("load")
