"""The autopilot's design, as a section of a report."""

import math

from reports.blocks import Heading, Section, Table
from reports.innerloop_charts import Record, innerloop_charts
from reports.tables import number


def innerloop_section(design: Record) -> Section:
    """Return the section on a design record: step responses, margins, loop shapes, poles and trims."""
    responses, *others = innerloop_charts(design)
    return Section(
        anchor="innerloop",
        title="Autopilot",
        blocks=[
            responses,
            _step_table(design),
            Heading("Margins at the middle design airspeed"),
            _margin_table(design),
            *others,
            Heading("Equilibria: level, and at 45 degrees of bank"),
            _trim_table(design),
        ],
    )


def _margin_table(design: Record) -> Table:
    """Return the margins at the middle design airspeed."""
    airspeed = design["design_airspeed_mps"]
    rows = [
        [
            m["loop"].replace("_", " "),
            _margin(m["gain_db"], "{:.1f}", m["loop"]),
            _margin(m["phase_deg"], "{:.1f}", m["loop"]),
            number(m["crossover"], "{:.2f}"),
            number(m["disk_gain_db"], "{:.1f}"),
            number(m["disk_phase_deg"], "{:.1f}"),
        ]
        for m in design["margins"]
        if m["airspeed_mps"] == airspeed
    ]
    head = ["Loop opened at", "Gain [dB]", "Phase [deg]", "Crossover [rad/s]", "Disk gain [dB]", "Disk phase [deg]"]
    return Table(head=head, rows=rows, widths=[1.6, 1.0, 1.0, 1.2, 1.1, 1.2])


def _step_table(design: Record) -> Table:
    """Return what the flown steps show."""
    rows = [
        [
            f"{response['command'].replace('_', ' ')}, {response['size']:g}",
            response["kind"],
            number(response["rise_time_s"], "{:.2f}"),
            f"{100 * response['overshoot']:.1f}",
            f"{response['altitude_largest_m']:.3f}",
            f"{response['airspeed_largest_mps']:.3f}",
        ]
        for response in design["responses"]
    ]
    head = ["Step [rad/s, m/s, m]", "", "Rise 10–90 % [s]", "Overshoot [%]", "Altitude moves [m]", "Airspeed moves [m/s]"]
    return Table(head=head, rows=rows, widths=[1.6, 0.9, 1.2, 1.0, 1.2, 1.3], left_columns=2)


def _trim_table(design: Record) -> Table:
    """Return the equilibria behind the design."""
    rows = [
        [
            f"{t['airspeed_mps']:g}",
            f"{round(math.degrees(t['bank_rad']), 1) + 0.0:.1f}",
            f"{t['alpha_rad']:.4f}",
            f"{t['sideslip_rad']:.4f}",
            f"{t['pitch_rad']:.4f}",
            f"{t['yaw_rate_rad_s']:.4f}",
            f"{t['elevator_position']:.4f}",
            f"{t['aileron_position']:.4f}",
            f"{t['throttle']:.3f}",
        ]
        for t in design["trims"]
    ]
    head = [
        "Airspeed [m/s]", "Bank [deg]", "α [rad]", "β [rad]", "θ [rad]", "Yaw rate [rad/s]", "Elevator [rad]", "Aileron [rad]",
        "Throttle [-]",
    ]  # fmt: skip
    return Table(head=head, rows=rows, widths=[1.0] * 9, left_columns=0)


def _margin(value: float | None, pattern: str, loop: str) -> str:
    if value is None:
        return "–" if loop == "all controls" else "∞"
    return pattern.format(value)
