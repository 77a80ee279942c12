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
  params?: Omit<Param, "unit">[];
}

export type LightKind = "directional" | "point" | "spot";

export interface Light {
  kind: LightKind;
  name?: string | null;
  position?: Vec3; // point, spot
  direction?: Vec3; // the way the light travels; directional, spot
  color?: Vec3; // linear
  intensity?: number; // candela; lux for a directional light
  radius?: number;
  inner?: number; // degrees, half angles; spot
  outer?: number;
  range?: number; // 0: no limit
}

export interface SceneCamera {
  name: string | null;
  kind: "perspective" | "orthographic";
}

export interface SceneInfo {
  scene: string;
  triangles: number;
  drawn_triangles: number;
  vertices: number;
  bounds: { min: Vec3; max: Vec3 } | null;
  cameras: SceneCamera[];
  lights: Light[];
}

export interface LightsResult {
  index: number;
  lights: Light[];
}

export interface SnapshotSettings {
  scene?: string;
  size?: [number, number];
  camera?: LookAt | string | number;
  lights?: Light[];
  algorithm?: string;
  show?: string;
  format?: string;
  quality?: number;
  exposure?: number | "auto";
  ambient?: number;
  tonemap?: string;
  aa?: number;
  request_id?: number;
}

export interface Hello {
  version: string;
  session: string;
  role: "view" | "control";
  capabilities: { show: string[]; codecs: string[]; formats: string[]; methods: string[]; device: string };
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
  codec: string;
  quality: number;
  lights: Light[];
  pause: boolean;
  exposure?: number | "auto";
  ambient?: number;
  tonemap?: string;
  aa?: number;
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
  lights?: Light[];
  codec?: string;
  quality?: number;
  pause?: boolean;
  fps?: number;
  exposure?: number | "auto";
  ambient?: number;
  tonemap?: string;
  aa?: number;
}
