"""What the tests of the actuation bounds share."""

from gnc_cases import SPEED
from hypothesis import strategies as st

from gnc.analysis.bounds import fastest_within
from gnc.paper import look_ahead

# omega_max of the tables of docs/actuation_bounds.md; the paper has 0.503.
LIMIT = 0.505

distances = st.floats(0.0, 8.0).map(lambda power: 10.0 ** (power - 2.0))
steering = st.floats(0.01, 1.0)


@st.composite
def look_aheads(draw):
    """Look-aheads of 5 m to 5 km whose sigma is from 0.02 to 0.99."""
    radius = 5.0 * 1000.0 ** draw(st.floats(0.0, 1.0))
    sigma = draw(st.floats(0.02, 0.99))
    return look_ahead(1.0 / (4.0 * sigma**2 * radius), radius)


def fastest(reserve, *, limit=LIMIT):
    return fastest_within(
        speed=SPEED,
        heading_rate_max=limit,
        reference_heading_rate_max=(1.0 - reserve) * limit,
        distance_from=500.0,
        distance_to=5.0,
        gain=1.5,
    )
