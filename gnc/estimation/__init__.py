"""Estimates of own motion, wind and the vessel's motion, and the detection of the vehicle's faults."""

from gnc.estimation.health import Fault, Health
from gnc.estimation.vessel_filter import FilterParameters, VesselFilter, VesselMotion, VesselReport
from gnc.estimation.wind_filter import WindFilter

__all__ = ["Fault", "FilterParameters", "Health", "VesselFilter", "VesselMotion", "VesselReport", "WindFilter"]
