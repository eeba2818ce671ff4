"""What the steering laws on the delta formulation share: the look-ahead."""

from dataclasses import dataclass, field

from gnc.laws.delta import LookAhead, look_ahead
from gnc.laws.steering_law import check_parameters


@dataclass(frozen=True, slots=True, kw_only=True)
class DeltaLaw:
    """Base of a steering law on the relative state of the delta formulation.

    Attributes
    ----------
    epsilon_per_m : growth of the look-ahead with the squared distance [1/m]
    look_ahead_m : look-ahead on the reference, R [m], above 1/(4 epsilon)

    Raises
    ------
    ValueError : a parameter is not finite and above 0, or R is too short
    """

    epsilon_per_m: float = 0.005
    look_ahead_m: float = 60.0
    _look_ahead: LookAhead = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        check_parameters(self)
        object.__setattr__(self, "_look_ahead", look_ahead(self.epsilon_per_m, self.look_ahead_m))
