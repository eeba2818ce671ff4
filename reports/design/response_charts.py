"""Figures of the step responses of a design: predicted, flown, and as the reference model asks."""

import math
from collections.abc import Sequence

import numpy as np

from reports.design.data import Record, responses_of, speed
from reports.document.chart import Chart, Line, Panel, Style

RESPONSE_STYLES: dict[str, tuple[str, str, Style]] = {
    "model": ("reference model", "black", "dot"),
    "predicted": ("linear design", "orange", "dash"),
    "flown": ("flown in JSBSim", "blue", "solid"),
}
"""Label, colour and style by the kind of a response."""

_CHANNELS: dict[str, tuple[str, float]] = {
    "heading_rate": ("Heading rate [rad/s]", 1.0),
    "roll": ("Bank [deg]", math.degrees(1.0)),
    "altitude": ("Altitude [m]", 1.0),
    "airspeed": ("Airspeed [m/s]", 1.0),
}
"""Axis and scale by channel."""

_FIRST = (
    ("heading_rate", "heading_rate", "Turn"),
    ("heading_rate", "roll", "Turn"),
    ("airspeed", "airspeed", "Airspeed step"),
    ("altitude", "altitude", "Altitude step"),
)
"""Command, channel and title of each panel of page 1."""


def first_chart(design: Record) -> Chart | None:
    """Return what page 1 shows: a turn, and steps of airspeed and altitude; None of a design
    without step responses.
    """
    steps = [(responses_of(design, command), channel, title) for command, channel, title in _FIRST]
    panels = [
        _panel(responses, channel, title)
        for responses, channel, title in steps
        if any(channel in response["channels"] for response in responses)
    ]
    if not panels:
        return None
    caption = (
        "Steps of heading rate, airspeed and altitude from level flight at"
        f" {speed(design['design_airspeed_mps'])}: as the linear design predicts them, and as"
        " flown in JSBSim."
    )
    return Chart(name="first", caption=caption, panels=panels, columns=2)


def _panel(responses: Sequence[Record], channel: str, title: str) -> Panel:
    axis, scale = _CHANNELS[channel]
    lines = []
    for response in responses:
        if channel in response["channels"]:
            label, colour, style = RESPONSE_STYLES[response["kind"]]
            x, y = np.array(response["time_s"]), scale * np.array(response["channels"][channel])
            lines.append(Line(x=x, y=y, label=label, colour=colour, style=style))
    return Panel(x_label="Time [s]", y_label=axis, lines=lines, title=title)
