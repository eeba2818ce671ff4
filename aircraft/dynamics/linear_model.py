"""The linear model of an aircraft, of its autopilot, or of both: matrices, and the names of what
they relate.

python-control analyses such models; they themselves need numpy alone, so that a flight whose
autopilot is already designed does not wait for it to be imported.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Matrix = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LinearModel:
    """A linear system x' = A x + B u, y = C x + D u, whose attributes have the names that
    python-control gives them.

    Attributes
    ----------
    A, B, C, D : shapes (n, n), (n, m), (p, n) and (p, m)
    state_labels, input_labels, output_labels : names of the n states, m inputs and p outputs
    """

    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix
    state_labels: tuple[str, ...]
    input_labels: tuple[str, ...]
    output_labels: tuple[str, ...]

    def poles(self) -> npt.NDArray[np.complex128]:
        """Return the eigenvalues of A [1/s]."""
        return np.linalg.eigvals(self.A).astype(np.complex128)

    def pick(
        self, states: Sequence[str], inputs: Sequence[str], outputs: Sequence[str]
    ) -> tuple[Matrix, Matrix, Matrix, Matrix]:
        """Return A, B, C and D of the named states, inputs and outputs, all else at rest."""
        rows = [self.state_labels.index(name) for name in states]
        columns = [self.input_labels.index(name) for name in inputs]
        reads = [self.output_labels.index(name) for name in outputs]
        return (
            self.A[np.ix_(rows, rows)],
            self.B[np.ix_(rows, columns)],
            self.C[np.ix_(reads, rows)],
            self.D[np.ix_(reads, columns)],
        )
