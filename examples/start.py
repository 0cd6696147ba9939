"""What the examples share: the packages they need, where the FMU is, their options, and how far they are."""

import argparse
import importlib.util
import sys
from pathlib import Path

#: The FMU of FMI 2.0 that `cargo run --release` writes, wherever an example is run from.
FMU = str(Path(__file__).resolve().parents[1] / "target" / "fmu" / "CartilageLineContact.fmu")


def needs(*packages):
    """Ends the program, and says what to install, where a package is missing."""
    missing = [package for package in packages if importlib.util.find_spec(package) is None]
    if missing:
        names = {"dask": '"dask[distributed]"', "syssimx": '"syssimx[fmu,opensim]"'}
        sys.exit(f"{', '.join(missing)} missing: pip install {' '.join(names.get(name, name) for name in missing)}")


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
