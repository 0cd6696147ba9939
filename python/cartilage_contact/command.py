"""The command ``cartilage-contact``: the program that comes with the package."""

import subprocess
import sys
from pathlib import Path


def program() -> str:
    """Where the program is."""
    name = "cartilage-contact.exe" if sys.platform == "win32" else "cartilage-contact"
    return str(Path(__file__).parent / "native" / name)


def main() -> None:
    """Runs it with the arguments of this process."""
    sys.exit(subprocess.run([program(), *sys.argv[1:]]).returncode)
