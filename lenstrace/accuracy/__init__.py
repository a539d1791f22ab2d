"""How exact a number is and what that costs; it knows no lens."""
