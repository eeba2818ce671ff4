// What is drawn in three dimensions. East is x, up is y, south is z; everything points north before it is turned.

const PALE = 0.5;

// Height of a pixel at a distance of 1, shared by all lines.
const PIXEL = {value: 0.001};

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

// A ship about its funnel, of whose mouth the height above the sea is given, and the share of its length that is aft of it.
// One whose size is not known is pale.
function shipShape({length, beam, funnel: share, aside, known}, height, colour) {
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
  for (const part of group.children) part.position.x += aside;
  const funnel = new THREE.Mesh(
    new THREE.CylinderGeometry(0.11 * beam, 0.15 * beam, height - deck, 20), new THREE.MeshLambertMaterial({color: colour}),
  );
  funnel.position.y = (height + deck) / 2;
  group.add(funnel);
  if (!known) group.traverse((part) => part.material && Object.assign(part.material, {transparent: true, opacity: PALE}));
  return group;
}

// A line as wide on the picture everywhere [px]: a ribbon that faces the camera. Points are x, y, z one after the other;
// shades a colour for each. With times [s] it is drawn from where it fades until a time; see World.show.
function curve(points, {colour, width, shades = null, times = null}) {
  const n = points.length / 3, places = new Float32Array(6 * n), nexts = new Float32Array(6 * n), sides = new Float32Array(2 * n);
  const colours = new Float32Array(6 * n), stamps = new Float32Array(2 * n), triangles = new Uint32Array(6 * (n - 1));
  const one = new THREE.Color(colour);
  for (let i = 0; i < n; i++) {
    const here = points.slice(3 * i, 3 * i + 3), [from, to] = i + 1 < n ? [i, i + 1] : [i - 1, i];
    const ahead = here.map((value, k) => value + points[3 * to + k] - points[3 * from + k]);
    const shade = shades ? shades.slice(3 * i, 3 * i + 3) : [one.r, one.g, one.b];
    for (const side of [0, 1]) {
      places.set(here, 6 * i + 3 * side);
      nexts.set(ahead, 6 * i + 3 * side);
      colours.set(shade, 6 * i + 3 * side);
      sides[2 * i + side] = 2 * side - 1;
      stamps[2 * i + side] = times ? times[i] : 0;
    }
    if (i + 1 < n) triangles.set([2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 2, 2 * i + 1, 2 * i + 3], 6 * i);
  }
  const geometry = new THREE.BufferGeometry();
  for (const [name, values, size] of [["position", places, 3], ["next", nexts, 3], ["shade", colours, 3], ["side", sides, 1], ["stamp", stamps, 1]])
    geometry.setAttribute(name, new THREE.BufferAttribute(values, size));
  geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
  const material = new THREE.ShaderMaterial({
    transparent: true, depthWrite: false, side: THREE.DoubleSide,
    uniforms: {halfWide: {value: 0.5 * width}, pixel: PIXEL, now: {value: 0}, fade: {value: 1e9}},
    // In front of the camera and behind it alike: where a line passes it, what is behind is cut off as of any surface.
    vertexShader: `attribute vec3 next, shade; attribute float side, stamp; uniform float halfWide, pixel; varying vec3 tint; varying float at;
      void main() {
        vec4 here = modelViewMatrix * vec4(position, 1.0), there = modelViewMatrix * vec4(next, 1.0);
        vec3 across = cross(there.xyz - here.xyz, here.xyz);
        here.xyz += side * halfWide * pixel * abs(here.z) * across / max(length(across), 1e-9);
        tint = shade;
        at = stamp;
        gl_Position = projectionMatrix * here;
      }`,
    fragmentShader: `uniform float now, fade; varying vec3 tint; varying float at;
      void main() {
        float age = (now - at) / fade;
        if (age > 1.0) discard;
        gl_FragColor = vec4(tint, 1.0 - age * age);
#include <colorspace_fragment>

      }`,
  });
  const line = new THREE.Mesh(geometry, material);
  // What is drawn of it grows; its bounds are not worth the computing.
  line.frustumCulled = false;
  line.renderOrder = 1;
  return line;
}

function ring(radius, height, colour, width) {
  const points = [];
  for (let k = 0; k <= 120; k++) points.push(radius * Math.sin((Math.PI * k) / 60), height, radius * Math.cos((Math.PI * k) / 60));
  return curve(points, {colour, width});
}

// All that is within a radius of a hull, whose sides are bow, stern, port and starboard from the funnel: a wall up to a height.
function hullKeepoutShape(radius, [bow, stern, port, starboard], top, colour) {
  const group = new THREE.Group(), corners = [[-port, -bow], [starboard, -bow], [starboard, stern], [-port, stern]];
  const edge = [];
  for (let k = 0; k <= 120; k++) {
    const x = Math.sin((Math.PI * k) / 60), z = Math.cos((Math.PI * k) / 60);
    const [right, aft] = corners.reduce((far, corner) => (corner[0] * x + corner[1] * z > far[0] * x + far[1] * z ? corner : far));
    edge.push([right + radius * x, aft + radius * z]);
  }
  edge.push(edge[0]);
  const places = [], triangles = [];
  edge.forEach(([x, z], k) => {
    places.push(x, 0, z, x, top, z);
    if (k) triangles.push(2 * k - 2, 2 * k - 1, 2 * k, 2 * k, 2 * k - 1, 2 * k + 1);
  });
  const wall = new THREE.BufferGeometry();
  wall.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
  wall.setIndex(triangles);
  const look = {color: colour, transparent: true, opacity: 0.07, depthWrite: false, side: THREE.DoubleSide};
  const line = (height, width) => curve(edge.flatMap(([x, z]) => [x, height, z]), {colour, width});
  group.add(new THREE.Mesh(wall, new THREE.MeshBasicMaterial(look)), line(top, 2.5), line(0.4, 1.5));
  return group;
}

// The keep-out area, with where it is widest and where it meets the sea.
function keepoutShape({radius, shape, height, sides}, colour) {
  if (sides) return hullKeepoutShape(radius, sides, shape === "hull prism" ? 2.5 * height : height, colour);
  const group = new THREE.Group(), look = {color: colour, transparent: true, opacity: 0.07, depthWrite: false, side: THREE.DoubleSide};
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
