"""The plume behind a funnel over the sea: rise, spreads, meander, and its concentration at any time
and place.
"""
