"""The colours of all pictures; lines have some that the colour-blind can tell apart."""

from __future__ import annotations

import numpy as np

# The palette of Okabe & Ito (2008), safe for the colour-blind, without the two that are lost on glass or paper.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#000000")
# More lines than that take an ordered scale, which is also safe.
MANY = "viridis"
GLASS, NEGATIVE_GLASS, OUTLINE = "#DCEBF7", "#F7DDE3", "#34495E"
MIRROR, STOP, SCREEN, IMAGE, AXIS = "#2B2B2B", "#000000", "#7F7F7F", "#2B2B2B", "#8C8C8C"


def colours(count: int) -> list[str]:
    """As many colours, distinguishable also by the colour-blind."""
    if count <= len(PALETTE):
        return list(PALETTE[:count])
    import matplotlib as mpl
    from matplotlib.colors import to_hex

    scale = mpl.colormaps[MANY]
    return [to_hex(scale(place)) for place in np.linspace(0, 0.9, count)]
