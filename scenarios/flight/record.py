"""What is recorded of a flight: its columns, each with unit and meaning, and how the flight ended."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from common.columns import described
from common.text import did_you_mean
from scenarios.flight.interventions import Intervention
from scenarios.flight.outcome import Outcome

if TYPE_CHECKING:
    from measurement.estimate.repeated import RepeatedVerdict

Array = npt.NDArray[np.float64]

HISTORY_COLUMNS = described(
    {
        "time_s": "time since the start",
        "north_m": "place of the UAV over the ground, true",
        "east_m": "place of the UAV over the ground, true",
        "velocity_north_mps": "velocity over the ground, true",
        "velocity_east_mps": "velocity over the ground, true",
        "heading_rate_rad_s": "rate of the course through the air",
        "course_rad": "course over the ground, from -pi to pi",
        "vessel_north_m": "place of the vessel, true",
        "vessel_east_m": "place of the vessel, true",
        "vessel_velocity_north_mps": "velocity of the vessel over the ground, true",
        "vessel_velocity_east_mps": "velocity of the vessel over the ground, true",
        "plume_axis_rad": "course along which the plume trails, true",
        "reference_north_m": "place of the reference over the ground",
        "reference_east_m": "place of the reference over the ground",
        "reference_course_rad": "course of the reference through the air",
        "reference_heading_rate_rad_s": "rate of the reference's course",
        "centre_north_m": "centre of oscillation, as the guidance estimates it",
        "centre_east_m": "centre of oscillation, as the guidance estimates it",
        "centre_error_m": "distance of the orbit's centre from the centre of oscillation",
        "wind_north_mps": "velocity of the air mass, as estimated",
        "wind_east_mps": "velocity of the air mass, as estimated",
        "vessel_seen_north_m": "place of the vessel, as the guidance estimates it",
        "vessel_seen_east_m": "place of the vessel, as the guidance estimates it",
        "speed_ratio": "nu, as the guidance estimates it",
        "mode": "mode of the guidance, as an index into the manifest's modes",
        "heading_rate_demand_rad_s": "heading rate that the law demands, before any limit",
        "heading_rate_command_rad_s": "commanded heading rate",
        "airspeed_command_mps": "commanded airspeed",
        "altitude_command_m": "commanded altitude; far below the sea while a vehicle with a fault glides",
        "command_saturated": "1 while the demand is limited to omega_max",
        "guard": "1 while the keep-out guard changes commands, 2 while it cannot hold its radius",
        "altitude_m": "altitude above the sea",
        "airspeed_mps": "true airspeed, with gusts",
        "roll_rad": "roll",
        "climb_rate_mps": "climb rate",
        "heading_rad": "heading, from 0 to 2 pi",
        "pitch_rad": "pitch",
        "alpha_rad": "angle of attack",
        "sideslip_rad": "sideslip",
        "elevator": "elevator command, or its effect if it is commanded by that",
        "aileron": "aileron command, or its effect if it is commanded by that",
        "throttle": "throttle command",
        "rudder": "rudder command, or its effect if it is commanded by that",
        "delta_m": "look-ahead of the reference, equation (15)",
        "rho_m": "length of z, equation (16)",
        "phi_r_rad": "course of the reference against that of z, equation (19)",
        "phi_rad": "course through the air against that of z, equation (19)",
        "true_wind_north_mps": "velocity of the mean wind at the place and height of the UAV, true",
        "true_wind_east_mps": "velocity of the mean wind at the place and height of the UAV, true",
        "latitude_deg": "latitude of the UAV, true",
        "longitude_deg": "longitude of the UAV, true",
        "time_utc": "time in UTC",
    }
)
"""Columns of a time history, in order, and what each is. A vehicle's own, from ``altitude_m`` on,
may be not a number.
"""

RELATIVE_COLUMNS = ("delta_m", "rho_m", "phi_r_rad", "phi_rad")
"""The states of equation (19), in its order: they follow from the others."""

WIND_COLUMNS = ("true_wind_north_mps", "true_wind_east_mps")
"""The mean wind, of flights in wind: it follows from the scenario, too."""

PLACE_COLUMNS = ("latitude_deg", "longitude_deg", "time_utc")
"""Where and when on earth, of flights of which that is known: they follow from the others, too."""

COLUMNS = tuple(
    column
    for column in HISTORY_COLUMNS
    if column not in (*RELATIVE_COLUMNS, *WIND_COLUMNS, *PLACE_COLUMNS)
)
"""Columns of a flight's record."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightRecord:
    """What was flown.

    Attributes
    ----------
    outcome, message : how it ended, in a word and in a sentence
    mode : of the guidance at the end, or ``DITCHED``
    enough : why it left before its time, or nothing
    verdict : on the fuel by all looks of a flight that ends with one, or None
    settled_at : when it had settled, not a number if it never had [s]
    interventions : each time that the keep-out guard changed commands
    columns : of the histories: ``COLUMNS``, and those of the payload
    history : shape (samples, len(columns))
    every_step : the same of every step of the guidance, if that was recorded; otherwise ``history``
    saturation_fraction : fraction of guidance steps whose demand was cut at omega_max [-]
    heading_rate_demand_max, heading_rate_command_max : largest heading rate that the law asked for,
        and that was commanded, at any step of the guidance [rad/s]
    guard_time : for how long the guard changed commands, altogether [s]
    """

    outcome: Outcome
    message: str
    mode: str
    enough: str = ""
    verdict: "RepeatedVerdict | None" = None
    settled_at: float
    interventions: list[Intervention]
    columns: tuple[str, ...]
    history: Array
    every_step: Array
    saturation_fraction: float
    heading_rate_demand_max: float
    heading_rate_command_max: float
    guard_time: float

    def column(self, name: str) -> Array:
        """Return one column of the history.

        Raises
        ------
        ValueError : it has no such column
        """
        if name not in self.columns:
            raise ValueError(
                f"the flight's record has no column '{name}'{did_you_mean(name, self.columns)}"
            )
        return self.history[:, self.columns.index(name)]
