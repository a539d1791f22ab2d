"""Shapes in their own frame: vertex at the origin, axis +z. Each gives sag, normal and the crossing of a ray."""
