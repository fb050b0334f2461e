/** What tools do with images: clicks and drags on them, and layers over them. */

import { el, setText } from "./dom.js";

const ARRANGED = 300; // ms, after which the images have made room for a panel

/** @typedef {import("./tile.js").Tile} Tile */

/**
 * @typedef {Object} ImageTool
 * @property {string} name
 * @property {string} hint what it does, told above the images
 * @property {(tile: Tile) => boolean} touches whether it works on a tile
 * @property {string} [cursor]
 * @property {(tile: Tile, region: import("./geometry.js").Region) => any} [onDrag]
 * @property {(tile: Tile, pixel: import("./geometry.js").Point) => any} [onClick]
 */

export class TileTools {
  constructor() {
    /** @type {Map<string, Tile>} */
    this.tiles = new Map();
    /** @type {ImageTool|null} */
    this.tool = null;
    /** @type {Partial<ImageTool>|null} what drags do while there is no tool */
    this.idleTool = null;
    this.hint = el("div", { class: "hint", role: "status", hidden: true });
  }

  /**
   * What clicks and drags on images do, until it is another tool's or nobody's.
   * @param {ImageTool|null} tool
   */
  setTool(tool) {
    const before = this.tool;
    this.tool = tool;
    setText(this.hint, tool?.hint || "");
    this.hint.hidden = !tool?.hint;
    document.body.dataset.tool = tool?.name || "";
    this.showTool();
    if (tool && before?.name !== tool.name) setTimeout(() => this.showTouched(), ARRANGED);
  }

  /** Scrolls to an image that the tool works on, unless one is in sight. */
  showTouched() {
    const touched = [...this.tiles.values()].filter((tile) => this.tool?.touches(tile));
    const inSight = ({ element }) => {
      const { top, bottom } = element.getBoundingClientRect();
      const middle = (top + bottom) / 2;
      return middle > 0 && middle < innerHeight;
    };
    if (touched.length && !touched.some(inSight)) {
      touched[0].element.scrollIntoView({ block: "center" });
    }
  }

  /** Shows on which tiles the tool works. */
  showTool() {
    for (const tile of this.tiles.values()) {
      const touched = Boolean(this.tool?.touches(tile));
      tile.element.classList.toggle("touched", touched);
      tile.view.element.style.cursor = touched ? this.tool.cursor || "crosshair" : "";
      tile.showHint(this.idleHint(tile));
    }
  }

  /**
   * What drags on images do while there is no tool. By touch it works on an enlarged image only, as
   * else it would stand in the way of scrolling.
   * @param {Partial<ImageTool>} tool with hint, touches and onDrag
   */
  setIdleTool(tool) {
    this.idleTool = tool;
    this.showTool();
  }

  /** @param {Tile} tile @returns {string} what a drag on it does while there is no tool */
  idleHint(tile) {
    return !this.tool && this.idleTool?.touches(tile) ? this.idleTool.hint : "";
  }

  /**
   * A layer over a tile's image, in its pixels; the same name again replaces it.
   * @param {Tile} tile
   * @param {string} name
   * @param {(context: CanvasRenderingContext2D, scale: number) => void} draw scale: px of the
   *   canvas
   *   for one of the image
   * @returns {() => void} removes it
   */
  draw(tile, name, draw) {
    tile.view.layers.set(name, draw);
    tile.view.redraw();
    return () => {
      if (tile.view.layers.get(name) === draw) tile.view.layers.delete(name);
      tile.view.redraw();
    };
  }
}
