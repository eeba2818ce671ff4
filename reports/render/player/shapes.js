// What is drawn in three dimensions. East is x, up is y, south is z; everything points north before it is turned.

const PALE = 0.3;

function polyhedron(corners, faces, colours) {
  const places = [], shades = [];
  faces.forEach((face, number) => {
    const colour = new THREE.Color(colours[number % colours.length]);
    for (let i = 1; i + 1 < face.length; i++)
      for (const corner of [face[0], face[i], face[i + 1]]) {
        places.push(...corners[corner]);
        shades.push(colour.r, colour.g, colour.b);
      }
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(shades), 3));
  geometry.computeVertexNormals();
  return new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({vertexColors: true, flatShading: true, side: THREE.DoubleSide}));
}

// A flying wing of a span of 1: the upper side in its colour, the lower side dark, so that its bank can be seen.
function aircraftShape(colour) {
  const dark = "#12324a", light = "#d7e6f1", group = new THREE.Group();
  for (const side of [-1, 1]) {
    const corners = [
      [0, 0, -0.2], [0, 0.035, 0.0], [0, 0, 0.14], [0, -0.02, 0.0],
      [0.5 * side, 0.01, 0.14], [0.5 * side, 0.016, 0.18], [0.5 * side, 0.01, 0.22], [0.5 * side, 0.004, 0.18],
      [0.5 * side, 0.11, 0.2], [0.5 * side, 0.11, 0.245],
    ];
    group.add(polyhedron(corners, [[0, 4, 5, 1], [1, 5, 6, 2], [0, 4, 7, 3], [3, 7, 6, 2], [4, 8, 9, 6]], [colour, colour, dark, dark, colour]));
  }
  const body = new THREE.Mesh(new THREE.SphereGeometry(1, 20, 14), new THREE.MeshLambertMaterial({color: light}));
  body.scale.set(0.05, 0.04, 0.2);
  body.position.z = -0.04;
  const propeller = new THREE.Mesh(
    new THREE.CylinderGeometry(0.1, 0.1, 0.004, 24),
    new THREE.MeshBasicMaterial({color: dark, transparent: true, opacity: 0.35, depthWrite: false}),
  );
  propeller.rotation.x = Math.PI / 2;
  propeller.position.z = 0.18;
  group.add(body, propeller);
  return group;
}

function block(width, height, length, x, y, z, colour) {
  const [a, b, c] = [width / 2, height, length / 2];
  const corners = [[-a, 0, -c], [a, 0, -c], [a, 0, c], [-a, 0, c], [-a, b, -c], [a, b, -c], [a, b, c], [-a, b, c]];
  const mesh = polyhedron(corners, [[4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]], [colour]);
  mesh.position.set(x, y, z);
  return mesh;
}

// A ship about her funnel, of whose mouth the height above the sea is given, and the share of her length that is aft of it.
// One whose size is not known is pale.
function shipShape({length, beam, funnel: share, known}, height, colour) {
  const group = new THREE.Group(), aft = share * length, fore = aft - length, half = beam / 2, deck = 0.22 * height;
  const outline = [[0, fore], [0.3, fore + 0.06 * length], [0.5, fore + 0.2 * length], [0.5, aft - 0.04 * length], [0.4, aft]];
  const round = [...outline, ...outline.slice(1).reverse().map(([x, z]) => [-x, z])];
  const corners = [...round.map(([x, z]) => [1.7 * x * half, 0, 0.97 * z]), ...round.map(([x, z]) => [2 * x * half, deck, z])];
  const n = round.length, sides = round.map((_, i) => [i, (i + 1) % n, n + ((i + 1) % n), n + i]);
  group.add(polyhedron(corners, sides, [colour]));
  group.add(polyhedron(corners.slice(n), [round.map((_, i) => i)], ["#9aa3ab"]));
  group.add(block(0.84 * beam, 0.5 * height, 0.09 * length, 0, deck, -0.07 * length, "#f4f6f8"));
  group.add(block(0.94 * beam, 0.05 * height, 0.05 * length, 0, deck + 0.5 * height, -0.085 * length, "#dfe5ea"));
  for (let z = -0.24; z - 0.06 > share - 0.85; z -= 0.15) group.add(block(0.8 * beam, 0.14 * height, 0.12 * length, 0, deck, z * length, "#b9c1c9"));
  const funnel = new THREE.Mesh(
    new THREE.CylinderGeometry(0.11 * beam, 0.15 * beam, height - deck, 20), new THREE.MeshLambertMaterial({color: colour}),
  );
  funnel.position.y = (height + deck) / 2;
  group.add(funnel);
  if (!known) group.traverse((part) => part.material && Object.assign(part.material, {transparent: true, opacity: PALE}));
  return group;
}

// A plume as a tube that thins out: rows of distance from the funnel, height of the axis, half-width and half-height.
function plumeShape(rows, colour) {
  const around = 20, places = [], shades = [], triangles = [], {r, g, b} = new THREE.Color(colour);
  rows.forEach(([distance, height, halfWidth, halfHeight], row) => {
    for (let k = 0; k < around; k++) {
      const angle = (2 * Math.PI * k) / around;
      places.push(halfWidth * Math.cos(angle), Math.max(0.5, height + halfHeight * Math.sin(angle)), -distance);
      shades.push(r, g, b, 0.32 - (0.26 * row) / (rows.length - 1));
      if (row) {
        const here = row * around + k, next = row * around + ((k + 1) % around);
        triangles.push(here, next, here - around, next, next - around, here - around);
      }
    }
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(shades), 4));
  geometry.setIndex(triangles);
  const look = {vertexColors: true, transparent: true, depthWrite: false, side: THREE.DoubleSide};
  return new THREE.Mesh(geometry, new THREE.MeshBasicMaterial(look));
}

function curve(points, colour, width, shades = null) {
  const geometry = new THREE.LineGeometry();
  geometry.setPositions(points);
  if (shades) geometry.setColors(shades);
  const line = new THREE.Line2(geometry, new THREE.LineMaterial({color: shades ? 0xffffff : colour, linewidth: width, vertexColors: !!shades}));
  // What is drawn of it grows; its bounds are not worth the computing.
  line.frustumCulled = false;
  return line;
}

function ring(radius, height, colour, width) {
  const points = [];
  for (let k = 0; k <= 120; k++) points.push(radius * Math.sin((Math.PI * k) / 60), height, radius * Math.cos((Math.PI * k) / 60));
  return curve(points, colour, width);
}

// The keep-out area, with where it is widest and where it meets the sea.
function keepoutShape({radius, shape, height}, colour) {
  const group = new THREE.Group(), look = {color: colour, transparent: true, opacity: 0.1, depthWrite: false, side: THREE.DoubleSide};
  if (shape === "cylinder") {
    const top = 2.5 * height, wall = new THREE.CylinderGeometry(radius, radius, top, 72, 1, true);
    wall.translate(0, top / 2, 0);
    group.add(new THREE.Mesh(wall, new THREE.MeshBasicMaterial(look)), ring(radius, top, colour, 1.5), ring(radius, 0.4, colour, 2.5));
    return group;
  }
  // What would be below the sea is left out.
  const ball = new THREE.SphereGeometry(radius, 60, 40, 0, 2 * Math.PI, 0, Math.acos(-Math.min(1, height / radius)));
  ball.translate(0, height, 0);
  group.add(new THREE.Mesh(ball, new THREE.MeshBasicMaterial(look)), ring(radius, height, colour, 2.5));
  if (radius > height) group.add(ring(Math.sqrt(radius ** 2 - height ** 2), 0.4, colour, 1.5));
  return group;
}

// Lines on the sea every 100 m, every fifth one darker.
function seaGrid(size) {
  const group = new THREE.Group();
  for (const [step, colour] of [[100, "#c9d8e2"], [500, "#a9bfce"]]) {
    const points = [];
    // In pieces: some renderers leave out a line of which an end is far behind the camera.
    for (let at = -size; at <= size; at += step)
      for (let from = -size; from < size; from += 250) points.push(at, 0, from, at, 0, from + 250, from, 0, at, from + 250, 0, at);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
    group.add(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({color: colour, depthWrite: false})));
  }
  group.children.forEach((lines) => { lines.renderOrder = -1; });
  return group;
}
