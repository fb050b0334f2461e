/** How the images are arranged: their order, columns and sizes. */

import { el } from "./dom.js";
import { arrangement } from "./layout.js";
import { glide, placesOf } from "./tile_glide.js";
import { TileTools } from "./tile_tools.js";

const GAP = 10; // CSS px, as in layout.css

/** @typedef {import("./tile.js").Tile} Tile */

export class TileGrid extends TileTools {
  /** @param {any} app */
  constructor(app) {
    super();
    this.app = app;
    /** @type {string[]} keys of all tiles */
    this.order = [];
    this.dragged = null; // the tile that is moved just now
    this.main = document.getElementById("main");
    this.grid = el("div", { class: "tiles", "data-test": "tiles" });
    new ResizeObserver(() => this.arrange()).observe(this.main);
  }

  kept(name) {
    return this.app.storage.get(name, []);
  }

  /** @returns {Tile[]} those that are not hidden, in their order */
  visible() {
    const hidden = this.kept("hidden");
    return this.order
      .map((key) => this.tiles.get(key))
      .filter((tile) => tile && !hidden.includes(tile.key));
  }

  /**
   * @param {string[]} order of all keys
   * @param {boolean} [forNow] it is not kept
   */
  setOrder(order, forNow = false) {
    if (!forNow) this.app.storage.set("order", order);
    const same = order.join("\n") === this.order.join("\n");
    this.order = order;
    if (!same || !forNow) {
      const before = placesOf(this.tiles.values());
      const focused = document.activeElement;
      order.forEach((key, index) => (this.tiles.get(key).element.style.order = String(index)));
      if (!forNow) this.grid.append(...order.map((key) => this.tiles.get(key).element));
      if (focused !== document.activeElement)
        /** @type {any} */ (focused).focus?.({ preventScroll: true });
      glide(before);
    }
    this.arrange();
  }

  /** Columns and sizes. */
  arrange() {
    const [hidden, doubled] = [this.kept("hidden"), this.kept("double")];
    for (const tile of this.tiles.values()) {
      tile.element.hidden = hidden.includes(tile.key);
      tile.element.classList.toggle("double", doubled.includes(tile.key));
    }
    const shown = this.visible();
    const cells = shown.reduce((sum, tile) => sum + (doubled.includes(tile.key) ? 4 : 1), 0);
    const aspects = shown.map((tile) => tile.aspect || 4 / 3).sort((a, b) => a - b);
    const room = {
      width: this.main.clientWidth - 2 * GAP,
      height: this.main.clientHeight - 2 * GAP,
      gap: GAP,
    };
    const { columns, width } = arrangement(
      room,
      cells,
      aspects[Math.floor(aspects.length / 2)] || 4 / 3,
    );
    this.grid.style.setProperty("--columns", String(columns));
    this.grid.style.setProperty("--width", `${width}px`);
    this.grid.classList.toggle("single", columns === 1);
  }

  setDouble(tile, double) {
    this.app.storage.set("double", [
      ...this.kept("double").filter((key) => key !== tile.key),
      ...(double ? [tile.key] : []),
    ]);
    this.arrange();
  }
}
