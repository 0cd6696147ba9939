"""The Python examples run, and their numbers make sense."""

import importlib.util
from pathlib import Path

import numpy as np
from conftest import COARSE


def load(name):
    path = Path(__file__).parents[2] / "examples" / f"{name}.py"
    specification = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


def test_drive_fmu(fmu):
    result = load("drive_fmu").main(fmu, parameters=COARSE)
    assert len(result) == 11
    assert np.isfinite(result.tolist()).all()
    assert (np.diff(result["load"])[1:] > 0).all()


def test_two_compartments(fmu2, tmp_path):
    result = load("two_compartments").main(fmu2, tmp_path / "knee.ssp", parameters=COARSE)
    assert np.isfinite(result.tolist()).all()
    medial, lateral = result["medial.normal_force"], result["lateral.normal_force"]
    assert (np.diff(medial[2:]) > 0).all() and (np.diff(lateral[2:]) > 0).all()
    # The thicker layer gives way more.
    assert (lateral[2:] < medial[2:]).all()
