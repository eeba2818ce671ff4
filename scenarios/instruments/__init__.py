"""Instruments on board: how they are added, and a sniffer that measures the exhaust."""
