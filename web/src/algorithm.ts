// "sm:size=1024,slope=1": a name and parameters, as the wire and the command line write them. Scenes are written likewise.
import type { Algorithm, Param } from "./protocol.js";

export type Values = Record<string, number | string>;
export type Described = Pick<Param, "name" | "kind" | "default">;

export function splitSettings(text: string): { name: string; values: Map<string, string> } {
  const colon = text.indexOf(":");
  const name = colon < 0 ? text : text.slice(0, colon);
  const pairs = colon < 0 ? [] : text.slice(colon + 1).split(",").filter(Boolean);
  return { name, values: new Map(pairs.map((pair) => pair.split("=", 2) as [string, string])) };
}

export function readValues(params: Described[], given: Map<string, string>): Values {
  const values: Values = {};
  for (const param of params) {
    const text = given.get(param.name);
    values[param.name] = text === undefined ? param.default : param.kind === "choice" ? text : Number(text);
  }
  return values;
}

export function joinSettings(name: string, params: Described[], values: Values): string {
  const pairs = params.filter((p) => values[p.name] !== p.default).map((p) => `${p.name}=${values[p.name]}`);
  return name + (pairs.length ? `:${pairs.join(",")}` : "");
}

export function withoutDefaults(algorithms: Pick<Algorithm, "name" | "params">[], text: string): string {
  const { name, values } = splitSettings(text);
  const params = algorithms.find((a) => a.name === name)?.params;
  return params ? joinSettings(name, params, readValues(params, values)) : text;
}
