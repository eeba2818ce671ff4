"""From a trial to its flights: each with the keys that are drawn for it, from the trial's seed and the flight's number alone."""

import zlib

import numpy as np

from scenarios.errors import InputError
from scenarios.load import with_values
from scenarios.sea_config import SeaScenario
from scenarios.sea_world import vessel_track

_TRIES = 1000


def drawn_flight(trial: str, scenario: SeaScenario, number: int) -> tuple[SeaScenario, int, float]:
    """Return one flight's scenario, its seed, and its speed ratio nu at the start.

    Parameters
    ----------
    trial : its name
    scenario : the trial
    number : of the flight, from 0

    Raises
    ------
    InputError : a drawn key does not exist or is out of range, or no draw has a speed ratio within ``scenario.speed_ratio``
    """
    sequence = np.random.SeedSequence([scenario.seed, zlib.crc32(trial.encode()), number])
    generator = np.random.default_rng(sequence)
    seed = int(sequence.generate_state(1)[0])
    low, high = scenario.speed_ratio
    for _ in range(_TRIES):
        values: dict[str, object] = {}
        dealt = number
        for draw in scenario.draws:
            if draw.uniform is not None:
                values[draw.key] = float(generator.uniform(*draw.uniform))
            else:
                # Several choices are dealt like the digits of a number: every combination comes equally often.
                dealt, i = divmod(dealt, len(draw.choice or ()))
                values[draw.key] = (draw.choice or ())[i]
        flight = with_values(scenario, values) if values else scenario
        track = vessel_track(flight)
        least, most = (wind / flight.guidance.airspeed_mps for wind in track.apparent_wind_range)
        if low <= least and most <= high:
            return flight, seed, track.apparent_wind([0.0])[0] / flight.guidance.airspeed_mps
    raise InputError(
        f"trial '{trial}': {_TRIES} draws had no speed ratio within {low:g} to {high:g}; the last one went from {least:.3f} to"
        f" {most:.3f}: widen speed_ratio, or draw other winds and vessel speeds"
    )


def check_draws(trial: str, scenario: SeaScenario) -> None:
    """Check every choice, and both ends of what is drawn evenly, before anything is flown.

    Raises
    ------
    InputError : as of ``drawn_flight``
    """
    for number in range(max((len(draw.choice or ()) for draw in scenario.draws), default=0) or 1):
        for end in (0, 1):
            with_values(
                scenario,
                {
                    draw.key: draw.uniform[end] if draw.uniform else (draw.choice or ())[number % len(draw.choice or ())]
                    for draw in scenario.draws
                },
            )
    drawn_flight(trial, scenario, 0)
