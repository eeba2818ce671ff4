"""Made-up designs of autopilots, of the shape that a design's record has."""

import json
import math

import numpy as np

from tests.run_tables import write_manifest

AIRSPEEDS = [45.0, 50.0, 55.0, 60.0, 65.0]
BANKS_DEG = [-33.0, -27.0, -21.0, -13.0, 0.0, 13.0, 21.0, 27.0, 33.0]
LOOPS = (
    "elevator",
    "aileron",
    "throttle",
    "rudder",
    "airspeed",
    "altitude",
    "heading_rate",
    "sideslip",
)
CASES = (
    "mass +20 %",
    "mass -20 %",
    "inertia +20 %",
    "control effectiveness -20 %",
    "one more period of delay",
)
REVERSALS = {
    "bank_deg": 45.0, "airspeed_mps": 19.42, "delay_s": 0.254, "lag_s": 0.254, "reversals": 100, "unguided_reversals": 64,
    "deviation_99_percent_m": 2.37,
    "deviation_max_m": 4.39, "worst_command_before": -1.0, "worst_airspeed_before_mps": 18.9,
}  # fmt: skip
GRAVITY = 9.81


def write_design(path, **changes):
    """Write a directory as the design command leaves it; ``changes`` are fields of the record."""
    (path / "model" / "aircraft" / "c172x").mkdir(parents=True)
    for folder, name in (
        ("aircraft/c172x", "c172x"),
        ("systems", "c172x_autopilot"),
        ("scripts", "c172x"),
    ):
        (path / "model" / folder).mkdir(parents=True, exist_ok=True)
        (path / "model" / folder / f"{name}.xml").write_text("<xml/>", encoding="utf-8")
    write_manifest(path, manifest())
    text = json.dumps({**record(), **changes}, allow_nan=False)
    (path / "innerloop.json").write_text(text, encoding="utf-8")
    return path


def manifest():
    return {
        "format": 1,
        "study": "design",
        "name": "c172x",
        "title": "Autopilot of the Cessna 172",
        "overrides": [],
        "state": "complete",
        "config": {"aircraft": "c172x", "altitude_m": 1000.0, "description": "Designed at 1000 m."},
        "git_revision": "ba78b23",
        "packages": {"numpy": "2.0", "jsbsim": "1.2.3"},
        "python": "3.11",
        "platform": "Linux x86_64",
        "wall_time_s": 61.2,
    }


def record():
    """Return a design that meets everything that is required of it."""
    grid = [(v, b) for v in AIRSPEEDS for b in BANKS_DEG]
    between = [(v + 2.5, b) for v in AIRSPEEDS[:-1] for b in (-30.0, -17.0, 0.0, 17.0, 30.0)]
    climbs = [trim(55.0, 0.0, math.radians(c)) for c in (-4.0, -2.0, 2.0, 4.0)]
    return {
        "aircraft": "c172x",
        "title": "Cessna 172",
        "source": "JSBSim's own model c172x",
        "altitude_m": 1000.0,
        "envelope": {
            "airspeed_min_mps": 45.0,
            "airspeed_max_mps": 65.0,
            "airspeed_mps": 55.0,
            "stall_airspeed_mps": 27.0,
            "bank_deg": 27.0,
            "bank_max_deg": 33.0,
            "notes": [
                "The stall is that of level flight without flaps.",
                "Bank is limited by the load factor of 1.2.",
            ],
        },
        "inputs": [
            control("elevator", -1.55, 0.45, True),
            control("aileron"),
            control("throttle", 0.35),
            control("rudder"),
        ],
        "design_airspeed_mps": 55.0,
        "airspeeds_mps": AIRSPEEDS,
        "banks_deg": BANKS_DEG,
        "weights": {
            "airspeed": 1.0,
            "pitch": 0.3,
            "altitude": 0.5,
            "roll": 0.1,
            "sideslip": 0.05,
            "throttle": 0.15,
        },
        "model_frequency_rad_s": 1.5,
        "model_damping": 0.9,
        "trims": [*(trim(v, b) for v, b in grid), *climbs],
        "poles": [poles(v, b) for v, b in grid],
        "margins": [m for v, b in grid for m in margins(v, b, False)]
        + [m for v, b in between for m in margins(v, b, True)],
        "robustness": [robustness(case, i, v, b) for i, case in enumerate(CASES) for v, b in grid],
        "required": {
            "gain_db": 6.0,
            "phase_deg": 45.0,
            "perturbed_gain_db": 4.0,
            "perturbed_phase_deg": 30.0,
        },
        "loops": [loop_shape(name, i) for i, name in enumerate(LOOPS)],
        "responses": responses(),
        "heading_rate_lag_s": 0.61,
        "autopilot_rate_hz": 120.0,
        "turn_reversal": dict(REVERSALS),
        "verification": [
            {"input": control, "output": output, "error": 0.001 * (2 + i + 3 * j)}
            for i, control in enumerate(("elevator", "aileron", "throttle", "rudder"))
            for j, output in enumerate(("airspeed", "q", "p"))
        ],
    }


def control(name, lower=-1.0, upper=1.0, is_effect=False):
    return {"name": name, "lower": lower, "upper": upper, "is_effect": is_effect}


def trim(airspeed, bank_deg, climb=0.0):
    bank = math.radians(bank_deg)
    lift = (50.0 / airspeed) ** 2 / math.cos(bank)
    rate = GRAVITY * math.tan(bank) / airspeed
    limits = ["elevator at 97 % of its travel"] if (airspeed, bank_deg) == (45.0, 33.0) else []
    return {
        "airspeed_mps": airspeed, "bank_rad": bank, "climb_angle_rad": climb, "alpha_rad": 0.09 * lift - 0.03,
        "sideslip_rad": 0.004 * math.sin(bank), "pitch_rad": 0.09 * lift - 0.03 + climb, "yaw_rate_rad_s": rate,
        "residual": 1e-9 * airspeed, "limits": limits, "elevator": 0.05 - 0.25 * lift, "aileron": 0.01 - 0.06 * rate,
        "throttle": 0.25 + 0.4 * (airspeed / 65.0) ** 3 + 0.1 * lift + 3.0 * climb, "rudder": -0.02 - 0.1 * rate,
        "propeller_speed": 3.2 * airspeed,
    }  # fmt: skip


def poles(airspeed, bank_deg):
    s, b = airspeed / 55.0, math.radians(bank_deg)

    def pair(frequency, damping):
        size = frequency * s
        return [
            [-damping * size, sign * size * math.sqrt(1.0 - damping**2)] for sign in (-1.0, 1.0)
        ]

    real = [[-6.0 * s, 0.0], [-0.01 + 0.05 * b * b, 0.0], [-20.0, 0.0], [-20.0, 0.0]]
    closed = [
        [-7.0 * s, 0.0],
        [-0.5 - 0.1 * b * b, 0.0],
        [-18.0 * s, 0.0],
        [-240.0, 139.0],
        [-240.0, -139.0],
    ]
    return {
        "airspeed_mps": airspeed,
        "bank_rad": b,
        "open_loop": [*pair(5.0, 0.55), *pair(0.18, 0.08 + 0.1 * b * b), *pair(2.8, 0.25), *real],
        "closed_loop": [
            *pair(6.0, 0.7),
            *pair(1.1, 0.75),
            *pair(3.4, 0.62),
            *pair(1.4, 0.85),
            *closed,
        ],
    }


def margins(airspeed, bank_deg, between):
    away = abs(airspeed - 55.0) / 10.0 + abs(bank_deg) / 33.0
    rows = []
    for i, loop in enumerate((*LOOPS, "all controls")):
        together = loop == "all controls"
        rows.append({
            "airspeed_mps": airspeed, "bank_rad": math.radians(bank_deg), "between": between, "stable": True, "loop": loop,
            "gain_db": None if together or loop == "throttle" else 11.0 + 2.0 * i - 2.2 * away,
            "phase_deg": None if together else 75.0 - 3.0 * i - 2.0 * away,
            "crossover": None if together else 6.0 / (1 + i),
            "disk_gain_db": 9.0 + i - 1.5 * away - 8.0 * together,
            "disk_phase_deg": 52.0 + i - 3.0 * away - 20.0 * together,
        })  # fmt: skip
    return rows


def robustness(case, i, airspeed, bank_deg):
    away = abs(airspeed - 55.0) / 10.0 + abs(bank_deg) / 33.0
    return {
        "case": case, "periods_late": int(case.endswith("of delay")), "airspeed_mps": airspeed, "bank_rad": math.radians(bank_deg),
        "stable": True, "gain_db": 8.5 - 0.5 * i - away, "gain_loop": "elevator",
        "phase_deg": 46.0 - 2.0 * i - away, "phase_loop": "heading_rate",
    }  # fmt: skip


def loop_shape(name, i):
    """Return an integrator with two lags and a delay; the phase of some is a turn too high."""
    frequency = np.logspace(-2.0, 2.0, 161)
    s = 1j * frequency
    loop = 6.0 / (1 + i) / s / (1.0 + s / 25.0) ** 2 * (1.0 + 0.3 * i / (1.0 + s))
    phase = np.unwrap(np.angle(loop)) - 0.03 * frequency + (2.0 * math.pi if i % 2 else 0.0)
    return {
        "loop": name, "airspeed_mps": 55.0, "bank_rad": 0.0, "frequency_rad_s": frequency.tolist(),
        "gain_db": (20.0 * np.log10(np.abs(loop))).tolist(), "phase_deg": np.degrees(phase).tolist(),
    }  # fmt: skip


def responses():
    steps = (
        ("heading_rate", 0.05, 1.5, 0.9),
        ("airspeed", 1.0, 1.1, 0.75),
        ("altitude", 1.0, 0.9, 0.8),
    )
    rows = []
    for command, size, frequency, ratio in steps:
        for kind, slower, less in (
            ("predicted", 1.0, 0.0),
            ("flown", 0.96, 0.05),
            ("model", 1.0, -0.01),
        ):
            if kind != "model" or command == "heading_rate":
                rows.append(response(kind, command, size, slower * frequency, ratio - less))
    return rows


def response(kind, command, size, frequency, ratio):
    time = np.linspace(0.0, 12.0, 241)
    damped = frequency * math.sqrt(1.0 - ratio**2)
    decay = np.exp(-ratio * frequency * time)
    step = 1.0 - decay * (
        np.cos(damped * time) + ratio * frequency / damped * np.sin(damped * time)
    )
    bump = time * decay
    names = (
        "airspeed",
        "altitude",
        "heading_rate",
        "roll",
        "sideslip",
        "elevator",
        "aileron",
        "throttle",
    )
    channels = dict.fromkeys(names, 0.05 * size * bump)
    if command == "heading_rate":
        channels |= {
            "roll": 0.28 * step,
            "altitude": -2.0 * bump * size,
            "airspeed": -0.5 * bump * size,
        }
    channels[command] = size * step
    if kind == "model":
        channels = {"heading_rate": channels["heading_rate"]}
    return {
        "kind": kind, "command": command, "size": size, "rise_time_s": 1.8 / frequency, "overshoot": float(step.max() - 1.0),
        **{
            f"{name}_largest_{unit}": float(np.abs(channels[name]).max())
            for name, unit in (("altitude", "m"), ("airspeed", "mps"))
            if name in channels and name != command
        },
        "time_s": time.tolist(), "channels": {name: values.tolist() for name, values in channels.items()},
    }  # fmt: skip
