/* What `qboundEngine` offers to figures of other kinds, and how a page of the book uses it. */

interface Options {
  page?: boolean; // the explorer's own page: every control, the view in the address
  controls?: string[]; // of "legend", "task", "pose", "scaling", "show", "margins"
  q?: Pose; // the pose that it opens with
  scale?: number;
  show?: Partial<State["show"]>;
  lit?: string; // a boundary that stands out
}

interface Explorer {
  readonly root: HTMLElement;
  readonly robot: Robot;
  readonly state: State;
  readonly slice: Slice;
  readonly joints: JointPicture;
  readonly plane: PlanePicture;
  part(id: string): HTMLElement;
  pair(): Pair;
  move(pair: Pair): void; // both free joints; a running path stops
  moveTool(target: Point): void;
  play(stops: Pair[], from: number, each: (done: number) => void): void;
  stop(): void;
  isPlaying(): boolean;
  walkStops(): Pair[];
  setScale(scale: number): void;
  refresh(): void; // what moves with the pose
  redraw(): void; // both pictures
}

interface Engine {
  mount(root: HTMLElement, robot: Robot, options?: Options): Explorer;

  make<K extends keyof SVGElementTagNameMap>(
    name: K,
    attributes: Record<string, string | number>,
    text?: string,
  ): SVGElementTagNameMap[K];
  element<K extends keyof HTMLElementTagNameMap>(
    name: K,
    properties: Partial<HTMLElementTagNameMap[K]>,
    ...children: (Node | string)[]
  ): HTMLElementTagNameMap[K];
  newPrefix(): string;
  pathText(points: Point[], closed?: boolean): string;
  picture(svg: SVGSVGElement, ranges: number[][], margin: Picture["box"], equal: boolean): Picture;
  layer(drawn: Picture, name: string, clipped?: boolean): SVGGElement;
  clear(drawn: Picture): void;
  handle(svg: SVGSVGElement, mark: SVGElement): Handle;
  thin(names: Iterable<SVGTextElement>, width: number): void;
  legend(name: string, text: string, shows: boolean): HTMLLIElement[];
  between(value: number, low: number, high: number): number;
  number(value: number, digits: number): string;

  draggable(svg: SVGSVGElement, move: (pixel: Point, handle: Element | null) => void): void;
  onKeys(
    svg: SVGElement,
    step: (direction: number[], large: boolean) => void,
    keys?: Record<string, () => void>,
  ): void;
  pixelOf(svg: SVGSVGElement, event: MouseEvent): Point;

  drawJointAxes(robot: Robot, drawn: Picture, line: number): void;
  planeBox(robot: Robot): number[][];
  addArm(robot: Robot, drawn: Picture): ArmParts;
  placeArm(robot: Robot, drawn: PlanePicture, state: State, lit: Lit): void;
  skeleton(robot: Robot, drawn: Picture, q: Pose): string;
  viewAxes(robot: Robot, q: Pose): Place[];
  project(axes: Place[], place: Place): Point;

  framesOf(robot: Robot, q: Pose): Frame[];
  placeIn(frame: Frame, at: Place): Place;
  pointPlaces(robot: Robot, q: Pose): Place[];
  margins(robot: Robot, q: Pose): Margin[];
  tightest(robot: Robot, found: Margin[]): Margin | null;
  isSafe(found: Margin[]): boolean;
  withPair(robot: Robot, q: Pose, pair: Pair): Pose;

  toolMap(robot: Robot, q: Pose): ToolMap;
  toolAt(map: ToolMap, pair: Pair): Point;
  determinant(map: ToolMap, pair: Pair): number;
  armOf(map: ToolMap): Arm;
  singularValues(arm: Arm): number[];
  possible(robot: Robot, arm: Arm, target: Point): Pair[];
  mirroredPose(arm: Arm, pair: Pair): Pair;

  basis(kind: Kind, q: number): number[];
  restrict(form: Term[], robot: Robot, q: Pose): Matrix;
  evaluate(matrix: Matrix, x: number[], y: number[]): number;
  alongSecond(matrix: Matrix, x: number[]): number[];
  rootsWithin(kind: Kind, coefficients: number[], view: View): number[];
  sliceProblem(robot: Robot, q: Pose): SliceProblem;
  fibre(problem: SliceProblem, first: number): Interval[];
  sliceCells(problem: SliceProblem, count: number): Cell[];
  cellEdges(problem: SliceProblem, cells: Cell[]): Edge[];
  pieceAt(cells: Cell[], pair: Pair): number | null;
  outline(rows: Row[], steps?: number): Pair[];
  scaledPolygon(vertices: Pair[], factor: number, centre: Pair): Pair[];
  smallestClearance(
    robot: Robot,
    q: Pose,
    vertices: Pair[],
    factor: number,
    centre: Pair,
  ): Least;
  randomPairs(robot: Robot): Pair[];
  pieceLengths(robot: Robot, stops: Pair[]): number[];
  alongPath(robot: Robot, stops: Pair[], fraction: number): Pair;
}

interface FigureData {
  robot: Robot | null; // of `data-robot`, `data-rule`
  own: any; // what Python says to figures of this kind
}

/** A kind of figure: draws into the element, whose `data-*` are the options. */
type FigureKind = (element: HTMLElement, options: DOMStringMap, data: FigureData) => void;

declare const qboundEngine: Engine;
declare const qboundFigures: Record<string, FigureKind>;
declare const qboundRobots: Record<string, Robot>;
declare const qboundData: Record<string, unknown>;

interface Window {
  qboundEngine: Engine;
  qboundFigures: Record<string, FigureKind>;
  qboundRobots: Record<string, Robot>;
  qboundData: Record<string, unknown>;
  explorer?: Explorer;
}
