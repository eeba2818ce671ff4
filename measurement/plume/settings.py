"""What can be chosen about a plume, with what the specification takes."""

from dataclasses import dataclass, fields

from measurement.errors import MeasurementError

SOURCE_HEIGHT_MIN, SOURCE_HEIGHT_MAX = 1.0, 200.0
"""Heights above the sea at which exhaust may leave a funnel [m]."""

_RANGES = {
    "richardson": (0.01, 2.0),
    "structure_intensity": (0.0, 1.0),
    "structure_length": (0.1, 3.0),
    "meander_length_across": (0.1, 20.0),
    "meander_length_up": (0.05, 5.0),
    "dissipation_height": (0.1, 10.0),
    "age_max": (10.0, 900.0),
    "parcel_interval": (0.1, 10.0),
}


@dataclass(frozen=True, kw_only=True)
class PlumeSettings:
    """Constants and options of a plume.

    Attributes
    ----------
    mean : the ensemble mean (regulatory Gaussian) instead of a realisation: no meander, spreads with that of the meander
    meander : whether the centre line of a realisation leaves the axis; without it a realisation is too high on the axis
    downwash : whether the stack's tip draws the plume down where the exhaust is slower than 1.5 of the apparent wind (AERMOD)
    richardson : C_r of the 4/3 law [-], 0.08 to 0.1 of Richardson's g = 0.5 (Boffetta and Sokolov); sensitivity 0.1 to 0.6
    structure_intensity : i, standard deviation over mean of the fluctuations within the plume [-]; 0 leaves them out.
        About 0.4 for a buoyant plume's axis, 0.2 to 0.8: an assumption
    structure_length : of these fluctuations, in relative spreads [-], 0.5 to 1: an assumption
    meander_length_across, meander_length_up : integral scales of the meander along the plume, in heights of the source [-]:
        2 to 3, and 0.5, for neutral air over sea, to a factor of 2 either way: assumptions
    dissipation_height : height at which the dissipation is taken, in heights of the source [-]. The specification says not
        which; its worked table follows from 2, where the axis is some hundred metres behind
    age_max : age up to which there is a plume [s]; the spreads hold below about 300 s
    parcel_interval : between parcels of the axis that is made of the ship's track [s]

    Raises
    ------
    MeasurementError : a value is out of its range
    """

    mean: bool = False
    meander: bool = True
    downwash: bool = True
    richardson: float = 0.1
    structure_intensity: float = 0.0
    structure_length: float = 0.7
    meander_length_across: float = 2.5
    meander_length_up: float = 0.5
    dissipation_height: float = 2.0
    age_max: float = 300.0
    parcel_interval: float = 1.0

    def __post_init__(self) -> None:
        for name in (field.name for field in fields(self)):
            value = getattr(self, name)
            low, high = _RANGES.get(name, (0, 1))
            if not low <= value <= high:
                raise MeasurementError(f"plume setting {name} is {value:g}; give {low:g} to {high:g}")
