"""Sniffers: their specification and their readings."""

from measurement.sniffer.channel import Channel
from measurement.sniffer.sniffer import Readings, Sniffer
from measurement.sniffer.spec import SnifferSpec, sensor_of, sensor_preset, sensor_presets

__all__ = [
    "Channel",
    "Readings",
    "Sniffer",
    "SnifferSpec",
    "sensor_of",
    "sensor_preset",
    "sensor_presets",
]
