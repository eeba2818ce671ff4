"""Global convergence, measured."""
