"""A scenario file: whether its keys go together."""

import math
from typing import TYPE_CHECKING

from pydantic import model_validator

from gnc.laws import ON_CIRCLE, ON_OSCILLATION
from scenarios.scenario.added_keys import ADDED
from scenarios.scenario.experiment_checks import check_together
from scenarios.scenario.scenario_keys import DEFAULT_AIRCRAFT, ScenarioKeys
from scenarios.scenario.sections.equipment import REPORTS_MAX
from scenarios.scenario.sections.guidance import law_refusal
from scenarios.scenario.sections.section import check_divides, check_ordered

POINTS_MAX = 10_000
"""Most points of an experiment: all are checked before the first flight, in a millisecond and 20 kB
each.
"""


if TYPE_CHECKING:
    _AllKeys = ScenarioKeys
else:
    _AllKeys = type("_AllKeys", (*ADDED, ScenarioKeys), {"__module__": __name__})
    """The project's keys, and those that studies of installed packages add."""


class Scenario(_AllKeys):
    """A whole scenario file of flights."""

    @model_validator(mode="after")
    def _consistent(self) -> "Scenario":
        check_divides("flight.log_rate_hz", self.flight.log_rate_hz, self.guidance.rate_hz)
        check_ordered("speed_ratio", self.speed_ratio)
        if self.circles and (self.follows or self.sweep.root or self.draws):
            raise ValueError(
                "reference.path is 'circle' beside wind, a vessel that is followed, a sweep or draws; a circle has no vessel:"
                " set reference.path to 'oscillation', or put it into a case of its own"
            )
        if self.circles and self.criteria.required == "keep_out":
            raise ValueError(
                "criteria.required is 'keep_out', and a circle has no area to keep out of; set it to 'criteria'"
            )
        if self.fidelity == "six_dof" and not self.guidance.command_limit:
            raise ValueError(
                "guidance.command_limit is false; an aircraft cannot turn so fast: set fidelity to 'kinematic'"
            )
        if (
            not (self.guidance.command_limit or self.follows or self.circles)
            and self.guidance.approach
        ):
            raise ValueError(
                "guidance.command_limit is false and guidance.approach true; the way to the orbit has turns at the limit:"
                " set guidance.approach to false"
            )
        if not (self.guidance.command_limit or self.circles) and self.guidance.keepout_guard:
            raise ValueError(
                "guidance.command_limit is false; the keep-out guard predicts turns within the limit alone: set"
                " guidance.command_limit to true, or guidance.keepout_guard to false"
            )
        if self.fidelity == "kinematic" and not self.turbulence.calm:
            raise ValueError(
                "turbulence.level or turbulence.gusts is set with fidelity 'kinematic', which feels the steady wind alone:"
                " set fidelity to 'six_dof', or turbulence.level to 'none' and turbulence.gusts to 0"
            )
        return self

    @model_validator(mode="after")
    def _law_has_the_task(self) -> "Scenario":
        law = self.guidance.law
        if not self.circles and (
            reason := law_refusal(law, ON_CIRCLE if self.stands_off else ON_OSCILLATION)
        ):
            raise ValueError(f"guidance.law is '{law}': {reason}")
        return self

    @model_validator(mode="after")
    def _starts_outside(self) -> "Scenario":
        radius, start = self.keepout.radius_m, self.start
        # A default distance is scaled to the aircraft later, and checked then.
        to_be_scaled = (
            start.range_m is None
            and "distance_m" not in start.model_fields_set
            and self.aircraft != DEFAULT_AIRCRAFT
        )
        if self.circles:
            return self
        if start.place_m is not None:
            nearest, where = math.hypot(*start.place_m), "start.place_m lies at"
        elif start.range_m is not None:
            nearest, where = start.range_m, "start.range_m is"
        elif to_be_scaled or any(draw.key == "start.range_m" for draw in self.draws):
            # Each flight's own distance is checked once it is sampled.
            return self
        else:
            nearest, where = start.distance_m[0], "start.distance_m begins at"
        if nearest <= radius:
            raise ValueError(
                f"{where} {nearest:g} m; it must exceed keepout.radius_m, {radius:g} m"
            )
        return self

    @model_validator(mode="after")
    def _fits_into_the_flight(self) -> "Scenario":
        air, room = self.turbulence, self.flight.duration_max_s
        if self.fault.kind != "none" and self.fault.at_s[1] >= room:
            raise ValueError(
                f"fault.at_s ends at {self.fault.at_s[1]:g} s; it must lie within flight.duration_max_s, {room:g} s:"
                " fly longer, or let it fail earlier"
            )
        if air.gusts * 2.0 * air.gust_length_s > 0.9 * room:
            raise ValueError(
                f"turbulence.gusts is {air.gusts}, each {2.0 * air.gust_length_s:g} s long; they do not fit into"
                f" flight.duration_max_s, {room:g} s: give fewer or shorter ones"
            )
        interval = 0.5 * sum(self.reports.interval_s)
        if not self.reports.exact and room > REPORTS_MAX * interval:
            raise ValueError(
                f"reports.interval_s is {list(self.reports.interval_s)} s; in flight.duration_max_s, {room:g} s, this makes"
                f" more than {REPORTS_MAX} reports: let at least {room / REPORTS_MAX:.2g} s pass between them on average, or fly"
                " shorter"
            )
        return self

    @model_validator(mode="after")
    def _track_has_its_own_speed(self) -> "Scenario":
        given = [
            key
            for key in ("nu", "vessel.speed_ratio", "vessel.speed_mps")
            if key in self.sweep.root
        ]
        if self.vessel.from_file and given:
            raise ValueError(
                f"sweep has {given[0]} beside vessel.track, a file that the vessel's speed comes from; leave one of them out"
            )
        return self

    @model_validator(mode="after")
    def _experiment(self) -> "Scenario":
        names = [case.name for case in self.cases]
        if len(set(names)) < len(names):
            raise ValueError(f"cases are named {', '.join(names)}; give each a name of its own")
        if self.cases and self.sweep.root:
            raise ValueError(
                f"sweep has {', '.join(self.sweep.root)} beside {len(names)} cases; give one of the two"
            )
        if (points := math.prod(map(len, self.sweep.root.values()))) > POINTS_MAX:
            raise ValueError(
                f"sweep has {points} points; the most is {POINTS_MAX}: give fewer values, or sample keys at random"
            )
        if self.study == "paper" and not self.cases:
            raise ValueError(
                "study is 'paper' without cases; give it cases, or set study to 'flights'"
            )
        return self

    @model_validator(mode="after")
    def _together(self) -> "Scenario":
        check_together(self)
        return self
