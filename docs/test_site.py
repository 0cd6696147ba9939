"""The documentation site builds without a warning, its notebook runs, and it has every variable and every equation's place."""

import re
import subprocess
import sys
from pathlib import Path

import cartilage_contact as cc

ROOT = Path(__file__).parents[1]


def test_the_site_builds_and_has_every_variable(tmp_path):
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "docs", tmp_path]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    page = (tmp_path / "variables.html").read_text()
    for variable in cc.variables().values():
        name = f"{variable.name}[i]" if variable.shape else variable.name
        assert f">{name}<" in page, name
    assert (tmp_path / "equations.html").read_text().count("<math") > 15
    assert (tmp_path / "tutorial.html").read_text().count("<img") >= 3


def test_links_of_the_pages_at_the_root_lead_to_files():
    for page in sorted(page.name for page in ROOT.glob("*.md")):
        for target in re.findall(r"\]\(([^)#]+)[^)]*\)", (ROOT / page).read_text()):
            assert target.startswith("https://") or (ROOT / target).exists(), f"{page}: {target}"


def test_files_and_functions_that_pages_name_exist():
    for page in (ROOT / "docs").glob("*.md"):
        for name in re.findall(r"(?:examples|src)/[\w/]+\.\w+", page.read_text()):
            assert (ROOT / name).exists(), f"{page.name}: {name}"
    places = re.findall(r"`(\w+)` in `(src/[^`]+)`", (ROOT / "docs" / "equations.md").read_text())
    assert len(places) > 10
    for function, file in places:
        assert re.search(rf"fn {function}\b", (ROOT / file).read_text()), f"{function} in {file}"
