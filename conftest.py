"""Settings of the property tests, and one browser for all tests that look at pages.

For `tests` and `engine/tests`. The same examples on every run; the profile `explore` looks for
new ones.
"""

import gc

import pytest
from hypothesis import HealthCheck, Phase, settings

pytest.register_assert_rewrite("support", "engine_support")  # before their first import

from engine_support.browser import browser, open_quietly, tabs  # noqa: E402

__all__ = ["browser", "open_quietly", "tabs"]

# What the library and the parsed pages keep is looked through again and again, in vain.
gc.set_threshold(50_000, 20, 50)

# On a busy machine nothing is too slow.
PATIENT = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("steady", **PATIENT, max_examples=25, derandomize=True)
settings.register_profile("explore", **PATIENT, max_examples=1000)
# `mutants.py` wants a failure, and not the smallest one.
settings.register_profile(
    "unshrunk", settings.get_profile("steady"), phases=[Phase.explicit, Phase.generate]
)
settings.load_profile("steady")
