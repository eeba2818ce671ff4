"""What the columns of a run's tables mean, by table and name. Time histories have theirs in
``scenarios.simulation``.

Units are the ends of the names. "Settled" is said of the flight from its settling time on.
"""

from collections.abc import Mapping

from common.premises import EXCEEDED, TERMS, ratio_column, time_column
from common.run_layout import (
    COMPARISON,
    CROSSINGS,
    DRAWS,
    INTERVENTIONS,
    SULPHUR_TABLE,
    SUMMARY,
    TUNING_TABLE,
    WINDOW_TABLE,
)

_OF_FLIGHT = {
    "flight_id": "name of the flight",
    "trial": "the scenario that the flight is of",
    "variant": "study, or the name of a comparison",
}
"""Of several tables."""

_OF_POINT = {
    **_OF_FLIGHT,
    "nu": "speed ratio through the air at the start: the vessel's speed over the UAV's",
}

_PLANNED = {
    "beside": "flight of the study with the same start and air, if this one is of a comparison; else empty",
    "aircraft": "the aircraft",
    "fidelity": "six_dof, or kinematic for the paper's vehicle",
    "seed": "seed of start, air and noise of this flight",
    "nu_min": "least speed ratio over the vessel's track",
    "nu_max": "largest speed ratio over the vessel's track",
    "wind_speed_mps": "mean wind at the height of the funnel, at the start",
    "wind_from_deg": "direction that the wind comes from, clockwise from north",
    "vessel_speed_mps": "speed of the vessel over the ground at the start",
    "turbulence": "level of the turbulence",
    "place_latitude_deg": "latitude of the vessel at time 0, where it is known",
    "place_longitude_deg": "longitude of the vessel at time 0, where it is known",
    "start_utc": "UTC of time 0, where it is known",
    "fault": "kind of the fault",
    "fault_time_s": "time at which the fault begins",
    "plume_heading_deg": "direction of the plume's axis, clockwise from the vessel's course, at the start",
    "plume_elevation_deg": "elevation of the plume's axis above the horizon",
    "start_distance_m": "horizontal distance of the start from the vessel",
    "start_aspect_deg": "bearing of the start, seen from the vessel, from the plume's axis",
    "eta": "amplitude of the reference's course oscillation, in radians",
    "omega_0_rad_s": "angular frequency of the oscillation",
    "oscillation_limit": "what set that frequency, as the heading rate or the roll rate",
    "r_co_m": "distance of the centre of oscillation from the funnel",
    "keepout_shape": "sphere about the funnel's mouth, or cylinder about the vertical through it",
    "keepout_radius_m": "radius r_min of the keep-out area",
    "keepout_margin_m": "planned margin between r_min and the orbit, for errors of estimates, reports and tracking",
    "crossing_interval_predicted_s": "pi/omega_0; beside a vessel that manoeuvres, its mean over the time of the mean interval",
    "spread_predicted_m": "standard deviation of the tracking error towards the vessel, as predicted from turbulence alone",
    "manoeuvre_end_s": "time at which the vessel's last manoeuvre ends",
    "manoeuvres_unflown": "manoeuvres of the vessel that begin after the end of the flight",
    "heading_rate_limit_rad_s": "omega_max, to which commands are limited",
    "heading_rate_bound_rad_s": "bound on the demand over all states, if the law has one",
    "epsilon_per_m": "parameter epsilon of the look-ahead, equation (15)",
    "look_ahead_m": "radius R of the look-ahead, equation (15)",
    "steering_max_rad_s": "bound of the law's steering term, if it has one",
}
"""Known before the flight, of ``summary.csv`` and ``comparison.csv``."""

_PREMISES = {
    name: meaning
    for term, what in TERMS.items()
    for name, meaning in (
        (ratio_column(term), f"largest error over what the guard reckons with: {what}"),
        (time_column(term), "time of that ratio; of turns, at which the turn began"),
    )
}
"""How the premises of the guard's theorem held."""

_MEASURED = {
    "outcome": "completed, not_settled, incomplete, aircraft_lost, diverged, unexplained_violation, infeasible, trim_failed or failed",
    "message": "the reason of an outcome other than completed",
    "criteria_met": "whether the flight kept out, completed its mission and met every other criterion",
    "kept_out": "whether it kept out of the keep-out area and was observed to its end",
    "required": "what exit status 0 requires of it: criteria or keep_out",
    "modes": "modes of the guidance, in the order in which they first occurred",
    "mode_at_end": "mode of the guidance at the end",
    "keepout_violations": "number of times that it entered the keep-out area",
    "keepout_time_s": "time in the keep-out area",
    "keepout_depth_m": "largest depth inside the keep-out area, measured from its edge",
    "min_distance_m": "closest approach to the centre of the sphere, or to the axis of the cylinder",
    "horizontal_distance_min_m": "closest approach measured horizontally",
    "end_distance_m": "distance at the end of the flight",
    "settling_time_s": "time from which it stayed within the settling band for one period",
    "crossing_count": "crossings of the straight axis along the apparent wind, seen from above, settled, with smoke or without",
    "crossing_interval_mean_s": "mean time between crossings, over whole periods of the orbit",
    "crossing_interval_std_s": "standard deviation of the time between crossings, over whole periods of the orbit",
    "crossing_distance_mean_m": "mean distance of the crossings from the funnel, over whole periods of the orbit",
    "crossing_distance_min_m": "least distance of a crossing from the funnel",
    "crossing_clearance_min_m": "least distance of a crossing outside of the keep-out area, negative inside",
    "crossing_angle_mean_deg": "mean angle between path and axis at the crossings, over whole periods of the orbit, as seen from the vessel",
    "tracking_error_rms_m": "root mean square distance to the reference, settled",
    "tracking_error_max_m": "largest distance to the reference, settled",
    "tracking_error_end_m": "distance to the reference at the end",
    "spread_m": "standard deviation of the tracking error towards the vessel, settled",
    "resume_time_s": "time from the end of the vessel's last manoeuvre to the next crossing",
    "resume_periods": "resume_time_s in periods of the oscillation",
    "airspeed_error_rms_mps": "root mean square difference of the airspeed from its command, settled",
    "airspeed_error_max_mps": "largest error of the airspeed, settled",
    "airspeed_trim_rms_mps": "root mean square of what the airspeed law adds to the constant airspeed, settled",
    "airspeed_min_mps": "least airspeed of the flight",
    "airspeed_max_mps": "largest airspeed of the flight",
    "speed_max_mps": "largest speed over the ground",
    "altitude_error_rms_m": "root mean square difference of the altitude from its command, settled",
    "altitude_error_max_m": "largest error of the altitude, settled",
    "altitude_min_m": "least altitude of the flight",
    "bank_max_deg": "largest bank of the flight",
    "heading_rate_error_rms_rad_s": "root mean square difference of the heading rate from that of the reference, settled",
    "heading_rate_demand_max_rad_s": "largest heading rate that the law demanded, before any limit",
    "heading_rate_command_max_rad_s": "largest commanded heading rate, over every step of the guidance",
    "heading_rate_flown_max_rad_s": "largest heading rate that was flown",
    "saturation_fraction": "fraction of guidance steps whose demand was limited to omega_max",
    "guard_interventions": "number of times that the keep-out guard changed commands",
    "guard_time_s": "total time in which the keep-out guard changed commands",
    "guard_after_settling_s": "part of that time after settling",
    "guard_lost_s": "time in which no turn away held the guard's radius, by more than the declared errors explain",
    EXCEEDED: "premises of the guard's theorem that did not hold: terms with a ratio above 1, or none",
    **_PREMISES,
    "wind_error_rms_mps": "root mean square error of the estimated wind, settled",
    "vessel_error_rms_m": "root mean square error of the vessel's estimated position, settled",
    "vessel_error_max_m": "largest error of the vessel's estimated position over the whole flight",
    "centre_error_rms_m": "root mean square distance of the orbit's centre from the centre of oscillation, settled",
    "duration_s": "duration of the flight",
    "wall_time_s": "computing time of the flight",
}
"""Measured, of ``summary.csv`` and ``comparison.csv``."""

_OF_SNIFFER = {
    "sensor": "preset of the sniffer, or the title of one's own",
    "fsc_fuel_percent": "sulphur in the fuel, by mass",
    "fsc_expected_percent": "fuel sulphur content that a perfect instrument measures",
    "sulphur_limit_percent": "limit of the sulphur content on which the verdict is given",
    "fsc_percent": "fuel sulphur content by regression",
    "fsc_uncertainty_percent": "standard uncertainty of the fuel sulphur content",
    "fsc_noise_percent": "part of the uncertainty that a longer measurement reduces",
    "fsc_common_percent": "part of the uncertainty that a longer measurement does not reduce",
    "fsc_low_percent": "lower end of the 95 % interval",
    "fsc_high_percent": "upper end of the 95 % interval",
    "areas_fsc_percent": "fuel sulphur content by areas",
    "areas_fsc_uncertainty_percent": "standard uncertainty of the fuel sulphur content by areas",
    "areas_fsc_separate_percent": "fuel sulphur content by areas if passes did not overlap",
    "areas_fsc_noise_percent": "part of that uncertainty that a longer measurement reduces",
    "areas_fsc_low_percent": "lower end of the 95 % interval",
    "areas_fsc_high_percent": "upper end of the 95 % interval",
    "sulphur_quality": "class A, B or C of the result",
    "sulphur_reason": "reason for a class other than A",
    "sulphur_verdict": "above, below or open",
    "probability_above": "probability that the fuel is above the limit",
    "verdict_2min": "verdict after two minutes",
    "verdict_time_s": "time from which on the verdict does not change any more",
    "co2_signal_to_noise": "signal-to-noise ratio of the CO2 readings",
    "so2_signal_to_noise": "signal-to-noise ratio of the SO2 readings",
    "sulphur_suspect": "whether payload.rule reports the ship as suspect; empty without a rule, or of quality C",
    "suspect_false_alarm": "share of fuels at the rule's limit that it reports, with this uncertainty",
    "suspect_miss": "share of fuels of twice that limit that it does not report, with this uncertainty",
    "plume_axis_crossings": "crossings of the smoke's mean axis seen from above, in the time evaluated, with smoke or without",
    "smoke_passes": "of those crossings the ones with smoke: once above exp(-2) of the concentration in the plume's centre",
    "hit_rate": "of those crossings the share whose peak is above 0.6 of the concentration in the centre of the plume",
    "seconds_in_plume_s": "time in which the concentration is above exp(-2) of that on the axis",
    "dose_per_pass_ppm_s": "mean over plume_axis_crossings, with smoke or without, of the integral of CO2 above clean air",
    "axis_height_error_mean_m": "mean height of plume_axis_crossings above the plume's own axis",
    "axis_height_error_rms_m": "root mean square height of plume_axis_crossings above the plume's own axis",
}
"""Of flights with a sniffer."""

_OF_SEARCH = {
    "orbit_at_s": "time at which the UAV reached the orbit",
    "time_to_find_s": "time on the orbit until the plume was first detected",
    "found": "whether the plume was detected within 300 s on the orbit",
    "axis_height_3min_m": "true height of the plume's axis at the crossing nearest to 180 s on the orbit",
    "axis_height_error_3min_m": "error of the estimated height there",
    "axis_height_deviation_3min_m": "standard deviation of the estimated height there",
    "hit_rate_found": "share of the crossings of the smoke's mean axis that hit the plume, as in hit_rate, after it was found",
    "axis_height_end_m": "estimated height of the axis at the end",
    "axis_deviation_end_m": "standard deviation of the estimated height of the axis at the end",
    "axis_measurable_end": "estimated probability at the end that the plume can be crossed within the limits of the altitude",
    "altitude_outside_s": "time outside the limits of the altitude",
    "enough": "why the flight ended early, or empty",
    "verdict_looks": "looks of a flight that ends with a verdict, its end among them, at which there could be one",
    "verdict_guard": "standard uncertainties from the limit that the last of them needed for a verdict; 1.645 is that of one look",
}
"""Of flights that search for the plume, are given its true axis, or end with a verdict."""

_FLIGHTS = {**_OF_POINT, **_PLANNED, **_MEASURED, **_OF_SNIFFER, **_OF_SEARCH}

MEANINGS: Mapping[str, Mapping[str, str]] = {
    SUMMARY: _FLIGHTS,
    COMPARISON: _FLIGHTS,
    CROSSINGS: {
        **_OF_POINT,
        "crossing": "number of the crossing, from 1",
        "time_s": "time of the crossing",
        "axis_distance_m": "distance from the funnel along the plume's axis",
        "distance_m": "distance from the funnel",
        "horizontal_distance_m": "distance from the vertical through the funnel",
        "angle_deg": "angle between path and axis, as seen from the vessel",
        "height_m": "height above a line from the funnel's mouth at plume.elevation_deg, level for smoke, which rises above it",
    },
    INTERVENTIONS: {
        **_OF_FLIGHT,
        "time_s": "time at which the keep-out guard began to change commands",
        "duration_s": "time for which it did",
        "distance_min_m": "least distance from the vessel's estimated position",
        "lost": "whether no turn away held the guard's radius for certain",
    },
    DRAWS: {
        **_OF_POINT,
        "search_method": "method that proposed the flight",
        "confirms": "flight that it repeats with other noise",
    },
    SULPHUR_TABLE: {
        **_OF_FLIGHT,
        "elapsed_s": "time since settling",
        "fsc_percent": "fuel sulphur content from the readings up to then",
        "noise_percent": "standard uncertainty by noise",
        "total_percent": "standard uncertainty",
        "low_percent": "lower end of the 95 % interval",
        "high_percent": "upper end of the 95 % interval",
        "quality": "class A, B or C",
        "passes": "peaks of CO2 in the readings up to then, each of 5 times its noise or more",
        "verdict": "above, below or open",
        "probability_above": "probability that the fuel is above the limit",
    },
    WINDOW_TABLE: {
        **_OF_FLIGHT,
        "window_s": "time before the end of the flight over which it is evaluated",
        "error_rms_m": "root mean square distance to the reference",
        "error_mean_m": "mean distance to the reference",
        "error_max_m": "largest distance to the reference",
        "effort_rms_rad_s": "root mean square commanded heading rate",
        "excess_rms_rad_s": "root mean square of the commanded heading rate less that of the reference",
        "saturated_share": "share of the time in which the demand was limited to omega_max",
        "guard_share": "share of the time in which the keep-out guard changed commands",
        "crossings_per_minute": "crossings of the plume's axis in a minute",
        "crossing_distance_mean_m": "mean distance of the crossings from the funnel",
        "window_distance_min_m": "closest approach, at the recorded samples",
        "speed_ratio_mean": "mean speed ratio through the air",
        "plume_s_per_minute": "seconds in the plume in a minute",
        "sulphur_information_per_minute": "1/sigma^2 of the sulphur content by noise, in a minute",
    },
    TUNING_TABLE: {
        "entrant": "steering law and task",
        "evaluation": "number of the setting that was tried, from 0",
        "cost_m": "cost of the setting: its error, and its excess times a weight",
        "error_m": "mean over its flights of the rms distance to the reference",
        "excess_rad_s": "mean over its flights of the rms of the commanded heading rate less that of the reference",
        "parameters": "parameters of the law, as JSON",
        "message": "why the setting could not be flown",
        "wall_time_s": "computing time",
    },
}
"""Meanings by the file and the column, but for the studies of convergence and for the keys in
``draws.csv``.
"""

CONVERGENCE_MEANINGS = {
    "trajectory": "number of the start",
    "law": "steering law",
    "reference": "kind of the reference",
    "reference_heading_rate_max_rad_s": "largest heading rate of the reference",
    "start_north_m": "position of the start relative to the reference",
    "start_east_m": "position of the start relative to the reference",
    "start_distance_m": "distance of the start from the reference",
    "start_course_rad": "course at the start",
    "reference_course_rad": "course of the reference at the start",
    "start_phi_rad": "phi at the start, equation (19)",
    "outcome": "whether it settled",
    "message": "the reason if it did not",
    "settling_time_s": "time from which it stayed within the settling band",
    "settling_time_predicted_s": "settling time predicted by the averaged motion",
    "distance_final_m": "distance to the reference at the end",
    "phi_final_rad": "phi at the end",
    "duration_s": "time over which the motion was integrated",
    "distance_max_m": "largest distance to the reference",
    "heading_rate_max_rad_s": "largest heading rate",
    "reference_terms": "heading rate of the reference as JSON: its mean, and amplitude, frequency and phase of each oscillation",
}
"""Of ``summary.csv`` and ``counterexamples.csv`` of a study of convergence."""
