"""JavaScript in Node, called with JSON: the one way in which tests run it outside of a browser."""

from __future__ import annotations

import atexit
import json
import os
import shutil
import subprocess
import sys
from functools import cache
from itertools import count
from pathlib import Path
from typing import Any

import pytest

HOW_TO_GET_NODE = "Tests of JavaScript need Node: install nodejs from your system's packages."

SERVER = """
const vm = require("node:vm");
const scopes = new Map();
const lines = require("node:readline").createInterface({ input: process.stdin });
lines.on("line", (line) => {
  const { scope, code } = JSON.parse(line);
  if (!scopes.has(scope)) scopes.set(scope, vm.createContext({ URLSearchParams }));
  let answer;
  try {
    answer = { value: vm.runInContext(code, scopes.get(scope)) };
  } catch (error) {
    answer = { error: String(error) };
  }
  process.stdout.write(`${JSON.stringify(answer)}\\n`);
});
"""
"""Runs each line's code in the scope that it names and answers with a line of its own."""

_numbers = count()


class JavaScriptError(Exception):
    """A script has thrown an error."""


class Script:
    """A global scope with scripts in it, and nothing of a page.

    Parameters
    ----------
    *sources
        Text of classic scripts, which see each other's names.
    """

    def __init__(self, *sources: str) -> None:
        self.number = next(_numbers)
        for source in sources:
            self.read(source)

    def read(self, source: str) -> None:
        """Run one more script."""
        self._answer(f"{source}\n;0")

    def __call__(self, expression: str, **values: Any) -> Any:
        """Return the value of an expression, in which the given values have names."""
        names = ", ".join(values)
        given = ", ".join(json.dumps(value) for value in values.values())
        return self._answer(f"(({names}) => {expression})({given})").get("value")

    def _answer(self, code: str) -> dict[str, Any]:
        process = _node()
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(json.dumps({"scope": self.number, "code": code}) + "\n")
        process.stdin.flush()
        answer: dict[str, Any] = json.loads(process.stdout.readline())
        if "error" in answer:
            raise JavaScriptError(answer["error"])
        return answer


def find_node() -> str:
    """Return the environment's Node, from a wheel, or else the machine's.

    Without one the test is skipped, or fails where Node is required.
    """
    places = [str(Path(sys.executable).parent), os.environ.get("PATH", os.defpath)]
    path = shutil.which("node", path=os.pathsep.join(places))
    required = os.environ.get("CI") == "true" or os.environ.get("QBOUND_REQUIRE_NODE") == "1"
    if path is None and required:
        pytest.fail(HOW_TO_GET_NODE)
    return path or pytest.skip(HOW_TO_GET_NODE)


@cache
def _node() -> subprocess.Popen[str]:
    """Start the one Node of this process; at the end its input is closed, and it ends too."""
    process = subprocess.Popen(
        [find_node(), "--eval", SERVER],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        encoding="utf-8",
    )
    atexit.register(process.communicate)
    return process
