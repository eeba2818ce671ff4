"""Every key of the schema acts: with another value the flight differs, or the key is refused by
name.
"""

import contextlib
import tomllib

import pytest
from flight_cases import flight_of

from scenarios.errors import InputError
from scenarios.scenario.errors import known_keys
from scenarios.scenario.files import load_study
from scenarios.scenario.scenario import Scenario

pytestmark = pytest.mark.slow

SHORT = """
title = "short"
fidelity = "kinematic"
seed = 3
guidance.rate_hz = 5.0
flight.log_rate_hz = 5.0
criteria.tracking_error_rms_m = 1e-4
"""

BASES = {
    "tracking": """
flight.duration_max_s = 120.0
vessel.speed_mps = 8.0
flight.crossings = 2
start.distance_m = [300.0, 400.0]
""",
    "following": """
flight.duration_max_s = 120.0
guidance.mission = "follow"
vessel.speed_mps = 6.0
vessel.manoeuvres = [{ at_s = 60.0, turn_deg = 20.0, speed_mps = 7.0 }]
wind = { speed_mps = 4.0, from_deg = 60.0 }
reports.interval_s = [2.0, 5.0]
following.vessel_acceleration_mps2 = 0.15
fault = { kind = "satellite_navigation", at_s = [70.0, 80.0] }
traffic = [{ place_m = [700.0, 700.0], course_deg = 10.0, manoeuvres = [{ at_s = 2.0, turn_deg = 20.0, speed_mps = 7.0 }] }]
flight.crossings = 0
start.distance_m = [300.0, 400.0]
""",
    "measuring": """
flight.duration_max_s = 120.0
vessel.speed_mps = 8.0
wind = { speed_mps = 5.0, from_deg = 80.0 }
plume = { model = "fluctuating", source_height_m = 35.0 }
emission = { ship = "container", fuel = "vlsfo", sulphur_percent = 0.3 }
payload.instruments = ["sniffer"]
payload.sensor = "fast"
payload.channels.ch4 = { t90_s = 1.0, delay_s = 0.2, noise = 2.0 }
payload.channels.bc = { t90_s = 1.0, delay_s = 0.2, noise = 20.0 }
payload.channels.pn = { t90_s = 1.0, delay_s = 0.2, noise = 50.0 }
air = { background = "sine", background_s = 20.0 }
flight.crossings = 0
flight.after_settling_s = 20.0
start = { place_m = [-130.0, -200.0], course_deg = 160.0 }
""",
    "searching": """
flight.duration_max_s = 120.0
vessel.speed_mps = 8.0
wind = { speed_mps = 5.0, from_deg = 80.0 }
plume = { model = "fluctuating", source_height_m = 30.0 }
emission = { ship = "container", fuel = "vlsfo", sulphur_percent = 2.0 }
payload = { instruments = ["sniffer"], sensor = "fast" }
following = { plume = "estimated", source_height_m = [12.0, 20.0], load = [0.2, 0.9] }
flight.crossings = 0
flight.altitude_m = 60.0
flight.altitude_min_m = 52.0
start = { place_m = [-100.0, -280.0], course_deg = -20.0 }
""",
    "standoff": """
flight.duration_max_s = 80.0
guidance.mission = "standoff"
guidance.law = "npfg"
keepout.radius_m = 90.0
vessel.speed_mps = 6.0
vessel.manoeuvres = [{ at_s = 30.0, turn_deg = 20.0, speed_mps = 7.0 }]
wind = { speed_mps = 4.0, from_deg = 60.0 }
reports.interval_s = [2.0, 5.0]
following.vessel_acceleration_mps2 = 0.15
fault = { kind = "satellite_navigation", at_s = [40.0, 50.0] }
flight.crossings = 0
start.distance_m = [300.0, 400.0]
""",
    "hull": """
flight.duration_max_s = 120.0
guidance.mission = "follow"
keepout = { from = "hull", radius_m = 120.0 }
vessel = { speed_mps = 6.0, length_m = 110.0, beam_m = 17.0, stack_from_bow_m = 80.0, antenna_from_bow_m = 10.0 }
reports.interval_s = [2.0, 5.0]
following.vessel_acceleration_mps2 = 0.15
flight.crossings = 0
start.distance_m = [400.0, 500.0]
""",
    "emitting": """
flight.duration_max_s = 120.0
vessel.speed_mps = 8.0
wind = { speed_mps = 5.0, from_deg = 80.0 }
plume = { model = "fluctuating", source_height_m = 35.0 }
emission = { ship = "container", fuel = "vlsfo", sulphur_percent = 0.3 }
payload = { instruments = ["sniffer"], sensor = "fast" }
traffic = [{ place_m = [700.0, 300.0], speed_mps = 8.0, emission = { ship = "container", fuel = "hfo", load = 0.4 } }]
flight.crossings = 0
flight.after_settling_s = 20.0
start = { place_m = [-100.0, -280.0], course_deg = -20.0 }
""",
    "circle": 'flight.duration_max_s = 120.0\nreference.path = "circle"\nstart.place_m = [80.0, -60.0]\n',
}
"""Flights of the kinematic vehicle with each mission, and without a vessel."""

VALUES = {
    "seed": 4, "flight_seed": 9, "speed_ratio": [0.0, 0.5], "method": "subset", "sampling": "random", "common_random_numbers": True,
    "subset.flights_per_level": 100, "subset.conditional_probability": 0.2, "subset.levels_max": 3, "subset.repeats": 4,
    "comparison.nu": [0.5], "comparison.flights": 2,
    "statistics.confidence": 0.9, "statistics.violation_upper": 0.1, "statistics.distance_quantile_width_m": 1.0,
    "statistics.distance_quantile": 0.05,
    "search.population": 8, "search.generations": 1, "search.mutation": [0.4, 0.6], "search.recombination": 0.5, "search.kept": 1,
    "laws": ["npfg"], "arena.tracking": ["npfg"], "arena.standoff": ["npfg"], "arena.conditions": [{"name": "a", "title": "b"}],
    "arena.evaluations": 1, "arena.tuning_flights": 1, "arena.tuning_duration_s": 100.0, "arena.tuning_set": {"seed": 2},
    "arena.tuning_range": 2.0, "arena.effort_weight_m_s": 1.0, "arena.error_max_m": 50.0, "arena.window_s": 10.0,
    "arena.resamples": 100, "arena.limits": [[0.5, 9.0]],
    "patrol.ships": 3, "patrol.endurance_s": 1800.0, "patrol.area_m": 2e4, "patrol.separation_m": 2000.0,
    "patrol.clearance_m": 200.0, "patrol.patience_s": 300.0, "patrol.service_s": 100.0, "patrol.service_deviation_s": 20.0,
    "patrol.oracle_share_min": 0.5, "patrol.wrong_share_max": 0.1,
    "search.methods": ["local"], "search.time_s": 5.0, "search.restarts": 3, "search.confirmations": 1,
    "place.latitude_deg": 57.0, "place.longitude_deg": 11.0, "place.utc": "2026-06-01T10:00:00Z",
    "vessel.mmsi": 219999001, "vessel.gap_max_s": 100.0,
    "vessel.speed_mps": 7.0, "vessel.speed_ratio": 0.3, "vessel.course_deg": 40.0,
    "vessel.manoeuvres": [{"at_s": 20.0, "turn_deg": 30.0}],
    "vessel.manoeuvres.0.at_s": 50.0, "vessel.manoeuvres.0.turn_deg": 30.0, "vessel.manoeuvres.0.turn_rate_deg_s": 1.0,
    "vessel.manoeuvres.0.speed_mps": 8.0, "vessel.manoeuvres.0.acceleration_mps2": 0.1,
    "vessel.length_m": 120.0, "vessel.beam_m": 18.0, "vessel.stack_from_bow_m": 90.0, "vessel.stack_from_port_m": 4.0,
    "vessel.antenna_from_bow_m": 20.0, "vessel.antenna_from_port_m": 3.0, "keepout.from": "stack",
    "reports.heading_sigma_deg": 3.0, "reports.turn_rate_sigma_deg_s": 0.2,
    "traffic": [{"place_m": [900.0, 900.0]}], "traffic.0.name": "other", "traffic.0.track": "lane.csv", "traffic.0.mmsi": 219999001,
    "traffic.0.place_m": [400.0, 800.0], "traffic.0.latitude_deg": 57.0, "traffic.0.longitude_deg": 11.0,
    "traffic.0.speed_mps": 6.0, "traffic.0.course_deg": 200.0, "traffic.0.radius_m": 120.0,
    "traffic.0.manoeuvres": [{"at_s": 3.0, "turn_deg": 30.0}],
    "traffic.0.manoeuvres.0.at_s": 3.0, "traffic.0.manoeuvres.0.turn_deg": 30.0, "traffic.0.manoeuvres.0.turn_rate_deg_s": 0.4,
    "traffic.0.manoeuvres.0.speed_mps": 6.0, "traffic.0.manoeuvres.0.acceleration_mps2": 0.1, "keepout.other_radius_m": 150.0,
    "traffic.0.emission.ship": "cruise", "traffic.0.emission.fuel": "mgo", "traffic.0.emission.sulphur_percent": 1.0,
    "traffic.0.emission.load": 0.7,
    "plume.direction": "apparent_wind", "plume.heading_deg": 170.0, "plume.elevation_deg": 10.0, "plume.source_height_m": 80.0,
    "emission.ship": "cruise", "emission.fuel": "mgo", "emission.sulphur_percent": 0.2, "emission.load": 0.5,
    "emission.methane_slip_percent": 3.0, "emission.black_carbon_g_kg": 0.3, "emission.particle_number_1e15_kg": 8.0,
    "wind.temperature_c": 30.0, "wind.stability_per_s": 0.03, "flight.after_settling_s": 60.0, "flight.measured_s": 15.0,
    "flight.altitude_min_m": 80.0, "flight.altitude_max_m": 40.0,
    "keepout.radius_m": 180.0, "keepout.shape": "cylinder", "wind.speed_mps": 3.0, "wind.from_deg": 100.0,
    "wind.roughness_m": 2e-4, "wind.height_m": 20.0,
    "table.file": "wind.table", "table.separator": ";", "table.decimal": ",", "table.encoding": "latin-1",
    "table.time_format": "%d.%m.%Y %H:%M", "table.time_unit": "ms",
    "turbulence.level": "light", "turbulence.gusts": 2, "turbulence.gust_speed_mps": 3.0, "turbulence.gust_length_s": 3.0,
    "air.background": "haze", "air.background_ppm": 5.0, "air.background_s": 10.0,
    "reports.interval_s": [3.0, 6.0], "reports.position_sigma_m": 8.0, "reports.velocity_sigma_mps": 0.3,
    "reports.latency_max_s": 2.0, "reports.missing": 0.5,
    "sensors.position_sigma_m": 1.0, "sensors.velocity_sigma_mps": 0.1, "sensors.airspeed_sigma_mps": 0.3,
    "sensors.airspeed_bias_mps": 0.5, "sensors.heading_sigma_deg": 1.0, "sensors.heading_bias_deg": 2.0,
    "fault.kind": "vessel_data", "fault.at_s": [20.0, 40.0], "fault.vessel_data_s": 20.0, "fault.satellite_navigation_s": 30.0,
    "fault.declared": ["satellite_navigation"],
    "kinematic.heading_rate_lag_s": 0.5, "reference.path": "circle", "reference.radius_m": 150.0,
    "reference.standoff_radius_m": 300.0, "following.margin_law": "line_of_sight",
    "guidance.mission": "follow", "guidance.law": "line_of_sight", "guidance.airspeed_mps": 18.0, "guidance.bank_deg": 40.0,
    "guidance.heading_rate_max_rad_s": 0.45, "guidance.reserve": 0.1, "guidance.roll_rate_max_deg_s": 5.0,
    "guidance.phase_deg": 90.0, "guidance.placement": "exact", "guidance.tracking_allowance_m": 5.0, "guidance.tuning": "bounded",
    "guidance.bound_speed_margin_mps": 0.8, "guidance.epsilon_per_m": 0.01, "guidance.look_ahead_m": 80.0,
    "guidance.gain_per_s": 1.0, "guidance.steering_max_rad_s": 0.2, "guidance.lyapunov_gain_per_m2": 0.002,
    "guidance.command_limit": False, "guidance.preview": False, "guidance.airspeed_trim": False,
    "guidance.airspeed_gain_per_s": 0.1, "guidance.airspeed_trim_max_mps": 0.5, "guidance.keepout_guard": False,
    "guidance.approach": False, "guidance.rate_hz": 40.0,
    "following.touches_per_hour": 1e-6, "following.margin_min_m": 60.0, "following.speed_ratio_max": 0.2,
    "following.apparent_wind_min_mps": 12.0, "following.standoff_m": 50.0, "following.join_distance_m": 20.0,
    "following.tracked_m": 4.0, "following.vessel_acceleration_mps2": 0.3, "following.speed_error_mps": 1.0,
    "following.drift_rate_mps": 5.0, "following.turn_deviation_m": 15.0, "following.vessel_speed_max_mps": 7.5,
    "following.plume": "estimated", "following.search": "ladder", "following.distance": "best_measurement",
    "following.source_height_m": [20.0, 40.0], "following.load": [0.1, 0.4], "following.climb_gradient": 0.02,
    "flight.until": "verdict", "flight.altitude_m": 50.0,
    "start.distance_m": [350.0, 400.0], "start.spread_deg": 90.0, "start.range_m": 350.0, "start.aspect_deg": 20.0,
    "start.course_deg": 30.0, "start.place_m": [-300.0, 50.0],
    "flight.crossings": 4, "flight.duration_max_s": 20.0, "flight.settling_band_m": 0.5, "flight.log_rate_hz": 10.0,
    "criteria.required": "keep_out",
    "criteria.settles": False, "criteria.tracking_error_rms_m": 1e-6, "criteria.airspeed_error_rms_mps": 1e-9,
    "criteria.altitude_error_max_m": 1e-9, "criteria.crossing_interval_error": 1e-9, "criteria.tracking_error_end_m": 1e-15,
    "criteria.crossing_interval_s": [1.0, 1.1], "criteria.crossing_distance_m": [1.0, 1.1],
    "criteria.law_beyond_heading_rate_max": True, "criteria.law_within_heading_rate_max": True,
    "criteria.time_to_find_s": 1e-3, "criteria.within_altitudes": True,
    "criteria.resumes_within_periods": 1e-3, "criteria.modes_at_end": ["transit"],
}  # fmt: skip
"""Another legal value of each key."""

OWN_VALUES = {
    "following": {"plume.direction": "given", "guidance.mission": "track", "criteria.crossing_interval_error": False},
    "measuring": {
        "plume.direction": "given", "plume.meander": False, "payload.exact": True,
    },
    "searching": {"following.plume": "told", "flight.altitude_min_m": 45.0},
    "standoff": {"plume.direction": "given", "guidance.mission": "track", "criteria.crossing_interval_error": False},
    "circle": {"reference.path": "oscillation"},
}  # fmt: skip
"""Where that is what a mission has anyway, or its flight fails one limit as it does the other."""

OF_MISSION = {"criteria.resumes_within_periods", "criteria.modes_at_end"}
"""Criteria that hang on what a flight follows."""

SEARCHING = (
    "following.plume", "following.search", "following.distance", "following.source_height_m", "following.load",
    "following.climb_gradient", "criteria.time_to_find_s",
    "flight.until", "flight.altitude_m", "flight.altitude_min_m", "flight.altitude_max_m",
)  # fmt: skip
"""Keys that act on a search."""

MEASURING = tuple(
    key
    for key in VALUES
    if key.startswith(("air.", "emission.", "flight.", "payload.", "plume.", "wind."))
    and key != "flight.until"
)
"""Keys that act on what is measured, of a flight that is shorter than a verdict takes."""

OF_HULL = (
    "vessel.length_m", "vessel.beam_m", "vessel.stack_from_bow_m", "vessel.stack_from_port_m", "vessel.antenna_from_bow_m",
    "vessel.antenna_from_port_m", "keepout.from", "reports.heading_sigma_deg", "reports.turn_rate_sigma_deg_s",
)  # fmt: skip
"""Keys that act beside a ship with a hull."""

FOLLOWED = (
    "guidance.",
    "following.",
    "keepout.",
    "vessel.",
    "traffic.",
    "reports.",
    "fault.",
    "start.",
)
OF_FOLLOWING = tuple(key for key in VALUES if key.startswith(FOLLOWED) or key in OF_MISSION)
"""Keys that act on a flight that follows a ship."""

OF_CIRCLE = tuple(
    key for key in VALUES if key.startswith(("guidance.", "reference.", "following.", "keepout."))
)
"""Keys that act on a circle about the ship."""

OF_ANOTHER = tuple(key for key in VALUES if key.startswith("traffic.0.emission."))
"""Keys that act where the plume of another ship reaches the sniffer."""

LOOKED_AT = {
    "hull": OF_HULL,
    "following": OF_FOLLOWING,
    "standoff": OF_CIRCLE,
    "emitting": OF_ANOTHER,
    "measuring": (*MEASURING, "plume.meander", "payload.exact"),
    "searching": SEARCHING,
}
"""Keys that are tried in a flight in which the others do nothing more than elsewhere."""

ELSEWHERE = {
    "study", "title", "description", "fidelity", "aircraft", "payload.instruments", "vessel.track", "wind.table", "plume.model",
    "reference.shape",
    "flights", "histories", "sweep", "cases", "draws", "comparison", "comparison.variants",
    "report.title", "report.author", "report.organisation", "report.logo", "place.geoid_m",
}  # fmt: skip
"""Kinds of study, texts, experiments, parts, reports and exports, which tests of their own are about
(test_extension_points, test_monte_carlo_study, test_report_settings, test_heights)."""

LISTS = {"vessel.manoeuvres", "traffic", "traffic.0.manoeuvres"}
"""Keys of lists of tables, whose keys are keys as well."""

LEVEL = {"criteria.airspeed_error_rms_mps", "criteria.altitude_error_max_m"}
"""Criteria that the kinematic vehicle always meets: it is level and as fast as commanded."""

IN_SILENCE = {"following.vessel_speed_max_mps"}
"""Keys that act where nothing is received for long, of which there is a test of its own."""

DECLARED = {"fault.declared"}
"""Keys that say what follows from the flight's own fault here; of other flights there is a test,
test_falsify.
"""

BEYOND_OR_WITHIN = {"criteria.law_beyond_heading_rate_max", "criteria.law_within_heading_rate_max"}
"""Criteria of which every flight meets exactly one."""


def flown(document, *overrides):
    result = flight_of(load_study(document, overrides))
    (row,) = result.tables["summary.csv"]
    return {key: repr(value) for key, value in row.items() if key != "wall_time_s"}, result


@pytest.fixture(autouse=True)
def unwritten(monkeypatch):
    """Hand over time histories as they are: to write each into a file takes a tenth of the time."""
    monkeypatch.setattr(
        "scenarios.flight_runner.history_files", lambda _, history, *__, **___: {"history": history}
    )


def same_history(result, other):
    history, changed = result.files["history"], other.files["history"]
    return history is changed or (history is not None and history.equals(changed))


def written(value):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {written(below)}" for key, below in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(written, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else repr(value)


def test_every_key_has_another_value_here():
    known = set(known_keys(Scenario))
    sections = {key.rpartition(".")[0] for key in known}
    entries = ("cases.", "draws.", "comparison.v", "arena.conditions.")
    keys = {key for key in known - sections - LISTS if not key.startswith(entries)}
    assert keys - ELSEWHERE == VALUES.keys() - LISTS


def beginning_of(base):
    """Return what makes of a flight its beginning, which is enough to see most keys act."""
    fault = ["fault.at_s=[2.0, 4.0]"] if "fault" in BASES[base] else []
    return [f"flight.duration_max_s={10 if base in LOOKED_AT else 6}", *fault]


def tried(base):
    """Return the keys that are tried in a flight, and another value of each."""
    looked_at = LOOKED_AT.get(base)
    for key, value in (VALUES | OWN_VALUES.get(base, {})).items():
        # A criterion acts on the row of a flight, whatever its mission.
        of_row = key.startswith("criteria.") and base != "tracking" and key not in OF_MISSION
        if key in looked_at if looked_at else not of_row:
            yield key, value


def differ(one, other):
    return one[0] != other[0] or not same_history(one[1], other[1])


@pytest.mark.parametrize("base", BASES)
def test_with_another_value_of_any_key_the_flight_differs_or_the_key_is_refused(base):
    document = tomllib.loads(SHORT + BASES[base])
    begins = beginning_of(base)
    whole, beginning = flown(document), flown(document, *begins)
    silent, unnamed = [], []
    for key, value in tried(base):
        change = f"{key}={written(value)}"
        # What the beginning has no room for may act later, as most criteria do.
        with contextlib.suppress(InputError):
            if not key.startswith("criteria.") and differ(
                flown(document, *begins, change), beginning
            ):
                continue
        try:
            silent += [] if differ(flown(document, change), whole) else [key]
        except InputError as refusal:
            names = (
                key.rpartition(".")[2],
                key.partition(".")[0],
                "reference.path",
                "start.place_m",
            )
            unnamed += [] if any(name in str(refusal) for name in names) else [(key, str(refusal))]
    assert set(silent) <= LEVEL | BEYOND_OR_WITHIN | IN_SILENCE | DECLARED, silent
    assert len(BEYOND_OR_WITHIN & set(silent)) == (base == "tracking")
    assert not unnamed


def test_the_vessels_largest_speed_acts_where_little_is_received_of_it():
    base = BASES["following"].replace("acceleration_mps2 = 0.15", "acceleration_mps2 = 0.5")
    document = tomllib.loads(SHORT + base + "reports.missing = 0.8\n")
    changed = flown(document, *(f"{key}={VALUES[key]}" for key in IN_SILENCE))
    assert not same_history(flown(document)[1], changed[1])
