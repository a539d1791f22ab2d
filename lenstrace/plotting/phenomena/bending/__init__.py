"""Pictures of the demonstrations of bending."""
