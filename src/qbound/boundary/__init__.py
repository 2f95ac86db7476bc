"""Boundary functions: from a robot to named harmonic forms."""
