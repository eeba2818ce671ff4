"""What each declaration costs in distance: how far the orbit lies outside of r_min, for the X8 in
operational conditions.

``python -m benchmarks.keepout_price`` prints the table of docs/keepout_guard.md, and writes its
figure with ``--figure FILE``.
"""

import argparse
import math
import tempfile
from pathlib import Path

from benchmarks.vehicle import x8_setup
from scenarios.planning.missions import plan_flight
from scenarios.planning.spreads import predicted_spreads
from scenarios.scenario.files import load_study
from scenarios.scenario.scenario import Scenario

RATIOS = (0.2, 0.5, 0.8)
"""Speed ratios of the table [-]."""

AIS = ("reports.interval_s=[2,10]", "reports.latency_max_s=2")
SHIP = ("following.vessel_acceleration_mps2=0.25", "following.vessel_speed_max_mps=16")

BIASES = ("sensors.airspeed_bias_mps=0.5", "sensors.heading_bias_deg=2")

TOGETHER = (
    *AIS,
    *SHIP,
    "reports.missing=0.1",
    "sensors.position_sigma_m=1.5",
    "sensors.velocity_sigma_mps=0.1",
    "sensors.airspeed_sigma_mps=0.3",
    "sensors.heading_sigma_deg=1",
    *BIASES,
    "following.speed_error_mps=0.5",
    "turbulence.level=light",
    "turbulence.gusts=4",
    "turbulence.gust_speed_mps=4",
    "guidance.reserve=0.1",
)
"""What ``sea_together`` declares, but for the ship's largest speed: that is 15 m/s there, and at
0.8 in still air she has 15.5.
"""


def outage(duration: float) -> tuple[str, str]:
    """Return the keys that declare losses of satellite navigation of a duration [s]."""
    return "fault.kind=satellite_navigation", f"fault.satellite_navigation_s={duration:g}"


DECLARATIONS: dict[str, tuple[str, ...]] = {
    "everything known": (),
    "satellite navigation, 1.5 m": ("sensors.position_sigma_m=1.5",),
    "outages of satellite navigation, 1 m/s": ("fault.kind=satellite_navigation",),
    "velocity and wind known to 0.5 m/s": ("following.speed_error_mps=0.5",),
    "biases of the airspeed, 0.5 m/s, and the heading, 2 degrees": BIASES,
    "gusts of 4 m/s": ("turbulence.gusts=3", "turbulence.gust_speed_mps=4"),
    "gusts of 8 m/s": ("turbulence.gusts=3", "turbulence.gust_speed_mps=8"),
    "light turbulence": ("turbulence.level=light",),
    "light turbulence, outages of 10 s": (*outage(10), "turbulence.level=light"),
    "light turbulence, outages of 60 s": (*outage(60), "turbulence.level=light"),
    "moderate turbulence": ("turbulence.level=moderate",),
    "moderate turbulence, outages of 10 s": (*outage(10), "turbulence.level=moderate"),
    "moderate turbulence, outages of 60 s": (*outage(60), "turbulence.level=moderate"),
    "AIS every 2 to 10 s, a ship that keeps its course and speed": AIS,
    "AIS, a ship that may accelerate by 0.1 m/s²": (*AIS, "following.vessel_acceleration_mps2=0.1"),
    "AIS, by 0.25 m/s²": (*AIS, *SHIP),
    ("AIS every 30 s, by 0.1"
" m/s²"): ("reports.interval_s=[2,30]", AIS[1], "following.vessel_acceleration_mps2=0.1"),
    "AIS every 30 s, by 0.25 m/s²": ("reports.interval_s=[2,30]", AIS[1], *SHIP),
    "all of sea_together": TOGETHER,
    "all of it, and turns that deviate by 6.8 m": (*TOGETHER, "following.turn_deviation_m=6.8"),
}  # fmt: skip
"""What is declared, and the keys that do so."""


def prices(scenario_file: Path) -> dict[str, list[float]]:
    """Return how far the orbit lies outside of r_min [m], at each speed ratio, by declaration."""
    scenario_file.write_text(
        'title = "price"\nguidance.mission = "follow"\nstart.range_m = 1000.0\n', encoding="utf-8"
    )
    return {
        title: [_margin(scenario_file, keys, ratio) for ratio in RATIOS]
        for title, keys in DECLARATIONS.items()
    }


def _margin(scenario_file: Path, keys: tuple[str, ...], ratio: float) -> float:
    known = ("start.aspect_deg=0", "start.course_deg=0")
    scenario = load_study(str(scenario_file), [*keys, *known, f"vessel.speed_ratio={ratio}"])
    if not isinstance(scenario, Scenario):
        raise TypeError("the price is that of flights")
    design, setup = x8_setup(scenario, scenario_file.parent)
    spreads = predicted_spreads([scenario], design, setup)
    plan = plan_flight(scenario, flight_id="price", seed=1, setup=setup, spreads=spreads)
    return plan.margin.total if plan.margin else math.nan


def _figure(found: dict[str, list[float]], path: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 0.42 * len(found) + 1.2), layout="constrained")
    axes = figure.subplots()
    places = range(len(found))
    for i, (ratio, colour) in enumerate(
        zip(RATIOS, ("#0072B2", "#E69F00", "#009E73"), strict=True)
    ):
        widths = [margins[i] for margins in found.values()]
        axes.barh(
            [place + 0.26 * (i - 1) for place in places],
            widths,
            0.24,
            color=colour,
            label=f"nu = {ratio:g}",
        )
    axes.set_yticks(list(places), list(found))
    axes.invert_yaxis()
    axes.set_xlabel("Distance of the orbit from the keep-out area [m]")
    axes.grid(axis="x", alpha=0.3)
    axes.legend(loc="upper right")
    figure.savefig(path, dpi=110)


def main() -> None:
    """Print the table, and write the figure if it is asked for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--figure", type=Path, help="file of the figure, as PNG")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        found = prices(Path(folder) / "price.toml")
    print("| declared | " + " | ".join(f"nu = {ratio:g}" for ratio in RATIOS) + " |")
    print("|---|" + "---|" * len(RATIOS))
    for title, margins in found.items():
        print(f"| {title} | " + " | ".join(f"{margin:.1f}" for margin in margins) + " |")
    if asked.figure:
        _figure(found, asked.figure)


if __name__ == "__main__":
    main()
