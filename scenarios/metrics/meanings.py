"""What the columns of a run's tables mean, by table and name. Time histories have theirs in ``scenarios.simulation.record``.

Units are the ends of the names. "Settled" is said of the flight from its settling time on.
"""

from collections.abc import Mapping

from common.run_layout import COMPARISON, CROSSINGS, DRAWS, INTERVENTIONS, SULPHUR_TABLE, SUMMARY

_OF_FLIGHT = {
    "flight_id": "name of the flight",
    "trial": "the scenario that the flight is of",
    "variant": "study, or the name of a comparison",
}
"""Of several tables."""

_OF_POINT = {**_OF_FLIGHT, "nu": "speed ratio through the air at the start: the vessel's speed over the UAV's"}

_PLANNED = {
    "beside": "of a comparison, the flight of the study that has its start and its air; else empty",
    "aircraft": "the aircraft",
    "fidelity": "six_dof, or kinematic for the paper's vehicle",
    "seed": "of start, air and noise of this flight",
    "nu_min": "least speed ratio over the vessel's track",
    "nu_max": "largest speed ratio over the vessel's track",
    "wind_speed_mps": "mean wind at the height of the funnel, at the start",
    "wind_from_deg": "where it comes from, clockwise from north",
    "vessel_speed_mps": "speed of the vessel over the ground at the start",
    "turbulence": "level of the turbulence",
    "place_latitude_deg": "latitude of the vessel at time 0, where it is known",
    "place_longitude_deg": "longitude of the vessel at time 0, where it is known",
    "start_utc": "UTC of time 0, where it is known",
    "fault": "the fault that was flown",
    "fault_time_s": "when it begins",
    "plume_heading_deg": "direction of the plume's axis, from the vessel's course, at the start",
    "plume_elevation_deg": "elevation of the plume's axis above the horizon",
    "start_distance_m": "horizontal distance of the start from the vessel",
    "start_aspect_deg": "bearing of the start, seen from the vessel, from the plume's axis",
    "eta": "amplitude of the reference's course oscillation, in radians",
    "omega_0_rad_s": "angular frequency of the oscillation",
    "oscillation_limit": "what set that frequency, as the heading rate or the roll rate",
    "r_co_m": "distance of the centre of oscillation from the funnel",
    "keepout_shape": "sphere about the funnel's mouth, or cylinder about the vertical through it",
    "keepout_radius_m": "radius r_min of the keep-out area",
    "keepout_margin_m": "planned margin between r_min and the orbit, for all that is not known exactly",
    "crossing_interval_predicted_s": "pi/omega_0; with a vessel that manoeuvres its mean between first and last crossing",
    "spread_predicted_m": "standard deviation of the tracking error towards the vessel that the margin is planned for",
    "manoeuvre_end_s": "when the vessel's last manoeuvre ends",
    "manoeuvres_unflown": "manoeuvres of the vessel that begin after the end of the flight",
    "heading_rate_limit_rad_s": "omega_max, at which commands are cut",
    "heading_rate_bound_rad_s": "bound on the demand over all states, if the law has one",
    "epsilon_per_m": "parameter epsilon of the look-ahead, equation (15)",
    "look_ahead_m": "radius R of the look-ahead, equation (15)",
    "steering_max_rad_s": "bound of the law's steering term, if it has one",
}
"""Known before the flight, of ``summary.csv`` and ``comparison.csv``."""

_MEASURED = {
    "outcome": "completed, not_settled, incomplete, aircraft_lost, diverged, infeasible, trim_failed or failed",
    "message": "the reason of an outcome other than completed",
    "criteria_met": "whether the flight is met: it kept out, completed, and met every other criterion",
    "kept_out": "whether it kept out, and that is known to its end",
    "required": "what exit status 0 requires of it: criteria or keep_out",
    "modes": "what the guidance did, in the order in which each mode came first",
    "mode_at_end": "what it did last",
    "keepout_violations": "how often it entered the keep-out area",
    "keepout_time_s": "time in the keep-out area",
    "keepout_depth_m": "deepest place in it, measured from its edge",
    "min_distance_m": "closest approach to the centre of the sphere, or to the axis of the cylinder",
    "horizontal_distance_min_m": "closest approach measured horizontally",
    "end_distance_m": "distance at the end of the flight",
    "settling_time_s": "from when it stayed within the settling band for one period",
    "crossing_count": "crossings of the plume, settled",
    "crossing_interval_mean_s": "mean time between crossings",
    "crossing_interval_std_s": "standard deviation of it",
    "crossing_distance_mean_m": "mean distance of the crossings from the funnel",
    "crossing_distance_min_m": "least distance of a crossing from the funnel",
    "crossing_angle_mean_deg": "mean angle between path and axis at the crossings, as seen from the vessel",
    "tracking_error_rms_m": "distance to the reference, settled",
    "tracking_error_max_m": "largest distance to the reference, settled",
    "tracking_error_end_m": "distance to the reference at the end",
    "spread_m": "standard deviation of the tracking error towards the vessel, settled",
    "resume_time_s": "time from the end of the vessel's last manoeuvre to the next crossing",
    "resume_periods": "the same, in periods of the oscillation",
    "airspeed_error_rms_mps": "airspeed against its command, settled",
    "airspeed_error_max_mps": "largest error of the airspeed, settled",
    "airspeed_trim_rms_mps": "what the airspeed law adds to the constant airspeed, settled",
    "airspeed_min_mps": "least airspeed of the flight",
    "airspeed_max_mps": "largest airspeed of the flight",
    "speed_max_mps": "largest speed over the ground",
    "altitude_error_rms_m": "altitude against its command, settled",
    "altitude_error_max_m": "largest error of the altitude, settled",
    "altitude_min_m": "least altitude of the flight",
    "bank_max_deg": "largest bank of the flight",
    "heading_rate_error_rms_rad_s": "heading rate against that of the reference, settled",
    "heading_rate_demand_max_rad_s": "largest heading rate that the law demanded, before any limit",
    "heading_rate_command_max_rad_s": "largest commanded heading rate, over every step of the guidance",
    "heading_rate_flown_max_rad_s": "largest heading rate that was flown",
    "saturation_fraction": "fraction of guidance steps whose demand was cut at omega_max",
    "guard_interventions": "how often the keep-out guard changed commands",
    "guard_time_s": "for how long altogether",
    "guard_after_settling_s": "for how long of it settled",
    "guard_lost_s": "for how long neither turn away held the guard's radius",
    "wind_error_rms_mps": "error of the estimated wind, settled",
    "vessel_error_rms_m": "error of the vessel's place as the guidance has it, settled",
    "vessel_error_max_m": "the largest, over the whole flight",
    "centre_error_rms_m": "distance of the orbit's centre from the centre of oscillation, settled",
    "duration_s": "duration of the flight",
    "wall_time_s": "computing time of the flight",
}
"""Measured, of ``summary.csv`` and ``comparison.csv``."""

_OF_SNIFFER = {
    "sensor": "preset of the sniffer",
    "fsc_fuel_percent": "sulphur in the fuel, by mass",
    "fsc_expected_percent": "what a perfect instrument reads",
    "sulphur_limit_percent": "limit that the verdict is on",
    "fsc_percent": "fuel sulphur content by regression",
    "fsc_uncertainty_percent": "its standard uncertainty",
    "fsc_noise_percent": "the part of it that more time takes away",
    "fsc_common_percent": "the part of it that more time does not take away",
    "fsc_low_percent": "lower end of the 95 % interval",
    "fsc_high_percent": "upper end of the 95 % interval",
    "areas_fsc_percent": "fuel sulphur content by areas",
    "areas_fsc_uncertainty_percent": "its standard uncertainty",
    "areas_fsc_separate_percent": "what areas would read of passes that do not overlap",
    "areas_fsc_noise_percent": "the part of the uncertainty that more time takes away",
    "areas_fsc_low_percent": "lower end of the 95 % interval",
    "areas_fsc_high_percent": "upper end of the 95 % interval",
    "sulphur_quality": "class A, B or C of the result",
    "sulphur_reason": "why it is not A",
    "sulphur_verdict": "above, below or open",
    "probability_above": "probability that the fuel is above the limit",
    "verdict_2min": "verdict after two minutes",
    "verdict_time_s": "time after which the verdict is that of the end",
    "co2_signal_to_noise": "of the readings of CO2",
    "so2_signal_to_noise": "of the readings of SO2",
    "plume_passes": "passes through the plume",
    "hit_rate": "share of passes whose peak is above 0.6 of the centre of the plume",
    "seconds_in_plume_s": "time in which the concentration is above exp(-2) of that on the axis",
    "dose_per_pass_ppm_s": "CO2 above clean air, integrated over a pass, in the mean",
    "axis_height_error_mean_m": "mean height of the passes above the plume's own axis",
    "axis_height_error_rms_m": "root mean square of it",
}
"""Of flights with a sniffer."""

_OF_SEARCH = {
    "orbit_at_s": "when the way to the orbit ended",
    "time_to_find_s": "time on the orbit until the plume was smelt",
    "found": "whether that was within 300 s",
    "axis_height_3min_m": "true height of the plume's axis at the crossing nearest to 180 s on the orbit",
    "axis_height_error_3min_m": "error of the height as believed there",
    "axis_height_deviation_3min_m": "standard deviation as believed there",
    "hit_rate_found": "share of passes that hit the plume after it was found",
    "axis_height_end_m": "height of the axis as believed at the end",
    "axis_deviation_end_m": "its standard deviation as believed at the end",
    "axis_measurable_end": "probability, as believed at the end, that the plume can be crossed at altitudes that are flown",
    "altitude_outside_s": "time outside the limits of the altitude",
    "enough": "why it left before its time, or empty",
}
"""Of flights that search for the plume, are told where it is, or end with a verdict."""

_FLIGHTS = {**_OF_POINT, **_PLANNED, **_MEASURED, **_OF_SNIFFER, **_OF_SEARCH}

MEANINGS: Mapping[str, Mapping[str, str]] = {
    SUMMARY: _FLIGHTS,
    COMPARISON: _FLIGHTS,
    CROSSINGS: {
        **_OF_POINT,
        "crossing": "number of the crossing, from 1",
        "time_s": "when",
        "axis_distance_m": "distance from the funnel along the plume's axis",
        "distance_m": "distance from the funnel",
        "angle_deg": "angle between path and axis, as seen from the vessel",
        "height_m": "height above the axis",
    },
    INTERVENTIONS: {
        **_OF_FLIGHT,
        "time_s": "when the keep-out guard began to change commands",
        "duration_s": "for how long it did",
        "distance_min_m": "how near the vessel was taken to be",
        "lost": "whether no turn away held the guard's radius for certain",
    },
    DRAWS: {
        **_OF_POINT,
        "search_method": "method that proposed the flight",
        "confirms": "flight that it repeats with fresh noise",
    },
    SULPHUR_TABLE: {
        **_OF_FLIGHT,
        "elapsed_s": "time since settling",
        "fsc_percent": "fuel sulphur content as known by then",
        "noise_percent": "part of its standard uncertainty by noise",
        "total_percent": "its standard uncertainty",
        "low_percent": "lower end of the 95 % interval",
        "high_percent": "upper end of the 95 % interval",
        "quality": "class A, B or C",
        "passes": "passes by then",
        "verdict": "above, below or open",
        "probability_above": "probability that the fuel is above the limit",
    },
    "window.csv": {
        **_OF_FLIGHT,
        "window_s": "length of the end of the flight that is measured",
        "error_rms_m": "distance to the reference",
        "error_mean_m": "its mean",
        "error_max_m": "the largest",
        "effort_rms_rad_s": "commanded heading rate",
        "excess_rms_rad_s": "commanded heading rate less that of the reference",
        "saturated_share": "share of the time in which the demand was cut at omega_max",
        "guard_share": "share of the time in which the keep-out guard changed commands",
        "crossings_per_minute": "crossings of the plume in a minute",
        "crossing_distance_mean_m": "mean distance of the crossings from the funnel",
        "window_distance_min_m": "closest approach at samples",
        "speed_ratio_mean": "mean speed ratio through the air",
        "plume_s_per_minute": "seconds in the plume in a minute",
        "sulphur_information_per_minute": "1/sigma^2 of the sulphur content by noise, in a minute",
    },
    "tuning.csv": {
        "entrant": "steering law and task",
        "evaluation": "number of the setting that was tried, from 0",
        "cost_m": "cost of the setting: its error, and what its excess counts as",
        "error_m": "mean over its flights of the rms distance to the reference",
        "excess_rad_s": "mean over its flights of the rms of the commanded heading rate less that of the reference",
        "parameters": "of the law, as JSON",
        "message": "why it could not be flown",
        "wall_time_s": "computing time",
    },
}
"""Meanings by the file and the column, but for the studies of convergence and for the keys in ``draws.csv``."""

CONVERGENCE_MEANINGS = {
    "trajectory": "number of the start",
    "law": "steering law",
    "reference": "kind of the reference",
    "reference_heading_rate_max_rad_s": "largest heading rate of the reference",
    "start_north_m": "start, from the reference",
    "start_east_m": "start, from the reference",
    "start_distance_m": "distance of the start from the reference",
    "start_course_rad": "course at the start",
    "reference_course_rad": "course of the reference at the start",
    "start_phi_rad": "phi at the start, equation (19)",
    "outcome": "whether it settled",
    "message": "the reason if it did not",
    "settling_time_s": "from when it stayed within the settling band",
    "settling_time_predicted_s": "by averaged motion",
    "distance_final_m": "distance to the reference at the end",
    "phi_final_rad": "phi at the end",
    "duration_s": "time that was integrated",
    "distance_max_m": "largest distance to the reference",
    "heading_rate_max_rad_s": "largest heading rate",
    "reference_terms": "number of terms of a random reference",
}
"""Of ``summary.csv`` and ``counterexamples.csv`` of a study of convergence."""

INSTRUMENT_MEANINGS = {
    **{
        name: text
        for gas in ("so2_ppb", "co2_ppm", "no_ppb", "no2_ppb")
        for name, text in (
            (gas, "true concentration along the path"),
            (gas.replace("_", "_reading_"), "reading, which stands until the next"),
        )
    },
    "plume_across_m": "place across the plume's mean axis",
    "plume_above_m": "height above the plume's mean axis",
    "plume_fraction": "concentration over that in the centre of the plume",
    "axis_height_estimated_m": "height of the plume's axis as believed",
    "axis_height_deviation_m": "its standard deviation",
    "axis_offset_estimated_m": "place of the axis across that predicted, as believed",
    "axis_offset_deviation_m": "its standard deviation",
    "axis_spread_estimated_m": "vertical spread of the plume as believed",
    "axis_spread_across_estimated_m": "horizontal spread of the plume as believed",
    "axis_measurable": "probability, as believed, that the plume can be crossed within the limits of the altitude",
    "axis_innovation": "mean normalised innovation squared of the passes, 1 where the filter is consistent",
}
"""Of time histories, of a sniffer and of a search for the plume."""
