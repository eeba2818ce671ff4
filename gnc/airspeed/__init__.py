"""Airspeed laws: along-track trim, pace hold."""
