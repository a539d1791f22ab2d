"""Questions asked of a lens, each with a result dataclass."""
