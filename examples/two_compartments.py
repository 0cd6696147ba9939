"""Writes a knee of two compartments as a system of two FMUs (.ssp) and runs it with FMPy (`pip install fmpy`).

Both compartments are pressed together by the same depth; the lateral cartilage is thicker. Any tool that reads System
Structure and Parameterization 1.0 can open the file. Run it after `cargo run --release`, which writes the FMU.
"""

import zipfile

from start import FMU, needs, options

needs("fmpy")

from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssv

SSP = FMU.replace("CartilageLineContact.fmu", "two_compartments.ssp")
COMPARTMENTS = {"medial": 1.0e-3, "lateral": 1.5e-3}
INPUTS = ["penetration_depth", "sliding_speed"]
OUTPUTS = ["normal_force", "minimum_film_thickness"]
NAMESPACES = " ".join(
    f'xmlns:{prefix}="http://ssp-standard.org/SSP1/{name}"'
    for prefix, name in [
        ("ssd", "SystemStructureDescription"),
        ("ssv", "SystemStructureParameterValues"),
        ("ssc", "SystemStructureCommon"),
    ]
)


def connectors(names, kind):
    return "".join(f'<ssd:Connector name="{name}" kind="{kind}"><ssc:Real/></ssd:Connector>' for name in names)


def structure():
    components = "".join(
        f'<ssd:Component name="{name}" type="application/x-fmu-sharedlibrary" source="resources/contact.fmu">'
        f'<ssd:Connectors>{connectors(INPUTS, "input")}{connectors(OUTPUTS, "output")}</ssd:Connectors></ssd:Component>'
        for name in COMPARTMENTS
    )
    connections = "".join(
        f'<ssd:Connection startConnector="{name}" endElement="{element}" endConnector="{name}"/>'
        for name in INPUTS
        for element in COMPARTMENTS
    )
    return (
        f'<ssd:SystemStructureDescription {NAMESPACES} version="1.0" name="knee"><ssd:System name="knee">'
        f'<ssd:Connectors>{connectors(INPUTS, "input")}</ssd:Connectors><ssd:Elements>{components}</ssd:Elements>'
        f"<ssd:Connections>{connections}</ssd:Connections></ssd:System></ssd:SystemStructureDescription>"
    )


def values(parameters):
    """Parameters of every compartment: each thickness, and what both have in common."""
    rows = ""
    for compartment, thickness in COMPARTMENTS.items():
        of_both = {"upper.thickness": thickness, "lower.thickness": thickness, **parameters}
        for name, value in of_both.items():
            kind = "Integer" if isinstance(value, int) else "Real"
            rows += f'<ssv:Parameter name="{compartment}.{name}"><ssv:{kind} value="{value}"/></ssv:Parameter>'
    return (
        f'<ssv:ParameterSet {NAMESPACES} version="1.0" name="knee"><ssv:Parameters>{rows}</ssv:Parameters>'
        "</ssv:ParameterSet>"
    )


def main(fmu=FMU, ssp=SSP, parameters=None):
    """Forces [N] and least films [m] of both compartments over time."""
    with zipfile.ZipFile(ssp, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("SystemStructure.ssd", structure())
        archive.writestr("resources/values.ssv", values(parameters or {}))
        archive.write(fmu, "resources/contact.fmu")
    motion = {"penetration_depth": lambda time: (time - 5) * 1e-6, "sliding_speed": lambda time: 0.2}
    parameter_set = read_ssv(str(ssp), "resources/values.ssv")
    result = simulate_ssp(str(ssp), stop_time=10.0, step_size=1.0, parameter_set=parameter_set, input=motion)
    for row in result:
        forces = [row[f"{name}.normal_force"] for name in COMPARTMENTS]
        print(f"{row['time']:5.1f} s   " + "   ".join(f"{n} {f:8.3f} N" for n, f in zip(COMPARTMENTS, forces)))
    return result


if __name__ == "__main__":
    main(**options(__doc__, ssp=SSP))
