// What the server says, as far as the viewer uses it: proto/gnomon.openrpc.json.

export type Vec3 = [number, number, number];

export interface LookAt {
  eye: Vec3;
  target: Vec3;
  up?: Vec3;
  fov?: number; // degrees, vertical
}

export interface Param {
  name: string;
  unit: string;
  help: string;
  kind: "int" | "float" | "choice";
  min?: number | null;
  max?: number | null;
  default: number | string;
  choices?: string[];
  odd?: boolean;
}

export interface Algorithm {
  name: string;
  title: string;
  help: string;
  lights: string[];
  params: Param[];
}

export interface SceneName {
  name: string;
  source: "builtin" | "file";
  help?: string;
}

export interface Hello {
  version: string;
  session: string;
  role: "view" | "control";
  capabilities: { show: string[]; codecs: string[]; device: string };
  limits: Record<string, number>;
  scenes: SceneName[];
  algorithms: Algorithm[];
}

export interface ViewInfo {
  view: number;
  scene: string;
  size: [number, number];
  camera: Required<LookAt>;
  algorithm: string;
  show: string;
}

export interface ViewStats {
  view: number;
  fps: number;
  frame_ms: number;
  encode_ms: number;
  rtt_ms: number;
  bytes: number;
  dropped: number;
  shadow_bytes: number;
  passes: Record<string, number>;
}

export interface ViewSettings {
  scene?: string;
  size?: [number, number];
  dpr?: number;
  camera?: LookAt | string | number;
  algorithm?: string;
  show?: string;
  quality?: number;
  pause?: boolean;
  fps?: number;
}
