"""The keep-out guard: a filter that keeps the vehicle out of a moving disc whatever the steering
law demands.
"""
