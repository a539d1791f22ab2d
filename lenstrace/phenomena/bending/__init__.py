"""Demonstrations of light that bends at a surface, or on its way."""
