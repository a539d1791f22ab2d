"""Ordered surfaces: the prescription, its numbers, tracing, launching, paraxial optics."""
