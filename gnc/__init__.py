"""The guidance: the paper's, extended for an aircraft in wind and a ship that manoeuvres.

It knows neither JSBSim nor aircraft. ``paper.py`` has the paper's equations, and ``EQUATIONS.md``
lists where the code differs. The plane is north-east, in metres; courses are clockwise from north,
in radians.
"""

from gnc.compiled import choose

choose()
