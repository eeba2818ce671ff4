"""A study that chooses its flights on the way, each by what those before it have come to."""

from collections.abc import Mapping, Sequence

from common.run_layout import SUMMARY
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Progress
from scenarios.engine.task import Row, Task
from scenarios.scenario.scenario import Scenario
from scenarios.studies.flight_study import FlightStudy


def clearance(row: Row, *, unmeasured: float) -> float:
    """Return how far from the keep-out area a flight stayed at its closest, or ``unmeasured`` if
    that is not known [m].
    """
    return (
        float(row["min_distance_m"] - row["keepout_radius_m"])
        if "min_distance_m" in row
        else unmeasured
    )


class ChosenFlightsStudy(FlightStudy):
    """Flights of one trial, at points of its draws that the study chooses; what runs it appends
    their tasks.

    Parameters
    ----------
    scenario, name : the scenario, and its name
    trials : the same by its name
    numbers : that flights may have: so many at the most
    overrides : overrides that were applied, recorded in the manifest

    Raises
    ------
    InputError : as of ``FlightStudy``
    """

    chooses_flights = True

    def __init__(
        self,
        scenario: Scenario,
        name: str,
        trials: Mapping[str, Scenario],
        *,
        numbers: int,
        overrides: Sequence[str] = (),
    ) -> None:
        numbered = {
            trial: of.model_copy(update={"flights": numbers}) for trial, of in trials.items()
        }
        super().__init__(
            scenario.model_copy(update={"flights": numbers}), name, numbered, overrides=overrides
        )
        ((self._trial, self._scenario),) = self.trials.items()
        self._tasks: list[Task] = []

    def task(self, number: int) -> Task:
        """Return the task of a flight, at the point that was chosen for it."""
        return self._tasks[number]

    def depended_on(self, journal: Journal, *, below: int) -> bool:
        """Return whether flights after those that are chosen so far, of numbers below ``below``,
        are in the journal.

        They were chosen by these. So a lost one among these is tried again only as long as there
        are none: otherwise a run that is resumed would choose others.
        """
        return (
            next(journal.numbered(SUMMARY, first=len(self._tasks), below=below), None) is not None
        )

    def postprocess(self, run: RunDirectory, journal: Journal, progress: Progress) -> None:
        """Write nothing: flights that follow from others are not a sample that shows how well
        sulphur is measured.
        """
