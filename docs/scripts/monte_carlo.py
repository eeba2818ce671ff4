"""Fly a Monte Carlo study on two processes, and print its statistics."""

from scenarios import run

if __name__ == "__main__":
    study = run("monte_carlo", jobs=2, flights=6, flight={"crossings": 1}, progress=True)
    found = study.statistics

    violation = found.violation
    print(f"{violation.events} of {violation.flights} flights violated the keep-out area:")
    print(
        f"{violation.low:.1%} to {violation.high:.1%} of flights do, at {found.confidence:.0%}"
        " confidence"
    )
    nearest = found.quantile("min_distance_m", 0.5)
    print(
        f"median of the closest approach {nearest.value:.1f} m, {nearest.low:.1f} to"
        f" {nearest.high:.1f} m"
    )
    for name, flight in study.flights.items():
        if not flight.met:
            print(f"{name}: {'; '.join(flight.reasons)}")
    study.report("report.html")
