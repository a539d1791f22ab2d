"""The ways to answer a question about a lens that a trade compares, and the truth of each question."""
