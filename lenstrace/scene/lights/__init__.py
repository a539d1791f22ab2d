"""Lights: how each lights a point of the scene."""
