"""The keep-out guard: a filter that keeps the vehicle out of a moving disc whatever the steering law demands."""

from gnc.safety.guard_parameters import GuardParameters
from gnc.safety.keepout_guard import KeepoutGuard

__all__ = ["GuardParameters", "KeepoutGuard"]
