/** The panels of the page, in the order of the rail. One that cannot be loaded is left out. */

import { tool as graph } from "./graph.js";
import { tool as log } from "./log.js";
import { tool as parameters } from "./parameters.js";

/**
 * @typedef {Object} Tool
 * @property {string} name
 * @property {string} title
 * @property {string} icon path data of 24x24 units
 * @property {string} [key] its shortcut
 * @property {boolean} [wide] it uses half of the page
 * @property {string} [missing] what it needs, told while it is not available
 * @property {(app: any) => any} [idle] makes what drags on images do while no tool is open, see
 *   Tiles.setIdleTool
 * @property {(app: any) => boolean} available
 * @property {(element: HTMLElement, app: any) => (() => void)} open returns what closes it
 */

const MODULES = ["select.js", "color.js", "faces.js", "scene3d.js", "bags.js", "calibration.js"];

/** @returns {Promise<Tool[]>} */
export async function loadTools() {
  const modules = await Promise.allSettled(MODULES.map((file) => import(`./${file}`)));
  const found = modules.flatMap((module) =>
    module.status === "fulfilled" ? [module.value.tool] : [],
  );
  return [parameters, ...found, log, graph];
}
