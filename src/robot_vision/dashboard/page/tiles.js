/** All images of the page: which there are, how they are arranged, and what tools do with them. */

import { EmptyPage } from "./empty_page.js";
import { hasView, keyViews, orderKeys } from "./layout.js";
import { Streams } from "./streams.js";
import { Tile } from "./tile.js";
import { dragByHeader } from "./tile_drag.js";
import { TileGrid } from "./tile_grid.js";
import { addTileShortcuts } from "./tile_keys.js";
import { showLayoutMenu, showPicker, showTileMenu } from "./tile_menus.js";

const NUMBERS_PERIOD = 500; // ms

export class Tiles extends TileGrid {
  /** @param {any} app */
  constructor(app) {
    super(app);
    this.streams = new Streams(app);
    this.selected = null;
    this.topics = new Map();
    this.nothing = new EmptyPage(this);
    this.main.append(this.grid, this.nothing.element);
    this.main.after(this.hint); // over the images, and not among them: nothing moves when it comes
    this.observer = new IntersectionObserver((entries) => this.seen(entries), {
      root: this.main,
      rootMargin: "40px",
    });
    document.addEventListener("visibilitychange", () =>
      this.tiles.forEach((tile) => tile.updateStreams()),
    );
    setInterval(
      () => !document.hidden && this.tiles.forEach((tile) => tile.onScreen && tile.showNumbers()),
      NUMBERS_PERIOD,
    );
    app.on("graph", () => this.update());
    app.on("state", () => this.update());
    this.typeOf = (topic) => this.topics.get(topic)?.type || "";
    addTileShortcuts(this);
    this.update();
  }

  /** @returns {Map<string, import("./layout.js").View>} */
  wantedViews() {
    const views = keyViews(this.app.graph?.views || []);
    for (const topic of this.kept("added")) {
      views.set("topic " + topic, {
        node: "",
        title: topic,
        image: topic,
        overlays: [],
        processed: "",
      });
    }
    for (const tile of this.tiles.values()) {
      // what has gone stays with its last image
      if (views.has(tile.key) || !tile.view.drawn || tile.key.startsWith("topic ")) continue;
      if (!hasView(views, tile.source)) views.set(tile.key, tile.source);
    }
    return views;
  }

  /** Makes the tiles those of the graph. */
  update() {
    const { graph } = this.app;
    this.topics = new Map((graph?.topics || []).map((topic) => [topic.name, topic]));
    const nodes = new Map((graph?.nodes || []).map((node) => [node.name, node]));
    const views = this.wantedViews();
    for (const [key, tile] of this.tiles) if (!views.has(key)) this.remove(tile);
    for (const [key, view] of views) {
      if (!this.tiles.has(key)) this.add(key);
      const node = nodes.get(view.node);
      this.tiles.get(key).update(view, node?.status || null, Boolean(node) || !view.node);
    }
    this.showTool();
    this.setOrder(orderKeys(views, this.dragged ? this.order : this.kept("order")), true);
    this.nothing.update();
  }

  add(key) {
    const tile = new Tile(this, key);
    this.tiles.set(key, tile);
    dragByHeader(this, tile);
    this.grid.append(tile.element);
    this.observer.observe(tile.element);
  }

  remove(tile) {
    if (tile.enlarged) this.enlarge(null);
    if (tile === this.selected) this.selected = null;
    tile.view.close();
    this.observer.unobserve(tile.element);
    tile.element.remove();
    this.tiles.delete(tile.key);
  }

  isPublished(topic) {
    return Boolean(this.topics.get(topic)?.publishers.length);
  }

  /** @returns {Tile[]} what tools know of: each has node, image (its topic) and size in px */
  list() {
    return this.visible();
  }

  seen(entries) {
    for (const entry of entries) {
      const tile = [...this.tiles.values()].find(({ element }) => element === entry.target);
      if (!tile) continue;
      tile.onScreen = entry.isIntersecting;
      tile.updateStreams();
    }
  }

  /** @param {Tile} tile */
  select(tile) {
    if (this.selected === tile) return;
    this.selected?.element.classList.remove("selected");
    this.selected = tile;
    tile.element.classList.add("selected");
    if (tile.node) this.app.select(tile.node);
  }

  hide(tile) {
    if (tile.enlarged) this.enlarge(null);
    if (tile.key.startsWith("topic ")) {
      this.app.storage.set(
        "added",
        this.kept("added").filter((topic) => topic !== tile.image),
      );
      this.update();
      return;
    }
    this.app.storage.set("hidden", [...this.kept("hidden"), tile.key]);
    this.arrange();
    this.nothing.update();
    this.app.notify(
      `${tile.title.textContent} is hidden. The menu of the arrangement shows it again.`,
    );
  }

  /**
   * @param {Tile|null} tile null: all of them again
   * @returns {boolean} whether something has changed
   */
  enlarge(tile) {
    const before = [...this.tiles.values()].find(({ enlarged }) => enlarged);
    if (before === tile || (!before && !tile)) return false;
    before?.setEnlarged(false);
    tile?.setEnlarged(true);
    this.main.classList.toggle("enlarging", Boolean(tile));
    if (tile) this.select(tile);
    (tile || before).element.focus({ preventScroll: Boolean(tile) });
    return true;
  }

  /** Adds a tile for a topic, and goes to it. @param {string} topic */
  addTopic(topic) {
    const added = this.kept("added");
    if (!added.includes(topic)) this.app.storage.set("added", [...added, topic]);
    this.update();
    this.tiles.get("topic " + topic)?.element.focus();
  }

  showPicker(anchor) {
    showPicker(this, anchor);
  }

  showMenu(anchor) {
    showLayoutMenu(this, anchor);
  }

  showTileMenu(tile, anchor) {
    showTileMenu(this, tile, anchor);
  }
}
