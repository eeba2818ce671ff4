"""Configuration of the documentation: `make docs` builds it from what is installed, without a
network.
"""

import importlib.metadata
import logging
import os
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT), str(Path(__file__).parent / "_ext")]
# Tutorials are run in temporary directories, by processes of their own.
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
# Signatures and docstrings are those of the sources.
os.environ["PLUME_FLIGHT_SOURCES"] = "1"
# The tutorials do not depend on the user's settings of IPython, and their log has only errors.
_ipython = tempfile.TemporaryDirectory(prefix="ipython-")
os.environ["IPYTHONDIR"] = _ipython.name
_profile = Path(_ipython.name) / "profile_default"
_profile.mkdir()
(_profile / "ipython_kernel_config.py").write_text(
    "get_config().IPKernelApp.log_level = 'ERROR'\n", encoding="utf-8"
)
logging.getLogger("traitlets").setLevel(logging.WARNING)

project = "Plume flight study"
author = "the authors of the plume flight study"
version = release = importlib.metadata.version("plume-flight-study")

extensions = ["myst_nb", "sphinx.ext.autodoc", "docstrings", "generated_pages", "repository_links"]
smartquotes = False
exclude_patterns = ["_build", "scripts"]
html_theme = "furo"
html_title = f"{project} {version}"
html_static_path = ["_static"]
html_css_files = ["tables.css"]
html_show_sourcelink = html_show_sphinx = html_show_copyright = False

myst_enable_extensions = ["attrs_inline", "deflist"]
myst_heading_anchors = 3

nb_execution_mode = "force"
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True

nitpicky = True
# Types in signatures are text where their module is not documented; what pages and docstrings refer
# to has to exist.
nitpick_ignore_regex = [("py:(class|data|obj)", ".*")]
