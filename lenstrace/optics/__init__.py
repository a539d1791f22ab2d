"""The shared physics: rays, shapes, media and the one law of interaction. Knows no lens and no scene."""
