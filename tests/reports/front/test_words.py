"""How sentences are broken into lines."""

from reports.render.words import unbroken


def test_a_number_and_its_unit_stay_on_one_line_and_other_words_do_not():
    assert (
        unbroken("at most 99.9 % in 6 m/s, 3 min")
        == "at most 99.9\u00a0% in 6\u00a0m/s, 3\u00a0min"
    )
    assert unbroken("0.097 % m/m, 95 % interval") == "0.097\u00a0%\u00a0m/m, 95\u00a0% interval"
    assert unbroken("2 missions, 3 h2, 4 steady") == "2 missions, 3 h2, 4 steady"
