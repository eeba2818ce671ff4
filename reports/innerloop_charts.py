"""Figures of the autopilot's design."""

from typing import Any

import numpy as np

from reports.chart import Chart, Line, Panel, constant

Record = dict[str, Any]

_LOOP_COLOURS = ("blue", "vermillion", "green", "orange", "purple", "sky")
_COMMANDS = {
    "heading_rate": ("Heading rate [rad/s]", "heading-rate step"),
    "airspeed": ("Airspeed [m/s]", "airspeed step"),
    "altitude": ("Altitude [m]", "altitude step"),
}


def innerloop_charts(design: Record) -> list[Chart]:
    """Return the figures of a design record: responses, margins over airspeed, loop shapes, poles."""
    return [_responses(design), _margins(design), _loops(design), _poles(design)]


def _responses(design: Record) -> Chart:
    panels = []
    for command, (own_label, title) in _COMMANDS.items():
        for channel in (command, *(name for name in ("airspeed", "altitude", "roll") if name != command))[:3]:
            label = own_label if channel == command else _COMMANDS.get(channel, ("Bank [deg]", ""))[0]
            scale = np.degrees(1.0) if channel == "roll" else 1.0
            lines = []
            for response in design["responses"]:
                if response["command"] == command:
                    predicted = response["kind"] == "predicted"
                    lines.append(
                        Line(
                            x=np.array(response["time_s"]),
                            y=scale * np.array(response["channels"][channel]),
                            label="linear design" if predicted else "flown in JSBSim",
                            colour="orange" if predicted else "blue",
                            style="dash" if predicted else "solid",
                        )
                    )
            panels.append(Panel(x_label="Time [s]", y_label=label, lines=lines, title=title if channel == command else ""))
    return Chart(
        name="responses",
        caption="Step responses about level flight: the linear design's prediction and what JSBSim flies. Columns: the commanded"
        " quantity, and what else moves. Deviations from trim.",
        panels=panels,
        columns=3,
        panel_height=0.24,
    )


def _margins(design: Record) -> Chart:
    loops = list(dict.fromkeys(m["loop"] for m in design["margins"]))

    def panel(name: str, label: str, limit: float, top: float) -> Panel:
        lines = []
        for i, loop in enumerate(loops):
            rows = [m for m in design["margins"] if m["loop"] == loop and m[name] is not None]
            if rows:
                lines.append(
                    Line(
                        x=np.array([m["airspeed_mps"] for m in rows]),
                        y=np.array([m[name] for m in rows]),
                        label=loop.replace("_", " "),
                        colour=(*_LOOP_COLOURS, "black")[i % 7],
                    )
                )
        x = np.array(design["airspeeds_mps"])
        lines.append(Line(x=x, y=constant(x, limit), label="required", colour="black", style="dash"))
        return Panel(x_label="Design airspeed [m/s]", y_label=label, lines=lines, y_range=(0.0, top))

    return Chart(
        name="margins",
        caption="Margins with one loop opened and all others closed, servos, propeller and computing delay included; disk margins"
        " allow for gain and phase changing together, “all controls” for all three controls changing independently.",
        panels=[
            panel("gain_db", "Gain margin [dB]", 6.0, 40.0),
            panel("phase_deg", "Phase margin [deg]", 45.0, 95.0),
            panel("disk_gain_db", "Disk gain margin [dB]", 6.0, 25.0),
            panel("disk_phase_deg", "Disk phase margin [deg]", 45.0, 95.0),
        ],
        columns=2,
        panel_height=0.3,
    )


def _loops(design: Record) -> Chart:
    gain, phase = [], []
    for loop, colour in zip(design["loops"], _LOOP_COLOURS, strict=False):
        x = np.array(loop["frequency_rad_s"])
        label = loop["loop"].replace("_", " ")
        gain.append(Line(x=x, y=np.array(loop["gain_db"]), label=label, colour=colour))
        phase.append(Line(x=x, y=np.array(loop["phase_deg"]), label=label, colour=colour))
    x = np.array(design["loops"][0]["frequency_rad_s"])
    limits = (float(x[0]), float(x[-1]))
    gain.append(Line(x=np.array(limits), y=np.zeros(2), label="crossover", colour="black", style="dash"))
    return Chart(
        name="loops",
        caption=f"Open loops at {design['design_airspeed_mps']:g} m/s, one opened at a time.",
        panels=[
            Panel(x_label="Frequency [rad/s]", y_label="Gain [dB]", lines=gain, log_x=True, x_range=limits, y_range=(-60.0, 60.0)),
            Panel(x_label="Frequency [rad/s]", y_label="Phase [deg]", lines=phase, log_x=True, x_range=limits),
        ],
        share_x=True,
        panel_height=0.27,
    )


def _poles(design: Record) -> Chart:
    index = design["airspeeds_mps"].index(design["design_airspeed_mps"])
    poles = design["poles"][index]

    def points(name: str, label: str, colour: str, style: Any) -> Line:
        values = np.array(poles[name])
        return Line(x=values[:, 0], y=values[:, 1], label=label, colour=colour, style=style)

    return Chart(
        name="poles",
        caption=f"Poles at {design['design_airspeed_mps']:g} m/s, up to 45 1/s: the bare aircraft with servos and propeller,"
        " and under the autopilot.",
        panels=[
            Panel(
                x_label="Real part [1/s]",
                y_label="Imaginary part [rad/s]",
                lines=[
                    points("open_loop", "aircraft", "orange", "diamonds"),
                    points("closed_loop", "under the autopilot", "blue", "points"),
                ],
                x_range=(-45.0, 2.0),
                y_range=(-20.0, 20.0),
            )
        ],
        panel_height=0.36,
    )
