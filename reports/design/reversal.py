"""What a design's report says of reversals of a turn."""

from reports.design.data import Record


def reversal_sentences(design: Record) -> str | None:
    """Return how far reversals stray from their response, or None for a record that was made before they were searched."""
    own = design.get("turn_reversal")
    if not own or "deviation_max_m" not in own:
        return None
    said = (
        f"A reversal of the turn at {own['bank_deg']:.0f}° of bank is predicted by a dead time of {own['delay_s']:.2f} s and a lag"
        f" of {own['lag_s']:.2f} s. In {own['reversals']} reversals from random commands the aircraft came up to"
        f" {own['deviation_max_m']:.2f} m nearer to what it turned away from than predicted, in 99 of 100 of them no more than"
        f" {own['deviation_99_percent_m']:.2f} m."
    )
    more = own.get("repeated_search")
    if more:
        said += f" In {more['reversals']} others it came up to {more['deviation_max_m']:.2f} m nearer."
    return said
