"""Monte Carlo, by flights at random or by subset simulation, as a study."""

from scenarios.studies.monte_carlo.study import MonteCarloStudy

__all__ = ["MonteCarloStudy"]
