"""Files: the native prescription in TOML."""
