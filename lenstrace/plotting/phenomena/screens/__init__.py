"""Pictures of the demonstrations of phase screens."""
