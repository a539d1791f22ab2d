"""The view factor of two squares with a smaller one halfway between them, in closed form.

Two unit squares face each other at the distance h; the screen, of side s, is in the middle and parallel to both. A ray
from (x, y) to (x + u, y + v) counts h^2 / (pi (u^2 + v^2 + h^2)^2), whatever x and y are. The x from which such a ray
begins and ends in the squares fill an interval of the length 1 - |u|; those from which it also meets the screen's
interval halfway, one of min(s, 1 - |u|). It is stopped where it does so in x and in y, so that with k for the kernel

    F = int int ((1 - |u|)(1 - |v|) - min(s, 1 - |u|) min(s, 1 - |v|)) k du dv.

Now min(s, 1 - |u|) is (1 - |u|) less the same of an interval of the length 1 - s, max(0, 1 - s - |u|), and the integral
of such products is P(a, b), the area times the view factor of two equal rectangles a by b at the distance h:

    F = P(1, 1) - (P(1, 1) - 2 P(1, 1 - s) + P(1 - s, 1 - s)) = 2 P(1, 1 - s) - P(1 - s, 1 - s).
"""

from __future__ import annotations

from lenstrace.phenomena.lines.howell import parallel_rectangles


def screened_squares(distance: float, screen: float) -> float:
    """Between two unit squares with a square screen halfway; screen: its side, at least 0 and below 1.

    >>> round(screened_squares(1.0, 0.5), 12)
    0.099506294599
    """
    rim = 1 - screen
    strip, square = parallel_rectangles(1, rim, distance), parallel_rectangles(rim, rim, distance)
    return rim * (2 * strip - rim * square)
