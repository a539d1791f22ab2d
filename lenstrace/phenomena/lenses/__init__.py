"""Demonstrations of what a lens is: its cardinal points, its focal length, its aberrations and their cures."""
