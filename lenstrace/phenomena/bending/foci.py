"""Foci along a ray, by Coddington's equations: how often the light beside it has met before the path ends.

Light beside a ray runs toward points 1/V ahead on it, in the plane of incidence (tangential) and across it (sagittal).
With N the unit normal on the side of the light, C the curvature of the surface toward it, I the angle between both,

    n' cos^2 I' V' = n cos^2 I V + C (n' d'.N - n d.N)            (without the cosines across the plane)

and the second derivative of the optical path by a displacement u of one corner alone, its neighbours at the distances s
and s', is n cos^2 I / s + n' cos^2 I' / s' - C (n' d'.N - n d.N).
Source: W. T. Welford, Aberrations of Optical Systems (1986); the second from the path's length.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lenstrace.phenomena.bending.broken_path import BrokenPath, profile


class Foci(NamedTuple):
    """Of a path with B corners; the last axis is tangential, sagittal.

    second:    (B, 2), second derivatives of the optical path by each corner alone, 1/mm.
    terms:     (B, 2), the sum of the sizes of their three terms, 1/mm.
    bent:      (B, 2), n' (1/s' - V') behind each, 1/mm: negative where the next corner, or the end, is beyond a focus.
    """

    second: np.ndarray
    terms: np.ndarray
    bent: np.ndarray


def foci(path: BrokenPath) -> Foci:
    """See the docstring of this file."""
    normals = np.cross(path.tangents[:, 1], path.tangents[:, 0])
    normals = (path.rotation @ normals[:, :, None])[:, :, 0]
    before, behind = path.directions[:-1], path.directions[1:]
    side = np.sign((normals * before).sum(1))
    cosine, bent_cosine = ((d * normals).sum(1) * side for d in (before, behind))
    n, n_bent = path.index[:-1], path.index[1:]
    power = side[:, None] * _curvatures(path) * (n_bent * bent_cosine - n * cosine)[:, None]
    shares, bent_shares = (np.stack([c * c, np.ones_like(c)], -1) for c in (cosine, bent_cosine))
    shares, bent_shares = n[:, None] * shares, n_bent[:, None] * bent_shares
    lengths = path.lengths
    nearness = 1 / lengths[:, None] if path.near else np.append(0.0, 1 / lengths[1:])[:, None]

    vergence = -nearness[0] * np.ones(2)
    bent = []
    for i in range(len(power)):
        vergence = (shares[i] * vergence + power[i]) / bent_shares[i]
        bent.append(n_bent[i] * (nearness[i + 1] - vergence))
        vergence = vergence * nearness[i + 1] / (nearness[i + 1] - vergence)
    before, behind = shares * nearness[:-1], bent_shares * nearness[1:]
    return Foci(before + behind - power, abs(before) + abs(behind) + abs(power), np.array(bent))


def _curvatures(path: BrokenPath) -> np.ndarray:
    """(B, 2), of surfaces of revolution z = f(r), toward +z: f'' / (1 + f'^2)^(3/2) and f' / (r (1 + f'^2)^(1/2))."""
    r = abs(path.corners[:, 1])
    first, second = profile(path.shapes, r)
    slant = np.sqrt(1 + (r * first) ** 2)
    return np.stack([second / slant**3, first / slant], -1)
