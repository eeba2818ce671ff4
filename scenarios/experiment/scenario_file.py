"""Flights as scenario files, which anyone can fly, change, and pass on."""

from scenarios.experiment.requests import FlightRequest
from scenarios.scenario.added_keys import ADDED
from scenarios.scenario.effect import unused
from scenarios.scenario.sections.experiment import SweepConfig


def scenario_file(request: FlightRequest, *, title: str) -> bytes:
    """Return a scenario that replays a flight, to the last bit.

    But where an experiment varies the bank beyond the design's, or the climb with a part that may
    fail: the vehicle is measured for the steepest of all its flights, and here for that of this
    one.
    """
    import tomli_w

    document = request.scenario.model_dump(mode="json", exclude_none=True)
    # The margin is planned for every fault that the experiment may bring, also for those that this
    # flight does not have.
    document["fault"]["declared"] = sorted(
        request.scenario.declared_faults - {request.scenario.fault.kind}
    )
    alone = request.scenario.model_copy(update={"draws": (), "sweep": SweepConfig()})
    for section, values in document.items():
        if isinstance(values, dict):
            document[section] = {
                key: value for key, value in values.items() if not unused(alone, f"{section}.{key}")
            }
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
        "laws",
        "report",
        *(name for keys in ADDED for name in keys.names()),
    ):
        document.pop(experiment, None)
    # It is of the experiment, and not of this flight.
    document.pop("description")
    # The random variables have their values, and nothing is sampled again.
    document.pop("speed_ratio")
    one = {"study": "flights", "title": title, "flights": 1, "flight_seed": request.seed}
    return tomli_w.dumps(document | one).encode()
