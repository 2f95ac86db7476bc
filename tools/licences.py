"""List the licence of everything that is installed here: Python's packages and JavaScript's.

`python3 run.py licences` calls this with the environment's Python. It fails on a licence that
licences.toml does not know, and on a package without one that is not listed there with a reason.
"""

import json
import re
import sys
import tomllib
from collections.abc import Callable, Iterable, Iterator
from importlib.metadata import Distribution, distributions
from pathlib import Path

HERE = Path(__file__).resolve().parent
RULES = tomllib.loads((HERE / "licences.toml").read_text(encoding="utf-8"))
NODE_MODULES = Path(sys.prefix, "javascript", "node_modules")

Package = tuple[str, str, list[str]]
"""Name, version, and the licences that the package states of itself."""


def stated(package: Distribution) -> list[str]:
    """Return the licence in the metadata: the expression (PEP 639), else classifiers or field."""

    def values(key: str) -> list[str]:
        return package.metadata.get_all(key) or []

    for expression in values("License-Expression"):
        return re.split(r"[\s()]+(?:AND|OR|WITH)[\s()]+", expression.strip("()"))
    classifiers = [text for text in values("Classifier") if text.startswith("License ::")]
    field = [text.strip().split("\n")[0] for text in values("License")]
    return [text.split(" :: ")[-1] for text in classifiers] or [text for text in field if text]


def python_packages() -> Iterator[Package]:
    for package in distributions():
        yield package.name, package.version, stated(package)


def javascript_packages(folder: Path) -> Iterator[Package]:
    for file in [*folder.glob("*/package.json"), *folder.glob("@*/*/package.json")]:
        content = json.loads(file.read_text(encoding="utf-8"))
        licence = content.get("license") or ""
        yield content["name"], content["version"], [s for s in licence.split(" OR ") if s]


def known_names(known: dict[str, list[str]]) -> Callable[[str], str | None]:
    """Return a function that gives a licence's usual name, or None if nobody has reviewed it."""
    names = {text.lower(): name for name, texts in known.items() for text in (name, *texts)}
    return lambda text: names.get(text.strip().lower())


def judge(package: Package) -> tuple[str, str]:
    """Return the licences of a package by their usual names, and what is wrong with them."""
    name, _, texts = package
    listed = RULES["listed"].get(name)
    if listed is not None:
        return f"{listed['licence']} (listed: {listed['reason']})", ""
    usual = known_names(RULES["known"])
    unknown = [text for text in texts if usual(text) is None]
    if unknown or not texts:
        return "", f"{name}: {'unknown: ' + ', '.join(unknown) if unknown else 'states no licence'}"
    return ", ".join(sorted({str(usual(text)) for text in texts})), ""


def report(packages: Iterable[Package]) -> tuple[list[str], list[str]]:
    """Return the lines of the list and the lines about what is wrong."""
    ordered = sorted(packages, key=lambda package: package[0].lower())
    judged = [(package, *judge(package)) for package in ordered]
    lines = [f"{name} {version}: {licence}" for (name, version, _), licence, _ in judged if licence]
    return lines, [wrong for _, _, wrong in judged if wrong]


def main() -> int:
    lines, wrong = report([*python_packages(), *javascript_packages(NODE_MODULES)])
    print("\n".join(lines))
    for line in wrong:
        print(f"{line}. Look at it, and say in tools/licences.toml what it is.", file=sys.stderr)
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
