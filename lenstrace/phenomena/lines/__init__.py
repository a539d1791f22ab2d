"""Demonstrations of straight lines: which side a point is on, and inside of what."""
