// Sea, sky and smoke: what is drawn point by point.

const DEEP = "#2f6f8f", HORIZON = "#dcebf3", ZENITH = "#7fb2d9", FOAM = "#ffffff";
const SUN = new THREE.Vector3(-0.55, 0.5, 0.45).normalize();

// Powers are products: a processor that draws what a graphics processor would takes long for others.
const SKY_LIGHT = `
  uniform vec3 sun, horizon, zenith;
  vec3 clear(float up) {
    float low = 1.0 - clamp(up, 0.0, 1.0);
    return mix(zenith, horizon, low * low);
  }
  vec3 sky(vec3 ray) {
    float toSun = max(dot(ray, sun), 0.0), halo = toSun * toSun * toSun;
    return clear(ray.y) + vec3(1.0, 0.93, 0.78) * (0.22 * halo * halo * halo * halo + 0.9 * smoothstep(0.9988, 0.9994, toSun));
  }`;

function skyLight() {
  return {sun: {value: SUN}, horizon: {value: new THREE.Color(HORIZON)}, zenith: {value: new THREE.Color(ZENITH)}};
}

// A sphere about the camera: the sky, with the sun.
function skyShape(radius) {
  const material = new THREE.ShaderMaterial({
    uniforms: skyLight(), side: THREE.BackSide, depthWrite: false,
    vertexShader: "varying vec3 ray; void main() { ray = position; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
    fragmentShader: `varying vec3 ray; ${SKY_LIGHT} void main() { gl_FragColor = vec4(sky(normalize(ray)), 1.0);
#include <colorspace_fragment>
}`,
  });
  const sky = new THREE.Mesh(new THREE.SphereGeometry(radius, 32, 20), material);
  sky.renderOrder = -3;
  sky.frustumCulled = false;
  return sky;
}

// The sea: it reflects the sky, glitters below the sun, and has a line every 100 m, a stronger one every 500 m.
function seaShape(size) {
  const material = new THREE.ShaderMaterial({
    uniforms: {...skyLight(), deep: {value: new THREE.Color(DEEP)}, time: {value: 0}, far: {value: size}},
    depthWrite: false,
    vertexShader: `varying vec3 place;
      void main() { vec4 world = modelMatrix * vec4(position, 1.0); place = world.xyz; gl_Position = projectionMatrix * viewMatrix * world; }`,
    fragmentShader: `varying vec3 place; uniform vec3 deep; uniform float time, far;
      ${SKY_LIGHT}
      float lines(float step) {
        vec2 at = place.xz / step, wide = fwidth(at), off = abs(fract(at - 0.5) - 0.5) / max(wide, 1e-6);
        return (1.0 - smoothstep(0.4, 1.4, min(off.x, off.y))) * (1.0 - smoothstep(0.08, 0.5, max(wide.x, wide.y)));
      }
      void main() {
        vec3 ray = place - cameraPosition;
        float away = length(ray);
        ray /= away;
        vec2 p = place.xz;
        // Three waves of 9 to 47 m; they calm down where they would flicker.
        vec2 slope = 0.06 * cos(dot(p, vec2(0.13, 0.03)) - 1.1 * time) * vec2(0.97, 0.22)
                   + 0.055 * cos(dot(p, vec2(0.17, 0.26)) - 1.7 * time) * vec2(0.55, 0.83)
                   + 0.05 * cos(dot(p, vec2(-0.21, 0.66)) - 2.6 * time) * vec2(-0.3, 0.95);
        slope /= 1.0 + away / 900.0;
        vec3 normal = normalize(vec3(-slope.x, 1.0, -slope.y)), back = reflect(ray, normal);
        float grazing = 1.0 - max(dot(-ray, normal), 0.0), glint = max(dot(back, sun), 0.0);
        grazing *= grazing;
        glint *= glint, glint *= glint, glint *= glint, glint *= glint, glint *= glint, glint *= glint;
        vec3 water = mix(deep * (0.82 + 0.5 * normal.x + 0.3 * normal.z), clear(abs(back.y)), 0.03 + 0.75 * grazing * grazing);
        water += vec3(1.0, 0.95, 0.82) * 0.5 * glint;
        water = mix(water, vec3(1.0), 0.07 * lines(100.0) + 0.1 * lines(500.0));
        gl_FragColor = vec4(mix(water, horizon, smoothstep(0.12 * far, 0.8 * far, away)), 1.0);
#include <colorspace_fragment>

      }`,
  });
  const sea = new THREE.Mesh(new THREE.PlaneGeometry(2 * size, 2 * size), material);
  sea.rotation.x = -Math.PI / 2;
  sea.renderOrder = -2;
  return sea;
}

// The wake: a strip of foam along the way that the vessel has come.
class Wake {
  static POINTS = 48;

  constructor({length, beam}) {
    this.reach = 5 * length;
    this.beam = beam;
    const n = Wake.POINTS, places = new Float32Array(6 * n), across = new Float32Array(4 * n), triangles = [];
    for (let i = 0; i < n; i++) {
      across.set([i / (n - 1), -1, i / (n - 1), 1], 4 * i);
      if (i) triangles.push(2 * i - 2, 2 * i - 1, 2 * i, 2 * i, 2 * i - 1, 2 * i + 1);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
    geometry.setAttribute("share", new THREE.BufferAttribute(across, 2));
    geometry.setIndex(triangles);
    const material = new THREE.ShaderMaterial({
      transparent: true, depthWrite: false, side: THREE.DoubleSide, uniforms: {foam: {value: new THREE.Color(FOAM)}},
      vertexShader: `attribute vec2 share; varying vec2 at; varying vec2 p;
        void main() { at = share; p = position.xz; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
      fragmentShader: `uniform vec3 foam; varying vec2 at; varying vec2 p;
        void main() {
          float side = abs(at.y), churn = 0.75 + 0.25 * sin(0.9 * p.x + 0.4 * p.y) * sin(0.7 * p.y - 0.3 * p.x);
          float arms = smoothstep(0.55, 0.85, side) * (1.0 - smoothstep(0.85, 1.0, side)), middle = 1.0 - smoothstep(0.1, 0.45, side);
          gl_FragColor = vec4(foam, pow(1.0 - at.x, 1.5) * churn * (0.6 * middle + 0.5 * arms * (1.0 - at.x)));
#include <colorspace_fragment>

        }`,
    });
    this.mesh = new THREE.Mesh(geometry, material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = -1;
  }

  // Lay it behind where the vessel is at a time [s].
  lay(flight, time, now) {
    const speed = Math.hypot(flight.rate("vessel_north", time), flight.rate("vessel_east", time));
    this.mesh.visible = speed > 0.5;
    if (!this.mesh.visible) return;
    const n = Wake.POINTS, places = this.mesh.geometry.attributes.position, span = this.reach / speed;
    let before = null;
    for (let i = 0; i < n; i++) {
      const share = i / (n - 1), back = time - span * share, [north, east] = flight.vesselAt(back);
      const [dn, de] = before ? [before[0] - north, before[1] - east] : [Math.cos(now.vessel_heading), Math.sin(now.vessel_heading)];
      const size = Math.hypot(dn, de) || 1, half = this.beam * (0.45 + 2.2 * share);
      before = [north, east];
      places.setXYZ(2 * i, east - (half * dn) / size, 0.15, -(north + (half * de) / size));
      places.setXYZ(2 * i + 1, east + (half * dn) / size, 0.15, -(north - (half * de) / size));
    }
    places.needsUpdate = true;
  }
}

// Smoke as many soft discs. Each parcel that the stack has emitted is some of them, within its own spreads: the same ones
// all the time, so that smoke drifts and does not flicker.
class SmokeShape {
  static DISCS = 3;

  constructor(smoke, colour) {
    this.smoke = smoke;
    const most = SmokeShape.DISCS * smoke.shown;
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]), 3));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    this.centres = new THREE.InstancedBufferAttribute(new Float32Array(3 * most), 3);
    this.sizes = new THREE.InstancedBufferAttribute(new Float32Array(2 * most), 2);
    geometry.setAttribute("centre", this.centres);
    geometry.setAttribute("size", this.sizes);
    const material = new THREE.ShaderMaterial({
      transparent: true, depthWrite: false, uniforms: {colour: {value: new THREE.Color(colour)}},
      vertexShader: `attribute vec3 centre; attribute vec2 size; varying vec2 at; varying float strength;
        void main() {
          at = position.xy;
          strength = size.y;
          vec4 eye = modelViewMatrix * vec4(centre, 1.0);
          // What is next to the camera would cover the picture, and is left out.
          strength *= smoothstep(15.0, 70.0, -eye.z);
          eye.xy += step(0.004, strength) * 2.4 * size.x * position.xy;
          gl_Position = projectionMatrix * eye;
        }`,
      fragmentShader: `uniform vec3 colour; varying vec2 at; varying float strength;
        void main() {
          // Nearly a Gaussian, and nothing at the edge.
          float left = max(0.0, 1.0 - dot(at, at));
          gl_FragColor = vec4(colour * vec3(1.75, 1.95, 2.15) * (1.0 + 0.3 * at.y), strength * left * left * left);
#include <colorspace_fragment>

        }`,
    });
    this.mesh = new THREE.Mesh(geometry, material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 2;
    // Places of the discs within a parcel, in its spreads: Gaussian, from a generator of its own.
    let state = 12345;
    const uniform = () => (state = (1103515245 * state + 12345) % 2147483648) / 2147483648;
    this.within = Array.from({length: 3 * 997}, () => Math.sqrt(-2 * Math.log(uniform() + 1e-9)) * Math.cos(2 * Math.PI * uniform()));
  }

  // Put the discs where the parcels are at a time [s].
  show(time) {
    let count = 0;
    const {centres, sizes, within} = this;
    this.smoke.each(time, (number, parcel) => {
      // Where parcels are much wider than their distance, every second one has the strength of two.
      const wide = Math.min(1, Math.max(0, parcel.sigmaY / parcel.spacing - 2)), strength = parcel.strength * (number % 2 ? 1 - wide : 1 + wide);
      if (strength < 0.004) return;
      for (let k = 0; k < SmokeShape.DISCS && count < sizes.count; k++, count++) {
        const place = (3 * (number * SmokeShape.DISCS + k)) % (within.length - 3), spread = 0.65;
        const across = spread * within[place] * parcel.sigmaY, along = within[place + 1] * parcel.spacing;
        const up = parcel.height + spread * within[place + 2] * parcel.sigmaZ;
        centres.setXYZ(
          count,
          parcel.east + across * parcel.acrossEast + along * parcel.alongEast,
          Math.abs(up),
          -(parcel.north + across * parcel.acrossNorth + along * parcel.alongNorth),
        );
        sizes.setXY(count, 0.85 * Math.sqrt(parcel.sigmaY * parcel.sigmaZ), strength);
      }
    });
    centres.needsUpdate = sizes.needsUpdate = true;
    this.mesh.geometry.instanceCount = count;
    this.mesh.visible = count > 0;
  }
}
