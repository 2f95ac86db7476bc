"""Settings of the property tests (the same examples on every run; `explore` looks for new ones),
and one browser for all tests that look at pages.
"""

import pytest
from hypothesis import settings

pytest.register_assert_rewrite("support")  # before its first import: its assertions show values

from support.browser import browser  # noqa: E402

__all__ = ["browser"]

settings.register_profile("steady", deadline=None, max_examples=40, derandomize=True)
settings.register_profile("explore", deadline=None, max_examples=1000)
settings.load_profile("steady")
