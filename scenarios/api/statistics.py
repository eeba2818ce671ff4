"""The statistics of a Monte Carlo study as typed objects, from ``statistics.json``."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from scenarios.errors import InputError


@dataclass(frozen=True, slots=True, kw_only=True)
class Probability:
    """The probability of an event in a flight; limits are NaN if there are too few flights.

    Attributes
    ----------
    events, flights : number of flights with the event, and of all flights
    estimate : fraction of flights with the event, or the estimate of subset simulation [-]
    low, high : two-sided interval by Clopper and Pearson, or from repeated subset simulations [-]
    upper : one-sided upper bound [-]
    """

    events: int
    flights: int
    estimate: float
    low: float
    high: float
    upper: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantile:
    """A quantile of a figure, in the figure's unit.

    Attributes
    ----------
    probability : probability of a value below the quantile [-]
    value : quantile of the flights
    low, high : interval from order statistics; NaN if there are too few flights
    """

    probability: float
    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Statistics:
    """Statistics of a Monte Carlo study.

    Attributes
    ----------
    confidence : confidence of each single interval [-]
    flights, measured : number of done flights, and of measured ones
    outcomes : number of flights by outcome
    violation : probability of a keep-out violation, from measured flights
    violation_at_most : one-sided upper bound of it if unknown flights count as violations [-]
    quantiles : quantiles of each figure by its column, such as "min_distance_m"; empty for subset
        simulation
    content : content of ``statistics.json``
    """

    confidence: float
    flights: int
    measured: int
    outcomes: Mapping[str, int]
    violation: Probability
    violation_at_most: float
    quantiles: Mapping[str, tuple[Quantile, ...]]
    content: Mapping[str, Any]

    def quantile(self, figure: str, probability: float) -> Quantile:
        """Return a quantile of a figure.

        Parameters
        ----------
        figure : column of the figure, such as "min_distance_m"
        probability : probability of a value below the quantile [-]

        Raises
        ------
        InputError : there is no such figure or no such quantile
        """
        known = self.quantiles.get(figure, ())
        for quantile in known:
            if math.isclose(quantile.probability, probability):
                return quantile
        given = ", ".join(f"{quantile.probability:g}" for quantile in known)
        there = (
            f"it has those of {given}"
            if known
            else f"figures are {', '.join(self.quantiles) or 'none'}"
        )
        raise InputError(f"statistics have no quantile {probability:g} of '{figure}'; {there}")


def statistics_of(content: Mapping[str, Any]) -> Statistics:
    """Return the object for the content of ``statistics.json``, by plain sampling or by subsets."""
    violation = content["violation"]
    plain = violation.get("measured", violation)
    flights = content["flights"]
    return Statistics(
        confidence=content["confidence"],
        flights=flights["done"],
        measured=flights["measured"],
        outcomes=content["outcomes"],
        violation=Probability(
            events=plain["events"],
            flights=plain.get("flights", flights["measured"]),
            estimate=_number(plain.get("share", plain.get("estimate"))),
            low=_number(plain["low"]),
            high=_number(plain["high"]),
            upper=_number(plain["upper"]),
        ),
        violation_at_most=_number(violation["pessimistic"]["upper"]),
        quantiles={
            name: tuple(
                Quantile(
                    **{
                        key: _number(quantile[key])
                        for key in ("probability", "value", "low", "high")
                    }
                )
                for quantile in figure["quantiles"]
            )
            for name, figure in content.get("figures", {}).items()
        },
        content=content,
    )


def _number(value: float | None) -> float:
    """Return a number from JSON, in which None stands for NaN."""
    return math.nan if value is None else value
