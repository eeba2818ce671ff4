// What the replay uses of three.js: esbuild leaves out the rest.
export {
  AdditiveBlending, BackSide, BufferAttribute, BufferGeometry, Color, CylinderGeometry, DirectionalLight, DoubleSide, Group,
  HemisphereLight, InstancedBufferAttribute, InstancedBufferGeometry, Mesh, MeshBasicMaterial, MeshLambertMaterial,
  NormalBlending, PerspectiveCamera, PlaneGeometry, Scene, ShaderMaterial, SphereGeometry, Vector2, Vector3, WebGLRenderer,
} from "three";
export {OrbitControls} from "three/examples/jsm/controls/OrbitControls.js";
