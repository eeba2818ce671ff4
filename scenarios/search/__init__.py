"""Search for the point of the unit cube with the least clearance: methods that ask for points and are told what came of them."""
