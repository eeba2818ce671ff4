"""Steering laws: each a frozen dataclass in a file of its own, registered by name, behind the
Protocol ``SteeringLaw``.

Those of the paper are here, those of autopilots and of the literature in ``gnc.laws.path``.
"""

from gnc.laws.steering_law import SteeringLaw

__all__ = ["SteeringLaw"]
