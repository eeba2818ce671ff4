"""A vessel from a file of AIS reports: the file's layout, the selection of usable reports, and a
smooth track through them.
"""

from scenarios.world.ais.reports import AisReports, read_ais
from scenarios.world.ais.size import ShipSize

__all__ = ["AisReports", "ShipSize", "read_ais"]
