"""The vehicle in the closed loop, as the guidance sees it: six degrees of freedom in JSBSim, or the
paper's kinematics.
"""

from typing import Protocol

from gnc.estimation.navigation import EngineReadings, MeasuredMotion

SAMPLE_COLUMNS = (
    "altitude_m",
    "airspeed_mps",
    "roll_rad",
    "climb_rate_mps",
    "heading_rad",
    "pitch_rad",
    "alpha_rad",
    "sideslip_rad",
    "elevator",
    "aileron",
    "throttle",
    "rudder",
)
"""What a vehicle's ``sample`` returns, in order; NaN where it has no such thing. Controls
are commands [-], or the effect by which a surface is commanded whose travel is unequal
(``aircraft.controls``).
"""


class Vehicle(Protocol):
    """A vehicle under way, stepped at the rate of the guidance."""

    def motion(self) -> MeasuredMotion:
        """Return the motion now."""

    def air_data(self) -> tuple[float, float, float]:
        """Return the measurements of sensors on board: airspeed including gusts [m/s], heading, not
        wrapped, and roll [rad].
        """

    def engine(self) -> EngineReadings | None:
        """Return the measurements that show whether there is thrust; None for a vehicle without an
        engine.
        """

    def sample(self) -> tuple[float, ...]:
        """Return ``SAMPLE_COLUMNS``."""

    def advance(self, heading_rate: float, airspeed: float) -> None:
        """Fly one guidance step with these commands [rad/s, m/s]."""

    def command_altitude(self, altitude: float, /) -> object:
        """Let it climb or sink to an altitude [m] from now on."""

    def servo_error(self) -> float:
        """Return the largest distance of a control surface from its recent commands, over its
        travel [-]; once per step.
        """

    def hold_elevator(self) -> object:
        """Leave pitch to the vehicle's own stability from now on, so that turns have all the
        remaining control.
        """

    def fail(self, name: str) -> None:
        """Let a part fail from now on; raises ValueError if there is no such part."""

    def fault(self, sample: tuple[float, ...]) -> str:
        """Return why a vehicle with this ``sample`` is out of control, or nothing."""
