"""A list of trials as a study."""

import math
from collections.abc import Sequence
from pathlib import Path

from scenarios.errors import InputError
from scenarios.scenario.effect import unused
from scenarios.scenario.files import load_study
from scenarios.scenario.overrides import parse_override
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.experiment import TrialList
from scenarios.studies.flight_study import FlightStudy

_ROUNDING = 1e-12
"""Relative error of a product [-]."""


class TrialStudy(FlightStudy):
    """The trials of a list, one after the other.

    Parameters
    ----------
    study, name : the list, and its name
    overrides : overrides that were applied, recorded in the manifest

    Raises
    ------
    InputError : a listed trial does not exist, or is not one of flights, or two have one name; and
        as of ``FlightStudy``
    """

    def __init__(self, study: TrialList, name: str, *, overrides: Sequence[str] = ()) -> None:
        super().__init__(study, name, _trials(study), overrides=overrides)


def _trials(study: TrialList) -> dict[str, Scenario]:
    seed = [] if study.seed is None else [f"seed={study.seed}"]
    trials: dict[str, Scenario] = {}
    for listed in study.trials:
        trial = load_study(listed, [*study.set, *seed], refusing=False)
        if not isinstance(trial, Scenario) or trial.study != "flights":
            raise InputError(
                f"trials: '{listed}' is a study of {trial.study}; list scenarios of flights"
            )
        if Path(listed).stem in trials:
            raise InputError(
                f"trials: two are called '{Path(listed).stem}'; list each once, and give files names of their own"
            )
        # Of 100 flights 0.07 are 7, and not the eighth that rounding would add.
        flights = math.ceil(study.share * trial.flights * (1.0 - _ROUNDING))
        trials[Path(listed).stem] = trial.model_copy(update={"flights": flights})
    for override in study.set:
        key, _ = parse_override(override)
        users = [unused(trial, key) for trial in trials.values()]
        if all(users):
            raise InputError(f"key '{key}' has no effect in any trial: it is used by {users[0]}")
    return trials
