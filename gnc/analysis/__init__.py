"""Stability and bounds of the steering laws: Lyapunov functions, bounds on commands, ensembles of trajectories."""

from gnc.analysis.bounds import BoundedSteering, fastest_within, heading_rate_bound
from gnc.analysis.ensemble import fly_ensemble
from gnc.analysis.ensemble_result import EnsembleResult, Outcome, Tolerances

__all__ = ["BoundedSteering", "EnsembleResult", "Outcome", "Tolerances", "fastest_within", "fly_ensemble", "heading_rate_bound"]
