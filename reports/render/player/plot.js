// Distance to the vessel, bank and, where there is an instrument, gas over time, and the time shown as a line through all. Distances are shown as far as in the
// figures of the flight: of one that begins far away how near it comes would not be seen beside that.

const MARGIN = {left: 58, right: 14, top: 18, bottom: 30}, GAP = 16, POINTS = 1200;

function ticks(low, high, count) {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 3, 5, 10].map((factor) => factor * power).find((candidate) => candidate >= raw);
  const values = [];
  for (let value = Math.ceil(low / step) * step; value <= high + 1e-9; value += step) values.push(value);
  return values;
}

class Plot {
  constructor(canvas, colours) {
    this.canvas = canvas;
    this.colours = colours;
    this.still = document.createElement("canvas");
  }

  take(flight) {
    this.flight = flight;
    const {radius} = flight.keepout, distance = [], bank = [], gas = [];
    this.times = Array.from({length: POINTS + 1}, (_, i) => flight.start + ((flight.end - flight.start) * i) / POINTS);
    for (const time of this.times) {
      const now = flight.at(time);
      distance.push(now.distance);
      bank.push((now.roll * 180) / Math.PI);
      if (flight.gas) gas.push(now.gas);
    }
    const [low, high] = flight.distances, most = Math.max(10, ...bank.map(Math.abs));
    const beyond = Math.max(...distance) > high ? `above ${Math.round(high)} m: not shown` : "";
    this.panels = [
      {label: "Distance [m]", values: distance, low, high, limit: radius, beyond},
      {label: "Bank [deg]", values: bank, low: -1.1 * most, high: 1.1 * most},
    ];
    if (flight.gas) {
      const [least, largest] = [Math.min(0, ...gas), Math.max(1e-9, ...gas)];
      this.panels.push({label: flight.gas.label, values: gas, low: least, high: 1.05 * largest});
    }
    this.resize();
  }

  resize() {
    const ratio = window.devicePixelRatio || 1, {clientWidth, clientHeight} = this.canvas;
    for (const canvas of [this.canvas, this.still]) {
      canvas.width = Math.max(1, Math.round(clientWidth * ratio));
      canvas.height = Math.max(1, Math.round(clientHeight * ratio));
    }
    this.ratio = ratio;
    const page = getComputedStyle(this.canvas);
    [this.paper, this.ink, this.quiet, this.line] = ["--paper", "--ink", "--quiet", "--line"].map((name) => page.getPropertyValue(name).trim());
    this.width = clientWidth - MARGIN.left - MARGIN.right;
    this.height = (clientHeight - MARGIN.top - MARGIN.bottom - (this.panels.length - 1) * GAP) / this.panels.length;
    if (this.width > 0) this.drawStill();
  }

  get bottom() {
    return MARGIN.top + this.panels.length * (this.height + GAP) - GAP;
  }

  x(time) {
    return MARGIN.left + (this.width * (time - this.flight.start)) / (this.flight.end - this.flight.start);
  }

  time(x) {
    const share = Math.min(Math.max((x - MARGIN.left) / this.width, 0), 1);
    return this.flight.start + share * (this.flight.end - this.flight.start);
  }

  drawStill() {
    const pen = this.still.getContext("2d");
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.fillStyle = this.paper;
    pen.fillRect(0, 0, this.still.width, this.still.height);
    pen.font = '12px system-ui, "Segoe UI", "DejaVu Sans", sans-serif';
    this.panels.forEach((panel, number) => this.drawPanel(pen, panel, MARGIN.top + number * (this.height + GAP)));
    const {bottom} = this;
    pen.fillStyle = this.quiet;
    pen.textAlign = "center";
    for (const time of ticks(this.flight.start, this.flight.end, this.width / 90)) pen.fillText(String(Math.round(time)), this.x(time), bottom + 14);
    pen.textAlign = "right";
    pen.fillText("Time [s]", MARGIN.left + this.width, bottom + 27);
  }

  drawPanel(pen, {label, values, low, high, limit, beyond}, top) {
    const y = (value) => top + (this.height * (high - value)) / (high - low);
    pen.save();
    pen.globalAlpha = 0.35;
    for (const [from, to, held] of this.flight.guard) {
      pen.fillStyle = this.colours[held ? "guard" : "guardLost"];
      pen.fillRect(this.x(from), top, Math.max(2, this.x(to) - this.x(from)), this.height);
    }
    pen.restore();
    pen.lineWidth = 1;
    for (const value of ticks(low, high, this.height / 22)) {
      pen.strokeStyle = this.line;
      this.stroke(pen, [[MARGIN.left, y(value)], [MARGIN.left + this.width, y(value)]]);
      pen.fillStyle = this.quiet;
      pen.textAlign = "right";
      pen.fillText(String(Math.round(value)).replace("-", "−"), MARGIN.left - 6, y(value) + 4);
    }
    pen.save();
    pen.beginPath();
    pen.rect(MARGIN.left, top, this.width, this.height);
    pen.clip();
    if (limit !== undefined) {
      pen.setLineDash([6, 4]);
      pen.lineWidth = 1.4;
      pen.strokeStyle = this.colours.limit;
      this.stroke(pen, [[MARGIN.left, y(limit)], [MARGIN.left + this.width, y(limit)]]);
      pen.setLineDash([]);
      pen.fillStyle = this.colours.crossing;
      for (const time of this.flight.crossings) {
        pen.beginPath();
        pen.arc(this.x(time), y(this.flight.at(time).distance), 2.6, 0, 2 * Math.PI);
        pen.fill();
      }
    }
    pen.strokeStyle = this.colours.flown;
    pen.lineWidth = 1.4;
    pen.lineJoin = "round";
    this.stroke(pen, values.map((value, i) => [this.x(this.times[i]), y(value)]));
    pen.restore();
    pen.strokeStyle = this.quiet;
    pen.strokeRect(MARGIN.left, top, this.width, this.height);
    pen.save();
    pen.translate(13, top + this.height / 2);
    pen.rotate(-Math.PI / 2);
    pen.textAlign = "center";
    pen.fillStyle = this.ink;
    pen.fillText(label, 0, 0);
    pen.restore();
    if (beyond) {
      pen.textAlign = "right";
      pen.fillStyle = this.quiet;
      pen.fillText(beyond, MARGIN.left + this.width, top - 5);
    }
  }

  stroke(pen, points) {
    pen.beginPath();
    points.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    pen.stroke();
  }

  draw(time) {
    if (!(this.width > 0)) return;
    const pen = this.canvas.getContext("2d");
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.drawImage(this.still, 0, 0);
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.strokeStyle = pen.fillStyle = this.ink;
    pen.lineWidth = 1.5;
    this.stroke(pen, [[this.x(time), MARGIN.top], [this.x(time), this.bottom]]);
    const now = this.flight.at(time), values = [now.distance, (now.roll * 180) / Math.PI, now.gas];
    this.panels.forEach(({low, high}, number) => {
      const top = MARGIN.top + number * (this.height + GAP), value = Math.min(Math.max(values[number], low), high);
      pen.beginPath();
      pen.arc(this.x(time), top + (this.height * (high - value)) / (high - low), 3.6, 0, 2 * Math.PI);
      pen.fill();
    });
  }
}
