/* What the page of a surface is told, and what its scripts hand each other: for the type checker. */

interface View3 {
  yaw: number;
  pitch: number;
  distance: number;
}

interface SurfaceData {
  schema: "qbound/surface-page/1";
  axes: { name: string; unit: string; ends: number[] }[]; // as people read them: degrees, lengths
  places: string; // base 64 of three whole numbers of 16 bits a vertex: parts of the ranges
  triangles: string; // base 64 of three numbers of vertices, of 32 bits each, a triangle
  pairs: { name: string; colour: string; triangles: number[] }[]; // from, to
}

interface SurfacePiece {
  name: string;
  colour: string;
  place: Float32Array;
  index: Uint32Array;
  draw: () => void;
  shown: boolean;
}

interface SurfaceActs {
  turn: (right: number, up: number) => void;
  zoom: (factor: number) => void;
  reset: () => void;
  tell: (pixel: number[]) => void;
}

interface Surface3 {
  view: View3;
  pieces: SurfacePiece[];
  redraw: () => void;
  tell: (pixel: number[]) => void;
}

interface Window {
  surface: Surface3 | null;
}
