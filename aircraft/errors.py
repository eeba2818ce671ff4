"""What can go wrong with an aircraft, each error naming the thing, its value, the limit and the
remedy.
"""


class AircraftError(ValueError):
    """An aircraft cannot be loaded, trimmed or linearised as asked."""


class UnknownPropertyError(AircraftError):
    """A JSBSim property does not exist. JSBSim itself would create it silently on writing."""


class ReadOnlyPropertyError(AircraftError):
    """A JSBSim property cannot be written. JSBSim itself would ignore the write silently."""


class TrimError(AircraftError):
    """No equilibrium was found."""
