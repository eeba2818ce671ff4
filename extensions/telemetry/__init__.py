"""Flights in programs that show them: as files, as a stream of MAVLink, and in FlightGear."""
