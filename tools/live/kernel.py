"""Cells of a chapter, run by Pyodide: output, figures, errors, and a comparison of the results.

A page and the tests in Node load this file as a module. It stands in for the few parts of IPython
and matplotlib-inline that the chapters import, because Jupyter itself does not run here.
"""

from __future__ import annotations

import builtins
import contextlib
import io
import json
import linecache
import sys
import time
import traceback
import types
from collections.abc import Iterator, Mapping
from functools import cache
from importlib import resources
from typing import Any

from pyodide.code import eval_code  # comes with the engine

SHOWN = {
    "_repr_svg_": "image/svg+xml",
    "_repr_html_": "text/html",
    "_repr_markdown_": "text/markdown",
    "_repr_latex_": "text/latex",
}
"""How an object shows itself, the best first; what has none of these shows its `repr`."""

ABSENT = {"fcl": "python-fcl", "shapely": "shapely", "skimage": "scikit-image"}
"""Libraries that cannot be had for a page, by the name that is imported."""


class Absent(types.ModuleType):
    """A library that is missing here: a cell may import it, and fails when it uses it."""

    def __getattr__(self, name: str) -> Any:
        """Return a function that fails when it is called."""
        if name.startswith("__"):
            raise AttributeError(name)

        def lacking(*_: object, **__: object) -> None:
            what = f"{ABSENT[self.__name__]} cannot be had inside a page"
            raise ModuleNotFoundError(what, name=self.__name__)

        return lacking


def import_for_cells(name: str, *rest: Any) -> Any:
    """Import as usual; an `Absent` for a missing library. The package still finds it missing."""
    top, _, below = name.partition(".")
    if top in ABSENT:
        named = bool(rest[2:3] and rest[2])  # "from top.below import ..."
        made = Absent(top)
        if below and not named:
            setattr(made, below, Absent(top))
        return made
    return builtins.__import__(name, *rest)


class Shown:
    """A text with a kind of output, as in `IPython.display`."""

    kind = "text/plain"

    def __init__(self, data: str | bytes) -> None:
        self.data = data.decode() if isinstance(data, bytes) else str(data)

    def __repr__(self) -> str:
        """Return the name of the kind, as in Jupyter."""
        return f"<IPython.core.display.{type(self).__name__} object>"

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        return {self.kind: self.data}


class Math(Shown):
    """A formula on a line of its own."""

    kind = "text/latex"

    def __init__(self, data: str) -> None:
        super().__init__(rf"$\displaystyle {data.strip('$')}$")


class Markdown(Shown):
    """Text with tables and formulas."""

    kind = "text/markdown"


class HTML(Shown):
    """A piece of a page; the page drops what could run or load anything."""

    kind = "text/html"


class SVG(Shown):
    """A picture."""

    kind = "image/svg+xml"


class Cells:
    """The cells of one chapter, in one namespace.

    Parameters
    ----------
    chapter : str
        Name of the chapter, such as ``region``; an empty one compares nothing.
    """

    def __init__(self, chapter: str) -> None:
        self.chapter = chapter
        self.outputs: list[dict[str, str]] = []
        self.compared: list[dict[str, Any]] = []
        names = vars(builtins) | {"__import__": import_for_cells}
        self.names: dict[str, Any] = {"__name__": "__main__", "__builtins__": names}
        self._stand_in()

    def run(self, number: int, source: str) -> str:
        """Run one cell; return its outputs, its error and the results that it recorded, as JSON.

        Parameters
        ----------
        number : int
            Of the cell in its chapter, from 0.
        source : str
        """
        self.outputs, self.compared = [], []
        start, error = time.perf_counter(), None
        with self._printed():
            try:
                self._run(f"cell {number + 1}", source)
            except BaseException as raised:  # SystemExit too: a page has nothing to leave
                error = told(raised)
            with contextlib.suppress(Exception):
                self._figures()
        seconds = time.perf_counter() - start
        result = {"outputs": self.outputs, "error": error, "compared": self.compared}
        return json.dumps(result | {"seconds": round(seconds, 3)})

    def _run(self, name: str, source: str) -> None:
        linecache.cache[f"<{name}>"] = len(source), None, source.splitlines(True), f"<{name}>"
        value = eval_code(source, self.names, self.names, filename=f"<{name}>")
        if value is not None:
            self.display(value)

    def display(self, *values: Any) -> None:
        """Show values, each by the best kind of output that it has."""
        sys.stdout.flush()
        for value in values:
            bundle = shown(value)
            if bundle:
                self.outputs.append(bundle)

    @contextlib.contextmanager
    def _printed(self) -> Iterator[None]:
        stream = Printed(self.outputs)
        with contextlib.redirect_stdout(stream), contextlib.redirect_stderr(stream):
            yield

    def _figures(self) -> None:
        """Show and close the figures that are open, as Jupyter does after a cell."""
        plt = sys.modules.get("matplotlib.pyplot")
        if plt is None:
            return
        for number in plt.get_fignums():
            self.outputs.append({"image/svg+xml": as_svg(plt.figure(number))})
        plt.close("all")

    def _stand_in(self) -> None:
        """Provide the parts of IPython and matplotlib-inline that the chapters import."""
        display = types.ModuleType("IPython.display")
        given: dict[str, Any] = {each.__name__: each for each in (Math, Markdown, HTML, SVG)}
        vars(display).update(given, display=self.display)
        ipython = types.ModuleType("IPython")
        vars(ipython).update(display=display, get_ipython=lambda: None, version_info=(9, 0))
        inline = types.ModuleType("matplotlib_inline")
        backend = types.ModuleType("matplotlib_inline.backend_inline")
        vars(backend).update(set_matplotlib_formats=lambda *_, **__: None)
        vars(inline).update(backend_inline=backend)
        for module in (display, ipython, inline, backend):
            module.__spec__ = types.SimpleNamespace(name=module.__name__)  # `find_spec` asks for it
            sys.modules[module.__name__] = module
        self.names["display"] = self.display

    def watch(self) -> None:
        """Compare each result with the recorded one, as soon as a chapter notes it."""
        from lizarraga2025.recorded import chapter_of  # noqa: PLC0415
        from lizarraga2025.results import Results, share_of_error  # noqa: PLC0415

        noted, cells = Results.add, self

        def add(self: Results, name: str, value: Any, unit: str, **settings: Any) -> Any:
            self.entries = [each for each in self.entries if each["id"] != name]  # run again
            given = noted(self, name, value, unit, **settings)
            if chapter_of(self.chapter) == cells.chapter:
                now, then = self.entries[-1], recorded_results(self.chapter).get(name)
                share = float("inf") if then is None else share_of_error(now, then)
                agrees = bool(share <= 1)
                cells.compared.append({"id": name, "agrees": agrees})
                if not agrees:
                    cells.compared[-1] |= {"now": now["value"], "then": then and then["value"]}
            return given

        Results.add = add  # type: ignore[method-assign]
        Results.save = lambda *_: None  # type: ignore[method-assign, assignment]


class Printed(io.TextIOBase):
    """A stream whose text becomes outputs, in order with all other outputs."""

    def __init__(self, outputs: list[dict[str, str]]) -> None:
        self.outputs = outputs

    def write(self, text: str) -> int:
        """Append to the last text output, if nothing else was shown after it."""
        if not (self.outputs and "stream" in self.outputs[-1]):
            self.outputs.append({"stream": ""})
        self.outputs[-1]["stream"] += text
        return len(text)


@cache
def recorded_results(name: str) -> dict[str, Mapping[str, Any]]:
    """Return the recorded results of a file, by id."""
    file = resources.files("lizarraga2025") / "recorded_results" / f"{name}.json"
    if not file.is_file():
        return {}
    return {each["id"]: each for each in json.loads(file.read_text(encoding="utf-8"))["results"]}


def shown(value: Any) -> dict[str, str]:
    """Return an object's output: the best kind that it knows."""
    if type(value).__name__ == "Figure" and "matplotlib.pyplot" in sys.modules:
        picture = {"image/svg+xml": as_svg(value)}
        sys.modules["matplotlib.pyplot"].close(value)
        return picture
    bundle = getattr(value, "_repr_mimebundle_", None)
    if callable(bundle):
        found = bundle(include=None, exclude=None)
        found = found[0] if isinstance(found, tuple) else found
        for kind in SHOWN.values():
            if kind in (found or {}):
                return {kind: found[kind]}
    for method, kind in SHOWN.items():
        text = getattr(value, method, lambda: None)() if not isinstance(value, type) else None
        if text is not None:
            return {kind: str(text)}
    return {"text/plain": repr(value)}


def as_svg(figure: Any) -> str:
    """Return a figure of matplotlib as the book prints it."""
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    return text.getvalue()


def told(error: BaseException) -> dict[str, Any]:
    """Return an error for the reader: message, cell and line, traceback."""
    frames = traceback.extract_tb(error.__traceback__)
    first = next((k for k, f in enumerate(frames) if f.filename.startswith("<cell ")), len(frames))
    kept = frames[first:]
    mine = [f for f in kept if f.filename.startswith("<cell ")]
    line = mine[-1].lineno if mine else getattr(error, "lineno", None)
    where = f"{mine[-1].filename.strip('<>')}, line {line}" if mine else ""
    trace = "".join(traceback.format_list(kept)) if len(kept) > len(mine) else ""
    missing = (getattr(error, "name", None) or "").partition(".")[0]
    if not isinstance(error, ModuleNotFoundError):
        missing = ""
    what = "".join(traceback.format_exception_only(error)).strip()
    lacks = {"missing": missing, "absent": ABSENT.get(missing, "")}
    return {"what": what, "where": where, "line": line, "trace": trace} | lacks
