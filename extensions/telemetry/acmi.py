"""Tacview: ACMI 2.2, a text file of one flight (https://www.tacview.net/documentation/acmi/en/)."""

from pathlib import Path

from reports.export.geographic import Body, GeographicFlight, recorded_flights
from reports.run.run_data import RunData

_UAV, _VESSEL = "a1", "b2"
"""Numbers of the objects, in hexadecimal."""


class Acmi:
    """UAV and vessel; the keep-out area is drawn as the vessel's engagement range."""

    suffix = ".acmi"
    one_flight = True

    def write(self, run: RunData, path: Path) -> None:
        """Write one flight."""
        flight = next(recorded_flights(run))
        start = flight.epoch
        lines = [
            "FileType=text/acmi/tacview",
            "FileVersion=2.2",
            f"0,ReferenceTime={start}",
            f"0,RecordingTime={start}",
            f"0,Title={_escaped(flight.flight_id)}",
            "0,DataSource=plume-flight-study",
            f"0,Comments={_escaped(flight.height_reference)}",
        ]
        for i in range(len(flight.time)):
            lines.append(f"#{flight.time[i]:.3f}")
            named = ",Type=Air+FixedWing,Name=UAV,Color=Orange" if i == 0 else ""
            angles = f"{flight.roll[i]:.2f}|{flight.pitch[i]:.2f}|{flight.heading[i]:.2f}"
            lines.append(
                f"{_UAV},T={_place(flight.uav, i)}|{angles}{named},TAS={flight.airspeed[i]:.2f}"
            )
            if flight.vessel is not None:
                lines.append(_vessel_line(flight, flight.vessel, i))
        # A byte order mark, as the format requires.
        path.write_text("\ufeff" + "\n".join(lines) + "\n", encoding="utf-8", newline="\n")


def _vessel_line(flight: GeographicFlight, vessel: Body, i: int) -> str:
    named = (
        f",Type=Sea+Watercraft,Name=Vessel,Color=Blue,EngagementRange={flight.keepout_circle:g}"
        if i == 0
        else ""
    )
    return f"{_VESSEL},T={_place(vessel, i)}|0|0|{flight.vessel_heading[i]:.2f}{named}"


def _place(body: Body, i: int) -> str:
    return f"{body.longitude[i]:.8f}|{body.latitude[i]:.8f}|{body.altitude[i]:.3f}"


def _escaped(text: str) -> str:
    """Return a text with its backslashes, commas and line ends escaped."""
    return text.replace("\\", "\\\\").replace(",", "\\,").replace("\n", "\\\n")
