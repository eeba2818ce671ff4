"""Figures of the autopilot's design."""

from typing import Any

import numpy as np

from reports.design.data import (
    FAST,
    Record,
    at_middle,
    bank_deg,
    loop_name,
    loops_of,
    responses_of,
    speed,
)
from reports.design.loop_charts import turned
from reports.design.loop_styles import LOOP_STYLES, OTHER_LOOP
from reports.design.response_charts import RESPONSE_STYLES
from reports.document.axes import cut_words
from reports.document.chart import Chart, Line, Panel, constant
from reports.document.palette import Meaning

_COMMANDS = {
    "heading_rate": ("Heading rate [rad/s]", "heading rate"),
    "airspeed": ("Airspeed [m/s]", "airspeed"),
    "altitude": ("Altitude [m]", "altitude"),
}


def step_charts(design: Record) -> list[Chart]:
    """Return the responses of a complete design record to a step of each command, in level flight."""
    charts: list[Chart] = []
    for command, (own_label, title) in _COMMANDS.items():
        panels = []
        for channel in (
            command,
            *(name for name in ("airspeed", "altitude", "roll") if name != command),
        )[:3]:
            label = (
                own_label if channel == command else _COMMANDS.get(channel, ("Bank [deg]", ""))[0]
            )
            scale = np.degrees(1.0) if channel == "roll" else 1.0
            lines = []
            for response in responses_of(design, command):
                if channel in response["channels"]:
                    kind, colour, style = RESPONSE_STYLES[response["kind"]]
                    x, y = (
                        np.array(response["time_s"]),
                        scale * np.array(response["channels"][channel]),
                    )
                    lines.append(Line(x=x, y=y, label=kind, colour=colour, style=style))
            panels.append(Panel(x_label="Time [s]", y_label=label, lines=lines))
        caption = (
            f"A step of the {title} from level flight, and what else moves: deviations from trim."
        )
        told = " The linear design's prediction, and what JSBSim flies." if not charts else ""
        charts.append(
            Chart(
                name=f"step{len(charts) + 1}",
                caption=caption + told,
                panels=panels,
                columns=3,
                panel_height=0.25,
            )
        )
    return charts


def loop_charts(design: Record) -> list[Chart]:
    """Return the other figures of a complete design record, of level flight alone: margins, loop
    shapes, poles.
    """
    return [*_margins(design), _loops(design), _poles(design)]


def _margins(design: Record) -> list[Chart]:
    required = design["required"]
    level = [m for m in design["margins"] if not (bank_deg(m) or m["between"])]

    def panel(name: str, label: str, limit: float | None, top: float) -> Panel:
        lines = []
        for loop in loops_of(level):
            rows = [m for m in level if m["loop"] == loop and m[name] is not None]
            if rows:
                x, y = (
                    np.array([m["airspeed_mps"] for m in rows]),
                    np.array([m[name] for m in rows]),
                )
                colour, style = LOOP_STYLES.get(loop, OTHER_LOOP)
                lines.append(Line(x=x, y=y, label=loop_name(rows[0]), colour=colour, style=style))
        if limit is not None:
            x = np.array(design["airspeeds_mps"])
            lines.append(
                Line(
                    x=x, y=constant(x, limit), label="required", colour=Meaning.LIMIT, style="dash"
                )
            )
        return Panel(
            x_label="Design airspeed [m/s]", y_label=label, lines=lines, y_range=(0.0, top)
        )

    kinds = (
        (
            "margins", "", "Margins with one loop opened and all others closed, servos, engine and computing delay included.",
            ("Gain margin [dB]", 40.0), ("Phase margin [deg]", 95.0),
        ),
        (
            "diskmargins", "disk_", "Disk margins allow for gain and phase changing together, “all controls” for every control"
            " changing independently.", ("Disk gain margin [dB]", 25.0), ("Disk phase margin [deg]", 95.0),
        ),
    )  # fmt: skip
    charts = []
    for name, prefix, caption, gain, phase in kinds:
        # Nothing is required of disk margins.
        panels = [
            panel(f"{prefix}{key}", label, None if prefix else required[key], top)
            for key, (label, top) in (("gain_db", gain), ("phase_deg", phase))
        ]
        charts.append(
            Chart(
                name=f"level{name}",
                caption=caption + cut_words(panels),
                panels=panels,
                columns=2,
                panel_height=0.3,
            )
        )
    return charts


def _loops(design: Record) -> Chart:
    gain, phase = [], []
    for loop in design["loops"]:
        x = np.array(loop["frequency_rad_s"])
        colour, style = LOOP_STYLES.get(loop["loop"], OTHER_LOOP)
        gain.append(
            Line(
                x=x, y=np.array(loop["gain_db"]), label=loop_name(loop), colour=colour, style=style
            )
        )
        phase.append(Line(x=x, y=turned(loop), label=loop_name(loop), colour=colour, style=style))
    x = np.array(design["loops"][0]["frequency_rad_s"])
    limits = (float(x[0]), float(x[-1]))
    gain.append(
        Line(x=np.array(limits), y=np.zeros(2), label="crossover", colour="black", style="dot")
    )
    panels = [
        Panel(
            x_label="Frequency [rad/s]",
            y_label="Gain [dB]",
            lines=gain,
            log_x=True,
            x_range=limits,
            y_range=(-60.0, 60.0),
        ),
        Panel(
            x_label="Frequency [rad/s]",
            y_label="Phase [deg]",
            lines=phase,
            log_x=True,
            x_range=limits,
        ),
    ]
    return Chart(
        name="loops",
        caption=f"Open loops at {speed(design['design_airspeed_mps'])}, one opened at a time.{cut_words(panels)}",
        panels=panels,
        share_x=True,
        panel_height=0.27,
    )


def _poles(design: Record) -> Chart:
    poles = at_middle(design, design["poles"])[0]
    reach = _reach([*poles["open_loop"], *poles["closed_loop"]])

    def points(name: str, label: str, colour: str, style: Any) -> Line:
        values = np.array(poles[name])
        return Line(x=values[:, 0], y=values[:, 1], label=label, colour=colour, style=style)

    return Chart(
        name="poles",
        caption=f"Poles at {speed(design['design_airspeed_mps'])}, up to {FAST:g} 1/s: the bare aircraft with servos and engine,"
        " and under the autopilot.",
        panels=[
            Panel(
                x_label="Real part [1/s]",
                y_label="Imaginary part [rad/s]",
                lines=[
                    points("open_loop", "aircraft", "orange", "diamonds"),
                    points("closed_loop", "under the autopilot", "blue", "points"),
                ],
                x_range=(-reach, 0.05 * reach),
                y_range=(-0.45 * reach, 0.45 * reach),
            )
        ],
        panel_height=0.36,
    )


def _reach(poles: list[list[float]]) -> float:
    """Return how far the s-plane is shown [1/s]: to hold every pole that is not too fast, in its
    width and in its height.
    """
    sizes = [1.1 * max(-real, abs(imaginary) / 0.45) for real, imaginary in poles]
    return max((size for size in sizes if size <= FAST), default=FAST)
