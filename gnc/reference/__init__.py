"""The point to be tracked: shapes of its orbit, where the orbit lies in the plume, and its motion.

The shapes and references themselves stand in files of their own: they need scipy, which takes long to import.
"""

from gnc.reference.reference import REFERENCE_SHAPES, Orbit, Reference, ReferenceShape, ReferenceStart

__all__ = ["REFERENCE_SHAPES", "Orbit", "Reference", "ReferenceShape", "ReferenceStart"]
