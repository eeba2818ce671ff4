"""How each loop of an autopilot is drawn, the same in every figure."""

from reports.document.chart import Style

LOOP_STYLES: dict[str, tuple[str, Style]] = {
    "elevator": ("blue", "solid"),
    "aileron": ("orange", "solid"),
    "throttle": ("green", "thin"),
    "rudder": ("plum", "solid"),
    "altitude": ("blue", "dash"),
    "heading_rate": ("orange", "dash"),
    "airspeed": ("green", "dot"),
    "sideslip": ("plum", "dash"),
    "all controls": ("black", "solid"),
}
"""Colour and style by loop: a measurement has the colour of the control that mostly regulates it,
dashed or dotted. Blue and green, which are alike in grey, have other styles."""

OTHER_LOOP: tuple[str, Style] = ("grey", "solid")
"""Of a loop that the table does not know."""
