"""Demonstrations of materials whose refractive index is negative."""
