"""SO2 and CO2 brought to one response, and the slope between them."""
