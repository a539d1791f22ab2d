"""Pictures of the demonstrations of straight lines."""
