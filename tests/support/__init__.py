"""What several test files share; `tests/test_ground.py` sees that none imports another.

What the engine's tests need too is in `engine/tests/engine_support`.

`worlds`: other worlds for the ledger (`tests/lizarraga2025/worlds` has one for each entry).
"""
