"""How the nearest of many primitives is found without asking them all."""
