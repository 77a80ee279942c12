// What travels, as proto/gnomon.openrpc.json says: generated.ts is made from it by the build. Here are the few shapes that the viewer's code wants
// otherwise: one Light for those that are sent and those that come back, and plain strings and numbers where menus made from server.hello give them.
import type * as wire from "./generated.js";

export type * from "./generated.js";

type Loose<T> = { [K in keyof T]: T[K] extends string | undefined ? string : T[K] extends number | undefined ? number : T[K] };

export type LightKind = wire.LightInfo["kind"];
export type Light = wire.Light & { kind: LightKind; name?: string | null };
export type SceneInfo = Omit<wire.SceneInfo, "lights"> & { lights: Light[] };
export type SceneCamera = wire.CameraInfo;
export type LightsResult = Omit<wire.Lights, "lights"> & { lights: Light[] };
export type SnapshotSettings = Loose<Omit<wire.RenderSnapshotParams, "lights">> & { lights?: Light[] };
export type CompareSettings = Loose<Omit<wire.CompareRunParams, "lights" | "request_id">> & { lights?: Light[] };
export type ViewInfo = Loose<Omit<wire.ViewInfo, "lights">> & { lights: Light[] };

// What a view takes when it is opened or changed, apart from its inputs.
export type ViewSettings = Loose<Omit<wire.ViewOpenParams, "input_seq" | "input_time_us" | "lights">> & { lights?: Light[] };
