"""The companion of J. A. Lizarraga et al., Appl. Sci. 2025, 15, 5383: printed numbers and verdicts.

It calls `qbound`, which knows nothing of it; the book calls both.
"""
