"""Pictures of the demonstrations of what a lens is."""
