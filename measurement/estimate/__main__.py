"""``python -m measurement.estimate FLIGHT.csv``: the command of ``measurement.log.command``."""

import sys

from measurement.log.command import main

if __name__ == "__main__":
    sys.exit(main())
