"""Paths through a region: traversals, what they meet, and when each joint is where."""
