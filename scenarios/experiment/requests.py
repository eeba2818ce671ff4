"""The flights of an experiment, by number. Scenario and seed of a flight follow from the experiment
and the number only.
"""

import bisect
import functools
import itertools
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from common.run_layout import COMPARISON, SUMMARY
from scenarios.errors import InputError
from scenarios.experiment.draws import (
    SampledFlight,
    Values,
    entropy_of,
    not_displaced,
    sampled_flight,
)
from scenarios.experiment.points import Point, points_of
from scenarios.scenario.added_keys import ADDED
from scenarios.scenario.effect import unused
from scenarios.scenario.files import with_values
from scenarios.scenario.overrides import displaced
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.experiment import STUDY, SweepConfig, swept_key
from scenarios.world.noise import Noise

_PLANNED_FOR = ("guidance.", "turbulence.level", "reference.shape", "following.margin_law")
"""Beginnings of keys: the tracking in turbulence is computed for each choice of them, before any
flight.
"""

_VARIATION = ("sweep", "cases", "draws", "comparison")
"""Sections that make several flights of a scenario, and are of none of them."""

_MEASURED_FOR = ("guidance.bank_deg", "guidance.heading_rate_max_rad_s", "following.climb_gradient")
"""Keys for whose largest values the aircraft is measured before any flight."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightRequest:
    """A flight to be planned and flown.

    Attributes
    ----------
    flight_id : unique in the run
    trial, variant : name of the trial, and ``STUDY`` or the name of a comparison
    scenario : of this flight alone
    noise : of its start, air, sensors and reports
    inputs : swept and sampled keys, and their values
    """

    flight_id: str
    trial: str
    variant: str
    scenario: Scenario
    noise: Noise
    inputs: dict[str, object]

    @property
    def seed(self) -> int:
        """Return the seed of its noise; of a blend, of the part that is not blended."""
        return self.noise.seed


def table_of(variant: str) -> str:
    """Return the name of the file with the rows of a variant's flights."""
    return SUMMARY if variant == STUDY else COMPARISON


class Experiment:
    """The flights of one scenario.

    Parameters
    ----------
    name : of the scenario, the trial's in a list
    scenario : scaled to its aircraft
    alone : whether it is the only experiment of its run; then its name is not part of the names of
        swept flights

    Raises
    ------
    InputError : a point cannot be flown as it is
    """

    def __init__(self, name: str, scenario: Scenario, *, alone: bool = True) -> None:
        self.name = name
        self.scenario = scenario
        self._alone = alone
        self.points = points_of(scenario)
        labels = Counter(point.label for point in self.points)
        self.points = [
            replace(point, label=f"{point.label}_{i}") if labels[point.label] > 1 else point
            for i, point in enumerate(self.points)
        ]

    @cached_property
    def _ends(self) -> list[int]:
        """The number of the flight after each point's last."""
        return list(itertools.accumulate(point.flights for point in self.points))

    @cached_property
    def _configuration(self) -> Mapping[str, Any]:
        return _without_variation(self.scenario)

    def overrides(self, flown: Scenario) -> Values:
        """Return the keys whose values differ between a flight and the scenario, with the flight's
        values in the form of the manifest. A list counts as one value, and so does a table that
        lacks a key.

        They include everything that case, sweep, comparison, samples and study have set.
        """
        return differing_keys(self._configuration, _without_variation(flown))

    @property
    def flights(self) -> int:
        """Return the number of flights, comparisons among them."""
        return self._ends[-1]

    @property
    def counted(self) -> int:
        """Return the number of flights of the study itself."""
        return sum(point.flights for point in self.points if point.variant == STUDY)

    @property
    def keys(self) -> list[str]:
        """Return the swept and sampled keys."""
        swept = map(swept_key, self.scenario.sweep.root)
        return list(dict.fromkeys([*swept, *(draw.key for draw in self.scenario.draws)]))

    def named(self, number: int) -> tuple[str, str]:
        """Return name and variant of a flight."""
        point, index = self.point_of(number)
        parts = [] if self._alone and point.label else [self.name]
        parts += [point.label] if point.label else []
        parts += [f"{index:05d}"] if point.flights > 1 or not point.label else []
        return "_".join(parts), point.variant

    def paired_flight(self, number: int) -> str:
        """Return the name of the study's flight with which a comparison's flight is compared; empty
        for other flights.
        """
        point, index = self.point_of(number)
        if point.paired_point is None:
            return ""
        return self.named(
            self._ends[point.paired_point] - self.points[point.paired_point].flights + index
        )[0]

    def names(self) -> list[str]:
        """Return the name of one flight of each point; the names of the others differ only in their
        number.
        """
        return [self.named(end - 1)[0] for end in self._ends]

    def point_of(self, number: int) -> tuple[Point, int]:
        """Return the point of a flight, and the flight's number among those of its point."""
        i = bisect.bisect_right(self._ends, number)
        return self.points[i], number - (self._ends[i - 1] if i else 0)

    def request(
        self, number: int, at: Sequence[float] = (), *, seed: int | None = None
    ) -> FlightRequest:
        """Return a flight.

        Parameters
        ----------
        number : of the flight, from 0
        at : as ``point`` of ``sampled_flight``
        seed : instead of the one that follows from the number and the random variables

        Raises
        ------
        InputError : a sampled value is out of range
        """
        point, index = self.point_of(number)
        flight_id, variant = self.named(number)
        if point.scenario.draws:
            sampled = self._sampled(point, index, at)
            scenario, noise, inputs = sampled.scenario, sampled.noise, point.inputs | sampled.values
        else:
            scenario, inputs = point.scenario, point.inputs
            noise = Noise(
                self._seed(point, index) if scenario.flight_seed is None else scenario.flight_seed
            )
        if seed is not None and seed != noise.seed:
            noise = Noise(seed)
            inputs = inputs | ({"flight_seed": seed} if "flight_seed" in inputs else {})
        return FlightRequest(
            flight_id=flight_id,
            trial=self.name,
            variant=variant,
            scenario=scenario,
            noise=noise,
            inputs=inputs,
        )

    def requests(self) -> Iterator[FlightRequest]:
        """Yield every flight, in the order of their numbers."""
        return map(self.request, range(self.flights))

    def settings(self) -> Iterator[Scenario]:
        """Yield the different scenarios for which autopilot and margins are computed: one for each
        point and choice.
        """
        for point in self.points:
            choices = [
                [(draw.key, value) for value in draw.choice]
                for draw in point.scenario.draws
                if draw.choice is not None
                and draw.key.startswith(_PLANNED_FOR)
                and not displaced(draw.key, point.given)
            ]
            for chosen in itertools.product(*choices):
                yield with_values(point.scenario, dict(chosen)) if chosen else point.scenario

    def steepest(self) -> Iterator[Scenario]:
        """Yield the settings, and those of the steepest turns and climbs that may be sampled.

        Raises
        ------
        InputError : turns or climbs have no limit
        """
        yield from self.settings()
        for point in self.points:
            draws = [
                d
                for d in point.scenario.draws
                if d.key in _MEASURED_FOR and not displaced(d.key, point.given)
            ]
            if unlimited := [draw.key for draw in draws if draw.largest is None]:
                raise InputError(
                    f"'{unlimited[0]}' is sampled from a distribution without an upper limit, for"
                    " which the aircraft would have to be measured; give the draw one with"
                    " within = [lowest, highest]"
                )
            if draws:
                yield with_values(point.scenario, {draw.key: draw.largest for draw in draws})

    def _sampled(self, point: Point, index: int, at: Sequence[float]) -> SampledFlight:
        """Return a flight with its samples; one of a comparison has those of the study's flight
        with which it is compared.
        """
        paired = (
            None
            if point.paired_point is None
            else functools.partial(_with_samples, self.points[point.paired_point])
        )
        return sampled_flight(
            self.name,
            point.scenario,
            index,
            at,
            given=point.given,
            paired=paired,
            stream=point.stream,
        )

    def _seed(self, point: Point, index: int) -> int:
        """Return the seed of a flight; variants of a point start alike.

        In a sweep of nu with one flight a point it depends on nu alone, unless the points share
        their random numbers, or each has its own stream.
        """
        common = self.scenario.common_random_numbers is True and bool(point.inputs)
        if point.nu is not None and point.flights == 1 and not (point.stream or common):
            entropy = [self.scenario.seed, round(point.nu * 1e6)]
        else:
            entropy = entropy_of(self.scenario.seed, self.name, index, point.stream)
        return int(np.random.SeedSequence(entropy).generate_state(1)[0])


def _without_variation(scenario: Scenario) -> dict[str, Any]:
    """Return the configuration of a flight: a scenario without the sections that make several
    flights of it.
    """
    return scenario.model_dump(mode="json", exclude={*_VARIATION, "report"})


def differing_keys(before: Mapping[str, Any], now: Mapping[str, Any], above: str = "") -> Values:
    """Return the values of nested tables that differ from those of other tables, by dotted keys;
    the others may lack keys.
    """
    found: Values = {}
    for key, value in now.items():
        was: Any = before.get(key)
        if value == was and key in before:
            continue
        tables = isinstance(value, Mapping) and isinstance(was, Mapping)
        if tables and was.keys() <= value.keys():
            found |= differing_keys(was, value, f"{above}{key}.")
        else:
            found[f"{above}{key}"] = value
    return found


def _with_samples(point: Point, values: Values) -> Scenario:
    """Return a point's scenario with samples, without those that give way to its own keys."""
    return with_values(point.scenario, not_displaced(values, point.given))


def _used(scenario: Scenario, section: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return those values of a section that its flights use."""
    return {key: value for key, value in values.items() if not unused(scenario, f"{section}.{key}")}


def scenario_file(request: FlightRequest, *, title: str) -> bytes:
    """Return a scenario that replays a flight, to the last bit.

    There is one exception: an experiment varies the bank beyond the design's, or the climb with a
    part that may fail. Then its vehicle is measured for the steepest of all its flights, and the
    replay's vehicle for this flight only.
    """
    import tomli_w

    document = request.scenario.model_dump(mode="json", exclude_none=True)
    # The margin is planned for every fault that the experiment may have, even if this flight does
    # not have it.
    own = {fault.kind for fault in request.scenario.faults}
    faults = document["fault"]
    (faults[0] if isinstance(faults, list) else faults)["declared"] = sorted(
        request.scenario.declared_faults - own
    )
    alone = request.scenario.model_copy(update={"draws": (), "sweep": SweepConfig()})
    for section, values in document.items():
        if isinstance(values, dict):
            document[section] = _used(alone, section, values)
        elif section == "fault":
            document[section] = [
                _used(alone, f"{section}.{number}", of) for number, of in enumerate(values)
            ]
    for experiment in (
        "method",
        "sampling",
        "statistics",
        "subset",
        "search",
        "comparison",
        "sweep",
        "common_random_numbers",
        "cases",
        "draws",
        "report",
        *(name for keys in ADDED for name in keys.names()),
    ):
        document.pop(experiment, None)
    # It belongs to the experiment, and not to this flight.
    document.pop("description")
    # The random variables have their values, and nothing is sampled again.
    document.pop("speed_ratio")
    one = {"study": "flights", "title": title, "flights": 1, "flight_seed": request.seed}
    return tomli_w.dumps(document | one).encode()
