"""Proofs in numbers: Lyapunov functions, bounds, ensembles."""
