"""Tables of a design."""

import math
from typing import Any

from reports.design.data import (
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
from reports.document.tables import minus, number, pairs_table


def worst_margin_table(design: Record) -> Table:
    """Return the least of each margin of each loop over the grid and between its points, and where
    that is.
    """
    rows = []
    for loop in loops_of(design["margins"]):
        own = [row for row in design["margins"] if row["loop"] == loop]
        gain, phase, disk = (worst(own, key) for key in ("gain_db", "phase_deg", "disk_gain_db"))
        rows.append(
            [
                loop_name(own[0]),
                *_margin_cells(gain, "gain_db", loop),
                *_margin_cells(phase, "phase_deg", loop),
                down(disk["disk_gain_db"]) if disk else "∞",
                down(disk["disk_phase_deg"]) if disk else "∞",
                where(disk) if disk else "",
            ]
        )
    head = [
        "Loop opened at",
        "Gain [dB]",
        "at",
        "Phase [deg]",
        "at",
        "Disk gain [dB]",
        "Disk phase [deg]",
        "at",
    ]
    return Table(head=head, rows=rows, widths=[1.15, 0.85, 1.35, 0.95, 1.35, 1.1, 1.1, 1.35])


def _margin_cells(row: Record | None, key: str, loop: str) -> list[str]:
    if row is None:
        return ["–" if loop == "all controls" else "∞", ""]
    return [down(row[key]), where(row)]


def robustness_table(design: Record) -> Table:
    """Return the least margins of any loop under each perturbation, and where they are."""
    required = design["required"]
    rows = []
    for case in dict.fromkeys(row["case"] for row in design["robustness"]):
        own = [row for row in design["robustness"] if row["case"] == case]
        gain, phase = worst(own, "gain_db"), worst(own, "phase_deg")
        short = short_of(own, "gain_db", required["perturbed_gain_db"]) + short_of(
            own, "phase_deg", required["perturbed_phase_deg"]
        )
        rows.append(
            [
                case_name(own[0]),
                *_perturbed(gain, "gain"),
                *_perturbed(phase, "phase"),
                "no" if short else "yes",
            ]
        )
    head = ["Perturbation", "Gain [dB]", "of", "at", "Phase [deg]", "of", "at", "Met"]
    return Table(head=head, rows=rows, widths=[1.8, 0.75, 0.9, 1.15, 0.95, 0.9, 1.15, 0.4])


def _perturbed(row: Record | None, name: str) -> list[str]:
    key = "gain_db" if name == "gain" else "phase_deg"
    return (
        [down(row[key]), str(row[f"{name}_loop"]).replace("_", " "), where(row)]
        if row
        else ["∞", "", ""]
    )


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
        slowest = max(poles, key=lambda item: item[1][0])
        swinging = [item for item in poles if item[1][1] > 0.0]
        least = min(swinging, key=lambda item: damping(item[1]), default=None)
        cells = [
            name,
            minus(f"{slowest[1][0]:.3g}"),
            where(slowest[0]),
            minus(f"{damping(least[1]):.2f}") if least else "–",
            f"{math.hypot(*least[1]):.2f}" if least else "–",
            where(least[0]) if least else "",
        ]
        rows.append(cells)
    head = ["", "Largest real part [1/s]", "at", "Least damping [-]", "Frequency [rad/s]", "at"]
    return Table(
        caption=(
            "The slowest and the least damped pole, with and without the autopilot, and where"
            " they are."
        ),
        head=head,
        rows=rows,
        widths=[1.3, 1.2, 1.2, 1.1, 1.1, 1.2],
    )


def step_table(design: Record) -> Table:
    """Return what the steps show."""
    rows = [
        [
            f"{response['command'].replace('_', ' ')}, " + minus(f"{response['size']:g}"),
            "reference model" if response["kind"] == "model" else str(response["kind"]),
            number(response["rise_time_s"], "{:.2f}"),
            f"{100 * response['overshoot']:.1f}",
            *(
                _moved(response, channel)
                for channel in ("altitude_largest_m", "airspeed_largest_mps")
            ),
        ]
        for command in dict.fromkeys(response["command"] for response in design["responses"])
        for response in responses_of(design, command)
    ]
    head = [
        "Step [rad/s, m/s, m]",
        "",
        "Rise 10–90 % [s]",
        "Overshoot [%]",
        "Altitude moves [m]",
        "Airspeed moves [m/s]",
    ]
    return Table(
        caption="What the steps show.",
        head=head,
        rows=rows,
        widths=[1.4, 1.1, 1.2, 1.0, 1.25, 1.5],
        left_columns=2,
    )


def _moved(response: Record, key: str) -> str:
    """Return how far a quantity moves; a reference model has no such quantity."""
    return "–" if response["kind"] == "model" else number(response.get(key), "{:.3f}")


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
"""Of the weights of a design record, by their names."""


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
