"""The documentation site, by Sphinx: `sphinx-build -W docs target/site`. The page of all variables follows from the FMU's description."""

import re
from pathlib import Path
from xml.etree import ElementTree

from docutils import nodes
from latex2mathml.converter import convert

ROOT = Path(__file__).parents[1]

project = "cartilage-contact"
author = "The cartilage-contact developers"
release = version = re.search(r'^version = "(.+)"', (ROOT / "Cargo.toml").read_text(), re.MULTILINE).group(1)
extensions = ["myst_nb"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
myst_dmath_double_inline = True
# Notebooks are run whenever the site is built, and a cell that fails stops the build.
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
html_theme = "pydata_sphinx_theme"
html_title = project
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_theme_options = {
    "show_prev_next": True,
    "show_toc_level": 2,
    "header_links_before_dropdown": 5,
    "navbar_align": "left",
    "footer_start": ["copyright"],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
}
html_sidebars = {"**": []}
copyright = f"{author}. These pages are of version {version}"


def variables() -> str:
    """Every variable, a line each; a profile of many stations is one line."""
    tree = ElementTree.parse(ROOT / "modelDescription" / "fmi2.xml")
    page = ["# Every variable", "", "All values are in SI units. This page follows from the description inside the FMU. *Tunable*", ""]
    page[-2] += " parameters may be changed before any step."
    for causality, title in [("input", "Inputs"), ("output", "Outputs"), ("parameter", "Parameters")]:
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
            if variable.get("variability") == "tunable":
                meaning += " (tunable)"
            page.append(f"| `{name}` | {unit} | {kind.get('start', '')} | {bounds} | {meaning} |")
        page.append("")
    for enumeration in tree.iterfind(".//SimpleType"):
        page += [f"## {enumeration.get('name').removesuffix('_type')}", "", "| value | name | meaning |", "|---|---|---|"]
        page += [f"| {i.get('value')} | `{i.get('name')}` | {i.get('description', '')} |" for i in enumeration.iter("Item")]
        page.append("")
    return "\n".join(page)


def mathml(latex: str, kind: str) -> str:
    """Browsers draw bold letters only where they are bold characters."""

    def bold(found: re.Match) -> str:
        letter = ord(found[1])
        return f"<mi>&#{letter - 65 + 0x1D400 if letter < 97 else letter - 97 + 0x1D41A};</mi>"

    return re.sub(r'<mi mathvariant="bold">([A-Za-z])</mi>', bold, convert(latex, display=kind))


def inline(translator, node):
    translator.body.append(mathml(node.astext(), "inline"))
    raise nodes.SkipNode


def display(translator, node):
    translator.body.append(f'<div class="math">{mathml(node.astext(), "block")}</div>')
    raise nodes.SkipNode


def setup(app):
    # Equations as MathML: browsers draw it themselves, without a script from elsewhere.
    app.add_html_math_renderer("mathml", (inline, None), (display, None))
    app.config.html_math_renderer = "mathml"
    (Path(__file__).parent / "variables.md").write_text(variables(), encoding="utf-8")
