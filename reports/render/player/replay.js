// The replay of the flight that is picked: its controls, its clock, and what the page and its tests may ask of it.

const UP = new THREE.Vector3(0, 1, 0);

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
      this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
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

  // Show a flight from its start; none of those that have no time history.
  show(name) {
    this.play(false);
    this.root.hidden = !Object.hasOwn(this.flights, name);
    if (this.root.hidden) return;
    this.flight = new Flight(this.flights[name]);
    this.time = this.flight.start;
    [this.slider.min, this.slider.max, this.slider.step] = [this.flight.start, this.flight.end, 0.1];
    for (const kind of ["guard", "guardLost"])
      this.part(kind).hidden = !this.flight.guard.some(([, , held]) => held === (kind === "guard"));
    this.part("ship").textContent = this.flight.hull.name;
    this.part("hull").textContent = this.flight.hull.words;
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
      before = now;
      if (this.time >= this.flight.end) this.play(false);
      else requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
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
    const guard = flight.guardAt(time);
    this.part("readout").textContent =
      `Distance ${now.distance.toFixed(1)} m · height ${now.altitude.toFixed(1)} m · heading ${heading}° · bank ${bank}°` +
      (guard ? ` · ${this.part(guard).textContent}` : "");
    this.plot.draw(time);
    if (!this.world) return;
    const options = {enlarged: this.enlarged, aboutVessel: this.mode === "vessel", focus: this.camera.track(flight, time)};
    this.world.show(time, options);
    this.part("needle").style.transform = `rotate(${-this.camera.course}rad)`;
    this.renderer.render(this.world.scene, this.camera.camera);
    // That of the flight before goes once the new one is drawn, which takes over its shaders: to compile them takes longest.
    this.gone?.dispose();
    this.gone = null;
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
