// What a described parameter looks like in the panel: unit in the label, range and help in the tooltip.
import type { Controller, GUI } from "lil-gui";
import type { Param } from "./protocol.js";

const SLIDER_STEPS_MAX = 200; // beyond, a slider is too coarse a hand and a plain number serves better

export function describe(controller: Controller, id: string, help: string): Controller {
  const { domElement } = controller;
  domElement.dataset["control"] = id;
  domElement.title = help;
  for (const input of domElement.querySelectorAll("input, select, button")) (input as HTMLElement).title = help;
  return controller;
}

const inWords = (param: Omit<Param, "unit"> & { unit?: string }): string => {
  const unit = param.unit ? ` ${param.unit}` : "";
  const range = param.choices ? param.choices.join(", ") : param.min != null && param.max != null ? `${param.min} to ${param.max}${unit}` : "";
  return [param.help, range, param.odd ? "odd numbers only" : "", `default ${param.default}`].filter(Boolean).join("; ");
};

export function addParam(folder: GUI, values: Record<string, number | string>, param: Omit<Param, "unit"> & { unit?: string }): Controller {
  const label = param.unit ? `${param.name} (${param.unit})` : param.name;
  const controller = param.kind === "choice" ? folder.add(values, param.name, param.choices ?? []) : addNumber(folder, values, param);
  return describe(controller.name(label), `param-${param.name}`, inWords(param));
}

function addNumber(folder: GUI, values: Record<string, number | string>, param: Omit<Param, "unit">): Controller {
  const { min, max } = param;
  const span = min != null && max != null ? max - min : Infinity;
  const slider = param.kind === "float" ? span <= 100 : span / (param.odd ? 2 : 1) <= SLIDER_STEPS_MAX;
  // Numbers without a slider are left to the server to refuse: its sentence says more than a silent clamp.
  const controller = slider && min != null && max != null ? folder.add(values, param.name, min, max) : folder.add(values, param.name);
  if (param.kind === "int") controller.step(param.odd ? 2 : 1);
  else if (slider) controller.step(span / 1000);
  return controller;
}
