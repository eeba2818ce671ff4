"""Flights of a scenario as a gymnasium environment: the agent commands heading rate and airspeed in
place of the guidance.
"""

import math
import shutil
import tempfile
import weakref
from collections.abc import Generator, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, SupportsFloat

import gymnasium
import numpy as np

from extensions.gym.actions import action_box, limits_of
from extensions.gym.observation import Array, Observer, observation_space
from extensions.gym.reward import LOST, VIOLATION, CrossingReward
from gnc.errors import InfeasibleError
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from measurement.errors import MeasurementError
from scenarios.api.flying import flights_of
from scenarios.api.scenario import Given, load
from scenarios.engine.run_directory import RunDirectory
from scenarios.errors import InputError
from scenarios.experiment.requests import FlightRequest
from scenarios.flight.closed_loop import ClosedLoop, Commands, failable, record_of, release
from scenarios.flight.outcome import Outcome
from scenarios.flight.record import FlightRecord
from scenarios.flight_runner import FlightRunner, payload_of, reader_of
from scenarios.instruments.instrument import Instrument
from scenarios.scenario.sections.experiment import STUDY

_SEEDS = 2**32

_FLIGHT_ID = "flight_id"
"""Option of a reset."""

_TRIES = 100
"""Largest number of flights that are sampled at random for an episode until one has a solution."""


@dataclass(slots=True)
class _Episode:
    """A flight under way.

    Attributes
    ----------
    loop, steps : the flight, and its steps
    commands : of the guidance, at the last step
    observer, reward : of the agent
    low, high : least and largest commands of heading rate [rad/s] and airspeed [m/s]
    step : number of the last step
    over : whether the episode has ended
    record : of the flight, where that has ended
    """

    loop: ClosedLoop
    steps: Generator[Commands, Commands, FlightRecord]
    commands: Commands
    observer: Observer
    reward: CrossingReward
    low: Array
    high: Array
    step: int = 0
    over: bool = False
    record: FlightRecord | None = None

    @property
    def time(self) -> float:
        """Return the time since the start [s]."""
        return self.step * self.loop.plan.time_step

    @property
    def time_is_up(self) -> bool:
        """Return whether the flight's time is up after the last step."""
        return self.step > round(self.loop.plan.duration_max / self.loop.plan.time_step)

    @property
    def inside(self) -> bool:
        """Return whether the vehicle was in the keep-out area when it was last observed."""
        plan, height = self.loop.plan, 0.0
        if plan.keepout_shape == "sphere":
            height = self.loop.vehicle.sample()[0] - plan.source_height
        return math.hypot(self.observer.distance, height) < plan.keepout_radius


class PlumeCrossing(gymnasium.Env[Array, Array]):
    """A vessel, its plume, and a vehicle that is to cross the plume near the vessel and to keep out
    of the area around it.

    Actions are heading rate [rad/s] and airspeed [m/s] that the autopilot is commanded for one step
    of the guidance; observations are those of ``extensions.gym.observation.MEANINGS``,
    rewards those
    of ``extensions.gym.reward``. An episode is terminated when the keep-out area is entered, the
    aircraft is lost, or every crossing is flown; it is truncated when its time is up.

    Parameters
    ----------
    scenario : as in ``scenarios.fly``
    keys : to set, as in ``scenarios.fly``

    Raises
    ------
    InputError : the scenario cannot be flown, has no vessel, or objects as parts, or commands
        without a limit; one line
    """

    metadata = {"render_modes": []}  # noqa: RUF012 - as gymnasium has it

    def __init__(
        self,
        scenario: Given = "sweep_nu",
        *,
        keys: dict[str, object] | None = None,
        render_mode: None = None,
    ) -> None:
        loaded = load(scenario).set(**keys or {})
        if loaded.parts:
            raise InputError(
                "an environment takes parts by name or by FILE.py:NAME, not as objects"
            )
        self._study = flights_of(loaded)
        directory = Path(tempfile.mkdtemp(prefix="plume-flight-gym-"))
        weakref.finalize(self, shutil.rmtree, directory, ignore_errors=True)
        self.render_mode = render_mode
        self._work: FlightRunner = self._study.work(RunDirectory(directory))
        if self._work.refusal:
            raise InputError(self._work.refusal)
        self._numbers = dict(self._own_flights())
        self._aircraft: dict[bool, AutopilotedAircraft] = {}
        self._episode = self._begun(self._work.request(self._study.task(0)))
        self.action_space = action_box(self._work)
        self.observation_space = observation_space()

    @property
    def flight_ids(self) -> tuple[str, ...]:
        """Return the names of the scenario's flights."""
        return tuple(self._numbers)

    @property
    def record(self) -> FlightRecord:
        """Return the record of the flight, once its episode has run to its end by itself.

        Raises
        ------
        InputError : it is still under way, or was ended by a violation
        """
        if self._episode.record is None:
            raise InputError(
                "the episode has no record: it is under way, or a keep-out violation ended it;"
                " fly one to its end"
            )
        return self._episode.record

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begin a flight.

        Parameters
        ----------
        seed : of the flight, of its start, its air and its errors; further episodes follow from it
        options : ``{"flight_id": ...}`` begins that flight of the scenario with its seed in a run,
            in a separate simulation, so that it is identical to the run's flight to the last bit.
            Other episodes share one simulation, which repeats flights to 1e-9 m

        Raises
        ------
        InputError : an option is unknown, the scenario has no flight of this name, or it cannot be
            flown; or none of many at random can be; one line
        """
        super().reset(seed=seed)
        if unknown := [str(key) for key in options or {} if key != _FLIGHT_ID]:
            raise InputError(
                f"unknown option '{unknown[0]}' of reset; the only one is '{_FLIGHT_ID}', the"
                " name of a flight"
            )
        name = (options or {}).get(_FLIGHT_ID)
        if name is None:
            self._episode = self._begun_at_random()
        elif name in self._numbers:
            self._aircraft.clear()
            self._episode = self._begun(self._work.request(self._study.task(self._numbers[name])))
        else:
            raise InputError(
                f"the scenario has no flight '{name}'; its flights are {', '.join(self._numbers)}"
            )
        return self._episode.observer.observe(0.0), self._info()

    def step(self, action: Array) -> tuple[Array, SupportsFloat, bool, bool, dict[str, Any]]:
        """Fly one step of the guidance with an action, cut at the limits of this flight."""
        episode = self._episode
        if episode.over:
            raise InputError("the episode is over; reset the environment")
        if np.shape(action) != episode.low.shape or not np.isfinite(action).all():
            raise InputError(
                f"the action is {action}; give heading rate [rad/s] and airspeed [m/s], both finite"
            )
        heading_rate, airspeed = np.clip(action, episode.low, episode.high).tolist()
        if (heading_rate, airspeed) != episode.commands:
            episode.loop.guidance.overruled(heading_rate, airspeed)
        episode.step += 1
        lost = truncated = False
        try:
            episode.commands = episode.steps.send((heading_rate, airspeed))
        except StopIteration as over:
            record = record_of(over)
            lost = record.outcome in (Outcome.DIVERGED, Outcome.AIRCRAFT_LOST)
            # A flight without a number of crossings completes when its time is up.
            truncated = not lost and (
                episode.time_is_up or record.outcome in (Outcome.NOT_SETTLED, Outcome.INCOMPLETE)
            )
            episode.record, episode.over = record, True
        observed = episode.observer.observe(episode.time)
        entered = episode.inside
        reward = (
            episode.reward.update(episode.observer.along, episode.observer.across)
            + LOST * lost
            + VIOLATION * entered
        )
        truncated = truncated and not entered
        terminated = (episode.over or entered) and not truncated
        episode.over = terminated or truncated
        return observed, reward, terminated, truncated, self._info()

    def close(self) -> None:
        """Release the simulation."""
        self._episode.steps.close()
        self._aircraft.clear()

    def _own_flights(self) -> Iterator[tuple[str, int]]:
        """Yield name and number of each flight of the study; those of comparisons have numbers
        between them.
        """
        first = 0
        for experiment in self._work.experiments:
            for number in range(experiment.flights):
                name, variant = experiment.named(number)
                if variant == STUDY:
                    yield name, first + number
            first += experiment.flights

    def _begun(self, request: FlightRequest) -> "_Episode":
        """Begin a requested flight, and refuse one that has no solution in one line."""
        try:
            return self._begin(request)
        except (InfeasibleError, MeasurementError) as error:
            raise InputError(str(error)) from None

    def _begun_at_random(self) -> "_Episode":
        """Begin a random flight; if it has no solution, begin another one."""
        numbers = list(self._numbers.values())
        for _ in range(_TRIES):
            task = self._study.task(numbers[int(self.np_random.integers(len(numbers)))])
            request = self._work.request(replace(task, seed=int(self.np_random.integers(_SEEDS))))
            try:
                return self._begin(request)
            except (InfeasibleError, MeasurementError) as error:
                reason = str(error)
        raise InputError(f"{_TRIES} flights at random had no solution; the last one: {reason}")

    def _begin(self, request: FlightRequest) -> "_Episode":
        """Place the vehicle at the start of a flight, and let the guidance compute its first
        commands.
        """
        plan, setup = self._work.plan(request), self._work.setup_of(request)
        if plan.world is None:
            raise InputError(f"flight '{plan.flight_id}' has no vessel; an environment needs one")
        flown = None
        if setup.aircraft is not None:
            may_fail = failable(plan)
            if may_fail not in self._aircraft:
                aircraft = setup.aircraft
                self._aircraft[may_fail] = AutopilotedAircraft(
                    aircraft.spec, aircraft.model, failable=may_fail
                )
            flown = self._aircraft[may_fail]
        instruments = payload_of(request, plan)
        read = [instrument for instrument in instruments if isinstance(instrument, Instrument)]
        vehicle = release(plan, setup, flown=flown)
        loop = ClosedLoop(plan, vehicle, read, reader=reader_of(plan, instruments))
        steps = loop.steps()
        commands = next(steps)
        low, high = limits_of(plan, setup)
        return _Episode(
            loop, steps, commands, Observer(loop), CrossingReward(plan.keepout_radius), low, high
        )

    def _info(self) -> dict[str, Any]:
        episode = self._episode
        return {
            "flight_id": episode.loop.plan.flight_id,
            "time_s": episode.time,
            "guidance": np.array(episode.commands),
            "crossings": episode.reward.crossings,
            "settled": not math.isnan(episode.loop.settling.at),
        }
