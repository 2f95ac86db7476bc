/* What the scripts of live figures hand each other. For the type checker only: no page carries it.
   Angles are in rad, lengths in the robot's unit, places of a picture in its 400 units. */

type Place = number[]; // [x, y], or the values of both joints

interface Window {
  cspaceData: Record<string, any>; // what explorer/data.py sends, by robot
}

interface Scale {
  height: number;
  equal: boolean; // both axes have one scale
  pixels: number; // for one unit across
  box: number[]; // left, top, right, bottom
  at: (values: Place) => Place;
  from: (pixel: Place) => Place;
}

interface Handle {
  at: Place;
  move: (pixel: Place) => void;
  name: string;
  value: string;
  shape?: string;
  kind?: string;
  bad?: boolean;
  take?: () => void;
  over?: (pixel: Place) => boolean;
  keys?: (event: KeyboardEvent) => void;
}

interface Layer {
  clip?: boolean;
  content: any; // a template of html.js
}

interface Picture {
  title: string;
  scale: Scale;
  layers: Layer[];
  handles?: Handle[];
  go?: (q: Place) => void;
}

interface View {
  status: [string, boolean]; // what it says, and whether it is bad
  pictures: Picture[];
  before?: any[]; // controls above
  controls?: any[]; // and below the pictures
  after?: any;
}
