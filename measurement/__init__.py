"""What a sniffer in a ship's plume measures, from the engine to the fuel's sulphur content. Knows
no other room of the project.
"""
