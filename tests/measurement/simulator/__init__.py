"""Simulated logs of sniffers, of which the truth is known, and a command that has them estimated.

It shares no code with ``measurement``: air, response and noise are computed here anew, so that an
error there is not repeated. ``regimes.py`` declares in what air and with what instruments the logs
are made, ``log.py`` makes one, ``runner.py`` gives them to the estimate and counts.

Seeds from 1000 on are kept for the tables of the documentation: thresholds of the estimate are
calibrated on smaller ones.
"""
