"""The columns of a run's tables and their descriptions. A figure that a flight does not have is an
empty cell.

A new column is one entry here, or in the part that fills it (``scenarios.instruments``,
``scenarios.measures.window``, ``scenarios.studies``): the header of the file, ``columns.json``, the
page of the reference, and names and units in reports follow. "Settled" refers to the flight from
its settling time on.
"""

from common.columns import Column, described
from common.faults import fault_columns
from common.premises import PREMISE_COLUMNS, TRAFFIC_PREMISE_COLUMNS

FLIGHT_COLUMNS = described(
    {
        "flight_id": Column("name of the flight", title="Flight", kind="text"),
        "trial": Column("the scenario that the flight is of", kind="text"),
        "variant": Column("study, or the name of a comparison", kind="text"),
    }
)
"""Of every table: what names a flight."""

SPEED_RATIO = Column(
    "speed ratio through the air at the start: the vessel's speed over the UAV's",
    title="Speed ratio",
    symbol="ν",
)


SUMMARY_COLUMNS = described(
    {
        **FLIGHT_COLUMNS,
        "beside": Column(
            "flight of the study with the same start and air, if this one is of a comparison; else"
            " empty",
            kind="text",
        ),
        "outcome": Column(
            "completed, not_settled, incomplete, aircraft_lost, diverged, unexplained_violation,"
            " infeasible, trim_failed or failed",
            kind="text",
        ),
        "message": Column("the reason of an outcome other than completed", kind="text"),
        "criteria_met": Column(
            "whether the flight kept out, completed its mission and met every other criterion",
            kind="truth",
        ),
        "kept_out": Column(
            "whether it was outside of the keep-out area to its end, come back or not", kind="truth"
        ),
        "required": Column("what exit status 0 requires of it: criteria or keep_out", kind="text"),
        "aircraft": Column("the aircraft", kind="text"),
        "fidelity": Column("six_dof, or kinematic for the paper's vehicle", kind="text"),
        "seed": Column("seed of start, air and noise of this flight", digits=0),
        "nu": SPEED_RATIO,
        "nu_min": "least speed ratio over the vessel's track",
        "nu_max": "largest speed ratio over the vessel's track",
        "wind_speed_mps": Column(
            "mean wind at the height of the funnel, at the start", title="Wind speed", digits=1
        ),
        "wind_from_deg": Column(
            "direction that the wind comes from, clockwise from north", title="Wind from", digits=0
        ),
        "vessel_speed_mps": "speed of the vessel over the ground at the start",
        "turbulence": Column("level of the turbulence", kind="text"),
        "place_latitude_deg": "latitude of the vessel at time 0, where it is known",
        "place_longitude_deg": "longitude of the vessel at time 0, where it is known",
        "start_utc": Column("UTC of time 0, where it is known", kind="text"),
        "fault": Column("kind of the fault, of several of the first", kind="text"),
        "fault_time_s": "time at which that fault begins",
        "modes": Column(
            "modes of the guidance, in the order in which they first occurred", kind="text"
        ),
        "mode_at_end": Column("mode of the guidance at the end", kind="text"),
        "plume_heading_deg": "direction of the plume's axis, clockwise from the vessel's course, at"
        " the start",
        "plume_elevation_deg": "elevation of the plume's axis above the horizon",
        "start_distance_m": "horizontal distance of the start from the vessel",
        "start_aspect_deg": "bearing of the start, seen from the vessel, from the plume's axis",
        "eta": Column(
            "amplitude of the reference's course oscillation, in radians",
            title="Amplitude of the course",
            symbol="η",
            unit="rad",
            digits=4,
        ),
        "omega_0_rad_s": Column(
            "angular frequency of the oscillation",
            title="Frequency of the oscillation",
            symbol="ω₀",
            digits=4,
        ),
        "oscillation_limit": Column(
            "what set that frequency, as the heading rate or the roll rate", kind="text"
        ),
        "r_co_m": Column(
            "distance of the centre of oscillation from the funnel",
            title="Distance of the centre of oscillation",
            symbol="r_CO",
        ),
        "keepout_shape": Column(
            "sphere about the funnel's mouth, or cylinder about the vertical through it; hull, or"
            " hull prism of any height, where it is measured from the outline of the hull",
            kind="text",
        ),
        "keepout_radius_m": Column(
            "radius r_min of the keep-out area", title="Keep-out radius", symbol="r_min", digits=1
        ),
        "keepout_margin_m": Column(
            "planned margin between r_min and the orbit, for errors of estimates, reports and"
            " tracking",
            title="Planned margin",
        ),
        "keepout_violations": Column(
            "number of times that it entered the keep-out area, or that of another ship",
            title="Keep-out violations",
            digits=0,
            worse="higher",
            adds_up=True,
        ),
        "keepout_time_s": Column(
            "time in the keep-out area",
            title="Time in the keep-out area",
            digits=1,
            worse="higher",
            adds_up=True,
        ),
        "keepout_depth_m": Column(
            "largest depth inside the keep-out area, measured from its edge",
            title="Depth of the violation",
            worse="higher",
        ),
        "min_distance_m": Column(
            "closest approach to the centre of the sphere, to the axis of the cylinder, or to the"
            " outline of the hull",
            title="Closest approach",
            digits=1,
            worse="lower",
        ),
        "horizontal_distance_min_m": Column(
            "closest approach measured horizontally",
            title="Closest approach, horizontal",
            digits=1,
            worse="lower",
        ),
        "end_distance_m": Column(
            "distance at the end of the flight", title="Distance at the end", digits=0
        ),
        "settling_time_s": Column(
            "time from which it stayed within the settling band for one period",
            title="Settling time",
            digits=1,
            worse="higher",
            missing="not settled",
        ),
        "crossing_count": Column(
            "crossings of the straight axis along the apparent wind, seen from above, settled, with"
            " smoke or without",
            title="Plume crossings after settling",
            digits=0,
            adds_up=True,
        ),
        "crossing_interval_mean_s": Column(
            "mean time between crossings, over whole periods of the orbit",
            title="Mean crossing interval",
            digits=3,
        ),
        "crossing_interval_std_s": Column(
            "standard deviation of the time between crossings, over whole periods of the orbit",
            title="Deviation of the crossing interval",
            digits=3,
        ),
        "crossing_interval_predicted_s": Column(
            "pi/omega_0; beside a vessel that manoeuvres, its mean over the time of the mean"
            " interval",
            title="Predicted crossing interval",
            symbol="π/ω₀",
            digits=3,
        ),
        "crossing_distance_mean_m": Column(
            "mean distance of the crossings from the funnel, over whole periods of the orbit",
            title="Mean crossing distance",
            digits=1,
        ),
        "crossing_distance_min_m": Column(
            "least distance of a crossing from the funnel",
            title="Nearest crossing",
            digits=1,
            worse="lower",
        ),
        "crossing_clearance_min_m": Column(
            "least distance of a crossing outside of the keep-out area, negative inside",
            title="Nearest crossing, beyond r_min",
            digits=1,
            worse="lower",
        ),
        "crossing_angle_mean_deg": Column(
            "mean angle between path and axis at the crossings, over whole periods of the orbit, as"
            " seen from the vessel",
            title="Mean crossing angle",
            digits=1,
        ),
        "tracking_error_rms_m": Column(
            "root mean square distance to the reference, settled",
            title="Tracking error, rms after settling",
            worse="higher",
        ),
        "tracking_error_max_m": Column(
            "largest distance to the reference, settled",
            title="Tracking error, largest after settling",
            worse="higher",
        ),
        "tracking_error_end_m": Column(
            "distance to the reference at the end",
            title="Tracking error at the end",
            worse="higher",
        ),
        "spread_m": Column(
            "standard deviation of the tracking error towards the vessel, settled",
            title="Deviation towards the vessel",
        ),
        "spread_predicted_m": Column(
            "standard deviation of the tracking error towards the vessel, as predicted from"
            " turbulence alone",
            title="Deviation towards the vessel, from turbulence alone",
        ),
        "manoeuvre_end_s": "time at which the vessel's last manoeuvre ends",
        "manoeuvres_unflown": "manoeuvres of the vessel that begin after the end of the flight",
        "resume_time_s": Column(
            "time from the end of the vessel's last manoeuvre to the next crossing",
            title="Time to the next crossing after the last manoeuvre",
            digits=1,
            worse="higher",
        ),
        "resume_periods": Column(
            "resume_time_s in periods of the oscillation",
            title="Next crossing after the last manoeuvre",
            unit="periods",
            worse="higher",
        ),
        "airspeed_error_rms_mps": Column(
            "root mean square difference of the airspeed from its command, settled",
            title="Airspeed error, rms after settling",
            digits=3,
            worse="higher",
        ),
        "airspeed_error_max_mps": Column(
            "largest error of the airspeed, settled",
            title="Airspeed error, largest after settling",
            worse="higher",
        ),
        "airspeed_trim_rms_mps": "root mean square of what the airspeed law adds to the constant"
        " airspeed, settled",
        "airspeed_min_mps": "least airspeed of the flight",
        "airspeed_max_mps": "largest airspeed of the flight",
        "speed_max_mps": "largest speed over the ground",
        "altitude_error_rms_m": Column(
            "root mean square difference of the altitude from its command, settled",
            title="Altitude error, rms after settling",
            worse="higher",
        ),
        "altitude_error_max_m": Column(
            "largest error of the altitude, settled",
            title="Altitude error, largest after settling",
            worse="higher",
        ),
        "altitude_min_m": "least altitude of the flight",
        "bank_max_deg": Column(
            "largest bank of the flight", title="Largest bank", digits=1, worse="higher"
        ),
        "heading_rate_error_rms_rad_s": "root mean square difference of the heading rate from that"
        " of the reference, settled",
        "heading_rate_demand_max_rad_s": Column(
            "largest heading rate that the law demanded, before any limit",
            title="Largest demanded heading rate",
            digits=4,
        ),
        "heading_rate_command_max_rad_s": Column(
            "largest commanded heading rate, over every step of the guidance",
            title="Largest commanded heading rate",
            digits=4,
        ),
        "heading_rate_limit_rad_s": Column(
            "omega_max, to which commands are limited",
            title="Limit of the heading rate",
            symbol="ω_max",
            digits=4,
        ),
        "heading_rate_bound_rad_s": "bound on the demand over all states, if the law has one",
        "heading_rate_flown_max_rad_s": Column(
            "largest heading rate that was flown", title="Largest heading rate", digits=4
        ),
        "epsilon_per_m": Column(
            "parameter epsilon of the look-ahead, equation (15)", symbol="ε", digits=4
        ),
        "look_ahead_m": Column("radius R of the look-ahead, equation (15)", symbol="R"),
        "steering_max_rad_s": "bound of the law's steering term, if it has one",
        "saturation_fraction": "fraction of guidance steps whose demand was limited to omega_max",
        "guard_interventions": Column(
            "number of times that the keep-out guard changed commands",
            title="Interventions of the guard",
            digits=0,
            worse="higher",
            adds_up=True,
        ),
        "guard_time_s": Column(
            "total time in which the keep-out guard changed commands",
            title="Time guarded",
            digits=1,
            worse="higher",
            adds_up=True,
        ),
        "guard_after_settling_s": Column(
            "part of that time after settling",
            title="Time guarded after settling",
            digits=1,
            worse="higher",
            adds_up=True,
        ),
        "guard_lost_s": Column(
            "time in which no turn away held the guard's radius, by more than the declared errors"
            " explain",
            title="Time with the guard's radius lost",
            digits=1,
            worse="higher",
            adds_up=True,
        ),
        **PREMISE_COLUMNS,
        "wind_error_rms_mps": Column(
            "root mean square error of the estimated wind, settled",
            title="Error of the wind estimate, rms",
            worse="higher",
        ),
        "vessel_error_rms_m": Column(
            "root mean square error of the vessel's estimated position, settled",
            title="Error of the vessel's position, rms after settling",
            worse="higher",
        ),
        "vessel_error_max_m": Column(
            "largest error of the vessel's estimated position over the whole flight",
            title="Error of the vessel's position, largest",
            worse="higher",
        ),
        "centre_error_rms_m": Column(
            "root mean square distance of the orbit's centre from the centre of oscillation,"
            " settled",
            title="Error of the orbit's centre, rms after settling",
            worse="higher",
        ),
        "duration_s": Column("duration of the flight", title="Flight time", digits=1, adds_up=True),
        "wall_time_s": Column("computing time of the flight", title="Computing time", adds_up=True),
    }
)
"""Of ``summary.csv`` and ``comparison.csv``: a row per flight."""


HULL_COLUMNS = described(
    {
        "hull_length_m": Column("length of the ship", title="Length of the ship", digits=0),
        "hull_beam_m": Column("beam of the ship", title="Beam of the ship", digits=0),
        "stack_from_bow_m": Column("funnel from the bow", title="Funnel from the bow", digits=0),
        "stack_from_port_m": Column(
            "funnel from the port side", title="Funnel from the port side", digits=0
        ),
        "antenna_distance_m": Column(
            "distance of the antenna whose place is reported from the funnel",
            title="Antenna from the funnel",
            digits=0,
        ),
        "guarded_radius_m": Column(
            "distance from the funnel that keeps r_min at any heading of the ship",
            title="Guarded radius",
            digits=1,
        ),
    }
)
"""Of the summary, of flights beside a ship whose size is known."""


def further_faults(most: int) -> dict[str, Column]:
    """Return the summary's additional columns if flights have up to ``most`` faults."""
    declared: dict[str, Column | str] = {}
    for number in range(2, most + 1):
        kind, begins = fault_columns(number)
        declared[kind] = Column(f"kind of fault {number}, in the order of time", kind="text")
        declared[begins] = f"time at which fault {number} begins"
    return described(declared)


TRAFFIC_FIGURES = described(
    {
        "others_nearest": Column(
            "other ship whose radius the path came nearest to, or went farthest into",
            title="Nearest other ship",
            kind="text",
        ),
        "others_distance_min_m": Column(
            "closest approach to it, measured horizontally",
            title="Closest approach to another ship",
            digits=1,
            worse="lower",
        ),
        "others_clearance_min_m": Column(
            "closest approach to it beyond its radius, negative inside",
            title="Closest approach to another ship, beyond its radius",
            digits=1,
            worse="lower",
        ),
        "others_violations": Column(
            "entries into the areas of other ships, which count in keepout_violations as well",
            title="Entries into areas of other ships",
            digits=0,
            worse="higher",
            adds_up=True,
        ),
        "yielded_s": Column(
            "time in which the mission gave way to other ships",
            title="Time given way to other ships",
            digits=1,
            worse="higher",
            adds_up=True,
        ),
        **TRAFFIC_PREMISE_COLUMNS,
    }
)
"""More of them, of flights with ships besides the one that is measured."""

TRAFFIC_COLUMNS = described(
    {
        **FLIGHT_COLUMNS,
        "ship": Column("name of the other ship", title="Ship", kind="text"),
        "radius_m": Column("radius that is kept from it", title="Radius", digits=0),
        "distance_min_m": Column(
            "closest approach to it, measured horizontally", title="Closest approach", digits=1
        ),
        "time_s": Column("time of the sample nearest to that approach", title="At", digits=1),
        "violations": Column("entries into its area", title="Entries", digits=0, adds_up=True),
        "time_inside_s": Column("time in it", title="Time inside", digits=1, adds_up=True),
        "plume_s": Column(
            "time in its plume, within two spreads of the axis; empty of a ship that emits nothing",
            title="Time in its plume",
            digits=1,
            adds_up=True,
        ),
    }
)
"""Of ``traffic.csv``: a row per flight and ship besides the one that is measured, of those whose
track is known in the time of the flight."""

FINDING_COLUMNS = described(
    {
        "orbit_at_s": "time at which the UAV reached the orbit",
        "time_to_find_s": Column(
            "time on the orbit until the plume was first detected",
            title="Time to find the plume",
            digits=1,
            worse="higher",
            missing="not found",
        ),
        "found": Column("whether the plume was detected within 300 s on the orbit", kind="truth"),
        "axis_height_3min_m": "true height of the plume's axis at the crossing nearest to 180 s on"
        " the orbit",
        "axis_height_error_3min_m": "error of the estimated height there",
        "axis_height_deviation_3min_m": "standard deviation of the estimated height there",
        "hit_rate_found": "share of the crossings of the smoke's mean axis that hit the plume, as"
        " in hit_rate, after it was found",
        "axis_height_end_m": "estimated height of the axis at the end",
        "axis_deviation_end_m": "standard deviation of the estimated height of the axis at the end",
        "axis_measurable_end": "estimated probability at the end that the plume can be crossed"
        " within the limits of the altitude",
        "altitude_outside_s": Column(
            "time outside the limits of the altitude",
            title="Time outside the altitudes of the scenario",
            digits=1,
            worse="higher",
            adds_up=True,
        ),
        "enough": Column("why the flight ended early, or empty", kind="text"),
        "verdict_looks": Column(
            "looks of a flight that ends with a verdict, its end among them, at which there could"
            " be one",
            title="Looks at the verdict",
            digits=0,
        ),
        "verdict_guard": Column(
            "standard uncertainties from the limit that the last of them needed for a verdict;"
            " 1.645 is that of one look",
            title="Uncertainties from the limit that a verdict needs",
            digits=3,
        ),
    }
)
"""More of them, of flights that search for the plume, are given its true axis, or end with a
verdict.
"""

CROSSING_COLUMNS = described(
    {
        **FLIGHT_COLUMNS,
        "nu": SPEED_RATIO,
        "crossing": Column("number of the crossing, from 1", digits=0),
        "time_s": "time of the crossing",
        "axis_distance_m": "distance from the funnel along the plume's axis",
        "distance_m": "distance from the funnel",
        "horizontal_distance_m": "distance from the vertical through the funnel",
        "angle_deg": Column("angle between path and axis, as seen from the vessel", digits=1),
        "height_m": "height above a line from the funnel's mouth at plume.elevation_deg, level for"
        " smoke, which rises above it",
    }
)
"""Of ``crossings.csv``: a row per crossing."""

INTERVENTION_COLUMNS = described(
    {
        **FLIGHT_COLUMNS,
        "time_s": "time at which the keep-out guard began to change commands",
        "duration_s": Column("time for which it did", title="Duration", digits=1, adds_up=False),
        "distance_min_m": "least distance from the vessel's estimated position",
        "lost": Column("whether no turn away held the guard's radius for certain", kind="truth"),
    }
)
"""Of ``interventions.csv``: a row per stretch in which the keep-out guard changed commands."""

INPUT_COLUMNS = described(
    {
        **FLIGHT_COLUMNS,
        "nu": SPEED_RATIO,
    }
)
"""Of ``draws.csv``, before the keys that differ from flight to flight: a row per flight."""

ANY_KEY = Column("value of this key", kind="any")
"""Of ``draws.csv``: a key that differs from flight to flight."""

SEARCH_COLUMNS = described(
    {
        "search_method": Column("method that proposed the flight", kind="text"),
        "confirms": Column("flight that it repeats with other noise", kind="text"),
    }
)
"""Of ``draws.csv`` of a search, between these: the method that proposed the flight, or the flight
that it repeats.
"""

DERIVED_COLUMNS = described(
    {
        "clearance_m": Column(
            "closest approach beyond the flight's own r_min, negative inside",
            title="Distance kept beyond r_min",
            digits=1,
            worse="lower",
        ),
        "crossing_interval_error": Column(
            "relative difference of the mean crossing interval from pi/omega_0",
            title="Mean crossing interval off π/ω₀",
            unit="%",
            scale=100.0,
            worse="off zero",
        ),
        "crossing_clearance_m": Column(
            "least distance of a crossing outside of the keep-out area",
            title="Nearest crossing, beyond r_min",
            digits=1,
            worse="lower",
        ),
        "fsc_error_percent": Column(
            "difference of the sulphur content found from what a perfect instrument measures",
            title="Error of the sulphur content",
            digits=4,
            worse="off zero",
        ),
    }
)
"""Of no file: what statistics, reports and comparisons derive from columns of the summary."""
