"""The command ``cspace``: one thin module for each command; radians become degrees at the end.

- commands: `region`, `workspace`, `contains`, `why` (`connected` too), `traverse`, `fibre`,
  `sweep`, `allowed`, `certify`, `check`, `draw`, `explore`,
  `import` (`import_urdf`), `robots`;
- `chosen`: options for robot and slice, which several commands share; `values`: joint values
  as people type them; `terminal`: safe printing, a line of progress for long work, files written
  whole or not at all.
"""

import argparse
import gc
import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from itertools import chain, pairwise
from typing import Any, NoReturn

from cspace.cli.terminal import check_targets, complain, finish_output, plain_terminal, say, waiting
from cspace.files import refuse_replacing
from cspace.printable import printable

COMMANDS = {
    "region": "region",
    "workspace": "workspace",
    "contains": "contains",
    "why": "why",
    "connected": "why",
    "traverse": "traverse",
    "fibre": "fibre",
    "sweep": "sweep",
    "allowed": "allowed",
    "certify": "certify",
    "check": "check",
    "draw": "draw",
    "explore": "explore",
    "import": "import_urdf",
    "robots": "robots",
}
"""Module of each command, in the order of the help.

Only the command that is asked for is imported: all of them together take half a second."""

WRITTEN: Mapping[str, Sequence[str]] = {
    "output": (),
    "json": ("json",),
    "svg": ("svg",),
    "csv": ("csv",),
    "geojson": ("geojson", "json"),
    "npz": ("npz",),
    "disabled": ("srdf", "xml"),
}
"""Options, by what argparse calls them, that name files to write, each with the endings that fit.

So a slip replaces no file of another kind. Those of `output` a command sets as `endings`."""

READ = ("robot", "certificate", "path", "polygon", "urdf", "srdf", "specification")
"""Options that name files to read. All files are checked here, once for all commands."""

STOPPED, NO_READER = 130, 141
"""Exit status after Ctrl-C, and where nobody reads the output any more, as shells have it."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0 done or proved, 1 infeasible or refuted, 2 bad input, 3 undecided.

    Only `check` returns 3 for refuted and 2 for anything else, as `check.py` alone does.

    Without arguments the command is that of this process, which does nothing else (`_process`).
    """
    with plain_terminal():
        try:
            if arguments is not None:
                return _run(arguments)
            with _process():
                return _run(sys.argv[1:], before_work=_look_again)
        except BrokenPipeError:  # as in `cspace region ... | head`
            return NO_READER
        except (ValueError, OSError, ImportError) as error:
            from cspace.extras import explained

            complain(explained(error))
            from cspace.region import UnresolvedError  # slow, and few commands fail

            if isinstance(error, UnresolvedError):
                return 3
        except MemoryError:
            complain("this asks for more memory than there is")
        except KeyboardInterrupt:
            complain("stopped")
            return STOPPED
        except Exception:  # a bug must not look like an answer: Python's own status is 1
            import traceback

            for line in traceback.format_exc().splitlines():
                complain(line)
        return 2


@contextmanager
def _process() -> Iterator[None]:
    """Switch off work that a process of one command does not need, a quarter of its time.

    Garbage is not collected before and after the work, because what modules define stays. Idle
    threads of OpenBLAS, which NumPy starts, sleep at once; by default each spins for 30 ms first.
    No result depends on this.
    """
    os.environ.setdefault("OPENBLAS_THREAD_TIMEOUT", "4")
    gc.disable()
    try:
        yield
    finally:
        _look_again()


def _look_again() -> None:
    gc.freeze()  # else everything would be searched at once
    gc.enable()


def _run(words: Sequence[str], before_work: Callable[[], None] = lambda: None) -> int:
    _refuse_empty(words)
    if words and words[0] not in COMMANDS and not words[0].startswith("-"):
        raise ValueError(_no_command(words[0]))
    try:
        options = command_line(words[0] if words else None).parse_args(words)
        _check_files(vars(options))
        before_work()
        with waiting(f"cspace {words[0]}"):
            return int(options.run(options))
    finally:
        finish_output()


def _no_command(word: str) -> str:
    """Say that a word is no command, and which one is most like it."""
    from difflib import get_close_matches  # rarely needed

    near = get_close_matches(word, COMMANDS, 1)
    meant = f": did you mean {near[0]}?" if near else ";"
    return f"no command {word!r}{meant} cspace --help lists them"


def _refuse_empty(words: Sequence[str]) -> None:
    """Refuse empty arguments, because ``--json ""`` is a slip and not a missing option."""
    if words and not words[0]:
        raise ValueError("an empty value where a command is wanted; cspace --help lists them")
    for before, word in pairwise(["", *words]):
        option = word.startswith("-") and word.endswith("=")
        if not word or option:
            where = word.rstrip("=") or before
            raise ValueError(f"{where}: an empty value; give one, or leave the option out")


def _check_files(options: Mapping[str, Any]) -> None:
    """Refuse, before any work, files that cannot be written, that are read, or are others' work."""
    remedy = "choose another name" + (", or give --force" if "force" in options else "")
    written = {name: options.get(name) for name in WRITTEN}
    sources = [file for name in READ if isinstance(file := options.get(name), str)]
    check_targets([file for file in written.values() if isinstance(file, str)], sources=sources)
    for name, file in written.items():
        kinds = options.get("endings", ()) if name == "output" else WRITTEN[name]
        if isinstance(file, str) and file != "-":
            check_targets([file], kinds)
            if not options.get("force"):
                refuse_replacing(file, remedy)


def command_line(name: str | None = None) -> argparse.ArgumentParser:
    """Return the parser of the whole command, or only of `name` if it is one of our commands.

    For ``--version`` no command is imported, so that it answers even if a command is broken.
    """
    if name == "--version":
        return _parsers({})[0]
    return _parsers({name: COMMANDS[name]} if name in COMMANDS else None)[0]


def command_parsers() -> dict[str, argparse.ArgumentParser]:
    """Return the parser of each command, by its name; the book shows their help."""
    return _parsers()[1]


def _parsers(
    chosen: Mapping[str, str] | None = None,
) -> tuple[argparse.ArgumentParser, dict[str, argparse.ArgumentParser]]:
    parser = _Parser(prog="cspace", description="Feasible workspaces of robots.")
    parser.add_argument("--version", action=_Version)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for name in dict.fromkeys((COMMANDS if chosen is None else chosen).values()):
        import_module(f"cspace.cli.{name}").add_to(commands)
    if chosen is None:
        parser.epilog = "\n".join(_where_to_read())
    return parser, dict(commands.choices)


def _where_to_read() -> Iterator[str]:
    """Say where the formats and the manual are, for users who have only the package."""
    from importlib import metadata, resources

    schema = resources.files("cspace") / "schemas" / "robot.schema.json"
    yield f"robot file: every key is in {schema}"
    yield "  one to begin with: cspace robots show minervabot-v2"
    code = "from importlib.metadata import metadata as m; print(m('cspace').json['description'])"
    yield f'manual: python -c "{code}"'
    for url in metadata.metadata("cspace").get_all("Project-URL") or ():
        name, _, address = url.partition(", ")
        if name != "Paper":
            yield f"{name}: {address}"


class _Version(argparse.Action):
    """``--version``, computed only when it is needed, because the search is slow."""

    def __init__(self, option_strings: Sequence[str], dest: str) -> None:
        """Declare an option without a value."""
        text = "show program's version number and exit"
        super().__init__(option_strings, argparse.SUPPRESS, nargs=0, help=text)

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        """Print it and stop."""
        from cspace.version import __version__

        say(f"cspace {__version__}")
        parser.exit()


class _Parser(argparse.ArgumentParser):
    """A parser that takes ``-45deg`` for a value, and makes quoted arguments printable.

    The first of several values may also follow a ``=``.
    """

    def __init__(self, *names: Any, **options: Any) -> None:
        """Set the pattern of negative numbers, because argparse knows only plain ones."""
        super().__init__(*names, **{"formatter_class": _formatter} | options)
        self._negative_number_matcher = re.compile(r"-\.?\d")

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        words = sys.argv[1:] if args is None else args
        several = [a.option_strings for a in self._actions if isinstance(a.nargs, int) and a.nargs]
        names = {name for group in several for name in group}
        split = (w.split("=", 1) if w.partition("=")[0] in names else [w] for w in words)
        return super().parse_known_args([*chain.from_iterable(split)], namespace)

    def error(self, message: str) -> NoReturn:
        """Print the usage and the message, and stop with status 2."""
        super().error(printable(message))


def _formatter(prog: str) -> argparse.HelpFormatter:
    """Return the formatter of help, which keeps the lines of examples.

    argparse makes one for each option. Left to itself, each asks `shutil` for the width, which is
    slow to import.
    """
    columns = os.environ.get("COLUMNS", "")
    width = int(columns) if columns.isdecimal() else 0
    with suppress(OSError):
        width = width or os.get_terminal_size().columns
    return argparse.RawDescriptionHelpFormatter(prog, width=(width or 80) - 2)
