"""Demonstrations of thin phase screens: one law for lenses, gratings, deformable mirrors and masses."""
