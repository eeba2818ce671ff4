"""Designs of these tests are remembered for the session alone."""

from tests.design_cache import session_cache

__all__ = ["session_cache"]
