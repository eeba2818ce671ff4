"""The point to be tracked: shapes of its orbit, where the orbit lies in the plume, and its motion."""

from gnc.reference.circling import CirclingReference
from gnc.reference.oscillating import OscillatingReference, Sinusoid
from gnc.reference.oscillation import Oscillation, design_oscillation
from gnc.reference.reference import REFERENCE_SHAPES, Orbit, Reference, ReferenceShape, ReferenceStart
from gnc.reference.steered import SteeredReference

__all__ = [
    "REFERENCE_SHAPES",
    "CirclingReference",
    "Orbit",
    "OscillatingReference",
    "Oscillation",
    "Reference",
    "ReferenceShape",
    "ReferenceStart",
    "Sinusoid",
    "SteeredReference",
    "design_oscillation",
]
