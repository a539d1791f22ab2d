"""Drawings of results: every function takes a result and an Axes, computes nothing, returns the Axes."""
