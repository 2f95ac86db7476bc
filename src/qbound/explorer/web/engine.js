/* What figures of other kinds may use, and `mount`, which puts an explorer into an element. */

/** @type {Engine} */
const engine = {
  mount,
  // elements
  make,
  element,
  newPrefix,
  pathText,
  picture,
  layer,
  clear,
  handle,
  thin,
  legend,
  between,
  number,
  // hands
  draggable,
  onKeys,
  pixelOf,
  // pictures
  drawJointAxes,
  planeBox,
  addArm,
  placeArm,
  skeleton,
  viewAxes,
  project,
  // kinematics and margins
  framesOf,
  placeIn,
  pointPlaces,
  margins,
  tightest,
  isSafe,
  withPair,
  // the tool of two joints
  toolMap,
  toolAt,
  determinant,
  armOf,
  singularValues,
  possible,
  mirroredPose,
  // slices, polygons, paths
  basis,
  restrict,
  evaluate,
  alongSecond,
  rootsWithin,
  sliceProblem,
  fibre,
  sliceCells,
  cellEdges,
  pieceAt,
  outline,
  scaledPolygon,
  smallestClearance,
  randomPairs,
  pieceLengths,
  alongPath,
};
window.qboundEngine = engine;
window.qboundFigures = {};
