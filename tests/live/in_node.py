"""Run in Pyodide by `tools/live/node.mjs`: a chapter cell by cell, or tests of the library."""

import json
import os
import sys
import types
from pathlib import Path

job = json.loads(job_text)  # noqa: F821 - set by node.mjs


def run_chapter(name, cells):
    """Run the cells of a chapter as its page does, and return what came of each."""
    sys.path.insert(0, "/kernel")
    import kernel

    desk = kernel.Cells(name)
    desk.watch()
    answers = [json.loads(desk.run(number, source)) for number, source in cells]
    libraries = sorted({module.partition(".")[0] for module in sys.modules})
    return {"answers": answers, "libraries": libraries}


class Judge(types.ModuleType):
    """A library that cannot be had here: a test that asks it is skipped."""

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)

        def ask(*_, **__):
            import pytest

            pytest.skip(f"{self.__name__} cannot be had in Pyodide")

        return ask


def run_tests(arguments):
    """Run pytest on the mounted tests, without their conftest: it needs what looks at pages."""
    import pytest
    from hypothesis import settings

    settings.register_profile("steady", deadline=None, max_examples=25, derandomize=True)
    settings.load_profile("steady")
    sys.modules["shapely"] = Judge("shapely")
    os.chdir("/")
    sys.path.insert(0, "/engine/tests")
    options = ["--noconftest", "-p", "no:cacheprovider", "-q", "-ra"]
    return {"status": int(pytest.main([*arguments, *options]))}


done = run_chapter(job["chapter"], job["cells"]) if "chapter" in job else run_tests(job["tests"])
Path("/results/done.json").write_text(json.dumps(done), encoding="utf-8")
0  # noqa: B018 - the exit status
