"""The pictures of the demonstrations: phenomena/G/NAME.py is drawn by plotting/phenomena/G/NAME.py."""
