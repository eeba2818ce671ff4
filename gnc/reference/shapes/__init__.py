"""The shapes that a reference's orbit about the centre of oscillation can have, a file each."""

from gnc.reference.reference import Orbit, ReferenceShape, Swing

__all__ = ["Orbit", "ReferenceShape", "Swing"]
