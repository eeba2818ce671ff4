"""What is planned of a plume: where its axis is expected, and how far from the ship it is measured
best.
"""
