"""Run in Pyodide by `tools/live/node.mjs`: a chapter cell by cell, or tests of the library."""

import json
import os
import sys
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


def run_tests(arguments):
    """Run pytest on the mounted tests."""
    import pytest

    os.chdir("/")
    sys.path.insert(0, "/tests")
    return {"status": int(pytest.main([*arguments, "-p", "no:cacheprovider", "-q", "-ra"]))}


done = run_chapter(job["chapter"], job["cells"]) if "chapter" in job else run_tests(job["tests"])
Path("/results/done.json").write_text(json.dumps(done), encoding="utf-8")
0  # noqa: B018 - the exit status
