"""Statistics of independent flights: intervals, sensitivity indices and stopping rules."""
