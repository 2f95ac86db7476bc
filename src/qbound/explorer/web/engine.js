/* What figures of other kinds may use, and `mount`, which puts an explorer into an element. */

const engine = {
  mount,
  // vectors.js
  TURN,
  between,
  wrapped,
  sum,
  leastBy,
  minus,
  cross,
  angle,
  turnedBy,
  sides,
  area,
  isInside,
  toSegment,
  crossing,
  // roots.js
  basis,
  basisSlope,
  circleArc,
  circleRoots,
  rootsWithin,
  // arcs.js
  CIRCLE,
  insert,
  joined,
  onCircle,
  holds,
  without,
  // kinematics.js
  restrict,
  evaluate,
  alongSecond,
  framesOf,
  placeIn,
  pointPlaces,
  margins,
  withPair,
  tightest,
  isSafe,
  viewAxes,
  project,
  toolMap,
  toolAt,
  determinant,
  // contacts.js
  encounter,
  // postures.js
  armOf,
  postures,
  otherPosture,
  mirroredPose,
  // fibres.js
  SEAM,
  CLOSEST,
  UPRIGHT,
  refined,
  components,
  pieceAt,
  cells,
  uprights,
  // polygons.js
  scaledPolygon,
  randomPairs,
  wayTo,
  pieceLengths,
  stopsAt,
  alongPath,
  // drawing.js
  make,
  set,
  picture,
  wholePicture,
  pathText,
  layer,
  clear,
  handle,
  number,
  // hands.js
  pixelOf,
  draggable,
  onKeys,
  // player.js
  PACE,
  player,
  // arm.js
  planeBox,
  addArm,
  placeArm,
  placeAt,
  // parts.js
  newPrefix,
  element,
};
window.qboundEngine = engine;
window.qboundFigures = {};
