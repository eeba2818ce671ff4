"""What can be chosen about a plume, with what the specification takes."""

from dataclasses import dataclass, field, fields

from measurement.errors import MeasurementError

SOURCE_HEIGHT_MIN, SOURCE_HEIGHT_MAX = 1.0, 200.0
"""Heights above the sea at which exhaust may leave a funnel [m]."""


def _within(default: float, low: float, high: float) -> float:
    """Return the field of a number, with its default and its limits."""
    made: float = field(default=default, metadata={"limits": (low, high)})
    return made


@dataclass(frozen=True, kw_only=True)
class PlumeSettings:
    """Constants and options of a plume.

    Attributes
    ----------
    mean : the ensemble mean (regulatory Gaussian) instead of a realisation: no meander, spreads
        with that of the meander
    meander : whether the centre line of a realisation leaves the axis; without it a realisation is
        too high on the axis
    downwash : whether the stack's tip draws the plume down where the exhaust is slower than 1.5 of
        the apparent wind (AERMOD)
    richardson : C_r of the 4/3 law [-]; 0.08 to 0.1 follow from Richardson's g = 0.5 (Boffetta and
        Sokolov), and results depend on it between 0.1 and 0.6
    structure_intensity : standard deviation over mean of the fluctuations within the plume [-]; 0
        leaves them out. About 0.4 on the axis of a buoyant plume, 0.2 to 0.8: an assumption
    structure_length : length of the fluctuations within the plume, in relative spreads [-]; 0.5 to
        1 are plausible: an assumption
    meander_length_across : integral scale of the meander to the sides along the plume, in heights
        of the source [-]; 2 to 3 for neutral air over sea, to a factor of 2 either way: an
        assumption
    meander_length_up : integral scale of the meander in height along the plume, in heights of the
        source [-]; 0.5 for neutral air over sea, to a factor of 2 either way: an assumption
    dissipation_height : height at which the dissipation is taken, in heights of the source [-]. The
        specification says not which; its worked table follows from 2, where the axis is some
        hundred metres behind
    age_max : age up to which there is a plume [s]; the spreads hold below about 300 s
    parcel_interval : time between parcels of the axis that is made of the ship's track [s]

    Raises
    ------
    MeasurementError : a value is out of its range
    """

    mean: bool = False
    meander: bool = True
    downwash: bool = True
    richardson: float = _within(0.1, 0.01, 2.0)
    structure_intensity: float = _within(0.0, 0.0, 1.0)
    structure_length: float = _within(0.7, 0.1, 3.0)
    meander_length_across: float = _within(2.5, 0.1, 20.0)
    meander_length_up: float = _within(0.5, 0.05, 5.0)
    dissipation_height: float = _within(2.0, 0.1, 10.0)
    age_max: float = _within(300.0, 10.0, 900.0)
    parcel_interval: float = _within(1.0, 0.1, 10.0)

    def __post_init__(self) -> None:
        for of in fields(self):
            value = getattr(self, of.name)
            low, high = of.metadata.get("limits", (0, 1))
            if not low <= value <= high:
                raise MeasurementError(f"{of.name} is {value:g}; give {low:g} to {high:g}")
