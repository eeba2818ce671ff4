"""The study's aircraft as a MAVLink vehicle, and the study's guidance as a companion computer."""
