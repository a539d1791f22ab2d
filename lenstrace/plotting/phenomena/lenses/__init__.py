"""Pictures of the demonstrations of lenses."""
