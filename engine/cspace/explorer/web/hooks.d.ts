/* How `mount` puts an explorer into a page, and how a page of the book uses the engine. */

declare const MARKUP: string; // of parts.html
declare function mount(root: HTMLElement, robot: Robot, options?: Options): Explorer;

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

interface FigureData {
  robot: Robot | null; // of `data-robot`, `data-rule`
  own: any; // what Python says to figures of this kind
}

/** A kind of figure: draws into the element, whose `data-*` are the options. */
type FigureKind = (element: HTMLElement, options: DOMStringMap, data: FigureData) => void;

declare const qboundEngine: typeof engine;
declare const qboundFigures: Record<string, FigureKind>;
declare const qboundRobots: Record<string, Robot>;
declare const qboundData: Record<string, unknown>;

interface Window {
  qboundEngine: typeof engine;
  qboundFigures: Record<string, FigureKind>;
  qboundRobots: Record<string, Robot>;
  qboundData: Record<string, unknown>;
  explorer?: Explorer;
}
