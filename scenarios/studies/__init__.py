"""Sweep, paper, trials, Monte Carlo, falsification."""
