"""Demonstrations of straight lines: inside or outside, a room of mirrors, the light from shape to shape."""
