"""The Python examples run, and their numbers make sense."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import COARSE
from pyarrow import parquet


sys.path.append(str(Path(__file__).parents[2] / "examples"))


def load(name):
    path = Path(__file__).parents[2] / "examples" / f"{name}.py"
    specification = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


EXAMPLES = sorted(path for path in (Path(__file__).parents[2] / "examples").glob("*.py") if path.name != "start.py")


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_help_and_missing_packages(path, tmp_path):
    """From another folder, and with the packages of this environment or with none."""
    name = path.name
    helped = subprocess.run([sys.executable, path, "--help"], capture_output=True, text=True, cwd=tmp_path)
    bare = subprocess.run([sys.executable, "-S", path, "--help"], capture_output=True, text=True, cwd=tmp_path)
    assert bare.returncode == 1 and "missing: pip install" in bare.stderr and "fmpy" in bare.stderr, bare.stderr
    if "missing: pip install" in helped.stderr:
        assert name in ("joint_opensim.py", "joint_syssimx.py"), helped.stderr
    else:
        assert helped.returncode == 0 and "--fmu" in helped.stdout, helped.stderr
        absent = subprocess.run([sys.executable, path, "--fmu", "no.fmu"], capture_output=True, text=True, cwd=tmp_path)
        assert absent.returncode == 1 and "no.fmu is not there" in absent.stderr


def test_drive_fmu(fmu):
    result = load("drive_fmu").main(fmu, parameters=COARSE)
    np.testing.assert_allclose(result["penetration_depth"][1:], np.linspace(-10e-6, 10e-6, 11), atol=1e-15)
    assert np.isfinite(result.tolist()).all()
    assert (np.diff(result["load"])[1:] > 0).all()


def test_two_compartments(fmu2, tmp_path):
    result = load("two_compartments").main(fmu2, tmp_path / "knee.ssp", parameters=COARSE)
    assert np.isfinite(result.tolist()).all()
    medial, lateral = result["medial.normal_force"], result["lateral.normal_force"]
    assert (np.diff(medial[2:]) > 0).all() and (np.diff(lateral[2:]) > 0).all()
    # The thicker layer gives way more.
    assert (lateral[2:] < medial[2:]).all()


def test_cavitation(fmu2, tmp_path):
    results = load("cavitation").main(
        fmu2, tmp_path / "cavitation.png", depths=1e-6 * np.array([-10, 0, 5]), parameters=COARSE
    )
    loads = [result["load"] for result in results.values()]
    for pressure, result in results.items():
        if pressure is None:
            assert (result["cavitated_length"] == 0).all() and result["minimum_fluid_pressure"].min() < -2500
        else:
            assert result["minimum_fluid_pressure"].min() > pressure - 1e-3
            assert result["cavitated_length"].max() > 1e-4
    # Less suction, more load; on so few elements a film that never cavitates is another one.
    assert all((more >= less).all() for less, more in zip(loads[1:], loads[2:]))
    assert (loads[-1] > 1.04 * loads[0]).all()
    assert (tmp_path / "cavitation.png").stat().st_size > 10_000


def test_joint_mujoco(fmu2, tmp_path):
    result = load("joint_mujoco").main(
        fmu2, picture=tmp_path / "joint.png", parameters={"mesh.columns": 24, "mesh.rows": 4}, duration=0.03, small=4e-4,
        large=2.5e-3, explicit_sizes=(4e-4, 2.5e-3), implicit_sizes=(2.5e-3,),
    )  # fmt: skip
    stable = result["stable"]
    # Of the spring, which has no damping of its own, the estimate is the limit.
    assert (stable["explicit"], stable["implicit"], stable["penalty"]) == (4e-4, 2.5e-3, 4e-4)
    assert 4e-4 < stable["limit"] < 2.5e-3
    fine, coarse = (result["runs"][f"cartilage, {name}"][0] for name in ("explicit", "implicit"))
    assert fine[-1, 0] == pytest.approx(0.03) and coarse[-1, 0] == pytest.approx(0.03)
    # Depth, force and moment, on the way that they vibrate.
    agreed = [np.interp(coarse[:, 0], fine[:, 0], fine[:, column]) for column in (1, 2, 3)]
    for found, expected, tolerance in zip(coarse[2:, 1:4].T, agreed, (0.05, 0.1, 0.05)):
        np.testing.assert_allclose(found, expected[2:], rtol=tolerance)
    # The body's weight is what the joint carries in the mean.
    assert coarse[5:, 2].mean() == pytest.approx(750, rel=0.03)
    # Friction turns against the swing, which is positive.
    assert (coarse[1:, 3] < 0).all() and (coarse[:, 5] > 0.9).all()
    assert (tmp_path / "joint.png").stat().st_size > 10_000


def test_population_resumes_and_keeps_failures(fmu2, tmp_path):
    # In a process of its own: Dask's workers import the program anew.
    program = Path(__file__).parents[2] / "examples" / "population.py"
    command = [sys.executable, program, "--fmu", fmu2, "--folder", tmp_path / "knees", "--workers", "1"]
    command += ["--picture", tmp_path / "population.png"]

    def run(knees):
        done = subprocess.run([*command, "--knees", str(knees)], capture_output=True, text=True, check=True)
        return done.stdout

    assert "0 knees are there, 1 to run" in run(1)
    resumed = run(2)
    assert "1 knees are there, 1 to run" in resumed and "2 knees, 0 of them with a problem" in resumed, resumed
    assert len(list((tmp_path / "knees").glob("*.parquet"))) == 2
    population = load("population")
    number, problem = population.run_knee(9, fmu2, str(tmp_path), {"mesh.columns": 3}, population.SPEEDS)
    assert number == 9 and "mesh.columns" in problem
    solved, failed = tmp_path / "knees" / "knee_00000.parquet", tmp_path / "knee_00009.parquet"
    assert parquet.read_schema(failed).names == parquet.read_schema(solved).names  # they become one table


def test_stribeck(fmu2, tmp_path):
    depths = 1e-6 * np.arange(-10.0, 17.0, 2.0)
    mesh = {"mesh.columns": 60, "mesh.rows": 4}
    result = load("stribeck").main(fmu2, mesh, depths, picture=tmp_path / "stribeck.png")
    np.testing.assert_allclose(result["penetration_depth"], depths, atol=1e-12)
    least = np.argmin(result["friction_coefficient"])
    assert result["penetration_depth"][least] == pytest.approx(12e-6)
    assert (result["solid_load"][: least + 1] == 0).all() and (result["solid_load"][least + 1 :] > 0).all()


def test_gait(fmu2, tmp_path):
    picture = tmp_path / "gait.png"
    result = load("gait").main(fmu2, COARSE, steps=40, cycles=3, picture=picture)
    transient, steady = result["transient"], result["quasi_steady"]
    for run in (transient, steady):
        np.testing.assert_allclose(run["fluid_load"] + run["solid_load"], result["applied_load"], rtol=1e-5)
    assert result["applied_load"].max() == pytest.approx(25, rel=0.01)
    assert np.count_nonzero(np.diff(np.sign(result["sliding_speed"]) >= 0)) == 2
    # Where sliding turns, a steady film is gone, and one that takes time to be squeezed out still carries.
    slowest = np.argmin(abs(result["sliding_speed"]))
    assert steady["fluid_load_support"][slowest] < 0.2 < 0.5 < transient["fluid_load_support"][slowest]
    assert result["change"] < 0.02
    assert picture.stat().st_size > 10_000
