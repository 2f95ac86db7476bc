"""What each install brings: README's commands in environments that hold only what it says."""

import ast
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
import venv
from collections.abc import Iterable
from importlib.metadata import distribution, packages_distributions
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from cspace import extras
from cspace.cli import command_parsers
from lizarraga2025.commands import command_parsers as companions

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
SMALL, ENGINE = PROJECTS = [
    tomllib.loads((ROOT / name / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    for name in (".", "engine")
]
BLOCKS = re.findall(r"(?s)```(\w+)\n(.*?)```", README)
LINES = [line for kind, text in BLOCKS if kind == "shell" for line in text.splitlines()]
PROGRAMS = ("cspace ", "lizarraga2025 ")
COMMANDS = [shlex.split(line, comments=True) for line in LINES if line.startswith(PROGRAMS)]
[PYTHON] = [text for kind, text in BLOCKS if kind == "python"]
[ROBOT] = [text for kind, text in BLOCKS if kind == "toml"]
CONSOLE = [line for kind, text in BLOCKS if kind == "console" for line in text.splitlines()]
[INSTALL] = [shlex.split(line)[2:] for line in LINES if line.startswith("pip install ")]


# --- environments ---------------------------------------------------------------------------------


def required(names: Iterable[str], *projects: dict) -> list[Requirement]:
    """What pip installs for projects with some extras, by each pyproject.toml."""
    wanted = [text for project in projects for text in project["dependencies"]]
    for name in names:
        for project in projects:
            wanted += project["optional-dependencies"].get(name, [])
    return [Requirement(text) for text in wanted if text != "qbound"]  # a wheel of our own


def closure(wanted: list[Requirement]) -> set[str]:
    """These distributions and all that they require here, by the metadata of what is installed."""
    found: set[tuple[str, frozenset[str]]] = set()
    todo = [(one.name, frozenset(one.extras)) for one in wanted]
    while todo:
        name, chosen = one = todo.pop()
        if one in found:
            continue
        found.add(one)
        for text in distribution(name).requires or ():
            needed = Requirement(text)
            cases = [{"extra": extra} for extra in ("", *chosen)]
            if needed.marker is None or any(needed.marker.evaluate(case) for case in cases):
                todo.append((needed.name, frozenset(needed.extras)))
    return {canonicalize_name(name) for name, _ in found}


class Environment:
    """A venv that installs are put in one after the other, as a reader does."""

    def __init__(self, place: Path) -> None:
        venv.create(place, symlinks=os.name != "nt", with_pip=False)
        self.place, self.bin = place, place / ("Scripts" if os.name == "nt" else "bin")
        self.work = place / "work"
        self.work.mkdir()
        where = "import sysconfig; print(sysconfig.get_path('purelib'))"
        self.site = Path(self.run("python", "-c", where).stdout.strip())

    def install(self, wheels: list[Path], needs: list[Requirement]) -> None:
        """Install wheels, and link the distributions that they require."""
        if wheels:
            options = ["install", "--quiet", "--no-index", "--no-deps", *wheels]
            pip = [sys.executable, "-m", "pip", "--python", self.place, *options]
            subprocess.run(pip, check=True, capture_output=True)
        for name in closure(needs):
            link(name, self.site)

    def run(self, program: str, *arguments: str) -> subprocess.CompletedProcess[str]:
        """Run a program of the environment, as in a shell in which it is active."""
        kept = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "MPL"))}
        path = os.pathsep.join([str(self.bin), kept.get("PATH", "")])
        command = [shutil.which(program, path=str(self.bin)) or program, *arguments]
        return subprocess.run(
            command,
            cwd=self.work,
            env=kept | {"PATH": path, "PYTHONNOUSERSITE": "1", "PYTHONUTF8": "1"},
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=False,
        )


def link(name: str, site: Path) -> None:
    """Put an installed distribution into another environment, by its own list of files."""
    files = distribution(name).files or []
    tops = {file.parts[0] for file in files} - {"..", "__pycache__", "bin", "share"}
    for top in tops:
        source, target = Path(str(distribution(name).locate_file(top))), site / top
        if not target.exists():
            target.symlink_to(source, target_is_directory=source.is_dir())


def build_wheels(folder: Path) -> list[Path]:
    """Build the wheels of both projects from a copy: building leaves files behind."""
    copy, made = folder / "copy", folder / "wheels"
    skip = shutil.ignore_patterns("*.egg-info", "__pycache__", "build", "tests", "benchmarks")
    for name in ("src", "engine", "results"):
        shutil.copytree(ROOT / name, copy / name, ignore=skip)
    for file in (path for path in ROOT.iterdir() if path.is_file()):
        shutil.copy(file, copy)
    build = "import sys, setuptools.build_meta as b; b.build_wheel(sys.argv[1])"
    command = [sys.executable, "-c", build, made]
    for project in (copy, copy / "engine"):
        subprocess.run(command, cwd=project, check=True, capture_output=True)
    return sorted(made.glob("*.whl"))


def extras_of(targets: list[str]) -> list[str]:
    """The extras of the engine in the words behind `pip install`."""
    [target] = [target for target in targets if target.startswith("./engine")]
    return sorted(Requirement(f"cspace{target.removeprefix('./engine')}").extras)


# --- README ---------------------------------------------------------------------------------------


def test_readme_shows_commands() -> None:
    assert len(COMMANDS) >= 4
    assert any("--svg" in command for command in COMMANDS)


SAYS = {
    "certify": (0, "proved: at every configuration of the set"),
    "check --source": (0, ""),
    "-I": (0, "proved: at every configuration of the set"),
    "import": (0, "29 balls, 193 pairs"),
    "why": (1, "falls into 3 ranges"),
    "check": (0, "proved: no path from (0, -90, 90, -90, -90, 0) to (0, -90, 270, -90, -90, 0)"),
}
"""Exit status of each command after the second install, and what it says."""


CALLS = {
    "scipy": "from cspace.proofs.subpaving.connection import joined; joined(2, [])",
    "tomlkit": "cspace.save_robot(robot, 'arm.toml')",
}
"""Calls that miss a library of an extra after the plain install."""


def test_each_install_of_readme_brings_what_its_commands_take(tmp_path: Path) -> None:
    """First the small library, then the engine, what README installs, and what proofs take."""
    engine, small = build_wheels(tmp_path)
    environment = Environment(tmp_path / "venv")
    environment.install([small], required([], SMALL))
    check_the_small_library_and_the_ledger(environment)
    environment.install([engine], required([], *PROJECTS))
    check_what_the_plain_install_lacks(environment)
    (environment.work / "arm.toml").write_text(ROBOT, encoding="utf-8")
    environment.install([], required(extras_of(INSTALL), *PROJECTS))
    for command in COMMANDS:
        done = environment.run(*command)
        assert (done.returncode, done.stderr) == (0, "")
        files = [word for word in command if word.endswith((".svg", ".html"))]
        assert all((environment.work / file).stat().st_size > 1000 for file in files)
    install, *commands = [shlex.split(line, comments=True) for line in CONSOLE if line.strip()]
    environment.install([], required(extras_of(install[2:]), *PROJECTS))
    check_the_commands_about_proofs_and_six_joints(environment, commands)


def check_the_small_library_and_the_ledger(paper: Environment) -> None:
    """They need no engine."""
    done = paper.run("python", "-W", "error", "-c", PYTHON)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("11.754 rad^2\n")
    assert "together: 241 entries" in paper.run("lizarraga2025", "claims").stdout
    assert paper.run("lizarraga2025", "results", "paper.area").returncode == 0
    done = paper.run("lizarraga2025", "claims", "--recompute", "--output", "claims.json")
    assert (done.returncode, done.stdout) == (2, "")
    assert "takes cspace, which is not installed" in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert list(paper.work.iterdir()) == []


def check_what_the_plain_install_lacks(plain: Environment) -> None:
    """It lacks every extra, and a call says how to install what it misses."""
    look = "import sys, importlib.util as u; print([m for m in sys.argv[1:] if u.find_spec(m)])"
    assert plain.run("python", "-c", look, "numpy", *extras.EXTRAS).stdout == "['numpy']\n"
    load = "import cspace.model.robot\nrobot = cspace.load_robot('minervabot-v2')\n"
    for module, call in CALLS.items():
        last = plain.run("python", "-c", load + call).stderr.splitlines()[-1]
        assert last == f"ModuleNotFoundError: {extras.how_to_install(module)}"


def check_the_commands_about_proofs_and_six_joints(
    environment: Environment, commands: list[list[str]]
) -> None:
    """In the folder where the reader has saved `arm.toml`, which stays as it was."""
    assert len(commands) == len(SAYS)
    for words, (called, (status, says)) in zip(commands, SAYS.items(), strict=True):
        assert " ".join(words[1:]).startswith(called)
        line, _, target = " ".join(words).partition(" > ")
        done = environment.run(*line.split())
        assert (done.returncode, done.stderr) == (status, "")
        assert says in done.stdout
        if target:
            (environment.work / target).write_text(done.stdout, encoding="utf-8")
        for word in words:
            if re.fullmatch(r"\w+\.(json|toml|py)", word):
                assert (environment.work / word).stat().st_size > 500
    assert (environment.work / "arm.toml").read_text(encoding="utf-8") == ROBOT


def test_readme_knows_the_extras_and_what_they_bring() -> None:
    _, _, table = README.partition("| extra |")
    rows = dict(re.findall(r"(?m)^\| `(\w+)` \| ([^|]*) \|", table))
    assert {extra.name for extra in extras.EXTRAS.values()} == rows.keys() - {"notebooks"}
    for extra in extras.EXTRAS.values():
        assert extra.library in rows[extra.name]


# --- help -----------------------------------------------------------------------------------------

PARSERS = command_parsers() | companions()
HELP = {name: parser.format_help() for name, parser in PARSERS.items()}
EXAMPLES = [
    (name, line.removeprefix("example: ").partition(" > ")[0])
    for name, text in HELP.items()
    for line in text.splitlines()
    if line.startswith("example: ")
]
SWEEP = """
schema = 2
robot = "minervabot-v2"
measure = ["region.area"]
vary = [{ number = "joint.q2.origin.0", from = 10, to = 20, count = 2 }]
"""
ALONE = (
    "import shlex, sys; sys.modules.update(dict.fromkeys(sys.argv[1].split()));"
    "from cspace.cli import main; from lizarraga2025.commands import main as companion;"
    "programs = {'cspace': main, 'lizarraga2025': companion};"
    "lines = map(shlex.split, sys.argv[2:]);"
    "print(*[programs[name](words) for name, *words in lines])"
)
"""Commands in a process that cannot import what its first argument lists; their statuses."""


def named(command: str) -> tuple[str, ...]:
    """The extras that the help of a command names."""
    return tuple(sorted(set(re.findall(r"(?:cspace|qbound)\[(\w+)\]", HELP[command]))))


def run_alone(folder: Path, extra: tuple[str, ...], *lines: str) -> tuple[set[str], str]:
    """Run commands where of all extras only these can be imported; return statuses and errors."""
    brought = closure(required(extra, ENGINE))
    homes = packages_distributions()
    barred = [m for m in extras.EXTRAS if not {canonicalize_name(n) for n in homes[m]} & brought]
    program = [sys.executable, "-c", ALONE, " ".join(barred), *lines]
    done = subprocess.run(program, cwd=folder, capture_output=True, text=True, check=False)
    return set(done.stdout.splitlines()[-1].split()), done.stderr


@pytest.mark.parametrize("extra", sorted({named(name) for name, _ in EXAMPLES}), ids=" ".join)
def test_examples_of_help_run_with_the_extras_that_their_help_names(tmp_path, extra) -> None:
    """And with no other: what a command takes besides, its help has to say."""
    (tmp_path / "lengths.toml").write_text(SWEEP, encoding="utf-8")
    lines = [line for name, line in EXAMPLES if named(name) == extra]
    if extra == named("check"):  # it needs a certificate
        words = "cspace certify minervabot-v2 --scale 0.96 -o cert.json"
        assert run_alone(tmp_path, named("certify"), words) == ({"0"}, "")
    statuses, errors = run_alone(tmp_path, extra, *lines)
    assert errors == ""
    assert statuses <= {"0", "1"}


def test_without_what_its_help_names_a_command_does_not_run(tmp_path, monkeypatch) -> None:
    monkeypatch.setitem(HELP, "import", "")
    answer = run_alone(tmp_path, named("import"), "cspace import ur5.urdf -o ur5.toml")
    assert answer == ({"2"}, f"cspace: {extras.how_to_install('lxml')}\n")


# --- what is missing ------------------------------------------------------------------------------


def test_the_sentence_names_the_extra() -> None:
    wanted = "a polygon of shapely takes shapely: pip install 'cspace[polygons]'"
    assert extras.how_to_install("shapely") == wanted
    assert extras.explained(ModuleNotFoundError(name="shapely.geometry")) == wanted
    assert extras.explained(ImportError("other", name="shapely")) == "other"
    assert extras.explained(ModuleNotFoundError("none", name="attic")) == "none"
    extras.require("shapely")


IN_NOTEBOOKS = {"IPython", "matplotlib_inline"}  # functions that a notebook calls need them


def imported(folder: str) -> set[str]:
    """Modules of others that a tree's packages import anywhere, also within functions."""
    found: set[str] = set()
    for file in (ROOT / folder).rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                found.add(node.module or "")
    ours = {"cspace", "lizarraga2025", "qbound"} | set(sys.stdlib_module_names)
    return {name.partition(".")[0] for name in found} - ours


def test_every_module_that_is_imported_comes_by_default_or_by_the_extra_it_is_said_to() -> None:
    homes = {
        module: {canonicalize_name(name) for name in names}
        for module, names in packages_distributions().items()
    }
    plain = closure(required([], *PROJECTS))
    optional = {module for module in imported("engine/cspace") if not homes[module] & plain}
    assert optional == extras.EXTRAS.keys()
    for module, extra in extras.EXTRAS.items():
        assert homes[module] & closure(required([extra.name], ENGINE))
    plain, notebooks = (closure(required(names, SMALL)) for names in ([], ["notebooks"]))
    for module in imported("src/qbound"):
        assert homes[module] & (notebooks if module in IN_NOTEBOOKS else plain), module
