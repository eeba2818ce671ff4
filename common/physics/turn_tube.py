"""What the keep-out guard's tube about a turn and the search for its width have to agree on
(docs/keepout_guard.md).
"""

LEAST_CHANGE = 0.2
"""Of heading rate, over that of a full reversal, for which a turn is taken to deviate at least [-].
"""

FORGOTTEN = 64.0
"""Time constant with which course that is still to come is forgotten, over the lag [-]: of a turn
at the largest bank, some never comes. Heading rates oscillate for as long after a reversal as
``CHANGED`` says."""

CHANGED = 24.0
"""Time constant with which the largest change of command counts less for how far turns deviate,
over the lag [-].
"""

SLOW_LAG_ERROR = 0.025
"""Share of the lag behind slow commands that it may be off [-]: it was measured at one airspeed,
amplitude and frequency.
"""
