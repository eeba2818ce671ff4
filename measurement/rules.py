"""Rules by name, by which ships are reported as suspect."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class DecisionRule:
    """Rule by which a ship is reported as suspect.

    Attributes
    ----------
    name, title : in a word, and in words
    limit_percent : of the fuel's sulphur content [% m/m]
    suspect_percent : estimate from which the ship is suspect, with any uncertainty; None for a
        guard band of 1.645 standard uncertainties above the limit [% m/m]
    """

    name: str
    title: str
    limit_percent: float
    suspect_percent: float | None = None


RULES = {
    rule.name: rule
    for rule in (
        DecisionRule(
            name="eca", title="control area, guard band of the uncertainty", limit_percent=0.10
        ),
        DecisionRule(
            name="eca_0.10",
            title="control area, no guard band",
            limit_percent=0.10,
            suspect_percent=0.10,
        ),
        DecisionRule(
            name="eca_0.13",
            title="control area, reported from 0.13 %",
            limit_percent=0.10,
            suspect_percent=0.13,
        ),
        DecisionRule(
            name="eca_0.15",
            title="control area, reported from 0.15 %",
            limit_percent=0.10,
            suspect_percent=0.15,
        ),
        DecisionRule(
            name="global",
            title="outside control areas, guard band of the uncertainty",
            limit_percent=0.50,
        ),
        DecisionRule(
            name="global_0.50",
            title="outside control areas, no guard band",
            limit_percent=0.50,
            suspect_percent=0.50,
        ),
    )
}
"""Rules by name.

Most parties to the Bonn Agreement report infringements from 0.15 % on (W. Van Roy et al.,
Communications Earth & Environment 4 (2023), doi 10.1038/s43247-023-01050-7).
"""
