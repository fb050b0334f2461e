/**
 * Clicks and drags on the image of a tile: for a tool, in pixels of the image; without one, to
 * select it.
 */

import { pixelAt, regionBetween, toImage } from "./geometry.js";

const CLICK_DISTANCE = 5; // CSS px that a pointer may move meanwhile

/**
 * @param {CanvasRenderingContext2D} context
 * @param {number} scale
 * @param {import("./geometry.js").Region} region
 */
function drawBand(context, scale, { x, y, width, height }) {
  context.fillStyle = "rgb(99 179 255 / 22%)";
  context.fillRect(x, y, width, height);
  context.lineWidth = (2 * devicePixelRatio) / scale;
  context.strokeStyle = "#04182c";
  context.strokeRect(x, y, width, height);
  context.setLineDash([6 / scale, 5 / scale]);
  context.strokeStyle = "#ffffff";
  context.strokeRect(x, y, width, height);
}

export class TilePointer {
  /** @param {any} tiles @param {any} tile */
  constructor(tiles, tile) {
    this.tiles = tiles;
    this.tile = tile;
    this.start = null; // where the pointer went down
    this.escape = (event) => this.cancel(event);
    const { element } = tile.view;
    element.addEventListener("pointerdown", (event) => this.down(event));
    element.addEventListener("pointermove", (event) => this.move(event));
    element.addEventListener("pointerup", (event) => this.up(event));
    element.addEventListener("pointercancel", (event) => this.isOurs(event) && this.end());
    element.addEventListener(
      "dblclick",
      () => !tiles.tool && tiles.enlarge(tile.enlarged ? null : tile),
    );
  }

  /** @returns {any} the tool, if it works on this tile; without one, what drags do then */
  tool() {
    const tool = this.tiles.tool || this.tiles.idleTool;
    return tool && this.tile.view.size[0] && tool.touches(this.tile) ? tool : null;
  }

  point(event) {
    const rect = this.tile.view.overlay.getBoundingClientRect();
    return toImage({ x: event.clientX, y: event.clientY }, rect, this.tile.view.size);
  }

  down(event) {
    if (event.button !== 0 || !event.isPrimary) return; // a second finger begins nothing
    this.tiles.select(this.tile);
    if (!this.tool()) return;
    if (!this.tiles.tool && event.pointerType === "touch" && !this.tile.enlarged) return;
    event.preventDefault();
    this.tile.view.element.setPointerCapture(event.pointerId);
    const { pointerId: pointer, clientX: x, clientY: y } = event;
    this.start = { image: this.point(event), pointer, x, y };
    document.addEventListener("keydown", this.escape, true); // before it is for anything else
  }

  /** Whether it is of the finger, or the mouse, that has begun. @param {PointerEvent} event */
  isOurs(event) {
    return this.start?.pointer === event.pointerId;
  }

  /** @param {PointerEvent} event */
  isDrag(event) {
    return Math.hypot(event.clientX - this.start.x, event.clientY - this.start.y) > CLICK_DISTANCE;
  }

  move(event) {
    if (!this.isOurs(event) || !this.tool()?.onDrag || !this.isDrag(event)) return;
    const region = regionBetween(this.start.image, this.point(event), this.tile.view.size);
    this.tile.view.layers.set("drag", (context, scale) => drawBand(context, scale, region));
    this.tile.view.redraw();
  }

  async up(event) {
    const tool = this.tool();
    const { start, tile } = this;
    if (!this.isOurs(event)) return;
    const drag = this.isDrag(event);
    const end = this.point(event);
    this.end();
    if (!tool) return; // Its node has gone meanwhile.
    try {
      if (drag) await tool.onDrag?.(tile, regionBetween(start.image, end, tile.view.size));
      else await tool.onClick?.(tile, pixelAt(end, tile.view.size));
    } catch (error) {
      this.tiles.app.notify(error.message, "bad");
    }
  }

  /** @param {KeyboardEvent} event Escape, which ends a drag without effect */
  cancel(event) {
    if (event.key !== "Escape") return;
    event.preventDefault();
    event.stopPropagation();
    this.end();
  }

  end() {
    document.removeEventListener("keydown", this.escape, true);
    this.start = null;
    if (this.tile.view.layers.delete("drag")) this.tile.view.redraw();
  }
}
