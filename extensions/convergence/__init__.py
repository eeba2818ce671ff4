"""Global convergence of the steering laws, from many starts."""
