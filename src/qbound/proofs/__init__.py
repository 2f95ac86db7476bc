"""Proofs: exact numbers, balls, cells and certificates that a checker accepts."""
