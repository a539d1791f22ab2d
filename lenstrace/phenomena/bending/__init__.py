"""Demonstrations of light that bends, at a surface or in a medium that changes from place to place."""
