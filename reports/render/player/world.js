// Sea, ship, smoke, keep-out area and aircraft of one flight, each where it is at the time shown.

const SPAN = 2.1, ENLARGED = 5, FAR = 5000, TRAIL = 0.1, CROSSINGS_SHOWN = 6, TRAIL_LEAST = 45;

// Of Cividis, from the least to the largest value.
const SCALE = ["#00224e", "#35456c", "#666970", "#948e77", "#c8b866", "#fee838"].map((shade) => new THREE.Color(shade));

function scaled(share) {
  const at = Math.min(Math.max(share, 0), 1) * (SCALE.length - 1), i = Math.min(Math.floor(at), SCALE.length - 2);
  return SCALE[i].clone().lerp(SCALE[i + 1], at - i);
}

class World {
  constructor(flight, colours) {
    this.flight = flight;
    this.colours = colours;
    this.scene = new THREE.Scene();
    const sun = new THREE.DirectionalLight("#fff4dd", 2.2);
    sun.position.copy(SUN);
    this.sky = skyShape(1.6 * FAR);
    this.sea = seaShape(FAR);
    this.wake = new Wake(flight.hull);
    this.vessel = new THREE.Group();
    this.ship = shipShape(flight.hull, flight.keepout.height, colours.ship);
    this.vessel.add(this.ship);
    // About a hull it turns with the ship.
    (flight.keepout.sides ? this.ship : this.vessel).add(keepoutShape(flight.keepout, colours.limit));
    this.others = flight.others.map((other) => {
      const group = new THREE.Group(), ship = shipShape(other.hull, flight.keepout.height, colours.ship);
      group.add(ship, keepoutShape({radius: other.radius, shape: "cylinder", height: flight.keepout.height}, colours.limit));
      this.scene.add(group);
      return {other, group, ship};
    });
    this.smoke = new SmokeShape(flight.smoke, colours.plume);
    this.aircraft = aircraftShape(colours.aircraft);
    this.aircraft.rotation.order = "YXZ";
    const ball = new THREE.SphereGeometry(1, 16, 12);
    this.reference = new THREE.Mesh(ball, new THREE.MeshLambertMaterial({color: colours.reference}));
    const faint = {color: "#16242e", transparent: true, opacity: 0.4, depthWrite: false};
    this.shadow = new THREE.Mesh(new THREE.CylinderGeometry(0.5, 0.5, 0.01, 24), new THREE.MeshBasicMaterial(faint));
    this.plumb = curve([0, 0, 0, 0, 1, 0], {colour: faint.color, width: 1});
    // Over the ground, and as seen from the vessel, which takes it along.
    this.trails = {ground: this.tracks(""), vessel: this.tracks("relative_")};
    this.vessel.add(this.trails.vessel);
    this.scene.add(
      new THREE.HemisphereLight("#ffffff", "#7f9aac", 1.5), sun, this.sky, this.sea, this.wake.mesh, this.vessel, this.smoke.mesh,
      this.aircraft, this.reference, this.shadow, this.plumb, this.trails.ground,
    );
    this.scale = ENLARGED;
    // How long a trail stays: for some crossings.
    const {crossings} = flight, span = crossings.length > 1 ? (crossings.at(-1) - crossings[0]) / (crossings.length - 1) : 0;
    this.fade = Math.max(TRAIL_LEAST, CROSSINGS_SHOWN * span);
  }

  // The whole path of aircraft and reference, a point every TRAIL seconds, in the colour of the gas that was read or simulated
  // there; where there is none, in that of the flight. What the guard flew has the guard's.
  tracks(relative) {
    const {flight, colours} = this, group = new THREE.Group(), {gas} = flight;
    const shade = Object.fromEntries(["flown", "guard", "guardLost"].map((name) => [name, new THREE.Color(colours[name])]));
    const flown = [], reference = [], shades = [], times = [];
    for (let time = flight.start; time <= flight.end + 1e-9; time += TRAIL) {
      const now = flight.at(time), guard = flight.guardAt(time);
      const {r, g, b} = guard ? shade[guard] : gas ? scaled(now.gas / gas.most) : shade.flown;
      flown.push(now[`${relative}east`], now.altitude, -now[`${relative}north`]);
      reference.push(now[`${relative}reference_east`], now.altitude, -now[`${relative}reference_north`]);
      shades.push(r, g, b);
      times.push(time);
    }
    if (times.length < 2) return group;
    group.add(curve(reference, {colour: colours.reference, width: 1.2, times}), curve(flown, {colour: colours.flown, width: 3.4, shades, times}));
    return group;
  }

  // Put everything where it is at a time [s], and the sea about a point that the camera looks at.
  show(time, {enlarged, aboutVessel, focus, eye}) {
    const now = this.flight.at(time);
    this.scale = enlarged ? ENLARGED : 1;
    this.aircraft.position.set(now.east, now.altitude, -now.north);
    this.aircraft.rotation.set(now.pitch, -now.heading, -now.roll);
    this.aircraft.scale.setScalar(SPAN * this.scale);
    this.reference.position.set(now.reference_east, now.altitude, -now.reference_north);
    this.reference.scale.setScalar(0.12 * SPAN * this.scale ** 0.7);
    this.shadow.position.set(now.east, 0.3, -now.north);
    this.shadow.scale.setScalar(0.6 * SPAN * this.scale);
    this.plumb.position.set(now.east, 0, -now.north);
    this.plumb.scale.y = now.altitude;
    this.vessel.position.set(now.vessel_east, 0, -now.vessel_north);
    this.ship.rotation.y = -now.vessel_heading;
    for (const {other, group, ship} of this.others) {
      const place = this.flight.otherAt(other, time);
      group.visible = place !== null;
      if (place === null) continue;
      group.position.set(place.east, 0, -place.north);
      ship.rotation.y = -place.heading;
    }
    this.smoke.show(time);
    this.wake.lay(this.flight, time, now);
    this.trails.vessel.visible = aboutVessel;
    this.trails.ground.visible = !aboutVessel;
    const points = Math.floor((time - this.flight.start) / TRAIL + 1e-6) + 1;
    const from = Math.max(0, Math.floor(points - this.fade / TRAIL));
    for (const trail of Object.values(this.trails))
      for (const line of trail.children) {
        line.material.uniforms.now.value = time;
        line.material.uniforms.fade.value = this.fade;
        line.geometry.setDrawRange(6 * from, Math.max(0, 6 * (points - 1 - from)));
      }
    this.sea.position.set(focus.x, 0, focus.z);
    this.sea.material.uniforms.time.value = time;
    this.sky.position.copy(eye);
    return now;
  }

  // Where the aircraft is drawn, read from what is drawn: metres north, east and up, angles in radians, nose up and right wing down.
  place() {
    this.scene.updateMatrixWorld();
    const m = this.aircraft.matrixWorld.elements, size = Math.hypot(m[8], m[9], m[10]);
    const [right, tail] = [[m[0], m[1], m[2]], [m[8], m[9], m[10]]].map((axis) => axis.map((part) => part / size));
    const pitch = Math.asin(-tail[1]);
    const up = m[5] / size / Math.cos(pitch);
    return {north: -m[14], east: m[12], altitude: m[13], heading: Math.atan2(-tail[0], tail[2]), pitch, roll: Math.atan2(-right[1] / Math.cos(pitch), up)};
  }

  dispose() {
    this.scene.traverse((part) => {
      part.geometry?.dispose();
      part.material?.dispose();
    });
  }
}
