"""Fly beside a ship from a file of AIS reports, in wind from a table."""

from pathlib import Path

from scenarios import fly, load, read_ais

Path("wind.csv").write_text(
    "time_utc,speed_mps,from_deg\n2026-06-01T10:00:00Z,4.0,60\n2026-06-01T10:30:00Z,6.0,80\n2026-06-01T11:30:00Z,5.0,70\n"
)
ship = read_ais(load("ship_from_ais")["vessel.track"], mmsi=219999001)
flight = fly(
    "ship_from_ais",
    track=ship,
    wind={"table": "wind.csv"},
    flight={"duration_max_s": 300.0},
)
print(
    f"{len(flight.crossings)} crossings in {flight.row['duration_s']:.0f} s, from"
    f" {flight.row['start_utc']} on"
)
print(
    f"closest approach {flight.row['min_distance_m']:.1f} m, keep-out violations:"
    f" {flight.row['keepout_violations']:.0f}"
)
flight.export("flight.kmz")
