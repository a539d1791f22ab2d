"""Demonstrations of what a lens is: its planes and its power, and the surfaces that image a point perfectly."""
