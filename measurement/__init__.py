"""From a ship's engine over its plume and a sniffer's readings to the fuel sulphur content."""
