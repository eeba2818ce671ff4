"""Other formats of what a run recorded: an extension point."""

from reports.export.exporter import EXPORTERS, Exporter

__all__ = ["EXPORTERS", "Exporter"]
