"""The book's numbers: the paper's own where the paper has the object, N1, N2, ... elsewhere."""

import re
from pathlib import Path

import pytest
from bs4 import BeautifulSoup
from sphinx.errors import ExtensionError

from engine_support.pages import HTML, read
from support.trial_book import BOOK, build_book

# What the extensions call will leave Sphinx one day: their matter, not this book's.
pytestmark = pytest.mark.filterwarnings(
    "ignore:.*Sphinx:DeprecationWarning", "ignore:.*Sphinx:PendingDeprecationWarning"
)

CONF = """
extensions = ["myst_parser", "sphinx_proof", "paper_numbers"]
myst_enable_extensions = ["colon_fence", "dollarmath"]
numfig = nitpicky = True
numfig_format = {"figure": "Figure %s", "table": "Table %s"}
"""
INDEX = "# Book\n\n```{toctree}\nfirst\nsecond\n```\n"

# Labels in another order than the paper's, the book's own among them; references come first.
FIRST = r"""
# First

{eq}`eq:15` {eq}`eq:own` {eq}`eq:later` {numref}`fig:8a` {numref}`tab:own` {numref}`tab:4`
{prf:ref}`thm:2` {prf:ref}`lem:own` {numref}`plot %s <fig:8a>`

$$ c = d $$ (eq:own)

$$
\begin{aligned}
a &= b, \\
c &= d.
\end{aligned}
$$ (eq:15)

:::{figure} arm.svg
:name: fig:8a
:alt: Arm

The paper's.
:::

:::{list-table} Ours.
:name: tab:own

* - a
:::

:::{list-table} Fourth.
:name: tab:4

* - a
:::

:::{prf:theorem} Bounds
:label: thm:2
It holds.
:::

:::{prf:lemma}
:label: lem:own
It holds too.
:::
"""
SECOND = "# Second\n\n$$ e = f $$ (eq:later)\n"
SHOWN = "(15) (N1) (N2) Figure 8a Table N1 Table 4 Theorem 2 Lemma N1 plot 8a"
SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"><path d="M1 1h7"/></svg>'


def build(folder: Path, first: str) -> BeautifulSoup:
    """Build a book of two chapters as strictly as ours; return the first one."""
    files = {"conf.py": CONF, "index.md": INDEX, "first.md": first, "second.md": SECOND}
    for name, text in (files | {"arm.svg": SVG}).items():
        (folder / name).write_text(text, encoding="utf-8")
    html, warnings = build_book(folder, BOOK / "_ext", warningiserror=True, freshenv=True)
    assert warnings == ""
    return BeautifulSoup((html / "first.html").read_text(encoding="utf-8"), "html.parser")


def test_a_reference_shows_the_number_of_its_object_and_of_several_lines_one(tmp_path):
    page = build(tmp_path, FIRST)
    assert page.p.get_text(" ", strip=True) == SHOWN
    assert len(page.find(id="equation-eq-15").select(".eqno")) == 1


def test_an_object_of_the_paper_has_its_number_in_the_book_and_a_cells_table_is_a_table():
    found = {"equation": set(), "fig": set(), "tab": set(), "thm": set()}
    for file in sorted((HTML / "chapters").glob("*.html")):
        page = read(f"chapters/{file.name}")
        for place in page.find_all(id=re.compile(r"^(equation-eq|fig|tab)-\d+[a-z]?$|^thm:\d$")):
            kind, number = re.split(r"[-:]", place["id"])[0], re.split(r"[-:]", place["id"])[-1]
            said = place.select_one(".eqno, .caption-number").get_text().strip("¶# ")
            names = {"equation": f"({number})", "fig": f"Figure {number}"}
            names |= {"tab": f"Table {number}", "thm": f"Theorem {number}"}
            assert said == names[kind]
            assert kind != "tab" or place.select_one("td")
            assert place.select_one("figcaption td") is None
            found[kind].add(int(re.match(r"\d+", number)[0]))
    ends = {"equation": 39, "fig": 11, "tab": 6, "thm": 2}
    assert found == {kind: set(range(1, end + 1)) for kind, end in ends.items()}


@pytest.mark.parametrize(
    ("more", "complaint"),
    [
        ("$$ x = y $$ (eq:15)", "appears twice"),
        (":::{figure} arm.svg\n:name: fig:8a\n:alt: Arm\n\nAgain.\n:::", "appears twice"),
        (":::{list-table} Again.\n:name: tab:4\n\n* - a\n:::", "appears twice"),
        (":::{prf:theorem}\n:label: thm:2\nAgain.\n:::", "appears twice"),
        ("$$ x = y $$ (eq:later)", "duplicate label of equation eq:later"),
        (":::{list-table} A table.\n:name: fig:3\n\n* - a\n:::", "labels no numbered"),
        (":::{prf:lemma}\n:label: thm:1\nA lemma.\n:::", "labels no numbered"),
        (":::{image} arm.svg\n:name: fig:3\n:alt: No caption\n:::", "labels no numbered"),
    ],
)
def test_a_label_used_twice_or_in_the_wrong_place_stops_the_build(tmp_path, more, complaint):
    with pytest.raises((ExtensionError, AssertionError), match=complaint):
        build(tmp_path, f"{FIRST}\n\n{more}\n")
