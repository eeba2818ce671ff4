// What the replay uses of three.js: esbuild leaves out the rest.
export {
  BufferAttribute, BufferGeometry, Color, CylinderGeometry, DirectionalLight, DoubleSide, Fog, Group, HemisphereLight, Line,
  LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, PlaneGeometry, Scene,
  SphereGeometry, Vector3, WebGLRenderer,
} from "three";
export {OrbitControls} from "three/examples/jsm/controls/OrbitControls.js";
export {Line2} from "three/examples/jsm/lines/Line2.js";
export {LineGeometry} from "three/examples/jsm/lines/LineGeometry.js";
export {LineMaterial} from "three/examples/jsm/lines/LineMaterial.js";
