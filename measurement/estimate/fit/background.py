"""What a record has beside the plume: a slow background of each channel, and the transient of each
segment's start.
"""

import math

import numpy as np

from measurement.estimate.fit.response import Poles, transients
from measurement.estimate.record import Record
from measurement.sniffer.lag import Array

STRAIGHT_MAX = 300.0
"""Duration up to which a background is a straight line [s]."""

KNOT_INTERVAL = 120.0
"""Between the knots of the background of a longer record, which is linear between them [s]."""

_INDEPENDENT = 1e-6
"""Size of a column, relative to the first, under which it says nothing that the others do not."""


def background_basis(record: Record, common: Poles, known: Array) -> Array:
    """Return an orthonormal basis of the background over all samples, shape (n, k); it is 0 where
    these are not ``known``.
    """
    time = record.time
    pieces = 1 if record.duration <= STRAIGHT_MAX else math.ceil(record.duration / KNOT_INTERVAL)
    place = (time - time[0]) / max(record.duration, 1e-9) * pieces
    columns = [np.maximum(0.0, 1.0 - np.abs(place - knot)) for knot in range(pieces + 1)]
    start = 0
    for segment in record.times:
        for transient in transients(segment, common).T:
            column = np.zeros(len(time))
            column[start : start + len(segment)] = transient
            columns.append(column)
        start += len(segment)
    # In a gap a knot may have no samples.
    columns = [column for column in (known * column for column in columns) if column.any()]
    if not columns:
        return np.zeros((len(time), 0))
    unit = np.stack([column / np.linalg.norm(column) for column in columns], axis=1)
    basis, sizes, _ = np.linalg.svd(unit, full_matrices=False)
    return np.asarray(basis[:, sizes > _INDEPENDENT * sizes[0]])


def without(basis: Array, signal: Array) -> Array:
    """Return what a signal has beside the background, shape as the signal's."""
    return np.asarray(signal - basis @ (basis.T @ signal))
