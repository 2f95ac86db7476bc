"""The book's numbers: the paper's own where the paper has the object, N1, N2, ... elsewhere."""

from pathlib import Path

import nbformat
import pytest
from bs4 import BeautifulSoup, Tag
from sphinx.errors import ExtensionError

from support.trial_book import BOOK, build_book

# What the extensions call will leave Sphinx one day: their matter, not this book's.
pytestmark = pytest.mark.filterwarnings(
    "ignore:.*Sphinx:DeprecationWarning", "ignore:.*Sphinx:PendingDeprecationWarning"
)

EXTENSIONS = BOOK / "_ext"

CONF = """
extensions = ["myst_nb", "sphinx_proof", "paper_numbers"]
myst_enable_extensions = ["colon_fence", "dollarmath"]
nb_execution_mode = "off"
nb_render_markdown_format = "myst"
numfig = nitpicky = True
numfig_format = {"figure": "Figure %s", "table": "Table %s"}
"""

INDEX = """
# Book

```{toctree}
first
second
```
"""

# Labels in another order than the paper's, the book's own among them; references come first.
FIRST = r"""
# First

See {eq}`eq:15`, {eq}`eq:29`, {eq}`eq:own`, {eq}`eq:later`, {numref}`fig:7`, {numref}`fig:8a`,
{numref}`fig:own`, {numref}`tab:6`, {numref}`tab:4`, {numref}`tab:1`, {numref}`tab:own`,
{prf:ref}`thm:2`, {prf:ref}`lem:own`, {numref}`plot %s <fig:11>`.

$$ c = d $$ (eq:own)

$$
\begin{aligned}
\beta_{1,1} &= x_{1,7} \cos q_1, \\
\beta_{1,3} &= z_{0,1}.
\end{aligned}
$$ (eq:29)

$$ a = b $$ (eq:15)

```{figure} arm.svg
:name: fig:own
:alt: Arm

Ours.
```

```{figure} arm.svg
:name: fig:7
:alt: Arm

The paper's.
```

```{list-table} Fourth.
:name: tab:4

* - a
```

```{table} First.
:name: tab:1

| a | b |
|---|---|
| 1 | 2 |
```

:::{prf:theorem} Bounds
:label: thm:2
It holds.
:::

:::{prf:lemma}
:label: lem:own
It holds too.
:::
"""

SHOWN = {
    "eq:15": "(15)",
    "eq:29": "(29)",
    "eq:own": "(N1)",
    "eq:later": "(N2)",
    "fig:7": "Figure 7",
    "fig:8a": "Figure 8a",
    "fig:own": "Figure N1",
    "fig:11": "Figure 11",
    "tab:6": "Table 6",
    "tab:4": "Table 4",
    "tab:1": "Table 1",
    "tab:own": "Table N1",
    "thm:2": "Theorem 2",
    "lem:own": "Lemma N1",
}

SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"><path d="M1 1h7"/></svg>'
HTML_TABLE = "<table><tr><td>1.5</td></tr></table>"
MARKDOWN_TABLE = "| a | b |\n|---|---|\n| 1 | $q_1$ |"


def notebook() -> str:
    """Return an executed notebook: figures and tables that its cells made, an equation."""
    cells = [nbformat.v4.new_markdown_cell("# Second\n\n$$ e = f $$ (eq:later)")]
    for name, kind, data in [
        ("fig:8a", "image/svg+xml", SVG),
        ("tab:6", "text/html", HTML_TABLE),
        ("tab:own", "text/markdown", MARKDOWN_TABLE),
        ("fig:11", "image/svg+xml", SVG),
    ]:
        output = nbformat.v4.new_output("display_data", {kind: data})
        figure = {"name": name, "caption": f"Caption of {name}."}
        metadata = {"mystnb": {"figure": figure, "image": {"alt": name}}}
        cell = nbformat.v4.new_code_cell("show()", metadata=metadata, outputs=[output])
        cells.append(cell)
    metadata = {"language_info": {"name": "python"}}
    return nbformat.writes(nbformat.v4.new_notebook(cells=cells, metadata=metadata))


def build(folder: Path, first: str) -> dict[str, Tag]:
    """Build a book of two chapters as strictly as ours; return its pages."""
    folder.mkdir(exist_ok=True)
    for name, text in [
        ("conf.py", CONF),
        ("index.md", INDEX),
        ("first.md", first),
        ("second.ipynb", notebook()),
        ("arm.svg", SVG),
    ]:
        (folder / name).write_text(text, encoding="utf-8")
    html, warnings = build_book(folder, EXTENSIONS, warningiserror=True, freshenv=True)
    assert warnings == ""
    return {page: soup(html / f"{page}.html") for page in ("first", "second")}


def soup(file: Path) -> BeautifulSoup:
    return BeautifulSoup(file.read_text(encoding="utf-8"), "html.parser")


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Tag]:
    return build(tmp_path_factory.mktemp("book"), FIRST)


def test_an_object_and_a_reference_to_it_show_its_number(pages):
    shown, said = {}, {}
    for label in SHOWN:
        anchor = label if label.startswith(("thm:", "lem:")) else label.replace(":", "-")
        anchor = f"equation-{anchor}" if label.startswith("eq:") else anchor
        [place] = [page.find(id=anchor) for page in pages.values() if page.find(id=anchor)]
        shown[label] = place.select_one(".eqno, .caption-number").get_text().strip("¶ ")
        links = pages["first"].select(f"p a.reference.internal[href$='#{anchor}']")
        said[label] = links[0].get_text()
    assert shown == SHOWN
    assert said == SHOWN | {"fig:11": "plot 11"}  # a reference with words of its own


def test_an_equation_of_several_lines_has_one_number_and_no_tag(pages):
    equation = pages["first"].find(id="equation-eq-29")
    assert len(equation.select(".eqno")) == 1
    assert r"\tag" not in equation.get_text()
    assert equation.get_text().count(r"\begin{aligned}") == 1


def test_a_table_of_a_cell_is_called_a_table_and_its_body_stands_outside_its_caption(pages):
    table = pages["second"].find(id="tab-6")
    assert "table-figure" in table["class"]
    assert "Table 6 Caption of tab:6." in table.select_one("figcaption").get_text()
    assert table.select_one("figcaption td") is None
    assert table.select_one("td").get_text() == "1.5"
    cells = pages["second"].find(id="tab-own").select("td")  # written in Markdown
    assert [cell.get_text() for cell in cells] == ["1", r"\(q_1\)"]


@pytest.mark.parametrize(
    "again",
    [
        "$$ x = y $$ (eq:15)",
        ":::{figure} arm.svg\n:name: fig:7\n:alt: Arm\n\nAgain.\n:::",
        ":::{figure} arm.svg\n:name: fig:8a\n:alt: Arm\n\nAgain, in another chapter.\n:::",
        ":::{list-table} Again.\n:name: tab:4\n\n* - a\n:::",
        ":::{list-table} Again, in another chapter.\n:name: tab:6\n\n* - a\n:::",
        ":::{prf:theorem}\n:label: thm:2\nAgain.\n:::",
    ],
    ids=["eq:15", "fig:7", "fig:8a", "tab:4", "tab:6", "thm:2"],
)
def test_a_number_of_the_paper_used_twice_stops_the_build(tmp_path, again):
    with pytest.raises(ExtensionError, match="appears twice"):
        build(tmp_path / "book", f"{FIRST}\n\n{again}\n")


def test_a_label_of_the_book_used_twice_stops_the_build(tmp_path):
    with pytest.raises(AssertionError, match="duplicate label of equation eq:later"):
        build(tmp_path / "book", f"{FIRST}\n\n$$ x = y $$ (eq:later)\n")


@pytest.mark.parametrize(
    "misplaced",
    [
        ":::{list-table} A table.\n:name: fig:3\n\n* - a\n:::",
        ":::{prf:lemma}\n:label: thm:1\nA lemma.\n:::",
        ":::{image} arm.svg\n:name: fig:3\n:alt: No caption\n:::",
    ],
    ids=["figure's label on a table", "theorem's label on a lemma", "no caption"],
)
def test_a_label_of_the_paper_in_the_wrong_place_stops_the_build(tmp_path, misplaced):
    with pytest.raises(ExtensionError, match="labels no numbered"):
        build(tmp_path / "book", f"{FIRST}\n\n{misplaced}\n")
