"""Steering laws of autopilots and of the literature, which know paths and not moving points.

Each module has the law's equations as pure functions, and the laws of ``gnc.laws`` that apply them
to a moving reference; ``extensions.arena.laws.path`` says how. Positions and
velocities are tuples, north and east, in m and m/s. Courses are clockwise from north, in rad; a
turn to the right is positive.
"""
