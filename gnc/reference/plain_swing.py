"""Courses of a shape of a user's own, answered in plain numbers."""

from gnc.reference.reference import Swing


class PlainSwing:
    """Courses of another swing; methods as of ``gnc.reference.reference.Swing``.

    Whatever it answers with, of NumPy or a list, these are plain numbers in tuples: a step computes with nothing else.

    Parameters
    ----------
    swing : the other one
    """

    __slots__ = ("_swing",)

    def __init__(self, swing: Swing) -> None:
        self._swing = swing

    def eta(self, speed_ratio: float) -> float:
        """Return the amplitude of a mean speed over speed [rad]."""
        return float(self._swing.eta(speed_ratio))

    def speed_ratio(self, eta: float) -> float:
        """Return the mean speed over speed of an amplitude [-]."""
        return float(self._swing.speed_ratio(eta))

    def frequency(self, eta: float, heading_rate: float) -> float:
        """Return the largest omega_0 within a heading rate and the roll rate [rad/s]."""
        return float(self._swing.frequency(eta, heading_rate))

    def course(self, eta: float, phase: float) -> float:
        """Return the course offset from the mean course [rad]."""
        return float(self._swing.course(eta, phase))

    def slopes(self, eta: float, phase: float) -> tuple[float, float]:
        """Return the slopes of the course offset over eta and over the phase [-]."""
        by_eta, by_phase = self._swing.slopes(eta, phase)
        return float(by_eta), float(by_phase)

    def offset(self, eta: float, phase: float) -> tuple[float, float]:
        """Return where the reference is from the orbit's centre, along the mean course and to its right [V_r/omega_0]."""
        along, right = self._swing.offset(eta, phase)
        return float(along), float(right)
