// Where the parcels of the exhaust are: from the simulation's own realisation, or along the axis of a plume that has no width.

const STRENGTH = 34, STRONGEST = 0.7, AXIS_SPREAD = 3.0, AXIS_PARCELS = 90;

// Parcels of a realisation. In the air mass a parcel stays where it was emitted; it rises, spreads and meanders with its age.
class ParcelSmoke {
  constructor(data, flight) {
    this.flight = flight;
    Object.assign(this, data);
    this.parcels = Object.fromEntries(["north", "east", "wind", "across", "up", "drift_north", "drift_east"].map((name) => [name, decodedColumn(data[name], data.count)]));
    this.shown = Math.min(data.count, Math.ceil(data.age_max / data.step) + 1);
  }

  // A row of the table at an apparent wind [m/s] and an age [s]: height, spreads and meander [m].
  row(wind, age, into) {
    const {winds, table: rows} = this, at = Math.min(Math.max(age / this.age_max, 0), 0.999999) * (rows[0].length - 1);
    const i = Math.floor(at), s = at - i;
    let w = 0, v = 0;
    if (winds.length > 1) {
      const place = Math.min(Math.max(Math.log(wind / winds[0]) / Math.log(winds[1] / winds[0]), 0), winds.length - 1.000001);
      w = Math.floor(place);
      v = place - w;
    }
    const [low, high] = [rows[w], rows[Math.min(w + 1, rows.length - 1)]];
    for (let k = 0; k < 5; k++) {
      const below = low[i][k] + s * (low[i + 1][k] - low[i][k]), above = high[i][k] + s * (high[i + 1][k] - high[i][k]);
      into[k] = below + v * (above - below);
    }
    return into;
  }

  each(time, draw) {
    const {north, east, wind, across, up} = this.parcels, {first, step, count} = this, row = [], parcel = {};
    const place = Math.min(Math.max((time - first) / step, 0), count - 1.000001), whole = Math.floor(place);
    const drift = ["drift_north", "drift_east"].map((name) => {
      const moved = this.parcels[name];
      return moved[whole] + (place - whole) * (moved[whole + 1] - moved[whole]);
    });
    const newest = Math.min(count - 2, Math.floor((time - first) / step)), oldest = Math.max(1, Math.ceil((time - this.age_max - first) / step));
    for (let i = oldest; i <= newest; i++) {
      const age = time - first - i * step, [height, sigmaY, sigmaZ, meanderY, meanderZ] = this.row(wind[i], age, row);
      // The stack moves against the apparent wind in the air mass.
      const dn = north[i - 1] - north[i + 1], de = east[i - 1] - east[i + 1], size = Math.hypot(dn, de) || 1;
      [parcel.alongNorth, parcel.alongEast, parcel.acrossNorth, parcel.acrossEast] = [dn / size, de / size, -de / size, dn / size];
      const off = meanderY * across[i];
      parcel.north = north[i] + drift[0] + off * parcel.acrossNorth;
      parcel.east = east[i] + drift[1] + off * parcel.acrossEast;
      parcel.height = Math.abs(height + meanderZ * up[i]);
      parcel.sigmaY = sigmaY;
      parcel.sigmaZ = sigmaZ;
      parcel.spacing = 0.5 * wind[i] * step;
      // Soot in a parcel stays: it thins out as its cross-section grows. The oldest fade out.
      const fade = Math.min(1, (this.age_max - age) / (0.2 * this.age_max));
      parcel.strength = fade * STRONGEST * (1 - Math.exp(-STRENGTH / (sigmaY * sigmaZ)));
      draw(i, parcel);
    }
  }
}

// A plume that is simulated as an axis: parcels that drift along it.
class AxisSmoke {
  constructor({length, rise}, flight) {
    this.flight = flight;
    this.spacing = length / AXIS_PARCELS;
    this.rise = rise;
    this.shown = AXIS_PARCELS + 1;
  }

  each(time, draw) {
    const now = this.flight.at(time), cos = Math.cos(now.plume_axis), sin = Math.sin(now.plume_axis);
    const blown = now.apparent_drift, first = Math.floor(blown / this.spacing), rest = blown - first * this.spacing;
    const parcel = {
      alongNorth: cos, alongEast: sin, acrossNorth: -sin, acrossEast: cos, spacing: 0.5 * this.spacing, sigmaY: AXIS_SPREAD, sigmaZ: AXIS_SPREAD,
    };
    for (let k = 0; k < AXIS_PARCELS; k++) {
      const distance = k * this.spacing + rest;
      parcel.north = now.vessel_north + distance * cos;
      parcel.east = now.vessel_east + distance * sin;
      parcel.height = this.flight.keepout.height + distance * this.rise;
      parcel.strength = 0.5 * Math.min(1, 4 * (1 - k / AXIS_PARCELS));
      draw((((first - k) % 997) + 997) % 997, parcel);
    }
  }
}
