"""Sweep, paper, trials, Monte Carlo, falsification, convergence, arena, patrol."""
