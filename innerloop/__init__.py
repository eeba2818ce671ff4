"""The autopilot: designed with python-control from the linearised aircraft, flown as a JSBSim
``<system>``.
"""
