"""What no validator looks at, and what they do."""

import math
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from lxml import etree

INPUTS = {"penetration_depth", "sliding_speed", "slide_to_roll_ratio", "approach_speed", "applied_load"}
SCALAR_OUTPUTS = {
    "load", "fluid_load", "solid_load", "normal_force", "upper_friction_force", "lower_friction_force",
    "friction_coefficient", "fluid_friction_coefficient", "fluid_load_support", "minimum_film_thickness",
    "central_film_thickness", "contact_length", "maximum_fluid_pressure", "minimum_fluid_pressure",
    "maximum_contact_pressure", "maximum_von_mises_stress", "sommerfeld_number", "contact_stiffness",
    "lubrication_regime", "newton_iterations",
}  # fmt: skip
PROFILES = ["position", "film_thickness", "fluid_pressure", "contact_pressure"]


def read(fmu, name="modelDescription.xml"):
    with zipfile.ZipFile(fmu) as archive:
        return etree.fromstring(archive.read(name))


@pytest.fixture(scope="module")
def xml(fmu):
    return read(fmu)


def variables(xml):
    """Every variable as the element that has its type, with what FMI 2 puts into the element around it."""
    if xml.get("fmiVersion") == "2.0":
        for variable in xml.iterfind(".//ScalarVariable"):
            variable[0].attrib.update(variable.attrib)
            yield variable[0]
    else:
        yield from xml.find("ModelVariables")


def test_fmpy_finds_nothing_wrong(fmu):
    assert validate_fmu(fmu) == []


def test_fmu_manipulation_toolbox_finds_nothing_wrong(fmu):
    command = [sys.executable, "-m", "fmu_manipulation_toolbox.cli.fmutool", "-input", fmu, "-check"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    report = done.stdout + done.stderr
    assert "compliant" in report.lower(), report
    assert not any(word in report for word in ["ERROR", "WARNING", "CRITICAL"]), report


def test_variables_have_the_promised_names_and_roles(description):
    by_causality = {}
    for variable in description.modelVariables:
        by_causality.setdefault(variable.causality, set()).add(variable.name)
    assert by_causality["input"] == INPUTS
    assert SCALAR_OUTPUTS <= by_causality["output"]
    stations = {f"{name}[{i}]" for name in PROFILES for i in range(1, 102)}
    assert (stations if description.fmiVersion == "2.0" else set(PROFILES)) <= by_causality["output"]
    for body in ["upper", "lower"]:
        for name in "outer_radius thickness shear_modulus bulk_modulus permeability biot_coefficient".split():
            assert f"{body}.{name}" in by_causality["parameter"]
    assert {"width", "formulation", "viscosity", "tolerance"} <= by_causality["parameter"]


def test_every_length_pressure_force_and_speed_has_a_unit(description):
    dimensionless = ("coefficient", "support", "number", "ratio", "grading", "tolerance", "fraction", "exponent", "parameter",
                     "share", "error", "decay", "index", "zone_start", "zone_end")
    for variable in description.modelVariables:
        if variable.type in ("Real", "Float64") and variable.causality != "independent":
            assert (variable.unit is None) == variable.name.endswith(dimensionless), variable.name


def test_display_units_run_from_si(description):
    for unit in description.unitDefinitions:
        for display in unit.displayUnits:
            expected = {"mm": 1e3, "um": 1e6, "mm/s": 1e3, "deg": 180 / math.pi, "kPa": 1e-3, "MPa": 1e-6, "um2": 1e12,
                        "mm2": 1e6, "1/MPa": 1e6, "1/GPa": 1e9, "mPa.s": 1e3, "mN": 1e3, "kN": 1e-3,
                        "N/um": 1e-6, "kN/m": 1e-3, "mm2/s": 1e6, "um2/s": 1e12, "ms": 1e3, "N.mm": 1e3, "N.mm/mm": 1, "mW": 1e3, "mJ": 1e3,
                        "mm4/(N.s)": 1e12}
            assert float(display.factor) == pytest.approx(expected[display.name], rel=1e-12)


def test_every_unit_has_one_for_display_and_what_may_be_tuned_is_a_parameter(description):
    assert all(unit.displayUnits for unit in description.unitDefinitions)
    tunable = {variable.name: variable for variable in description.modelVariables if variable.variability == "tunable"}
    assert set(tunable) == {"viscosity", "boundary_friction_coefficient", "upper.permeability", "lower.permeability",
                            "surface_roughness"}
    assert all(variable.causality == "parameter" for variable in tunable.values())


def test_start_values_lie_in_their_ranges_and_zero_is_an_input(description):
    for variable in description.modelVariables:
        if variable.min is not None:
            low, start, high = float(variable.min), float(variable.start), float(variable.max)
            assert low < high and low <= start <= high, variable.name
            if variable.causality == "input":
                assert low <= 0 <= high


def test_inputs_have_a_start_and_no_initial(xml):
    inputs = [variable for variable in variables(xml) if variable.get("causality") == "input"]
    assert {variable.get("name") for variable in inputs} == INPUTS
    for variable in inputs:
        assert "initial" not in variable.attrib and "start" in variable.attrib


def test_references_and_names_are_unique(description):
    variables = description.modelVariables
    assert len({variable.valueReference for variable in variables}) == len(variables)
    assert len({variable.name for variable in variables}) == len(variables)


def test_structure_lists_exactly_the_outputs_depending_on_inputs_in_order(xml):
    two = xml.get("fmiVersion") == "2.0"
    known_by = [str(i) if two else v.get("valueReference") for i, v in enumerate(variables(xml), 1)]
    roles = dict(zip(known_by, (v.get("causality") for v in variables(xml))))
    outputs = [name for name, role in roles.items() if role == "output"]
    inputs = {name for name, role in roles.items() if role == "input"}
    for section in ["Outputs/Unknown", "InitialUnknowns/Unknown"] if two else ["Output", "InitialUnknown"]:
        unknowns = xml.findall(f".//ModelStructure/{section}")
        assert [unknown.get("index" if two else "valueReference") for unknown in unknowns] == outputs
        for unknown in unknowns:
            dependencies = unknown.get("dependencies").split()
            assert dependencies == sorted(set(dependencies), key=int) and set(dependencies) <= inputs


FLAGS = {
    "2.0": [
        "canHandleVariableCommunicationStepSize", "canInterpolateInputs", "canNotUseMemoryManagementFunctions",
        "canGetAndSetFMUstate", "canSerializeFMUstate", "providesDirectionalDerivative",
    ],
    "3.0": [
        "canHandleVariableCommunicationStepSize", "canGetAndSetFMUState", "canSerializeFMUState",
        "providesDirectionalDerivatives", "providesAdjointDerivatives",
    ],
}  # fmt: skip


def test_flags_say_what_works(xml):
    flags = xml.find("CoSimulation").attrib
    for flag in FLAGS[xml.get("fmiVersion")]:
        assert flags[flag] == "true"
    assert flags["maxOutputDerivativeOrder"] == "1"


def test_head_is_well_formed(xml):
    assert xml.get("generationDateAndTime").endswith("Z")
    assert not set("{}") & set(xml.get("guid") or xml.get("instantiationToken"))
    names = [category.get("name") for category in xml.iterfind(".//LogCategories/Category")]
    assert len(names) == len(set(names)) > 0
    experiment = {key: float(value) for key, value in xml.find("DefaultExperiment").attrib.items()}
    assert experiment["startTime"] < experiment["stopTime"]
    assert 0 < experiment["stepSize"] < experiment["stopTime"] - experiment["startTime"]


def test_profiles_are_arrays_in_fmi3(fmu3):
    arrays = {v.get("name"): int(v[0].get("start")) for v in read(fmu3).find("ModelVariables") if len(v)}
    assert arrays == dict.fromkeys(PROFILES, 101)


def test_both_versions_have_the_same_scalars(fmu2, fmu3):
    two, three = ({v.get("name"): v for v in variables(read(fmu))} for fmu in (fmu2, fmu3))
    assert {name for name in two if "[" not in name} == set(three) - {*PROFILES, "time"}
    for name in set(two) & set(three):
        for key in ["valueReference", "causality", "unit", "min", "max", "start", "nominal", "displayUnit"]:
            assert two[name].get(key) == three[name].get(key), f"{key} of {name}"


def test_the_terminal_is_valid_and_has_all_inputs_and_forces(fmu3):
    terminals = read(fmu3, "terminalsAndIcons/terminalsAndIcons.xml")
    schema = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"
    etree.XMLSchema(file=str(schema)).assertValid(terminals)
    (contact,) = terminals.iterfind(".//Terminal")
    members = {member.get("variableName") for member in contact}
    assert contact.get("name") == "contact"
    forces = {"normal_force", "upper_friction_force", "lower_friction_force"}
    on_bones = {f"{body}_{what}" for body in ("upper", "lower") for what in ("force_x", "force_y", "moment")}
    assert members == INPUTS | forces | on_bones
    assert members <= {v.get("name") for v in variables(read(fmu3))}


def test_archive_has_plain_entries_with_one_date(fmu):
    with zipfile.ZipFile(fmu) as archive:
        entries = archive.infolist()
        assert archive.testzip() is None
    names = [entry.filename for entry in entries]
    assert len(names) == len(set(names))
    of_the_version = {
        2: {"model.png", "binaries/linux64/CartilageLineContact.so"},
        3: {"terminalsAndIcons/icon.png", "binaries/x86_64-linux/CartilageLineContact.so"},
    }
    assert of_the_version[3 if fmu.endswith(".fmi3.fmu") else 2] <= set(names)
    assert {
        "modelDescription.xml", "documentation/index.html",
        "documentation/licenses/license.txt", "documentation/licenses/third-party.txt",
        "extra/org.fmi-standard.fmi-ls-ref/result.csv",
    } <= set(names)  # fmt: skip
    for entry in entries:
        assert not entry.filename.startswith(("/", "./")) and "\\" not in entry.filename and ".." not in entry.filename
        assert entry.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
        assert (entry.external_attr >> 16) & 0o170000 in (0, 0o100000), "links and devices are not allowed"
        assert entry.date_time == (1980, 1, 1, 0, 0, 0)
        assert entry.flag_bits & 0x1 == 0, "encrypted"


def test_the_reference_result_has_the_columns_of_the_outputs(fmu):
    with zipfile.ZipFile(fmu) as archive:
        lines = archive.read("extra/org.fmi-standard.fmi-ls-ref/result.csv").decode().splitlines()
    assert SCALAR_OUTPUTS <= set(lines[0].split(","))
    assert np.isfinite(np.genfromtxt(lines, delimiter=",", names=True).tolist()).all()
