"""Commands called within the process, and the schemas that what they write has to follow."""

import json
import shlex
from importlib import resources
from typing import Any

import pytest
from jsonschema import Draft202012Validator, validate

from cspace.cli import main


def run(capsys: pytest.CaptureFixture[str], line: str, *words: str) -> tuple[Any, str, str]:
    """Run a line of the shell and further words; return status, output and complaints."""
    try:
        status: Any = main([*shlex.split(line), *words])
    except SystemExit as stop:  # argparse
        status = stop.code
    return (status, *capsys.readouterr())


def follows_schema(content: Any, name: str, package: str = "cspace") -> None:
    """Assert that a document, as JSON would hold it, follows the packaged schema of its name."""
    file = resources.files(package) / "schemas" / f"{name}.schema.json"
    schema = json.loads(file.read_text(encoding="utf-8"))
    validate(json.loads(json.dumps(content)), schema, Draft202012Validator)
