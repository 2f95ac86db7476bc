"""Sphinx configuration of the book; what it states of the project comes from pyproject.toml."""

import sys
import tomllib
from importlib.metadata import files
from pathlib import Path

from sphinx.ext import autosummary
from sphinx_proof.domain import ProofDomain

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "_ext"))

PYPROJECT = tomllib.loads((HERE.parent / "pyproject.toml").read_text(encoding="utf-8"))
METADATA = PYPROJECT["project"]
REPOSITORY = METADATA.get("urls", {}).get("Repository")
html_baseurl = PYPROJECT["tool"]["qbound"].get("pages", "")  # where the book is read


def mathjax_file() -> str:
    """Return the one file of MathJax that the book needs: every TeX package, SVG, no fonts.

    The package that carries it is no extension here: as one it would add 24 MB to the book.
    """
    packaged = files("sphinx-mathjax-offline") or []
    return str(next(f.locate() for f in packaged if f.name == "tex-svg-full.js"))


project = METADATA["name"]
version = release = METADATA["version"]
author = METADATA["authors"][0]["name"]
copyright = f"2026, {author}. Text and figures CC BY 4.0, code MIT"
language = "en"

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx_proof",
    "sphinx_togglebutton",
    "sphinxcontrib.bibtex",
    "paper_numbers",
    "book_pages",
    "ledger_links",
    "cards",
    "panels",
    "live_figures",
    "recorded_numbers",
    "cells",
]
# Several processes read the pages: what this domain keeps, its extension merges, not the domain.
ProofDomain.merge_domaindata = lambda *_: None
exclude_patterns = ["_build", "**/.ipynb_checkpoints"]
templates_path = ["_templates"]

# References: everything that is ours must resolve. Names of other projects cannot, without a
# network; nor can the words of a numpydoc type ("array_like, shape (2, ...)").
nitpicky = True
nitpick_ignore_regex = [("py:.*", r"(?!cspace).*|cspace\.order\.Item")]  # a TypeVar has no place
numfig = True
numfig_format = {"figure": "Figure %s", "table": "Table %s", "code-block": "Listing %s"}

# Notebooks come executed; a chapter that raised has stopped the run before.
nb_execution_mode = "off"
nb_merge_streams = True
nb_render_markdown_format = "myst"  # tables and formulas in a cell's Markdown
nb_code_prompt_show = "Show the code"
nb_code_prompt_hide = "Hide the code"
myst_enable_extensions = ["amsmath", "attrs_inline", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
copybutton_selector = "div:not(.output) > div.highlight pre"
copybutton_prompt_text = r">>> |\.\.\. "  # an example is copied without its prompts and answers
copybutton_prompt_is_regexp = True

# API: the docstrings state types, shapes and units; the signature stays short.
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True  # -np.pi, not its digits
autosummary_generate = True
autosummary.WELL_KNOWN_ABBREVIATIONS += ("eq.", "eqs.")  # no end of a docstring's first sentence
napoleon_google_docstring = False
# Types are words ("ndarray, shape (..., 3)"), not names to look up: no section may make them links.
napoleon_use_param = False
napoleon_use_rtype = False
napoleon_custom_sections = [("Attributes", "params_style")]

bibtex_bibfiles = ["references.bib"]
bibtex_default_style = "unsrt"

# Formulas, without a network.
mathjax_path = "tex-svg-full.js"

html_theme = "sphinx_book_theme"
html_title = PYPROJECT["tool"]["qbound"]["title"]
html_static_path = ["_static", mathjax_file()]
html_css_files = ["book.css", "rerun-files.css"]
DEFERRED = ("hover.js", "ledger.js", "results.js")
html_js_files = ["book.js", *((name, {"defer": "defer"}) for name in DEFERRED)]
html_favicon = "_static/logo.svg"
html_context = {"default_mode": "auto"}
if (HERE / "_build" / "qbound.pdf").is_file():  # made by `run.py pdf`, which then builds again
    html_extra_path = ["_build/qbound.pdf"]
    html_context["printed"] = "qbound.pdf"
html_domain_indices = False
html_use_index = False
html_theme_options = {
    "logo": {
        "image_light": "_static/logo.svg",
        "image_dark": "_static/logo-dark.svg",
        "alt_text": "A two-link arm inside a curved region",
        "text": html_title,
    },
    "navbar_persistent": [],  # the theme's default adds a second search box
    "show_toc_level": 2,
    "use_fullscreen_button": False,
    "back_to_top_button": False,  # it would cover figures
    "use_download_button": False,  # it shows the file's text; a chapter offers its notebook itself
    "article_footer_items": ["notebook.html"],
    "extra_footer": f"<p>{project} {version}. Numbers and figures were computed when the book was "
    "built; the figures to try are drawn by your browser; running times were measured once.</p>",
}

if REPOSITORY:
    html_theme_options |= {
        "repository_url": REPOSITORY,
        "repository_branch": "main",
        "path_to_docs": "book",
        "use_repository_button": True,
        "use_edit_page_button": True,
        "use_issues_button": True,
        "launch_buttons": {
            "binderhub_url": "https://mybinder.org",
            "colab_url": "https://colab.research.google.com",
            "notebook_interface": "jupyterlab",
        },
    }
