"""The built book with Python beside it; without that the tests of this folder are skipped."""

import os
import shutil
from pathlib import Path

import pytest

from live.readers import FIREFOX, chromium_reader, firefox_reader

ROOT = Path(__file__).resolve().parents[2]
REQUIRED = os.environ.get("QBOUND_REQUIRE_LIVE") == "1"  # set by .ci/live
HOW = "There is no Python beside the book: python3 run.py live puts it there."


def missing(why):
    if REQUIRED:
        pytest.fail(why)
    pytest.skip(why)


@pytest.fixture(scope="session")
def html():
    folder = Path(os.environ.get("QBOUND_LIVE_BOOK", ROOT / "book" / "_build" / "html"))
    return folder if (folder / "_live").is_dir() else missing(HOW)


@pytest.fixture(scope="session")
def files():
    folder = Path(os.environ.get("QBOUND_LIVE_FILES", ROOT / ".live"))
    return folder if (folder / "pyodide.mjs").is_file() else missing(HOW)


@pytest.fixture(params=["chromium", "firefox"])
def reader(request, html, tmp_path_factory):
    if request.param == "chromium":
        with chromium_reader() as reader:
            yield reader
    elif not any(map(shutil.which, FIREFOX)):
        missing("There is no Firefox here: apt-get install firefox-esr")
    else:
        with firefox_reader(tmp_path_factory.mktemp("firefox")) as reader:
            yield reader
