"""The manifest of a design."""

from datetime import UTC, datetime, timedelta
from typing import Any

from common.provenance import provenance
from common.run_layout import FORMAT
from innerloop.designs.designed import Record


def design_manifest(record: Record, *, wall_time: float, command: str = "") -> dict[str, Any]:
    """Return the manifest of a design, from which its report takes title, description and
    provenance.

    Parameters
    ----------
    record : the design record
    wall_time : how long the design took [s], until now
    command : the command line; none if a program made the design
    """
    airspeeds = record["airspeeds_mps"]
    return {
        "format": FORMAT,
        "study": "design",
        "name": record["aircraft"],
        "title": f"Autopilot of the {record['title']}",
        "overrides": [],
        "state": "complete",
        "config": {
            "study": "design",
            "description": f"Designed at {record['altitude_m']:g} m of altitude for {airspeeds[0]:.4g} to {airspeeds[-1]:.4g} m/s:"
            " equilibria, linear models, gains, margins, and step responses flown in JSBSim.",
            "aircraft": record["aircraft"],
            "altitude_m": record["altitude_m"],
        },
        **provenance(),
        "command": command,
        "begun_utc": f"{datetime.now(UTC) - timedelta(seconds=wall_time):%Y-%m-%dT%H:%M:%SZ}",
        "wall_time_s": wall_time,
    }
