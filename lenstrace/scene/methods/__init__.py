"""Methods: how the light of a ray is found."""
