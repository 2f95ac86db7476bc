/* What the figures of the chapters hand each other, and what parts.js offers them. For the type
   checker only: no page carries this file. Angles are in rad, lengths in the robot's unit. */

/* --- parts.js --------------------------------------------------------------------------------- */

interface StatusLine {
  seen: HTMLElement;
  spoken: HTMLElement;
  say: (text: string, bad: boolean) => void;
}

type Press = [string, () => void]; // a button's words, and what it does

/* --- switches --------------------------------------------------------------------------------- */

type Reading = "arctan" | "atan2" | "plus";

interface Component2 {
  boundary: string;
  component: number; // 1, 2, 3: x, y, z
}

interface Coefficients extends Component2 {
  joint: number;
  a: number;
  b: number;
  c: number;
}

interface StraightBound extends Component2 {
  joint: number;
  k: number; // 1 is the upper bound, 2 the lower
  value: number;
}

interface CurvedWall extends Component2 {
  matrix: Matrix;
}

interface WallArc {
  middle: number;
  alpha: number;
  cuts: boolean; // whether it ends in roots
}

interface CurveRow extends WallArc {
  first: number;
}

interface BoxSide {
  value: number;
  by: string | null; // the bound there; null: the square's edge
}

interface BoundBox {
  box: HTMLInputElement;
  label: HTMLLabelElement;
  value: HTMLSpanElement;
}

/* --- scale ------------------------------------------------------------------------------------ */

interface Lowest {
  value: number;
  q: Pair;
}

/* --- traversals ------------------------------------------------------------------------------- */

interface Way {
  name: string; // "all", "right", "left", "mirror"
  labels: string[]; // of the stops
  stops: Pair[];
}

interface Trace {
  way: Way;
  joints: SVGPathElement; // as far as it is done
  plane: SVGPathElement;
}

/* --- regions ---------------------------------------------------------------------------------- */

interface Rule {
  wall: Wall;
  form: Matrix | null; // null: it is about bodies
}

interface Slid {
  at: Pair; // how far the arm came
  by: Wall[]; // what barred the straight way; empty where nothing did
  goal: Pair;
}

interface Behind {
  pair: Pair; // the first safe pose beyond
  width: number; // of what lies between, rad
  region: number | null;
}

/* --- goals ------------------------------------------------------------------------------------ */

interface RegionsKind {
  rulesOf: (robot: Robot) => Rule[];
  slide: (robot: Robot, rules: Rule[], from: Pair, to: Pair) => Slid;
}

interface Ring {
  name: string;
  at: Point;
  poses: { q: Pair; answer: string; file: string | null }[]; // answers of `cspace why`
  path: Pair[] | null;
}

/* --- postures --------------------------------------------------------------------------------- */

interface Judged {
  pair: Pair;
  safe: boolean;
  region: number | null;
  violated: string[];
  overlap: boolean; // of whole links, whatever the points say
}

/* --- live ------------------------------------------------------------------------------------- */

interface LiveObstacle {
  kind: "disc" | "box" | "polygon";
  name: string;
  x: number;
  y: number;
  angle: number;
  sizes: number[]; // radius, or width and height
  corners: Point[]; // of a polygon, about x, y, before it is turned
}

interface LiveScene {
  lengths: number[];
  thicknesses: number[];
  q: Pair;
  home: Pair;
  obstacles: LiveObstacle[];
}

interface LiveArm {
  lengths: number[];
  radii: number[];
}

interface LiveShape {
  points: Point[]; // of a disc its centre
  radius: number;
  x: number;
  y: number;
  size: number; // of a disc about x, y that holds it all
}

interface LiveContact {
  gap: number; // negative where they overlap, but no depth
  places: Point[]; // the two nearest, on the link's line and on the obstacle
  end: number | null; // of the link, 0 or 1; null: its side
  part: "corner" | "edge" | null; // of the obstacle; null: a disc
  number: number; // of that part
}

interface LiveEncounter extends LiveContact {
  link: number;
  obstacle: number;
}

interface LiveForbidden {
  windows: number[]; // pairs of ends in [-pi, pi]: q1 at which the first link meets it
  columns: number[][]; // the same of q2, for the second link, on each column of the grid
  critical: number[]; // q1 at which the number of those intervals changes
}

interface LiveSpace {
  columnsOf(arm: LiveArm, shapes: LiveShape[]): Column[];
}

interface LiveRegions {
  columns: Column[];
  home: boolean; // whether home is free; its component is the first
  areas: number[];
  of: number[][]; // of each interval of each column its component; -1: too small
}

interface LiveScale {
  x0: number; // a pixel is x0 + dx * angle
  dx: number;
  y0: number;
  dy: number;
}

interface LiveOutline {
  fill: string;
  edge: string;
}
