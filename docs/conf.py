"""Sphinx configuration: `make docs` builds the site into build/site, warnings being errors."""

import sys
from importlib.metadata import version as version_of
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "_ext"))

project = "armodal"
author = "The armodal authors"
copyright = author  # noqa: A001 - the name Sphinx wants
release = version_of("armodal")
version = release

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "numpydoc",
    "math_as_mathml",
    "readable",
    "written_reference",
    "widths",
]
exclude_patterns = ["_ext"]
nitpicky = False

html_theme = "furo"
html_title = "armodal"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False

myst_enable_extensions = ["dollarmath", "deflist", "colon_fence"]
myst_heading_anchors = 4

# Notebooks are run at every build: a cell that fails is an error.
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 600  # a guard against hanging: how long a cell takes says nothing under load

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # numpydoc's sections tell shapes and units
numpydoc_show_class_members = False
