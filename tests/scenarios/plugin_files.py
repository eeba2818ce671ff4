"""The parts of docs/howto/extending.md, each a file of its own, and scenarios that fly them."""

import re
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "extending.md"
BLOCKS = re.findall(r'^```python\n("""(my\w+\.py): .*?)^```$', PAGE.read_text("utf-8"), re.M | re.S)
# 19.1 m/s is nearer to the design of the X8, which tests have.
FILES = {name: text.replace("airspeed=18.0", "airspeed=19.1") for text, name in BLOCKS}
LAW, INSTRUMENT = FILES["mylaw.py"].replace("MyLaw", "Pursuit"), FILES["myinstrument.py"]

PARTS = {
    "guidance.law": "mylaw.py:MyLaw",
    "plume.model": "myplume.py:Slanted",
    "vessel.track": "mytrack.py:Weaving",
    "payload": "myinstrument.py:Sniffer",
    "aircraft": "myaircraft.py:SLOW_X8",
}
"""The key that takes each part, and its name."""

SHORT = """
title = "parts of others"
fidelity = "kinematic"
sweep.nu = [0.3, 0.5]
guidance.rate_hz = 5.0
flight.log_rate_hz = 5.0
flight.crossings = 2
criteria.crossing_interval_error = 0.2
start.spread_deg = 10.0
"""


def write_scenario(folder, lines, text=None):
    """Write a sweep with some lines more, and beside it the parts, or ``own.py`` with ``text``;
    return the scenario's path.
    """
    for file, content in ({"own.py": text} if text else FILES).items():
        (folder / file).write_text(content, encoding="utf-8")
    path = folder / "own.toml"
    path.write_text(SHORT + lines, encoding="utf-8")
    return str(path)


def line_of(key, name):
    """Return the lines of a scenario file that name a part, and declare what it does."""
    if key == "vessel.track":
        return f'{key} = "{name}"\nfollowing.vessel_acceleration_mps2 = 0.05\n'
    return f'{key} = ["{name}"]\n' if key == "payload" else f'{key} = "{name}"\n'
