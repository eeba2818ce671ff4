"""Flights as scenario files: what anyone can fly again, change, and pass on."""

from scenarios.experiment.draws import DrawnFlight
from scenarios.schema.sea_config import SeaScenario


def scenario_file(drawn: DrawnFlight, *, title: str) -> bytes:
    """Return a scenario of the real sea that flies a drawn flight again, to the last bit."""
    import tomli_w

    document = drawn.scenario.model_dump(mode="json", exclude_none=True, include=set(SeaScenario.model_fields))
    document |= {"study": "sea", "title": title, "flights": 1, "draws": [], "flight_seed": drawn.seed, "speed_ratio": [0.0, 1e9]}
    return tomli_w.dumps(document).encode()
