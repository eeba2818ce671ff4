"""Tables of a design."""

import math
from collections.abc import Callable
from typing import Any

from reports.design.data import (
    TOGETHER,
    Record,
    case_name,
    damping,
    down,
    loop_name,
    loops_of,
    responses_of,
    short_of,
    speed,
    where,
    worst,
)
from reports.document.blocks import Table
from reports.document.tables import Cell, minus, number, pairs_table, rows_table


def worst_margin_table(design: Record) -> Table:
    """Return the least of each margin of each loop over the grid and between its points, and where
    that is.
    """
    rows = [
        {"name": loop_name(own[0])}
        | {key: worst(own, key) for key in ("gain_db", "phase_deg", "disk_gain_db")}
        | {"classical": loop != TOGETHER}
        for loop in loops_of(design["margins"])
        if (own := [row for row in design["margins"] if row["loop"] == loop])
    ]
    cells = [
        Cell("Loop opened at", "name", width=1.15),
        Cell("Gain [dB]", _margin("gain_db"), width=0.85),
        Cell("at", _where("gain_db"), width=1.35),
        Cell("Phase [deg]", _margin("phase_deg"), width=0.95),
        Cell("at", _where("phase_deg"), width=1.35),
        Cell("Disk gain [dB]", _margin("disk_gain_db"), width=1.1),
        Cell("Disk phase [deg]", _margin("disk_gain_db", "disk_phase_deg"), width=1.1),
        Cell("at", _where("disk_gain_db"), width=1.35),
    ]
    return rows_table(rows, cells)


def _margin(key: str, shown: str = "") -> Callable[[Record], str]:
    """Return what writes a margin; one without a value is unlimited, and all controls together have
    no classical one.
    """

    def cell(of: Record) -> str:
        if of[key]:
            return down(of[key][shown or key])
        return "∞" if of["classical"] or key == "disk_gain_db" else "–"

    return cell


def _where(key: str) -> Callable[[Record], str]:
    return lambda of: where(of[key]) if of[key] else ""


def robustness_table(design: Record) -> Table:
    """Return the least margins of any loop under each perturbation, and where they are."""
    required = design["required"]
    rows = [
        {
            "name": case_name(own[0]),
            "gain_db": worst(own, "gain_db"),
            "phase_deg": worst(own, "phase_deg"),
            "classical": True,
            "short": short_of(own, "gain_db", required["perturbed_gain_db"])
            + short_of(own, "phase_deg", required["perturbed_phase_deg"]),
        }
        for case in dict.fromkeys(row["case"] for row in design["robustness"])
        if (own := [row for row in design["robustness"] if row["case"] == case])
    ]
    cells = [
        Cell("Perturbation", "name", width=1.8),
        Cell("Gain [dB]", _margin("gain_db"), width=0.75),
        Cell("of", _loop("gain"), width=0.9),
        Cell("at", _where("gain_db"), width=1.15),
        Cell("Phase [deg]", _margin("phase_deg"), width=0.95),
        Cell("of", _loop("phase"), width=0.9),
        Cell("at", _where("phase_deg"), width=1.15),
        Cell("Met", lambda of: "no" if of["short"] else "yes", width=0.4),
    ]
    return rows_table(rows, cells)


def _loop(kind: str) -> Callable[[Record], str]:
    key = {"gain": "gain_db", "phase": "phase_deg"}[kind]
    return lambda of: _words(of[key][f"{kind}_loop"]) if of[key] else ""


def pole_table(design: Record) -> Table:
    """Return the slowest and the least damped pole, with and without the autopilot, and where they
    are.
    """
    rows = []
    for kind, name in (("open_loop", "aircraft"), ("closed_loop", "under the autopilot")):
        poles = [
            (point, (float(pole[0]), float(pole[1])))
            for point in design["poles"]
            for pole in point[kind]
        ]
        swinging = [item for item in poles if item[1][1] > 0.0]
        least = min(swinging, key=lambda item: damping(item[1]), default=None)
        slowest = max(poles, key=lambda item: item[1][0])
        rows.append({"name": name, "slowest": slowest, "least": least})
    cells = [
        Cell("", "name", width=1.3),
        Cell("Largest real part [1/s]", lambda of: of["slowest"][1][0], "{:.3g}", 1.2),
        Cell("at", lambda of: where(of["slowest"][0]), width=1.2),
        Cell("Least damping [-]", lambda of: of["least"] and damping(of["least"][1]), "{:.2f}"),
        Cell("Frequency [rad/s]", lambda of: of["least"] and math.hypot(*of["least"][1]), "{:.2f}"),
        Cell("at", lambda of: where(of["least"][0]) if of["least"] else "", width=1.2),
    ]
    return rows_table(rows, cells, caption=_POLES)


_POLES = (
    "The slowest and the least damped pole, with and without the autopilot, and where they are."
)


def step_table(design: Record) -> Table:
    """Return what the steps show."""
    commands = dict.fromkeys(response["command"] for response in design["responses"])
    cells = [
        Cell("Step [rad/s, m/s, m]", _step, width=1.4),
        Cell("", lambda of: "reference model" if of["kind"] == "model" else of["kind"], width=1.1),
        Cell("Rise 10–90 % [s]", "rise_time_s", "{:.2f}", 1.2),
        Cell("Overshoot [%]", lambda of: 100.0 * of["overshoot"], "{:.1f}"),
        Cell("Altitude moves [m]", _moved("altitude_largest_m"), "{:.3f}", 1.25),
        Cell("Airspeed moves [m/s]", _moved("airspeed_largest_mps"), "{:.3f}", 1.5),
    ]
    rows = [response for command in commands for response in responses_of(design, command)]
    return rows_table(rows, cells, caption="What the steps show.", left_columns=2)


def _step(response: Record) -> str:
    return f"{_words(response['command'])}, " + minus(f"{response['size']:g}")


def _moved(key: str) -> Callable[[Record], float | None]:
    """Return what says how far a quantity moves; a reference model has no such quantity."""
    return lambda of: None if of["kind"] == "model" else of.get(key)


def verification_table(design: Record) -> Table:
    """Return the error of the linear model by input, a row each, and output, a column each."""
    outputs = list(dict.fromkeys(row["output"] for row in design["verification"]))
    errors = {(row["input"], row["output"]): row["error"] for row in design["verification"]}
    inputs = list(dict.fromkeys(row["input"] for row in design["verification"]))
    rows = [
        [
            _words(name),
            *(number(_percent(errors.get((name, output))), "{:.2f}") for output in outputs),
        ]
        for name in inputs
    ]
    head = ["Input", *(f"{_words(output)} [%]" for output in outputs)]
    return Table(
        caption="Error of the linear model, by input and output.",
        head=head,
        rows=rows,
        widths=[1.3] + [1.0] * len(outputs),
    )


def _percent(error: Any) -> float | None:
    return None if error is None else 100.0 * float(error)


def _words(name: str) -> str:
    return name.replace("_", " ")


_WEIGHT_UNITS = {
    "airspeed": "m/s", "pitch": "rad", "pitch_rate": "rad/s", "altitude": "m",
    "airspeed_integral": "m",
    "altitude_integral": "m s", "roll": "rad", "roll_rate": "rad/s", "sideslip": "rad",
    "heading_integral": "rad",
    "sideslip_integral": "rad s", "model_frequency": "rad/s", "model_damping": "-",
    "altitude_error_max": "m",
    "airspeed_error_max": "m/s", "anti_windup_rate": "1/s",
}  # fmt: skip
"""Units of the weights of a design record, by their names."""


def weight_table(design: Record) -> Table:
    """Return the acceptable deviations that the gains follow from, and what else the autopilot was
    designed with, as pairs.
    """
    pairs = [[_weight(name), f"{value:.3g}"] for name, value in design["weights"].items()]
    if "model_frequency_rad_s" in design and "model_frequency" not in design["weights"]:
        pairs += [
            ["heading-rate model: frequency [rad/s]", f"{design['model_frequency_rad_s']:.3g}"],
            ["heading-rate model: damping [-]", f"{design['model_damping']:g}"],
        ]
    pairs.append(["autopilot: computations a second [Hz]", f"{design['autopilot_rate_hz']:.3g}"])
    half = -(-len(pairs) // 2)
    rows = [
        [*left, *(pairs[half + i] if half + i < len(pairs) else ["", ""])]
        for i, left in enumerate(pairs[:half])
    ]
    return Table(
        caption=(
            "Acceptable deviations, from which the gains follow; the heading-rate model, limits"
            " of errors, and rates."
        ),
        head=["Quantity", "Value", "Quantity", "Value"],
        rows=rows,
        widths=[2.0, 0.7, 2.0, 0.7],
        left_columns=4,
    )


def _weight(name: str) -> str:
    unit = _WEIGHT_UNITS.get(name)
    return _words(name) + (f" [{unit}]" if unit else "")


def envelope_table(envelope: Record) -> Table:
    """Return where the aircraft may be flown, and where the study flies it."""
    stall = envelope["stall_airspeed_mps"]
    rows = [
        [
            "Airspeed that may be commanded",
            f"{round(envelope['airspeed_min_mps'], 1):g} to {speed(envelope['airspeed_max_mps'])}",
        ],
        ["Airspeed of the study", speed(envelope["airspeed_mps"])],
        ["Stall", "not known" if stall is None else f"{stall:.1f} m/s"],
        ["Largest bank commanded", f"{envelope['bank_max_deg']:g}°"],
        ["Bank of the study", f"{envelope['bank_deg']:g}°"],
    ]
    caption = "Where the aircraft may be flown, and where the study flies it."
    return pairs_table(rows, widths=(1.6, 3.0), caption=caption, print_size_pt=8.0)
