"""The installed Python package: run by `cargo test --release --test python`, or by pytest where it is installed."""

import json
import subprocess
from pathlib import Path

import cartilage_contact as cc
import fmpy
import numpy as np
import pytest

# Few elements: these tests are about the package, not about the numbers.
COARSE = {"mesh": {"columns": 40, "rows": 3}}


def test_both_fmus_are_there():
    for fmi, version in [(2, "2.0"), (3, "3.0")]:
        assert fmpy.read_model_description(str(cc.fmu_path(fmi))).fmiVersion == version
    with pytest.raises(ValueError, match="2 or 3"):
        cc.fmu_path(1)


def test_a_state_is_that_of_the_command(tmp_path):
    case = tmp_path / "case.toml"
    case.write_text("sliding_speed = 0.1\n[upper]\nthickness = 1.2e-3\n[both]\nthickness = 1.1e-3\n[mesh]\ncolumns = 40\nrows = 3\n")
    state = cc.solve(case, penetration_depth=5e-6)
    command = ["cartilage-contact", "solve", "--case", case, "--penetration-depth", "5e-6", "--json"]
    expected = json.loads(subprocess.run(command, capture_output=True, check=True, text=True).stdout)
    assert set(state) == set(expected) - {"warnings"}
    for name, value in state.items():
        if name == "lubrication_regime":
            assert value.name == expected[name]
        elif name != "newton_iterations":
            size = np.abs(expected[name]).max()
            np.testing.assert_allclose(value, expected[name], rtol=1e-5, atol=1e-7 * size, err_msg=name)
    assert state.units["load"] == "N/m" and state.units["friction_coefficient"] == "1"
    assert state["film_thickness"].shape == (101,)


def test_derivatives_are_those_of_differences():
    depth, by = 5e-6, 1e-8
    state = cc.solve(penetration_depth=depth, derivatives=True, **COARSE)
    low, high = (cc.solve(penetration_depth=depth + change, **COARSE) for change in (-by, by))
    for name in ("load", "minimum_film_thickness", "fluid_pressure"):
        difference = (high[name] - low[name]) / (2 * by)
        found = state.derivatives[name, "penetration_depth"]
        np.testing.assert_allclose(found, difference, rtol=1e-2, atol=1e-3 * np.abs(difference).max())
    assert state.derivatives["fluid_pressure", "sliding_speed"].shape == (101,)


def test_a_load_finds_its_depth_and_words_are_choices():
    state = cc.solve(applied_load=15.0, formulation="consistent", **COARSE)
    assert state["load"] == pytest.approx(15.0, rel=1e-6)
    assert state["lubrication_regime"] is cc.enumeration("lubrication_regime")[state["lubrication_regime"].name]


def test_suction_beyond_a_vacuum_is_a_warning():
    stiff = {"shear_modulus": 5e7, "bulk_modulus": 1e8}
    deep = cc.solve(penetration_depth=-5e-6, sliding_speed=2.0, viscosity=0.1, both=stiff, **COARSE)
    assert deep["minimum_fluid_pressure"] < -101325
    assert any("cavitation" in text for text in deep.warnings) and "warning" in repr(deep)
    coarse = cc.solve(penetration_depth=5e-6, sliding_speed=0.2, **COARSE)
    assert not any("cavitation" in text for text in coarse.warnings)
    # What the mesh does not resolve is told with the result.
    assert not coarse["well_resolved"] and any("mesh" in text for text in coarse.warnings), coarse.warnings


@pytest.mark.parametrize(
    "values, message",
    [
        ({"penetration_deptth": 0.0}, "did you mean penetration_depth"),
        ({"load": 1.0}, "no input or parameter"),
        ({"formulation": "papery"}, "paper, consistent"),
        ({"sliding_speed": 99.0}, "sliding_speed"),
        ({"penetration_depth": 9e-3}, "no converged solution"),
    ],
)
def test_mistakes_are_explained(values, message):
    with pytest.raises(cc.ContactError, match=message):
        cc.solve(**{**COARSE, **values})


def test_a_sweep_has_the_states_of_single_solutions():
    told = []
    depths, speeds = np.linspace(-10e-6, 10e-6, 9), [0.2, 0.1]
    table = cc.sweep(COARSE, depths=depths, speeds=speeds, threads=4, progress=lambda done, total: told.append((done, total)))
    assert told == [(done, 18) for done in range(1, 19)]
    np.testing.assert_array_equal(table["sliding_speed"], np.repeat([0.1, 0.2], 9))
    np.testing.assert_allclose(table["penetration_depth"], np.tile(depths, 2), atol=1e-18)
    for row in (4, 15):
        single = cc.solve(COARSE, **{name: table[name][row] for name in ("penetration_depth", "sliding_speed")})
        np.testing.assert_allclose(table["load"][row], single["load"], rtol=1e-5)
        np.testing.assert_allclose(table["film_thickness"][row], single["film_thickness"], rtol=1e-5)
        assert table["lubrication_regime"][row] == single["lubrication_regime"].name
    frame = table.to_dataframe()
    assert frame.shape[0] == 18 and frame.attrs["units"]["load"] == "N/m" and "film_thickness" not in frame
    assert table.to_xarray()["film_thickness"].dims == ("row", "station")


def test_a_state_that_is_not_found_leaves_the_others():
    table = cc.sweep(COARSE, depths=[0.0, 5e-6, 9e-3], threads=1)
    assert np.isnan(table["load"]).tolist() == [False, False, True]
    assert len(table.warnings) == 1 and "0.009" in table.warnings[0]


def test_a_ramp_ends_where_it_is_said_to(tmp_path):
    ramp = {"time": [0.0, 20.0], "penetration_depth": [-10e-6, 10e-6]}
    run = cc.simulate(ramp, COARSE, output_interval=2)
    np.testing.assert_allclose(run["time"], np.arange(0, 21, 2), atol=1e-9)
    np.testing.assert_allclose(run["penetration_depth"], np.linspace(-10e-6, 10e-6, 11), atol=1e-15)
    assert run["load"][-1] == pytest.approx(cc.solve(COARSE, penetration_depth=10e-6)["load"], rel=1e-5)
    assert run["lubrication_regime"][-1] == "low_friction" and run.units["time"] == "s"
    with pytest.raises(cc.ContactError, match="viscosity"):
        cc.simulate(ramp, COARSE, viscosity=-1.0)


def test_a_walking_cycle():
    history = {"time": np.linspace(0, 1, 9), "sliding_speed": np.full(9, 0.1), "applied_load": np.full(9, 10.0)}
    table = cc.gait(history=history, steps=8, cycles=2, **COARSE)
    transient = table["time_integration"] == "transient"
    assert 8 <= np.count_nonzero(transient) <= 18
    np.testing.assert_allclose(table["load"][transient], 10.0, rtol=1e-5)
    assert table.units["load"] == "N/m"
    with pytest.raises(cc.ContactError, match="both.thickness|thickness"):
        cc.gait(both={"thickness": -1.0})


def test_it_is_typed_and_the_command_packs_fmus(tmp_path):
    assert (Path(cc.__file__).parent / "py.typed").exists()
    subprocess.run(["cartilage-contact", "package", "--output", tmp_path / "contact.fmu"], check=True)
    assert (tmp_path / "contact.fmi3.fmu").stat().st_size > 100_000
