"""Aircraft: JSBSim models, their simulation and linear models. Only this package uses JSBSim."""
