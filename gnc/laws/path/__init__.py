"""Steering laws of autopilots and of the literature, which know paths: each a pure function, and
its adapter to a moving point.

Importing the package registers all of them.
"""

from gnc.laws.path import (
    ardupilot_l1,
    ardupilot_loiter,
    carrot,
    constant_bearing,
    lgvf,
    look_ahead_line_of_sight,
    npfg,
    park_l1,
    proportional_navigation,
    pure_pursuit,
    rosplane_field,
    vector_field,
)

__all__ = [
    "ardupilot_l1",
    "ardupilot_loiter",
    "carrot",
    "constant_bearing",
    "lgvf",
    "look_ahead_line_of_sight",
    "npfg",
    "park_l1",
    "proportional_navigation",
    "pure_pursuit",
    "rosplane_field",
    "vector_field",
]
