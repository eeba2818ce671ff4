"""Estimates of own motion, wind and the vessel's motion, and the detection of the vehicle's faults."""

from gnc.estimation.health import Fault, Health
from gnc.estimation.vessel_filter import VesselFilter, VesselMotion, VesselReport
from gnc.estimation.wind_filter import WindFilter

__all__ = ["Fault", "Health", "VesselFilter", "VesselMotion", "VesselReport", "WindFilter"]
