"""Columns of a run's tables, in order. A figure that a flight does not have is empty."""

from common.premises import PREMISE_COLUMNS

SUMMARY_COLUMNS = (
    "flight_id", "trial", "variant", "beside", "outcome", "message", "criteria_met", "kept_out", "required", "aircraft",
    "fidelity", "seed", "nu", "nu_min", "nu_max", "wind_speed_mps", "wind_from_deg", "vessel_speed_mps", "turbulence",
    "place_latitude_deg", "place_longitude_deg", "start_utc", "fault",
    "fault_time_s", "modes", "mode_at_end", "plume_heading_deg", "plume_elevation_deg", "start_distance_m",
    "start_aspect_deg", "eta", "omega_0_rad_s", "oscillation_limit", "r_co_m", "keepout_shape", "keepout_radius_m",
    "keepout_margin_m", "keepout_violations", "keepout_time_s", "keepout_depth_m", "min_distance_m",
    "horizontal_distance_min_m", "end_distance_m", "settling_time_s", "crossing_count", "crossing_interval_mean_s",
    "crossing_interval_std_s", "crossing_interval_predicted_s", "crossing_distance_mean_m", "crossing_distance_min_m",
    "crossing_clearance_min_m", "crossing_angle_mean_deg", "tracking_error_rms_m", "tracking_error_max_m",
    "tracking_error_end_m", "spread_m",
    "spread_predicted_m", "manoeuvre_end_s", "manoeuvres_unflown", "resume_time_s", "resume_periods",
    "airspeed_error_rms_mps", "airspeed_error_max_mps", "airspeed_trim_rms_mps", "airspeed_min_mps", "airspeed_max_mps",
    "speed_max_mps", "altitude_error_rms_m", "altitude_error_max_m", "altitude_min_m", "bank_max_deg",
    "heading_rate_error_rms_rad_s", "heading_rate_demand_max_rad_s", "heading_rate_command_max_rad_s",
    "heading_rate_limit_rad_s", "heading_rate_bound_rad_s", "heading_rate_flown_max_rad_s", "epsilon_per_m", "look_ahead_m",
    "steering_max_rad_s", "saturation_fraction", "guard_interventions", "guard_time_s", "guard_after_settling_s",
    "guard_lost_s", *PREMISE_COLUMNS, "wind_error_rms_mps", "vessel_error_rms_m", "vessel_error_max_m", "centre_error_rms_m", "duration_s",
    "wall_time_s",
)  # fmt: skip
"""Of ``summary.csv`` and ``comparison.csv``: a row per flight."""

FLIGHT_COLUMNS = ("flight_id", "trial", "variant")
"""Of every table: what names a flight."""

CROSSING_COLUMNS = (
    *FLIGHT_COLUMNS, "nu", "crossing", "time_s", "axis_distance_m", "distance_m", "horizontal_distance_m", "angle_deg",
    "height_m",
)  # fmt: skip
"""Of ``crossings.csv``: a row per crossing."""

INTERVENTION_COLUMNS = (*FLIGHT_COLUMNS, "time_s", "duration_s", "distance_min_m", "lost")
"""Of ``interventions.csv``: a row per stretch in which the keep-out guard changed commands."""

INPUT_COLUMNS = (*FLIGHT_COLUMNS, "nu")
"""Of ``draws.csv``, before the keys that differ from flight to flight: a row per flight."""

SEARCH_COLUMNS = ("search_method", "confirms")
"""Of ``draws.csv`` of a search, between these: the method that proposed the flight, or the flight
that it repeats.
"""
