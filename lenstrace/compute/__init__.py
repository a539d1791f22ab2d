"""How data is declared, compiled and looped over; it knows no optics."""
