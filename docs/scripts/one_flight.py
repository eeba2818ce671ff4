"""Fly one flight, look at its figures, and plot it."""

from scenarios import fly

flight = fly("sweep_nu", nu=0.5, flight={"crossings": 6}, **{"guidance.preview": False})

unit = flight.row.attrs["units"]["min_distance_m"]
print(f"{flight.flight_id}: {'met' if flight.met else '; '.join(flight.reasons)}")
print(
    f"closest approach {flight.row['min_distance_m']:.1f} {unit}, {len(flight.crossings)} crossings"
)
print(
    f"steepest bank {flight.history['roll_rad'].abs().max():.2f}"
    f" {flight.history.attrs['units']['roll_rad']}"
)

flight.plot().savefig("flight.png")
flight.export("flight.kmz")  # for Google Earth
flight.export("flight.parquet")  # the time history, with units
