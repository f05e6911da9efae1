"""Sphinx: the Markdown pages of docs/, those made from the program, and the contents. Run by build.py."""

project = "mpm"
copyright = "the mpm developers, BSD-3-Clause"
extensions = ["myst_parser", "sphinx_copybutton"]
html_theme = "furo"
html_title = "mpm"
html_static_path = []
myst_heading_anchors = 4
myst_enable_extensions = ["dollarmath"]
suppress_warnings = ["myst.header"]  # a page may go from # to ###
nitpicky = True
exclude_patterns = ["README.md"]
