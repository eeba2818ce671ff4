"""Report on a Monte Carlo study or a search: bounds, quantiles, sensitivity."""
