// SPDX-License-Identifier: Apache-2.0
// What the page uses of others; ./renew bundles it into libraries.min.js, where the page finds it as LIBRARIES.
export { default as uPlot } from "uplot";
export {
  BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineDashedMaterial, LineSegments, OrthographicCamera, Scene,
  Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/addons/controls/OrbitControls.js";
export { LineMaterial } from "three/addons/lines/LineMaterial.js";
export { LineSegments2 } from "three/addons/lines/LineSegments2.js";
export { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
