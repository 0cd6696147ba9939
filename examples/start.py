"""What the examples share: the packages they need, where the FMU is, cases of joints, their options, and how far they are."""

import argparse
import importlib
import importlib.util
import sys
from pathlib import Path

#: The FMU of FMI 2.0 that `cargo run --release` writes, wherever an example is run from.
FMU = str(Path(__file__).resolve().parents[1] / "target" / "fmu" / "CartilageLineContact.fmu")


#: The reader of TOML: part of Python from 3.11 on, before that a package.
TOML = "tomllib" if sys.version_info >= (3, 11) else "tomli"


def needs(*packages):
    """Ends the program, and says what to install, where a package is missing; asked for help, after what the program does."""
    missing = [package for package in packages if importlib.util.find_spec(package) is None]
    if missing:
        if {"-h", "--help"} & set(sys.argv[1:]):
            print(sys.modules["__main__"].__doc__.strip(), end="\n\n", flush=True)
        names = {"dask": '"dask[distributed]"', "syssimx": '"syssimx[fmu,opensim]"'}
        sys.exit(f"{', '.join(missing)} missing: pip install {' '.join(names.get(name, name) for name in missing)}")


def joint_case(joint):
    """Names and values of a joint's case file, for each body."""
    path = Path(__file__).with_name(f"{joint}.toml")
    if joint not in ("ankle", "hip", "knee"):
        sys.exit(f"--joint {joint} is not allowed: ankle, hip or knee, the case files beside this program")
    case = importlib.import_module(TOML).loads(path.read_text(encoding="utf-8"))
    both = case.pop("both", {})
    bodies = {body: both | case.pop(body, {}) for body in ("upper", "lower")}
    return case | {f"{body}.{name}": value for body, values in bodies.items() for name, value in values.items()}


def set_values(contact, description, values):
    """Sets parameters and inputs of an FMU by name, choices by their words."""
    variables = {variable.name: variable for variable in description.modelVariables}
    for name, value in values.items():
        variable = variables[name]
        if variable.type == "Enumeration":
            value = next(int(item.value) for item in variable.declaredType.items if item.name == value)
        put = {"Real": contact.setReal, "Boolean": contact.setBoolean}.get(variable.type, contact.setInteger)
        put([variable.valueReference], [value])


def options(description, **others):
    """What was typed: `--fmu`, and an option with its default for each of `others`."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fmu", default=FMU, help="by default the one that `cargo run --release` writes")
    for name, default in others.items():
        kind = str if default is None else type(default)
        text = "" if default is None else "by default %(default)s"
        parser.add_argument(f"--{name.replace('_', '-')}", type=kind, default=default, help=text)
    chosen = vars(parser.parse_args())
    if not Path(chosen["fmu"]).exists():
        sys.exit(f"{chosen['fmu']} is not there: write it with `cargo run --release`, or name another with --fmu")
    return chosen


def tell(part, whole, of=""):
    """How far a run is, on one line of standard error where somebody looks at it."""
    if sys.stderr.isatty():
        print(f"\r{of}{100 * part / whole:4.0f} %", end="\n" if part >= whole else "", file=sys.stderr, flush=True)
    return True
