"""Thin things that add optical path W(x, y) to a ray that crosses them, and bend it by the slope of W."""
