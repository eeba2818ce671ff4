// Sea, ship, plume, keep-out area and aircraft of one flight, each where it is at the time shown.

const SKY = "#f2f7fa", SEA = "#e3edf3", SPAN = 2.1, ENLARGED = 15, FAR = 5000, TRAIL = 0.1;

class World {
  constructor(flight, colours) {
    this.flight = flight;
    this.colours = colours;
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(SKY);
    this.scene.fog = new THREE.Fog(SKY, 0.3 * FAR, 0.9 * FAR);
    const sun = new THREE.DirectionalLight("#ffffff", 1.6);
    sun.position.set(-0.5, 1, 0.35);
    this.scene.add(new THREE.HemisphereLight("#ffffff", "#8fa5b4", 1.9), sun);
    this.sea = new THREE.Mesh(new THREE.PlaneGeometry(2 * FAR, 2 * FAR), new THREE.MeshBasicMaterial({color: SEA, depthWrite: false}));
    // Below everything, in whatever order things are drawn.
    this.sea.renderOrder = -2;
    this.sea.rotation.x = -Math.PI / 2;
    this.grid = seaGrid(3000);
    this.vessel = new THREE.Group();
    this.ship = shipShape(flight.hull, flight.keepout.height, colours.ship);
    this.plumes = flight.plumes.map(([, rows]) => plumeShape(rows, colours.plume));
    this.vessel.add(this.ship, ...this.plumes, keepoutShape(flight.keepout, colours.limit));
    this.aircraft = aircraftShape(colours.aircraft);
    this.aircraft.rotation.order = "YXZ";
    const ball = new THREE.SphereGeometry(1, 16, 12);
    this.reference = new THREE.Mesh(ball, new THREE.MeshLambertMaterial({color: colours.reference}));
    const faint = {color: "#33424e", transparent: true, opacity: 0.35};
    this.shadow = new THREE.Mesh(new THREE.CylinderGeometry(0.5, 0.5, 0.01, 24), new THREE.MeshBasicMaterial(faint));
    const plumb = new THREE.BufferGeometry();
    plumb.setAttribute("position", new THREE.BufferAttribute(new Float32Array([0, 0, 0, 0, 1, 0]), 3));
    this.plumb = new THREE.Line(plumb, new THREE.LineBasicMaterial(faint));
    // Over the ground, and as seen from the vessel, which takes it along.
    this.trails = {ground: this.tracks(""), vessel: this.tracks("relative_")};
    this.vessel.add(this.trails.vessel);
    this.scene.add(this.sea, this.grid, this.vessel, this.aircraft, this.reference, this.shadow, this.plumb, this.trails.ground);
    this.scale = ENLARGED;
  }

  // The whole path of aircraft and reference, a point every TRAIL seconds; of it what is flown is drawn.
  tracks(relative) {
    const {flight, colours} = this, group = new THREE.Group();
    const shade = Object.fromEntries(["flown", "guard", "guardLost"].map((name) => [name, new THREE.Color(colours[name])]));
    const flown = [], reference = [], shades = [];
    for (let time = flight.start; time <= flight.end + 1e-9; time += TRAIL) {
      const now = flight.at(time), {r, g, b} = shade[flight.guardAt(time) ?? "flown"];
      flown.push(now[`${relative}east`], now.altitude, -now[`${relative}north`]);
      reference.push(now[`${relative}reference_east`], now.altitude, -now[`${relative}reference_north`]);
      shades.push(r, g, b);
    }
    group.add(curve(reference, colours.reference, 1.2), curve(flown, colours.flown, 2.6, shades));
    return group;
  }

  // Put everything where it is at a time [s], and the sea about a point that the camera looks at.
  show(time, {enlarged, aboutVessel, focus}) {
    const now = this.flight.at(time);
    this.scale = enlarged ? ENLARGED : 1;
    this.aircraft.position.set(now.east, now.altitude, -now.north);
    this.aircraft.rotation.set(now.pitch, -now.heading, -now.roll);
    this.aircraft.scale.setScalar(SPAN * this.scale);
    this.reference.position.set(now.reference_east, now.altitude, -now.reference_north);
    this.reference.scale.setScalar(0.1 * SPAN * this.scale ** 0.7);
    this.shadow.position.set(now.east, 0.3, -now.north);
    this.shadow.scale.setScalar(0.6 * SPAN * this.scale);
    this.plumb.position.set(now.east, 0, -now.north);
    this.plumb.scale.y = now.altitude;
    this.vessel.position.set(now.vessel_east, 0, -now.vessel_north);
    this.ship.rotation.y = -now.vessel_heading;
    const shown = this.flight.plumeAt(time);
    this.plumes.forEach((plume, number) => {
      plume.visible = number === shown;
      plume.rotation.y = -now.plume_axis;
    });
    this.trails.vessel.visible = aboutVessel;
    this.trails.ground.visible = !aboutVessel;
    const segments = Math.floor((time - this.flight.start) / TRAIL + 1e-6);
    for (const trail of Object.values(this.trails))
      for (const line of trail.children) {
        line.geometry.instanceCount = segments;
        line.visible = segments > 0;
      }
    this.sea.position.set(focus.x, 0, focus.z);
    this.grid.position.set(500 * Math.round(focus.x / 500), 0, 500 * Math.round(focus.z / 500));
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
