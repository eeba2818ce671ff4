"""The paper in one file: every equation can be found, and its Simulation 3 flies in a short script."""

import math
import re
import runpy
from pathlib import Path

import numpy as np
import pytest

from gnc.paper import PlumeAxis, design_oscillation, distance_exact

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "docs" / "scripts" / "paper_sim_3.py"


def test_each_equation_of_the_paper_stands_at_a_line_of_the_file():
    text = (ROOT / "gnc" / "paper.py").read_text("utf-8")
    found = {int(number) for number in re.findall(r"# \((\d+)\)", text)}
    # The paper has 35 equations.
    assert found == set(range(1, 36))


def test_the_velocity_of_equation_4_has_the_mean_of_equation_5_and_the_speed_of_the_reference():
    orbit = design_oscillation(nu=0.5, speed=19.42, heading_rate_max=0.503)
    # Means over a period of a smooth periodic function: equal steps are exact to rounding.
    phases = np.linspace(0.0, 2.0 * math.pi, 64, endpoint=False)
    along, across = np.mean([orbit.velocity(phase) for phase in phases], axis=0)
    assert along == pytest.approx(0.5 * 19.42, rel=1e-12)
    assert across == pytest.approx(0.0, abs=1e-12)
    assert {round(math.hypot(*orbit.velocity(phase)), 9) for phase in phases} == {19.42}


def test_simulation_3_in_the_script_crosses_at_the_interval_of_the_oscillation_and_keeps_out():
    interval, r_co, closest = runpy.run_path(str(SCRIPT))["simulate"]()
    orbit = design_oscillation(nu=0.5, speed=19.42, heading_rate_max=0.503)
    # Half a period; the centre of oscillation lies outside of r_min = 200 m by the orbit's reach.
    assert interval == pytest.approx(math.pi / orbit.omega_0, rel=1e-12)
    assert r_co == pytest.approx(200.0 + orbit.half_widths()[0], rel=1e-9)
    assert closest >= 200.0


def test_the_readme_shows_the_script_as_it_is():
    shown = re.findall(
        r"^```python\n(.*?)^```$", (ROOT / "README.md").read_text("utf-8"), re.M | re.S
    )
    assert SCRIPT.read_text("utf-8") in shown


@pytest.mark.parametrize("radius", [0.0, 5.0])
def test_a_steep_plume_is_crossed_no_farther_off_than_where_all_of_its_plane_keeps_off(radius):
    # The orbit lies in a horizontal plane, r_CO sin(alpha_P) above the origin, and passes the CO.
    orbit, elevation = design_oscillation(nu=0.5, speed=19.42, heading_rate_max=0.503), 1.2
    for heading in (0.0, 1.0, math.pi):
        axis = PlumeAxis(heading=heading, elevation=elevation)
        distance = distance_exact(orbit, axis, radius)
        # The search for the worst point of the orbit stops within 1e-5 s of it, 2e-4 m of path.
        assert radius - 2e-4 <= distance <= radius / math.sin(elevation) + 2e-4
