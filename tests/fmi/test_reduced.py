"""The real-time model in the FMUs: a table of states in their resources, made by `tests/python.rs` for the parameters below."""

import math

import pytest
from fmpy.fmi1 import FMICallException

CASE = {"mesh.columns": 60, "mesh.rows": 2, "sector_half_angle": math.pi / 72}


@pytest.fixture
def contact(instantiate):
    with instantiate(initialized=False) as slave:
        yield slave


def choose(slave, **parameters):
    """Asks for the real-time model, the second item of `fidelity`."""
    slave.set(**{**CASE, **parameters})
    setter = slave.fmu.setInt64 if slave.version == 3 else slave.fmu.setInteger
    setter([slave.references["fidelity"]], [2])


def initialize(slave):
    slave.fmu.enterInitializationMode()
    slave.fmu.exitInitializationMode()


def test_it_follows_the_full_model(contact, instantiate):
    choose(contact)
    initialize(contact)
    with instantiate("full", initialized=False) as full:
        full.set(**CASE)
        initialize(full)
        for depth in (-8e-6, 0.0, 7e-6):
            for slave in (contact, full):
                slave.step(penetration_depth=depth)
            assert contact.get("load") == pytest.approx(full.get("load"), rel=0.02)
            assert contact.get("position" if contact.version == 3 else "position[1]") == pytest.approx(
                full.get("position" if full.version == 3 else "position[1]")
            )


def test_states_come_back_with_the_same_bits(contact):
    choose(contact)
    initialize(contact)
    contact.step(penetration_depth=5e-6)
    state, before = contact.save(), contact.everything()
    contact.step(penetration_depth=-3e-6, sliding_speed=-0.2)
    assert contact.everything() != before
    again = contact.from_bytes(contact.to_bytes(state))
    for saved in (state, again):
        contact.restore(saved)
        assert contact.everything() == before
        contact.drop(saved)


def test_directional_derivatives_are_those_of_the_outputs(contact):
    choose(contact)
    initialize(contact)
    for known, step, low in (("penetration_depth", 1e-9, 5e-6), ("sliding_speed", 1e-5, 0.2)):
        values = []
        for sign in (-1, 1):
            contact.step(**{"penetration_depth": 5e-6, "sliding_speed": 0.2, known: low + sign * step})
            values.append(contact.get("load", "upper_friction_force", "minimum_film_thickness"))
        contact.step(penetration_depth=5e-6, sliding_speed=0.2)
        for i, name in enumerate(("load", "upper_friction_force", "minimum_film_thickness")):
            difference = (values[1][i] - values[0][i]) / (2 * step)
            assert contact.derivative(name, known) == pytest.approx(difference, rel=1e-4)


def test_inputs_beyond_the_table_are_refused_and_the_state_is_kept(contact):
    choose(contact)
    initialize(contact)
    before = contact.get("load")
    with pytest.raises(FMICallException):
        contact.step(penetration_depth=13e-6)
    assert contact.get("load") == before
    contact.step(penetration_depth=-9e-6)
    assert contact.get("load") > before


def test_a_table_of_other_parameters_is_refused(contact):
    choose(contact, viscosity=2e-3)
    contact.fmu.enterInitializationMode()
    with pytest.raises(FMICallException):
        contact.fmu.exitInitializationMode()
