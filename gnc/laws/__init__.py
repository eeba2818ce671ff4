"""Steering laws: each a frozen dataclass in a file of its own, registered by name, behind the Protocol ``SteeringLaw``.

Those of the paper are here, those of autopilots and of the literature in ``gnc.laws.path``.
"""

from gnc.laws.cascade import CascadeLaw
from gnc.laws.line_of_sight import LineOfSightLaw
from gnc.laws.lyapunov import LyapunovLaw
from gnc.laws.steering_law import STEERING_LAWS, SteeringLaw

__all__ = ["STEERING_LAWS", "CascadeLaw", "LineOfSightLaw", "LyapunovLaw", "SteeringLaw"]
