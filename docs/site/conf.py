# SPDX-License-Identifier: BSD-3-Clause
# The site of `make site`: Sphinx over the folder that tools/pages/site stages.
import os
import re
import sys
from pathlib import Path
from unittest.mock import MagicMock

from docutils import nodes
from sphinx.builders.html import StandaloneHTMLBuilder
from sphinx.ext.napoleon import Config
from sphinx.ext.napoleon.docstring import NumpyDocstring

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
STAGE = Path(os.environ["WEFT_STAGE"])
sys.path.insert(0, str(ROOT / "python/src"))

project = "weft"
copyright = "the authors of weft, BSD-3-Clause"
extensions = ["myst_parser", "breathe", "sphinx.ext.autodoc"]
root_doc = "index"
exclude_patterns = ["README.md", "**/*.txt"]
pygments_style, pygments_dark_style = "friendly", "native"
smartquotes = False  # primes of formulas and two hyphens of an option stay
suppress_warnings = ["myst.header", "ref.python"]  # of notebooks; of names that several classes have
default_role = "literal"
StandaloneHTMLBuilder.supported_image_types.append("image/webp")

myst_enable_extensions = ["attrs_block", "attrs_inline"]
myst_heading_anchors = 4  # links such as scene.md#contact, as a Git host makes them

breathe_projects = {"weft": str(STAGE.parent / "xml")}
breathe_domain_by_extension = {"h": "c"}
breathe_default_project = "weft"
breathe_show_include = False
breathe_use_project_refids = True
c_id_attributes = ["WEFT_API"]
primary_domain = None

# The package is read without being built: its declarations are made from the headers.
autodoc_mock_imports = ["numpy", "pandas", "h5py", "yaml", "matplotlib", "scipy"]


class Compiled(MagicMock):
    """weft._weft: constants are 0, functions anything, callbacks themselves."""

    def __getattr__(self, name):
        return 0 if name.isupper() else super().__getattr__(name)

    def def_extern(self, **_):
        return lambda function: function


sys.modules["weft._weft"] = Compiled()
napoleon_use_ivar = True  # attributes of a class stand in its own text
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
python_use_unqualified_type_names = True

html_theme = "furo"
html_title = "weft"
html_static_path = [str(HERE / "style.css")]
html_css_files = ["style.css"]
html_domain_indices = False
html_show_search_summary = False  # it is fetched, which files may not
html_copy_source = False
html_show_sphinx = False
html_permalinks_icon = "#"
html_extra_path = [str(STAGE.parent / "extra")]


def as_page(app, name, source):
    """Links that lead to files on a Git host lead to their pages on the site."""
    text = source[0]
    text = re.sub(r"\]\(((?:\.\./)*)README\.md", r"](\1index.md", text)
    text = re.sub(r"\]\(((?:\.\./)*scenes/[\w-]+)\.yaml\)", r"](\1.md)", text)
    text = re.sub(r"\]\((?:\.\./)*include/weft/(\w+)\.h\)", r"](/reference/\1.md)", text)
    text = re.sub(r"\]\((?:\.\./)*include/weft/(\w+\.hpp)\)", r"](/reference/\1.md)", text)
    text = re.sub(r"\]\((?:\.\./)*include/weft\)", "](/reference/c.md)", text)
    text = re.sub(r"\]\((?:\.\./)*((?:examples|plugins)/[\w./-]+)\)", r"](/files/\1.md)", text)
    if name == "index":
        text = text.replace("| [flag]", "{.films}\n| [flag]", 1)
    if name == "docs/start/gallery":
        text = text.replace("| scene | what", "{.gallery}\n| scene | what")
        text = re.sub(r"(\[([\w-]+)\]\(\.\./\.\./scenes/[\w-]+\.md\)):", r'\1 (<a href="../../players/\2.html">player</a>):', text)
    source[0] = re.sub(r"\[([^\]]+)\]\((\.\./[^)#\s]+)(?:#[\w-]*)?\)", lambda link: unless_elsewhere(name, link), text)


def unless_elsewhere(name, link):
    """A link, or its text alone if it leads to a file of the tree that is not on the site."""
    path = os.path.normpath(os.path.join(os.path.dirname(name), link[2]))
    return link[0] if (STAGE / path).exists() or not (ROOT / path).exists() else link[1] if link[1] == path else f"{link[1]} ({path})"


def undocumented(app, what, name, thing, options, lines):
    """A field of a tuple without a comment has a docstring of Python's."""
    if lines and lines[0].startswith("Alias for field number"):
        lines.clear()


DOCSTRINGS = Config(napoleon_use_ivar=True, napoleon_use_rtype=False)


def as_sections(app, what, name, thing, options, lines):
    """Docstrings in the form of numpydoc; the extension napoleon itself would take a property's text for its type."""
    form = NumpyDocstring(lines, DOCSTRINGS, app, "method" if what == "property" else what, name, thing, options)
    text = re.sub(r"^( *:(?:ivar|vartype|param|type) )([^:]*, [^:]*):", lambda field: field[1] + field[2].replace(", ", ",\u200b") + ":",
                  str(form), flags=re.M)  # of several names with a space the first would be taken for a type
    lines[:] = text.split("\n")


def dashes(app, doctree):
    """Sphinx writes two hyphens between a parameter or type and its text, for smartquotes to replace."""
    for text in list(doctree.findall(nodes.Text)):
        if text.startswith(" -- "):
            text.parent.replace(text, nodes.Text(text.replace(" -- ", " \u2013 ", 1)))


def setup(app):
    app.connect("doctree-read", dashes)
    app.connect("autodoc-process-docstring", as_sections)
    app.connect("autodoc-process-docstring", undocumented)
    app.connect("source-read", as_page)
