"""What the keep-out guard's tube about a turn and the search for its width have to agree on (docs/keepout_guard.md)."""

LEAST_CHANGE = 0.5
"""Of heading rate, over that of a full reversal, for which a turn is taken to deviate at least [-]."""

FORGOTTEN = 8.0
"""Time constant with which a lack of course is forgotten, over the lag [-]: wind or trim leaves some, which never comes."""
