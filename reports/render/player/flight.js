// A flight as the page holds it: columns over time, and what they are between their samples.

function decodedColumn(column, samples) {
  const values = new Float64Array(samples);
  if (column.data === undefined) {
    const slope = (column.last - column.first) / Math.max(1, samples - 1);
    for (let i = 0; i < samples; i++) values[i] = column.first + slope * i;
    return values;
  }
  // Second differences in whole steps, packed as replay.py says.
  const bytes = Uint8Array.from(atob(column.data), (letter) => letter.charCodeAt(0));
  let at = 0, level = 0, slope = 0;
  for (let i = 0; i < samples; i++) {
    let number = 0, factor = 1, byte;
    do {
      byte = bytes[at++];
      number += (byte & 127) * factor;
      factor *= 128;
    } while (byte & 128);
    slope += number % 2 ? -(number + 1) / 2 : number / 2;
    level += slope;
    values[i] = level * column.step;
  }
  return values;
}

// How far a place seen from the funnel is ahead or astern of the hull and beside it [m]; sides are bow, stern, port and starboard.
function beyondHull({north, east, vessel_heading: heading}, [bow, stern, port, starboard]) {
  const ahead = Math.cos(heading) * north + Math.sin(heading) * east, right = Math.cos(heading) * east - Math.sin(heading) * north;
  return [Math.max(ahead - bow, -stern - ahead, 0), Math.max(right - starboard, -port - right, 0)];
}

class Flight {
  constructor(data) {
    this.start = data.start;
    this.interval = data.interval;
    this.samples = data.samples;
    this.end = data.start + data.interval * (data.samples - 1);
    this.guard = data.guard;
    this.crossings = data.crossings;
    this.distances = data.distances;
    this.keepout = data.keepout;
    this.hull = data.hull;
    this.utc = data.utc;
    this.events = data.events;
    this.gas = data.gas;
    this.estimate = data.estimate;
    this.columns = Object.fromEntries(Object.entries(data.columns).map(([name, c]) => [name, decodedColumn(c, data.samples)]));
    this.others = data.others.map(({columns, ...other}) => ({
      ...other, columns: Object.fromEntries(Object.entries(columns).map(([name, c]) => [name, decodedColumn(c, data.samples)])),
    }));
    this.smoke = data.smoke ? new ParcelSmoke(data.smoke, this) : new AxisSmoke(data.axis, this);
  }

  // A column at a time [s]: the cubic of Catmull and Rom through its samples, so that paths have no corners.
  value(name, time) {
    const values = this.columns[name], last = this.samples - 1;
    const place = Math.min(Math.max((time - this.start) / this.interval, 0), last);
    const i = Math.min(Math.floor(place), last - 1), s = place - i;
    const b = values[i], c = values[i + 1];
    const a = i > 0 ? values[i - 1] : 2 * b - c, d = i + 2 <= last ? values[i + 2] : 2 * c - b;
    return b + 0.5 * s * (c - a + s * (2 * a - 5 * b + 4 * c - d + s * (3 * (b - c) + d - a)));
  }

  // Everything at a time: places over the ground and altitude [m], angles [rad], the distance that the keep-out area is about [m].
  at(time) {
    const now = {time};
    for (const name of Object.keys(this.columns)) now[name] = this.value(name, time);
    const {shape, height, sides} = this.keepout;
    const up = ["cylinder", "hull prism"].includes(shape) ? 0 : now.altitude - height;
    now.distance = Math.hypot(...(sides ? beyondHull(now, sides) : [now.north, now.east]), up);
    for (const axis of ["north", "east"])
      for (const what of ["", "reference_"]) {
        now[`relative_${what}${axis}`] = now[what + axis];
        now[what + axis] += now[`vessel_${axis}`];
      }
    return now;
  }

  // Change of a column [1/s].
  rate(name, time) {
    const half = 0.5 * this.interval, from = Math.max(this.start, time - half), to = Math.min(this.end, time + half);
    return (this.value(name, to) - this.value(name, from)) / (to - from);
  }

  // Where the vessel is over the ground; before the flight it came on its first course.
  vesselAt(time) {
    const early = Math.min(0, time - this.start);
    return ["vessel_north", "vessel_east"].map((name) => this.value(name, time) + (early ? early * this.rate(name, this.start) : 0));
  }

  // Where another ship is at a time: north, east [m] and heading [rad]; null while its track is not known.
  otherAt({columns, known: [first, last]}, time) {
    const place = (time - this.start) / this.interval;
    if (place < first || place > last) return null;
    const i = Math.min(Math.floor(place), this.samples - 2), s = place - i;
    return Object.fromEntries(Object.entries(columns).map(([name, values]) => [name, values[i] + s * (values[i + 1] - values[i])]));
  }

  // Crossings of the plume until a time.
  crossingsUntil(time) {
    return this.crossings.filter((crossed) => crossed <= time).length;
  }

  // The latest estimate of the fuel's sulphur at a time: a row of time [s], content and its interval [%]; null before the first.
  estimateAt(time) {
    return this.estimate ? (this.estimate.rows.filter(([at]) => at <= time).at(-1) ?? null) : null;
  }

  // What the keep-out guard does at a time: null, "guard", or "guardLost" where it cannot hold its radius.
  guardAt(time) {
    const stretch = this.guard.find(([from, to]) => from <= time && time < to);
    return stretch ? (stretch[2] ? "guard" : "guardLost") : null;
  }
}
