"""Figures of the step responses of a design: predicted, flown, and as the reference model asks."""

import math
from collections.abc import Sequence

import numpy as np

from reports.design.data import CONTROLS, Record, control_axis, responses_of, speed
from reports.document.chart import Chart, Line, Panel, Style
from reports.document.tables import minus

RESPONSE_STYLES: dict[str, tuple[str, str, Style]] = {
    "model": ("reference model", "black", "dot"),
    "predicted": ("linear design", "orange", "dash"),
    "flown": ("flown in JSBSim", "blue", "solid"),
}
"""Label, colour and style by the kind of a response."""

_DEGREES = math.degrees(1.0)
_CHANNELS: dict[str, tuple[str, float]] = {
    "heading_rate": ("Heading rate [rad/s]", 1.0),
    "roll": ("Bank [deg]", _DEGREES),
    "sideslip": ("Sideslip [deg]", _DEGREES),
    "altitude": ("Altitude [m]", 1.0),
    "airspeed": ("Airspeed [m/s]", 1.0),
}
"""Axis and scale by channel, but for those of controls."""

_FIRST = (
    ("heading_rate", "heading_rate", "Turn"),
    ("heading_rate", "roll", "Turn"),
    ("airspeed", "airspeed", "Airspeed step"),
    ("altitude", "altitude", "Altitude step"),
)
"""Command, channel and title of each panel of page 1."""

_TURN = ("heading_rate", "roll", "sideslip", "altitude", "airspeed", "aileron")
_CLIMB = {
    "airspeed": ("Airspeed step", ("airspeed", "altitude", "throttle")),
    "altitude": ("Altitude step", ("altitude", "airspeed", "elevator")),
}
"""Channels of the turn, and title and channels by the command of the other steps: the first is what
was commanded.
"""


def response_charts(design: Record) -> list[Chart]:
    """Return the responses to steps of heading rate, and of airspeed and altitude."""
    charts = [_turn(design), _climb(design)]
    return [chart for chart in charts if chart.panels]


def first_chart(design: Record) -> Chart | None:
    """Return what page 1 shows: a turn, and steps of airspeed and altitude; None of a design
    without step responses.
    """
    steps = [(responses_of(design, command), channel, title) for command, channel, title in _FIRST]
    panels = [
        _panel(design, responses, channel, title=title)
        for responses, channel, title in steps
        if _present([channel], responses)
    ]
    if not panels:
        return None
    caption = (
        "Steps of heading rate, airspeed and altitude from level flight at"
        f" {speed(design['design_airspeed_mps'])}: as the linear design predicts them, and as"
        " flown in JSBSim."
    )
    return Chart(name="first", caption=caption, panels=panels, columns=2)


def _turn(design: Record) -> Chart:
    responses = responses_of(design, "heading_rate")
    model = (
        " Dotted: the reference model that it is to follow."
        if "model" in {row["kind"] for row in responses}
        else ""
    )
    return Chart(
        name="turnresponse",
        caption=(
            f"A step of the heading-rate command by {_size(responses)} rad/s from level flight at"
            f" {speed(design['design_airspeed_mps'])}; deviations from trim.{model}"
        ),
        panels=[_panel(design, responses, channel) for channel in _present(_TURN, responses)],
        columns=2,
        panel_height=0.28,
    )


def _climb(design: Record) -> Chart:
    panels = []
    for command, (title, channels) in _CLIMB.items():
        responses = responses_of(design, command)
        panels += [
            _panel(design, responses, channel, title=title if channel == command else "")
            for channel in _present(channels, responses)
        ]
    return Chart(
        name="climbresponse",
        caption=(
            f"Steps of the airspeed command by {_size(responses_of(design, 'airspeed'))} m/s and"
            f" of the altitude command by {_size(responses_of(design, 'altitude'))} m, and what"
            " else moves. Deviations from trim."
        ),
        panels=panels,
        columns=max(1, len(panels) // 2),
        panel_height=0.26,
    )


def _present(channels: Sequence[str], responses: Sequence[Record]) -> list[str]:
    return [
        channel
        for channel in channels
        if any(channel in response["channels"] for response in responses)
    ]


def _size(responses: Sequence[Record]) -> str:
    return " and ".join(dict.fromkeys(minus(f"{response['size']:g}") for response in responses))


def _panel(design: Record, responses: Sequence[Record], channel: str, title: str = "") -> Panel:
    axis, scale = (
        (control_axis(design, channel), 1.0) if channel in CONTROLS else _CHANNELS[channel]
    )
    lines = []
    for response in responses:
        if channel in response["channels"]:
            label, colour, style = RESPONSE_STYLES[response["kind"]]
            x, y = np.array(response["time_s"]), scale * np.array(response["channels"][channel])
            lines.append(Line(x=x, y=y, label=label, colour=colour, style=style))
    return Panel(x_label="Time [s]", y_label=axis, lines=lines, title=title)
