"""Hooks of MkDocs: the page of all variables from the model description, and pages that are there only sometimes."""

import re
from pathlib import Path
from xml.etree import ElementTree

from mkdocs.structure.files import File

ROOT = Path(__file__).parents[2]
CAUSALITIES = [("input", "Inputs"), ("output", "Outputs"), ("parameter", "Parameters")]


def on_config(config):
    """Adds pages before the limits where they exist."""
    present = [name for name in ("validation.md", "performance.md") if (ROOT / "docs" / name).exists()]
    listed = [name for name in config["nav"] if name not in present]
    place = listed.index("limits.md")
    config["nav"] = listed[:place] + present + listed[place:]
    return config


def on_files(files, config):
    files.append(File.generated(config, "variables.md", content=variables()))
    return files


def variables() -> str:
    """Every variable, a line each; a profile of many stations is one line."""
    tree = ElementTree.parse(ROOT / "modelDescription" / "fmi2.xml")
    page = ["# Every variable", "", "All values are in SI units. This page follows from the description inside the FMU.", ""]
    for causality, title in CAUSALITIES:
        page += [f"## {title}", "", "| variable | unit | start | range | meaning |", "|---|---|---|---|---|"]
        for variable in tree.iterfind(f".//ScalarVariable[@causality='{causality}']"):
            name, kind = variable.get("name"), variable[0]
            station = re.fullmatch(r"(.*)\[(\d+)\]", name)
            if station:
                if station[2] != "1":
                    continue
                name = f"{station[1]}[i]"
            bounds = f"{kind.get('min')} to {kind.get('max')}" if kind.get("min") else ""
            unit = kind.get("unit", "1" if kind.tag == "Real" else kind.tag.lower())
            meaning = variable.get("description", "").replace("|", "\\|")
            page.append(f"| `{name}` | {unit} | {kind.get('start', '')} | {bounds} | {meaning} |")
        page.append("")
    for enumeration in tree.iterfind(".//SimpleType"):
        page += [f"## {enumeration.get('name').removesuffix('_type')}", "", "| value | name | meaning |", "|---|---|---|"]
        page += [f"| {i.get('value')} | `{i.get('name')}` | {i.get('description', '')} |" for i in enumeration.iter("Item")]
        page.append("")
    return "\n".join(page)
