"""What is worked out of a record and kept for the next instrument that is asked about is of its
response, delays and windows.
"""

from crossings import changed, crossings, read

from measurement.estimate.areas import area_ratio
from measurement.estimate.fit import regress
from measurement.estimate.passes import find_passes
from measurement.estimate.record import checked_record
from measurement.estimate.signals import make_signals
from measurement.sniffer import sensor_preset


def test_a_record_that_was_asked_before_answers_as_a_new_one():
    # Passes so far from each other that a window is as long as the slowest response asks for.
    spec = sensor_preset("electrochemical")
    readings = read(spec, crossings(0.3, interval=75.0))
    so2, co2 = spec.known("so2"), spec.known("co2")
    instruments = [
        spec,
        changed(spec, "so2", t90_s=1.3 * so2.t90_s),
        changed(spec, "co2", t90_s=1.3 * co2.t90_s),
        changed(spec, "no2", t90_s=3.0 * so2.t90_s),
        changed(spec, "so2", delay_s=so2.delay_s + 2.0),
        changed(spec, "co2", delay_s=co2.delay_s + 2.0),
        changed(spec, "so2", gain=1.1),
    ]
    asked = checked_record(readings, spec)
    passes = find_passes(asked, co2)
    for instrument in [*instruments, *instruments]:
        new = checked_record(readings, spec)
        # To the last bit.
        assert area_ratio(asked, instrument, passes) == area_ratio(new, instrument, passes)
        assert regress(make_signals(asked, instrument)) == regress(make_signals(new, instrument))
