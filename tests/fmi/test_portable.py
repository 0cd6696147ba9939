"""The Linux library can be loaded elsewhere."""

import importlib.util
import os
import platform
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
# The release is built for glibc 2.17. Any other build needs at most the glibc of the machine that linked it.
CEILING = "2.17" if os.environ.get("RELEASED") else platform.libc_ver()[1]


def glibc():
    specification = importlib.util.spec_from_file_location("glibc", ROOT / "scripts" / "glibc.py")
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


def test_the_library_needs_no_newer_glibc_and_nothing_else(fmu, tmp_path):
    with zipfile.ZipFile(fmu) as archive:
        (name,) = [name for name in archive.namelist() if name.endswith(".so") and "aarch64" not in name]
        library = archive.extract(name, tmp_path)
    assert glibc().check(library, CEILING) == []


def test_what_is_too_new_or_missing_is_found(fmu, tmp_path):
    with zipfile.ZipFile(fmu) as archive:
        (name,) = [name for name in archive.namelist() if name.endswith(".so") and "aarch64" not in name]
        library = archive.extract(name, tmp_path)
    assert "more than 2.1" in glibc().check(library, "2.1")[0]
