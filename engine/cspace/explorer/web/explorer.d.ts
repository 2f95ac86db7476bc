/* What Python tells the page (the JSON of cspace.explorer.data, schema qbound/explorer/2) and what
   the page's scripts hand each other. For the type checker only: no page carries this file.
   Angles are in rad, lengths in the robot's unit. */

type Kind = "revolute" | "prismatic";
type Pose = number[]; // a value for every joint
type Pair = number[]; // values of the two free joints
type Place = number[]; // x, y, z
type Point = number[]; // two coordinates in the plane of motion, or pixels of a picture
type Matrix = number[][];
type Term = number[]; // a coefficient, then for each joint the index of its factor

/* --- what Python tells ------------------------------------------------------------------------ */

interface Robot {
  schema: "qbound/explorer/2";
  version: string;
  name: string;
  feasible_by: string; // what its boundaries are about, such as "points and bodies"
  safe: boolean; // whether whole links keep clear in every feasible pose
  length_unit: string;
  free: number[];
  q: Pose;
  joints: Joint[];
  steps: Step[];
  points: RobotPoint[];
  bodies: RobotBody[];
  flat: Place[] | null; // two axes of the plane in which bodies move
  apart: number[][]; // pairs of bodies of which an overlap is shown, whatever boundaries ask
  boundaries: Wall[];
  limits: Limit[];
  tool: number;
  tool_forms: Term[][];
  reach: number;
  plane: { frame: number; u: Place; v: Place; n: Place; oblique: boolean };
  views: View[];
  components: Component[];
  walls: number[] | null; // boundaries that can bound this slice; null: all
  row: SliceRow | null;
  polygon: VertexPolygon | null;
  workspace: { area: number; covered_twice: number } | null;
}

interface Joint {
  name: string;
  kind: Kind;
  limits: [number, number] | null;
  wraps: boolean;
}

interface Step {
  joint: number; // whose value it goes by: a parallelogram has two, a turn and a turn back
  sense: number; // -1: back by the value
  origin: Place;
  mount: Matrix;
  axis: Place;
}

interface RobotPoint {
  name: string;
  frame: number;
  at: Place;
  radius: number;
}

interface RobotBody {
  name: string;
  frame: number;
  outline: Place[];
  parts: { corners: Place[]; radius: number }[]; // convex; none where nothing is asked of it
}

interface WallOfAnyKind {
  name: string;
  used: boolean;
  points: number[];
  form: Term[];
}

interface PairWall extends WallOfAnyKind {
  kind: "pair";
  required: number;
}

interface HalfSpaceWall extends WallOfAnyKind {
  kind: "half-space";
  normal: Place;
  offset: number;
  body: number | null; // instead of a point; the radius is not in the offset then
}

interface BodiesWall extends WallOfAnyKind {
  kind: "bodies";
  bodies: number[];
  clearance: number;
}

type Wall = PairWall | HalfSpaceWall | BodiesWall;

interface Limit {
  name: string;
  joint: number;
  side: -1 | 1;
  value: number;
  middle: number;
}

interface View {
  low: number;
  high: number;
  wraps: boolean;
}

interface Component {
  home: boolean;
  area: number;
  centroid: Pair | null;
  wraps: boolean[];
  loops: { boundary: string; branch: -1 | 1 | null; feature: string | null; points: Pair[] }[][];
  vertices: { q: Pair; boundaries: string[] }[];
}

interface KnownSlice {
  components: Pick<Component, "home" | "area" | "loops">[];
  walls: number[] | null;
}

interface SliceRow {
  joint: number; // a held one
  unit: string; // of areas
  slices: (KnownSlice & { value: number })[]; // by rising value
}

interface VertexPolygon {
  vertices: Pair[];
  centroid: Pair;
  largest: number;
  binds: string | null;
  walks: number[][];
}

/* --- kinematics and margins ------------------------------------------------------------------- */

interface Frame {
  turn: Matrix;
  place: Place;
}

interface PlacedPart {
  corners: Point[];
  radius: number;
}

interface CoreEdge {
  start: Point;
  step: Point;
  length: number;
  normal: Point;
}

interface Encounter {
  distance: number;
  places: Point[];
}

interface BodyGap {
  bodies: number[];
  gap: number;
  overlap: boolean;
}

interface Seen {
  robot: Robot;
  found: Frame[];
  placed: PlacedPart[][];
}

interface Margin {
  name: string;
  value: number;
  used: boolean;
  unit: "length" | "angle";
}

interface ToolMap {
  x: Matrix;
  y: Matrix;
  kinds: Kind[];
  planar: boolean;
  /** Of the two joints, those that do not move the tool. */
  still: number[];
}

interface Arm {
  kind: "rr" | "rp" | "pr" | "pp";
  c: Point;
  d: Point;
  e: Point;
  s1: number;
  s2: number;
}

interface CircleArc {
  d: number; // amplitude
  theta: number; // middle
  alpha: number; // half the width
  count: number; // of roots; -1: every angle is one
  empty: boolean; // no angle satisfies the inequality
}

/* --- slices ----------------------------------------------------------------------------------- */

interface NamedView extends View {
  names: string[];
}

interface SliceProblem {
  robot: Robot;
  q: Pose;
  kinds: Kind[];
  forms: Matrix[];
  bodies: (BodiesWall | HalfSpaceWall)[];
  names: string[];
  ranges: NamedView[];
}

interface Column {
  q: number; // of the first joint
  free: number[]; // of the second: ends of intervals, in order
  by: number[]; // a label for each end
}

type Row = number[]; // of a cell: value of the first joint, lowest and highest of the second

interface Cell {
  low: number; // labels of its ends
  high: number;
  rows: Row[];
  piece: number;
}

interface Decomposition {
  columns: Column[];
  of: number[][]; // the component of each interval of each column
  cells: Cell[];
}

interface ColumnSizes {
  closest: number; // columns so near stand for one place
  least: number; // of an upright edge
  wraps: boolean; // whether the last column is the first one
}

interface UprightEdge {
  q: number;
  low: number;
  high: number;
  piece: number;
  side: 0 | 1; // of what is free: 0, it begins here; 1, it ends
}

interface Edge {
  boundary: string;
  piece: number;
  points: Pair[];
}

interface Images {
  positive: Point[][];
  negative: Point[][];
}

interface DrawnArc {
  boundary: string;
  branch: number | null;
  home: boolean;
  points: Pair[];
}

interface Slice extends Decomposition {
  home: number | null;
  exact: boolean; // whether the arcs are the library's
  own: boolean; // whether it is the slice that the page opened with
  map: ToolMap;
  arm: Arm;
  regular: boolean;
  arcs: DrawnArc[];
  images: Images;
  lines: number[];
  largest: number;
}

/* --- state and pictures ----------------------------------------------------------------------- */

interface Least {
  value: number;
  name: string | null;
  q: Pair;
}

interface SamplePose {
  pair: Pair;
  safe: boolean;
  home: boolean; // whether the home pose can be reached from it
  tool: Point;
}

interface State {
  q: Pose;
  scale: number;
  walk: number;
  progress: number;
  speed: number;
  show: { workspace: boolean; polygon: boolean; sample: boolean; names: boolean };
  sample: SamplePose[];
  path: Pair[] | null; // stops of the path that is drawn
  mirror: Pair | null; // the pose that the task asks for
  side: number; // the sign of det J where the task began
  hover: string | null; // a boundary pointed at in the table
}

interface Lit {
  violated: Set<string>;
  bold: Set<string>; // violated, or pointed at
  closest: string | null;
  boundaries: Set<string>; // those whose points are joined by a line
  points: Set<number>; // of what is bold
  named: Set<number>; // those, and the points of the closest boundary
}

interface ValueRow {
  name: string; // beside the slider
  spoken: string; // for those who do not see it, with its unit
  low: number;
  high: number;
  step: number; // of the slider; the field takes any number
  digits: number; // that the field shows
  unit: string;
  places?: number[]; // that the slider counts
}

interface SetRow {
  row: HTMLElement;
  slide: HTMLInputElement;
  field: HTMLInputElement;
  set: (value: number) => void;
}

interface Player {
  calm: () => boolean; // whether the reader wants no motion
  runs: () => boolean;
  stop: () => void;
  go: (done: number) => void;
  play: (way: { seconds: number; places: number[]; from?: number; loops?: boolean }) => void;
}

interface Picture {
  svg: SVGSVGElement;
  width: number;
  height: number;
  box: { left: number; top: number; right: number; bottom: number };
  at: (values: number[]) => Point;
  from: (pixel: Point) => number[];
}

interface JointAxis {
  name: string;
  unit: string;
  ticks: { value: number; text: string }[];
}

type Side = (point: Point) => number; // of a line: its sign says on which side a point lies

interface Handle {
  group: SVGGElement;
  mark: SVGElement;
  room: SVGCircleElement;
}

interface PathLayers {
  path: SVGPathElement;
  ghost: SVGElement;
}

interface JointPicture extends Picture, Handle, PathLayers {
  arcs: (SVGPathElement | SVGTextElement)[];
  singular: SVGLineElement[];
}

interface ArmParts {
  shadow: SVGPathElement[]; // on the floor, of an arm that is seen obliquely
  bodies: SVGPolygonElement[];
  clips: SVGClipPathElement[];
  overlaps: SVGPolygonElement[]; // one for each pair in `apart`: what both bodies share
  spine: SVGPathElement;
  axles: SVGCircleElement[];
  gaps: SVGLineElement[];
  nearest: SVGCircleElement[]; // two for each pair of bodies
  points: SVGCircleElement[];
  names: SVGTextElement[];
}

interface PlanePicture extends Picture, Handle, PathLayers, ArmParts {
  walls: SVGPathElement[];
}
