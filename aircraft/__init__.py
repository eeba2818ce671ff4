"""What flies: JSBSim models, and the only code that touches JSBSim. SI units and radians at its edge."""
