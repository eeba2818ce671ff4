// Where a flight is seen from: behind the aircraft, beside the vessel, or from a place that stays.

const CAMERAS = ["follow", "vessel", "free"], LOOK_BACK = 2.5, HALVES = 14, EDGE = 0.85;

class Camera {
  constructor(canvas, onChange) {
    this.camera = new THREE.PerspectiveCamera(45, 1, 1, 2 * FAR);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = 0.49 * Math.PI;
    this.controls.maxDistance = 0.6 * FAR;
    this.controls.minDistance = 3;
    // A finger that moves up or down scrolls the page, across it turns the view.
    canvas.style.touchAction = "pan-y";
    // The wheel scrolls the page unless the picture was clicked or reached by the keyboard.
    this.controls.enableZoom = false;
    canvas.addEventListener("focus", () => { this.controls.enableZoom = true; });
    canvas.addEventListener("blur", () => { this.controls.enableZoom = false; });
    this.controls.addEventListener("change", onChange);
    this.mode = "follow";
    this.turn = 0;
    // Of a view that was turned by hand nothing but its place is changed.
    this.turned = false;
    this.controls.addEventListener("start", () => { this.turned = true; });
  }

  // Begin a way of looking at a flight from where it is told best; a free camera begins with what is seen.
  begin(mode, flight, time, enlarged) {
    if (mode === "free") this.track(flight, time);
    this.mode = mode;
    this.turn = 0;
    this.turned = false;
    const {target} = this.controls, offset = new THREE.Vector3();
    if (mode === "follow") {
      target.copy(this.focus(flight, time));
      offset.set(0, 0.3, 1).multiplyScalar(enlarged ? 70 : 11);
      offset.applyAxisAngle(UP, -this.direction(flight, time));
      this.turn = this.direction(flight, time);
    } else if (mode === "vessel") {
      // Beside the plume and high, so that plume and vessel are both in the picture, also where that is narrow.
      const far = flight.keepout.radius * (this.camera.aspect < 1.1 ? 4.0 : 2.9);
      target.copy(this.focus(flight, time));
      offset.set(-0.72, 0.55, -0.42).multiplyScalar(far).applyAxisAngle(UP, -flight.value("plume_axis", time));
      this.beside = offset.clone();
    }
    if (mode !== "free") this.camera.position.copy(target).add(offset);
    if (mode === "vessel") this.fit(flight, time);
    this.controls.update();
  }

  // Look from beside the vessel, from farther off while the aircraft would be out of the picture; until someone turns the view.
  fit(flight, time) {
    const {target, maxDistance} = this.controls, now = flight.at(time), place = new THREE.Vector3();
    const sees = (factor) => {
      this.camera.position.copy(target).addScaledVector(this.beside, factor);
      this.camera.lookAt(target);
      this.camera.updateMatrixWorld();
      place.set(now.east, now.altitude, -now.north).project(this.camera);
      return Math.max(Math.abs(place.x), Math.abs(place.y)) < EDGE && place.z < 1;
    };
    let near = 1, far = Math.max(1, maxDistance / this.beside.length());
    if (sees(near)) return;
    for (let half = 0; half < HALVES; half++) {
      const middle = 0.5 * (near + far);
      if (sees(middle)) far = middle;
      else near = middle;
    }
    sees(far);
  }

  // Take the camera along to a time [s], by how what it looks at moves and turns.
  track(flight, time) {
    if (this.mode !== "free") {
      const focus = this.focus(flight, time), offset = this.camera.position.clone().sub(this.controls.target);
      if (this.mode === "follow") {
        const direction = this.direction(flight, time);
        offset.applyAxisAngle(UP, this.turn - direction);
        this.turn = direction;
      }
      this.controls.target.copy(focus);
      this.camera.position.copy(focus).add(offset);
      if (this.mode === "vessel" && !this.turned) this.fit(flight, time);
    }
    this.controls.update();
    return this.controls.target;
  }

  focus(flight, time) {
    const now = flight.at(time);
    if (this.mode === "follow") return new THREE.Vector3(now.east, now.altitude, -now.north);
    const along = 0.55 * flight.keepout.radius;
    const [north, east] = [along * Math.cos(now.plume_axis), along * Math.sin(now.plume_axis)];
    return new THREE.Vector3(now.vessel_east + east, 0.3 * flight.keepout.radius, -now.vessel_north - north);
  }

  // The course that the camera follows: that of the last seconds, so that it does not swing with every turn.
  direction(flight, time) {
    const [before, after] = [flight.at(Math.max(flight.start, time - LOOK_BACK)), flight.at(Math.min(flight.end, time + 0.5))];
    return Math.atan2(after.east - before.east, after.north - before.north);
  }

  // Turn about what is looked at, rise, or come nearer; from the keyboard.
  move(turn, rise, nearer) {
    this.turned = true;
    const {target, maxPolarAngle, minDistance, maxDistance} = this.controls, offset = this.camera.position.clone().sub(target);
    const distance = Math.min(Math.max(offset.length() * nearer, minDistance), maxDistance), course = Math.atan2(offset.x, offset.z) + turn;
    const polar = Math.min(Math.max(Math.acos(offset.y / offset.length()) - rise, 0.05), maxPolarAngle);
    offset.set(Math.sin(polar) * Math.sin(course), Math.cos(polar), Math.sin(polar) * Math.cos(course)).multiplyScalar(distance);
    this.camera.position.copy(target).add(offset);
    this.controls.update();
  }

  // The course that is up the picture [rad].
  get course() {
    const {x, z} = this.camera.position.clone().sub(this.controls.target);
    return Math.atan2(-x, z);
  }
}
