"""The way back from JSBSim's globe, which only tests need for an origin elsewhere."""


def to_local(frame, latitude, longitude):
    """Return north and east [m] of a place [rad] from the origin of a ``LocalFrame``."""
    origin = frame.to_geodetic(0.0, 0.0)
    return (latitude - origin[0]) * frame.north_scale, (longitude - origin[1]) * frame.east_scale
