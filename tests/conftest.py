"""Settings of the property tests (the same examples on every run; `explore` looks for new ones),
and one browser for all tests that look at pages.
"""

from browsers import browser
from hypothesis import settings

__all__ = ["browser"]

settings.register_profile("steady", deadline=None, max_examples=40, derandomize=True)
settings.register_profile("explore", deadline=None, max_examples=1000)
settings.load_profile("steady")
