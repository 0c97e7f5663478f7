"""Settings of Sphinx for the manual that scripts/docs.sh builds. Sphinx warns of each Markdown document that index.rst does not list, and of
links and anchors that lead nowhere; docs.sh makes errors of warnings."""
import os
import pathlib

from pygments.lexers.c_cpp import CppLexer

project = "hertzline"
root_doc = "index"
exclude_patterns = ["docs/manual", "**/node_modules", "**/build", "**/dist"]  # documents of others
extensions = ["myst_parser", "breathe"]
myst_heading_anchors = 6
myst_ref_domains = ["std"]  # links lead to documents and their headings, never to C++ of that name
suppress_warnings = ["myst.header"]  # headings may skip a level
highlight_language = "none"
breathe_projects = {"hertzline": os.path.join(os.environ["HERTZLINE_MANUAL"], "xml")}
breathe_default_project = "hertzline"

html_theme = "sphinx_rtd_theme"
html_title = "hertzline"
html_static_path = ["manual.css"]
html_css_files = ["manual.css"]
html_show_copyright = False
html_use_index = False
html_copy_source = False
html_show_search_summary = False  # it cannot read files without a server


def leave_folders_out(app, _environment, node, text):
    """Shows a link to a folder as its text: the manual has documents, not folders."""
    if (pathlib.Path(app.srcdir, node["refdoc"]).parent / node["reftarget"]).is_dir():
        return text
    return None


def setup(app):
    app.add_lexer("hpp", CppLexer)
    app.connect("missing-reference", leave_folders_out)
