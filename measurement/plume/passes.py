"""Passes through a plume: where each begins and ends, and which of them hit it."""

from collections.abc import Iterator

import numpy as np

from measurement.plume.arrays import Array

HIT = 0.6
"""Concentration at the peak of a pass, over that on the plume's own axis, from which it counts as a
hit [-].
"""

FOUND_WITHIN = 300.0
"""Time on the orbit within which the plume has to be found [s]."""


def passes(across: Array) -> Iterator[slice]:
    """Yield the samples of each pass: from half-way since the last change of sides to half-way to
    the next.

    A last change at once after the one before it makes no pass: it has no sample of its own.

    Parameters
    ----------
    across : distance from the plume's axis, positive on one side, not a number where there is no
        plume, shape (n,) [m]
    """
    change = np.flatnonzero(across[:-1] * across[1:] < 0.0)
    if not len(change):
        return
    middle = (change[:-1] + change[1:]) // 2 + 1
    begins = [max(0, 2 * change[0] - middle[0]) if len(middle) else 0, *middle]
    ends = [*middle, min(len(across), 2 * change[-1] - middle[-1]) if len(middle) else len(across)]
    yield from (
        slice(int(begin), int(end)) for begin, end in zip(begins, ends, strict=True) if end > begin
    )
