"""The scene tracer: whatever is hit first, and pictures of it."""
