"""What the guidance may ask of an aircraft, whether that can be flown, and how often it plans."""

import math

from aircraft.spec import Envelope
from common.physics.coordinated_turn import bank_for_heading_rate, heading_rate_for_bank
from scenarios.errors import InputError
from scenarios.schema.sections.guidance import GuidanceConfig

PLAN_PERIOD = 0.5
"""Time between plans, and between measurements of the wind [s]."""


def omega_max(guidance: GuidanceConfig) -> float:
    """Return omega_max, the largest heading rate that the guidance may command [rad/s]."""
    return guidance.heading_rate_max_rad_s or heading_rate_for_bank(math.radians(guidance.bank_deg), guidance.airspeed_mps)


def plan_interval(guidance: GuidanceConfig) -> int:
    """Return the guidance steps between plans."""
    return max(1, round(PLAN_PERIOD * guidance.rate_hz))


def check_flyable(guidance: GuidanceConfig, title: str, envelope: Envelope) -> None:
    """Raise an InputError for an airspeed or a bank that the aircraft called ``title`` cannot fly."""
    airspeed = guidance.airspeed_mps
    if not envelope.airspeed_min <= airspeed <= envelope.airspeed_max:
        raise InputError(
            f"guidance.airspeed_mps is {airspeed:g}; {title} flies {envelope.airspeed_min:.1f} to"
            f" {envelope.airspeed_max:.1f} m/s: choose an airspeed in between, or leave it out"
        )
    bank = bank_for_heading_rate(omega_max(guidance), airspeed)
    if bank > envelope.bank_max:
        raise InputError(
            f"guidance asks for {math.degrees(bank):.1f} deg of bank; the autopilot of {title} stops at"
            f" {math.degrees(envelope.bank_max):.0f}: lower guidance.bank_deg or guidance.heading_rate_max_rad_s"
        )
