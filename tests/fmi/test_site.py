"""The documentation site builds, every link within it leads somewhere, and it has every variable."""

import re
import subprocess
import sys
from pathlib import Path

from fmpy import read_model_description

ROOT = Path(__file__).parents[2]


def test_the_site_builds_and_its_links_lead_somewhere(tmp_path, fmu2):
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", tmp_path]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    page = (tmp_path / "variables" / "index.html").read_text()
    for variable in read_model_description(fmu2).modelVariables:
        if variable.causality in ("input", "output", "parameter"):
            name = re.sub(r"\[\d+\]", "[i]", variable.name)
            assert f"<code>{name}</code>" in page


def test_links_of_the_pages_at_the_root_lead_to_files():
    for page in sorted(page.name for page in ROOT.glob("*.md")):
        for target in re.findall(r"\]\(([^)#]+)[^)]*\)", (ROOT / page).read_text()):
            assert target.startswith("https://") or (ROOT / target).exists(), f"{page}: {target}"


def test_files_that_pages_name_exist():
    for page in (ROOT / "docs").glob("*.md"):
        for name in re.findall(r"examples/\w+\.\w+", page.read_text()):
            assert (ROOT / name).exists(), f"{page.name}: {name}"
