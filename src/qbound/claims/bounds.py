"""Bounds of the paper."""
