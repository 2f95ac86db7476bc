"""Every job of the comparison, in the order in which they are asked."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec

PLANS = ("streams_plan", "machine_plan", "planar_plan", "solvers_plan")
"""Modules with a list of JOBS; one that is not there adds none."""

JOBS = [job for plan in PLANS if find_spec(plan) for job in import_module(plan).JOBS]
