/**
 * One image of the page: its name and state, the image with what is drawn over it, and its numbers.
 */

import { el, iconButton, setText } from "./dom.js";
import { ICONS } from "./icons.js";
import { ImageView } from "./image_view.js";
import { chooseOverlays } from "./overlay.js";
import { TileNumbers } from "./tile_numbers.js";
import { TilePointer } from "./tile_pointer.js";
import { problemOf } from "./tile_problem.js";

const LEVELS = ["good", "warn", "bad", "bad"];

export class Tile {
  /** @param {any} tiles @param {string} key */
  constructor(tiles, key) {
    this.tiles = tiles;
    this.app = tiles.app;
    this.key = key;
    this.source = null; // the view of the graph
    this.status = null;
    this.isThere = true; // its node
    /** @type {{topic: string, type: string}[]} what can be drawn over the image */
    this.drawable = [];
    this.error = "";
    this.failedAt = 0; // ms
    this.onScreen = false;
    this.enlarged = false;
    this.options = { overlays: true, ...this.app.storage.get("tile." + key, {}) };
    this.view = new ImageView(
      this.app,
      tiles.streams,
      (size) => this.sized(size),
      (text) => this.failed(text),
    );
    this.numbers = new TileNumbers();
    this.makeElements();
    this.pointer = new TilePointer(tiles, this);
    const aspect = this.app.storage.get("aspect." + key, null);
    if (aspect) this.setAspect(aspect);
  }

  makeElements() {
    this.dot = el("span", { class: "state-dot", role: "img" });
    this.title = el("h2", { class: "ellipsis" });
    this.words = el("span", { class: "state-words ellipsis", "data-test": "state-words" });
    this.enlargeButton = iconButton(
      ICONS.expand,
      "Enlarge (Enter)",
      () => this.tiles.enlarge(this.enlarged ? null : this),
      { class: "icon-button small", "data-test": "enlarge" },
    );
    this.menuButton = iconButton(
      ICONS.more,
      "More",
      (event) => this.tiles.showTileMenu(this, event.currentTarget),
      { class: "icon-button small", "data-test": "tile-menu" },
    );
    this.head = el(
      "header",
      { class: "tile-head" },
      this.dot,
      this.title,
      this.words,
      this.menuButton,
      this.enlargeButton,
    );
    this.message = el("div", { class: "tile-message", hidden: true, "data-test": "tile-message" });
    this.hint = el("div", { class: "tile-hint", hidden: true, "data-test": "tile-hint" });
    this.body = el("div", { class: "tile-image" }, this.view.element, this.message, this.hint);
    this.element = el(
      "article",
      { class: "tile", tabindex: 0, "data-test": "tile" },
      this.head,
      this.body,
      this.numbers.element,
    );
    this.element.addEventListener("focus", () => this.tiles.select(this));
  }

  /** What tools know a tile by: its node, its image's topic, and its size in px. */
  get node() {
    return this.source.node;
  }

  get image() {
    return this.processed ? this.source.processed : this.source.image;
  }

  /**
   * Whether the node's own image is shown: what somebody has chosen, by default where nothing can
   * be drawn, and until it is known on which image the node works. It tells that as soon as it
   * works, which it does when somebody looks at what it makes.
   */
  get processed() {
    const { source, options } = this;
    const wanted = !source.image || (options.processed ?? !this.drawable.length);
    return Boolean(source.processed && wanted);
  }

  get size() {
    return this.view.size;
  }

  /**
   * @param {import("./layout.js").View} source
   * @param {any} status of its node, or null
   * @param {boolean} isThere whether the node is in the graph
   */
  update(source, status, isThere = this.isThere) {
    const { element } = this;
    const drawable = chooseOverlays(source.overlays, this.tiles.typeOf);
    if (drawable.length || !this.view.drawn) this.drawable = drawable; // else they have gone
    this.source = source;
    this.status = status;
    this.isThere = isThere;
    if (element.dataset.node !== source.node) element.dataset.node = source.node;
    if (element.dataset.topic !== this.image) element.dataset.topic = this.image;
    setText(this.title, source.title || source.node || source.image);
    const name = source.node
      ? `${source.node}, image ${this.image || "not known yet"}`
      : source.image;
    const [width, height] = this.size;
    this.title.title = width ? `${name}, ${width}×${height}` : name;
    element.setAttribute("aria-label", name);
    this.view.show(this.image, this.options.overlays && !this.processed ? this.drawable : []);
    this.showState();
    this.showMessage();
  }

  /** @returns {{kind: string, text: string}} good, warn, bad or "", and what there is to say */
  state() {
    const { status } = this;
    if (!this.isThere) return { kind: "bad", text: "this node has gone" };
    if (!status) return { kind: "", text: "" };
    if (status.level) return { kind: LEVELS[status.level] || "bad", text: status.message };
    const own = this.processed && this.drawable.length;
    return { kind: "good", text: own ? "own image" : status.message.replace(/^running /, "") };
  }

  showState() {
    const { kind, text } = this.state();
    this.dot.className = `state-dot ${kind}`;
    const words = { good: "good", warn: "warning", bad: "error" };
    this.dot.setAttribute("aria-label", words[kind] || "no state known");
    setText(this.words, text);
    this.words.className = `state-words ellipsis ${kind === "good" ? "" : kind}`;
    this.words.title = text;
  }

  showMessage() {
    const text = problemOf(this);
    setText(this.message, text);
    this.message.hidden = !text;
    this.element.classList.toggle("stale", Boolean(text) || this.app.connection.state !== "open");
    if (!text) this.error = "";
  }

  /** @param {string} text what a drag on the image does, shown under the pointer; "" if nothing */
  showHint(text) {
    setText(this.hint, text);
    this.hint.hidden = !text;
    this.element.classList.toggle("drags", Boolean(text));
  }

  showNumbers() {
    this.numbers.update(this.status, this.view);
    this.showMessage();
  }

  /** Streams are open only while somebody can see them. */
  updateStreams() {
    if (this.onScreen && !document.hidden) {
      if (!this.view.isOpen) this.openedAt = performance.now();
      this.view.open();
    } else {
      this.view.close();
    }
  }

  /** @param {string} text why the image cannot be shown */
  failed(text) {
    this.error = text;
    this.failedAt = performance.now();
  }

  sized(size) {
    const aspect = size[0] / size[1];
    this.setAspect(aspect);
    this.app.storage.set("aspect." + this.key, aspect);
    this.tiles.arrange();
  }

  setAspect(aspect) {
    this.aspect = aspect;
    this.element.style.setProperty("--aspect", String(aspect));
  }

  /** @param {"processed"|"overlays"} name */
  toggle(name) {
    this.options[name] = name === "processed" ? !this.processed : !this.options[name];
    this.app.storage.set("tile." + this.key, this.options);
    this.update(this.source, this.status);
  }

  /** @param {boolean} enlarged */
  setEnlarged(enlarged) {
    this.enlarged = enlarged;
    this.element.classList.toggle("enlarged", enlarged);
    const label = enlarged ? "Back to all images (Esc)" : "Enlarge (Enter)";
    this.enlargeButton.title = label;
    this.enlargeButton.setAttribute("aria-label", label);
    this.enlargeButton
      .querySelector("path")
      .setAttribute("d", enlarged ? ICONS.shrink : ICONS.expand);
  }
}
