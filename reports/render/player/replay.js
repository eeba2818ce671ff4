// The replay of the flight that is picked: its controls, its clock, and what the page and its tests may ask of it.

const UP = new THREE.Vector3(0, 1, 0), OPENS = "closest approach", LEAD = 4;

// Pictures that take longer than SLOW [ms], so many after each other, are drawn with fewer pixels.
const SLOW = 38, SLOW_FRAMES = 6, RATIO_LEAST = 0.5;

class Replay {
  constructor(root, flights, colours) {
    this.root = root;
    this.flights = flights;
    this.colours = colours;
    this.time = 0;
    this.playing = false;
    this.part = (name) => root.querySelector(`[data-part="${name}"]`);
    this.slider = this.part("time");
    this.plot = new Plot(this.part("plot"), colours);
    this.stage = this.part("stage");
    if (document.createElement("canvas").getContext("webgl2")) {
      this.renderer = new THREE.WebGLRenderer({canvas: this.stage, antialias: true});
      this.ratio = Math.min(window.devicePixelRatio || 1, 2);
      this.camera = new Camera(this.stage, () => this.draw());
    } else {
      this.stage.hidden = this.part("compass").hidden = true;
      this.part("without").hidden = false;
    }
    this.listen();
  }

  listen() {
    this.part("play").addEventListener("click", () => this.play(!this.playing));
    this.slider.addEventListener("input", () => this.seek(Number(this.slider.value)));
    for (const choice of this.root.querySelectorAll("[name=replay-camera]"))
      choice.addEventListener("change", () => this.look(choice.value));
    this.part("enlarged").addEventListener("change", () => this.look(this.mode));
    const drag = (event) => {
      if (event.buttons & 1) this.seek(this.plot.time(event.offsetX));
    };
    for (const kind of ["pointerdown", "pointermove"]) this.plot.canvas.addEventListener(kind, drag);
    this.stage.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.resize()).observe(this.root);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.resize());
    // It begins to play once it is seen, unless the reader's system asks for no motion.
    const seen = new IntersectionObserver(([entry]) => {
      if (!entry.isIntersecting) return;
      seen.disconnect();
      if (this.flight && !matchMedia("(prefers-reduced-motion: reduce)").matches) this.play(true);
    }, {threshold: 0.3});
    seen.observe(this.root);
  }

  key(event) {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    const step = event.shiftKey ? 10 : 1, moves = {a: [-0.1, 0, 1], d: [0.1, 0, 1], w: [0, 0.08, 1], s: [0, -0.08, 1], "+": [0, 0, 0.9], "-": [0, 0, 1.1]};
    if (event.key === " ") this.play(!this.playing);
    else if (event.key === "ArrowRight") this.seek(this.time + step);
    else if (event.key === "ArrowLeft") this.seek(this.time - step);
    else if (event.key in moves) this.camera.move(...moves[event.key]);
    else if (["1", "2", "3"].includes(event.key)) this.look(CAMERAS[event.key - 1]);
    else return;
    event.preventDefault();
  }

  // Show a flight shortly before its closest approach; none of those that have no time history.
  show(name) {
    this.play(false);
    this.root.hidden = !Object.hasOwn(this.flights, name);
    if (this.root.hidden) return;
    this.flight = new Flight(this.flights[name]);
    this.time = Math.max(this.flight.start, this.flight.events.find(({name}) => name === OPENS)?.time - LEAD || this.flight.start);
    [this.slider.min, this.slider.max, this.slider.step] = [this.flight.start, this.flight.end, 0.1];
    for (const kind of ["guard", "guardLost"])
      this.part(kind).hidden = !this.flight.guard.some(([, , held]) => held === (kind === "guard"));
    this.part("ship").textContent = this.flight.hull.name;
    this.part("hull").textContent = this.flight.hull.words;
    const {gas, estimate} = this.flight;
    this.part("gas").hidden = !gas;
    if (gas) this.part("gas-most").textContent = gas.words;
    this.part("flown").hidden = !!gas;
    this.part("estimate").hidden = !estimate;
    if (estimate) this.drawLimits(estimate);
    this.part("jumps").replaceChildren(...this.flight.events.map(({name, time}) => {
      const button = Object.assign(document.createElement("button"), {type: "button", textContent: name, title: `${time.toFixed(1)} s`});
      button.addEventListener("click", () => this.seek(time - LEAD));
      return button;
    }));
    this.plot.take(this.flight);
    this.gone?.dispose();
    this.gone = this.world;
    if (this.renderer) this.world = new World(this.flight, this.colours);
    this.resize();
    // A free camera stays where it is, which is at another flight's place.
    const mode = this.mode;
    this.look("vessel");
    this.look(mode);
  }

  get mode() {
    return this.root.querySelector("[name=replay-camera]:checked").value;
  }

  get enlarged() {
    return this.part("enlarged").checked;
  }

  look(mode) {
    this.root.querySelector(`[name=replay-camera][value=${mode}]`).checked = true;
    this.camera?.begin(mode, this.flight, this.time, this.enlarged);
    this.draw();
  }

  play(on) {
    if (on && this.time >= this.flight.end) this.time = this.flight.start;
    this.playing = on;
    this.part("play").textContent = on ? "❚❚ Pause" : "► Play";
    if (!on) return;
    let before = null;
    const next = (now) => {
      if (!this.playing) return;
      // A page that was hidden goes on where it was.
      this.seek(this.time + Number(this.part("speed").value) * Math.min(0.25, (now - (before ?? now)) / 1000));
      if (before !== null) this.keepUp(now - before);
      before = now;
      if (this.time >= this.flight.end) this.play(false);
      else requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
  }

  // A machine that draws slowly gets fewer pixels, down to half as many each way.
  keepUp(took) {
    this.slow = took > SLOW ? (this.slow ?? 0) + 1 : 0;
    if (this.slow < SLOW_FRAMES || !this.renderer || this.ratio <= RATIO_LEAST) return;
    this.slow = 0;
    this.ratio = Math.max(RATIO_LEAST, 0.8 * this.ratio);
    this.resize();
  }

  seek(time) {
    this.time = Math.min(Math.max(time, this.flight.start), this.flight.end);
    this.draw();
  }

  resize() {
    if (!this.flight || this.root.hidden) return;
    this.plot.resize();
    if (this.renderer) {
      const {clientWidth, clientHeight} = this.stage;
      this.renderer.setPixelRatio(this.ratio);
      this.renderer.setSize(clientWidth, clientHeight, false);
      this.camera.camera.aspect = clientWidth / clientHeight;
      this.camera.camera.updateProjectionMatrix();
    }
    this.draw();
  }

  draw() {
    // Once for each picture, however much has changed.
    this.asked ??= requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    this.asked = null;
    const {flight, time} = this, now = flight.at(time), degrees = (angle) => Math.round((angle * 180) / Math.PI);
    this.slider.value = time;
    const words = `${time.toFixed(1)} s of ${flight.end.toFixed(0)} s`;
    this.part("clock").textContent = words;
    this.slider.setAttribute("aria-valuetext", words);
    const heading = ((degrees(now.heading) % 360) + 360) % 360, bank = String(degrees(now.roll)).replace("-", "−");
    const guard = flight.guardAt(time), crossings = flight.crossingsUntil(time);
    const date = flight.utc === null ? "" : `${new Date(1000 * (flight.utc + time)).toISOString().slice(0, 19).replace("T", " ")} UTC · `;
    this.part("readout").textContent =
      `${date}${crossings} crossing${crossings === 1 ? "" : "s"} · distance ${now.distance.toFixed(0)} m · height ${now.altitude.toFixed(0)} m · ` +
      `airspeed ${now.airspeed.toFixed(1)} m/s · heading ${heading}° · bank ${bank}°` +
      (flight.gas ? ` · ${flight.gas.name} ${now.gas.toFixed(0)} ${flight.gas.unit}` : "") + (guard ? ` · ${this.part(guard).textContent}` : "");
    this.drawEstimate(flight.estimateAt(time));
    const wind = Math.hypot(now.wind_north, now.wind_east), from = Math.atan2(-now.wind_east, -now.wind_north);
    this.part("arrow").style.visibility = wind < 0.1 ? "hidden" : "visible";
    this.part("wind").textContent = `wind ${wind.toFixed(1)} m/s`;
    this.plot.draw(time);
    if (!this.world) return;
    const options = {enlarged: this.enlarged, aboutVessel: this.mode === "vessel", focus: this.camera.track(flight, time), eye: this.camera.camera.position};
    this.world.show(time, options);
    PIXEL.value = (2 * Math.tan((this.camera.camera.fov * Math.PI) / 360)) / this.stage.clientHeight;
    this.part("needle").style.transform = `rotate(${-this.camera.course}rad)`;
    // It points where the wind blows to, and is longer in more wind.
    this.part("arrow").style.transform = `rotate(${from + Math.PI - this.camera.course}rad) scale(1, ${Math.min(1.3, 0.4 + wind / 14)})`;
    this.renderer.render(this.world.scene, this.camera.camera);
    // That of the flight before goes once the new one is drawn, which takes over its shaders: to compile them takes longest.
    this.gone?.dispose();
    this.gone = null;
  }

  // The scale of the estimate, and the limits that it is compared with.
  drawLimits({most, limits, words}) {
    this.part("estimate-title").textContent = words;
    this.part("estimate-limits").replaceChildren(...limits.map((limit) => {
      const mark = document.createElement("i");
      mark.style.left = `${(100 * limit) / most}%`;
      mark.title = `limit ${limit} %`;
      return mark;
    }));
  }

  // What is known of the fuel's sulphur by now, with its interval.
  drawEstimate(row) {
    if (!this.flight.estimate) return;
    const band = this.part("estimate-band"), dot = this.part("estimate-dot"), {most} = this.flight.estimate;
    band.hidden = dot.hidden = !row;
    this.part("estimate-words").textContent = row
      ? `${row[1].toFixed(3)} % (${row[2].toFixed(3)} to ${row[3].toFixed(3)})${row[4] ? ` · ${row[4]}` : ""}` : "not known yet";
    if (!row) return;
    const place = (value) => 100 * Math.min(1, Math.max(0, value / most));
    band.style.left = `${place(row[2])}%`;
    band.style.width = `${place(row[3]) - place(row[2])}%`;
    dot.style.left = `${place(row[1])}%`;
  }

  // Where the aircraft is drawn, from the drawing itself, and at which time [s]; null where nothing is drawn.
  place() {
    if (!this.world) return null;
    if (this.asked) {
      cancelAnimationFrame(this.asked);
      this.drawNow();
    }
    return {time: this.time, ...this.world.place()};
  }
}

const data = JSON.parse(document.getElementById("replay-data").textContent);
window.replay = new Replay(document.getElementById("replay"), data.flights, data.colours);
