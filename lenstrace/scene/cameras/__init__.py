"""Cameras: which rays belong to a place in the picture."""
