"""Guidance and control of the paper, for any constant-speed nonholonomic vehicle. Knows neither
JSBSim nor aircraft.

Escudeiro, "UAV-based Measurement of Marine Vessels Smoke Plumes - Guidance and Control System".
``EQUATIONS.md`` maps its equations to functions and tests. The plane is north-east, in metres;
course angles are clockwise from north, in radians.
"""

from gnc.compiled import choose

choose()
