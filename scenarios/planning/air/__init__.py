"""What air and sensors make wrong in what the vehicle knows of its own motion: the estimated wind,
and dead reckoning.
"""
