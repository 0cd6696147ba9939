"""Serialised states go between instances, versions of FMI and processes; what is no state of this FMU is refused."""

import hashlib
import subprocess
import sys
import uuid
from pathlib import Path

import pytest
from conftest import Slave
from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException

NEXT = {"penetration_depth": -6e-6, "sliding_speed": 0.15}


def saved(contact, **parameters):
    """Initialises, takes a step and returns the state after it as bytes."""
    contact.set(**parameters)
    contact.fmu.enterInitializationMode()
    contact.fmu.exitInitializationMode()
    contact.step(penetration_depth=-8e-6, slide_to_roll_ratio=0.3)
    state = contact.save()
    data = contact.to_bytes(state)
    contact.drop(state)
    return data


def resume(contact, data):
    """Continues from bytes as far as `saved` went."""
    state = contact.from_bytes(data)
    contact.restore(state)
    contact.drop(state)
    contact.time = 0.1


# Numbers of the enumerations' items.
IN_TIME = {"time_integration": 2}
UNDER_LOAD = {"time_integration": 2, "control": 2}


def same_bits(values, others):
    return [value.hex() for value in values] == [value.hex() for value in others]


@pytest.mark.parametrize("mode", [{}, IN_TIME, UNDER_LOAD])
def test_an_instance_of_either_version_goes_on_with_the_same_bits(instantiate, instantiate_again, mode):
    with instantiate(initialized=False) as first, instantiate_again(initialized=False) as second:
        data = saved(first, **{"lower.thickness": 1.2e-3, "boundary_friction_loads_tissue": False}, **mode)
        resume(second, data)
        assert same_bits(second.everything(), first.everything())
        assert second.get("lower.thickness") == 1.2e-3 and second.get("slide_to_roll_ratio") == 0.3
        for contact in (first, second):
            contact.step(**NEXT)
        assert same_bits(second.everything(), first.everything())
        for known in ("penetration_depth", "applied_load"):
            slope = first.derivative("penetration_depth_result", known)
            assert second.derivative("penetration_depth_result", known) == slope
            assert (slope != 0) == ((known == "applied_load") == (mode is UNDER_LOAD))


def test_a_state_brings_its_parameters_and_mesh_into_an_instance_that_runs_with_others(instantiate, instantiate_again):
    with instantiate(initialized=False) as first, instantiate_again(initialized=False) as second:
        data = saved(first, **{"viscosity": 2e-3})
        saved(second, **{"mesh.columns": 20, "upper.shear_modulus": 0.7e6})
        resume(second, data)
        assert second.get("viscosity") == 2e-3 and second.get("upper.shear_modulus") == 0.5e6
        for contact in (first, second):
            contact.step(**NEXT)
        assert same_bits(second.everything(), first.everything())


@pytest.mark.parametrize("mode", [{}, UNDER_LOAD])
@pytest.mark.parametrize("reader", ["fmu2", "fmu3"])
def test_another_process_goes_on_with_the_same_bits(instantiate, reader, request, tmp_path, mode):
    file = tmp_path / "state"
    with instantiate(initialized=False) as contact:
        file.write_bytes(saved(contact, **mode))
        contact.step(**NEXT)
        expected = [value.hex() for value in contact.everything()]
    command = [sys.executable, __file__, request.getfixturevalue(reader), file]
    # Before it stand the warnings that FMPy prints.
    found = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[-1].split()
    assert found == expected


def written_by(description2, version, payload):
    """The bytes of a state as that version writes them: see src/fmi/state.rs."""

    def named(space, name):
        digest = hashlib.sha1(space.bytes + name, usedforsecurity=False).digest()
        return uuid.UUID(bytes=digest[:16], version=5)

    writer = named(uuid.NAMESPACE_OID, f"{description2.guid} {version}".encode())
    return b"CartilageLineContact state " + named(writer, payload).bytes + payload


def test_foreign_cut_altered_and_outdated_bytes_are_refused_with_the_reason(instantiate, fmu2, capfd):
    description = read_model_description(fmu2)
    with instantiate(initialized=False) as contact:
        data = saved(contact)
        before = contact.everything()
        head = len(b"CartilageLineContact state ")
        payload = data[head + 16 :]
        # The next case but one differs from this in the version only.
        assert written_by(description, description.version, payload) == data
        for bytes_, reason in [
            (b"", "no state of this FMU"),
            (b"<state/>" * 100, "no state of this FMU"),
            (data[: head + 5], "end too early"),
            (data[:-1], "cut or altered"),
            (data + b"more", "cut or altered"),
            (data[:-9] + bytes([data[-9] ^ 1]) + data[-8:], "cut or altered"),
            (written_by(description, "0.0.9", payload), "another version of this FMU wrote them"),
        ]:
            capfd.readouterr()
            with pytest.raises(FMICallException):
                contact.from_bytes(bytes_)
            assert reason in capfd.readouterr().out
        assert same_bits(contact.everything(), before)
        contact.step(**NEXT)


if __name__ == "__main__":
    # The other process: FMU, file of the state.
    slave = Slave("another process", extract(sys.argv[1]), read_model_description(sys.argv[1]))
    resume(slave, Path(sys.argv[2]).read_bytes())
    slave.step(**NEXT)
    print(*(value.hex() for value in slave.everything()))
    slave.fmu.freeInstance()
