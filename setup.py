"""Builds the program and the FMUs with Cargo and puts them into the Python package; everything else is in pyproject.toml.

`CARTILAGE_CONTACT_BUILT` may name a folder that has them already, as `scripts/release.sh` makes it.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

ROOT = Path(__file__).parent.resolve()
# Below Cargo's folder, so that the clone stays clean.
BUILD = ROOT / "target" / "python"
NAMES = {"win32": ("cartilage-contact.exe", "cartilage_contact.dll")}.get(
    sys.platform,
    ("cartilage-contact", "libcartilage_contact.dylib" if sys.platform == "darwin" else "libcartilage_contact.so"),
)


def build():
    """A folder with the program and, beside it, its library."""
    if shutil.which("cargo") is None:
        sys.exit("cartilage-contact is built with Rust, and `cargo` is not there: install it from https://rustup.rs")
    subprocess.run(["cargo", "build", "--release", "--locked"], cwd=ROOT, check=True)
    return Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve() / "release"


class Native(build_py):
    """Also the program, its library, and the FMUs that it writes."""

    def run(self):
        super().run()
        native = Path(self.get_package_dir("") if self.editable_mode else self.build_lib) / "cartilage_contact" / "native"
        native.mkdir(parents=True, exist_ok=True)
        built = os.environ.get("CARTILAGE_CONTACT_BUILT")
        if built:
            shutil.copytree(built, native, dirs_exist_ok=True)
            return
        folder = build()
        program, library = NAMES
        shutil.copy2(folder / program, native)
        # Cargo does not always copy the library out of `deps`.
        newest = max(folder.glob(f"**/{library}"), key=lambda path: path.stat().st_mtime)
        shutil.copy2(newest, native)
        output = native / "CartilageLineContact.fmu"
        subprocess.run([native / program, "package", "--output", output], check=True, stdout=subprocess.DEVNULL)


class Wheel(bdist_wheel):
    """For any Python, but for one platform."""

    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self):
        return "py3", "none", super().get_tag()[2]


BUILD.mkdir(parents=True, exist_ok=True)
setup(
    version=re.search(r'^version = "(.+)"', (ROOT / "Cargo.toml").read_text(), re.MULTILINE).group(1),
    cmdclass={"build_py": Native, "bdist_wheel": Wheel},
    options={
        "build": {"build_base": str(BUILD.relative_to(ROOT))},
        "egg_info": {"egg_base": str(BUILD.relative_to(ROOT))},
    },
)
