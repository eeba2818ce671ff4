"""From a scenario to a flight plan in SI."""
