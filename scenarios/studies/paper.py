"""The paper's simulations as a study: flights, and the bounds on what their law asks for."""

from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Progress
from scenarios.studies.flight_study import FlightStudy
from scenarios.studies.paper_bounds import bounds_record
from scenarios.studies.study import study


@study("paper")
class PaperStudy(FlightStudy):
    """Flights of cases; ``bounds.json`` bounds their commands."""

    def postprocess(self, run: RunDirectory, _journal: Journal, progress: Progress) -> None:
        """Bound the commands of the flights."""
        progress("bounding commands", self.planned, self.planned)
        ((_, scenario),) = self.trials.items()
        ((_, experiment),) = self.experiments.items()
        requests = [experiment.request(number) for number in range(experiment.flights)]
        run.write_json(run.bounds, bounds_record(requests, scenario.seed))
