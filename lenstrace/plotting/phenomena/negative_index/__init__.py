"""Pictures of the demonstrations of negative index."""
