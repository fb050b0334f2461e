/** The view in space: frames, cameras, tags, things, tables, objects and points. */

import { el, setText } from "./dom.js";
import { TYPES } from "./scene_messages.js";
import { POINTS, RATE, SceneTopics } from "./scene_topics.js";
import { SceneView } from "./scene_view.js";

const TELL_PERIOD = 500; // ms
const KEPT = 100; // topics of which it is remembered whether they are shown

class ScenePanel {
  constructor(element, app) {
    this.app = app;
    this.view = new SceneView();
    this.streams = new SceneTopics(app, this.view);
    this.topics = [];
    this.listed = null;
    this.off = new Set(app.storage.get("scene.off", []));
    this.on = new Set(app.storage.get("scene.on", []));
    this.view.imageOf = (beside) => this.imageBeside(beside);
    this.view.onRestored = () => this.renew();
    this.build(element);
    this.offs = [app.on("graph", () => this.showTopics())];
    this.openFrames(app.storage.get("scene.root", ""));
    this.showTopics();
    this.timer = setInterval(() => this.tell(), TELL_PERIOD);
  }

  build(element) {
    this.fixed = el("select", {
      "data-test": "scene-frame",
      onchange: () => {
        this.app.storage.set("scene.root", this.fixed.value);
        this.openFrames(this.fixed.value);
      },
    });
    const fit = { type: "button", class: "button small", "data-test": "scene-fit" };
    const shows = this.app.storage.get("scene.frames", true);
    this.framesBox = this.box(shows, "scene-frames", "", (on) => {
      this.app.storage.set("scene.frames", on);
      this.view.showFrames(on);
    });
    this.view.showsFrames = shows;
    const state = { class: "warn small-text", role: "status", "data-test": "scene-state" };
    this.said = el("p", state);
    this.list = el("div", { class: "scene-list" });
    const frame = el("span", { class: "dim" }, "Fixed frame");
    const head = el(
      "div",
      { class: "row" },
      el("label", { class: "row tight grow" }, frame, this.fixed),
      el("button", { ...fit, onclick: () => this.view.fit() }, "Show all"),
    );
    const main = el("div", { class: "scene-main" }, head, this.view.element, this.said);
    element.classList.add("scene-panel");
    element.append(el("div", { class: "scene-parts" }, main, this.list));
  }

  box(checked, test, name, change) {
    const attributes = { type: "checkbox", class: "switch", "data-test": test, "data-name": name };
    const made = el("input", { ...attributes, checked, onchange: () => change(made.checked) });
    return made;
  }

  row(name, box, note = "") {
    return el(
      "label",
      { class: "check", title: name },
      el("span", { class: "ellipsis grow" }, name),
      note && el("span", { class: "dim small-text" }, note),
      box,
    );
  }

  /** @param {string} root "": the one with most frames */
  openFrames(root) {
    this.closeFrames?.();
    const fields = { root, rate: RATE };
    this.closeFrames = this.app.connection.channel("frames", fields, (data) => this.onFrames(data));
  }

  onFrames(data) {
    if (data.root && !data.frames.length && data.roots.length && !data.roots.includes(data.root)) {
      this.openFrames(""); // The frame that was chosen another time is not there.
      return;
    }
    const all = [...data.roots, data.root, ...data.frames.map((frame) => frame.name)];
    const names = [...new Set(all)].filter(Boolean).sort();
    const shown = [...this.fixed.options].map((option) => option.value);
    if (shown.join("\n") !== names.join("\n")) {
      this.fixed.replaceChildren(...names.map((name) => el("option", { value: name }, name)));
    }
    this.fixed.value = data.root;
    this.view.setFrames(data);
  }

  /** Lists the topics that have something in space, by what they have. */
  showTopics() {
    const order = Object.keys(TYPES);
    const rank = ({ type }) => order.indexOf(type);
    const topics = (this.app.graph?.topics || [])
      .filter((one) => TYPES[one.type] && one.publishers.length)
      .sort((a, b) => rank(a) - rank(b) || (a.name < b.name ? -1 : 1));
    const listed = topics.map((one) => `${one.type} ${one.name}`).join("\n");
    if (listed === this.listed) return;
    this.listed = listed;
    this.topics = topics;
    this.streams.keep((name) => topics.some((one) => one.name === name));
    const groups = new Map([["Frames", [this.row("all frames", this.framesBox)]]]);
    for (const topic of topics) {
      const on = this.isOn(topic);
      const box = this.box(on, "scene-topic", topic.name, (now) => this.change(topic, now));
      const title = TYPES[topic.type];
      groups.set(title, [...(groups.get(title) || []), this.row(topic.name, box)]);
      if (on) this.streams.show(topic);
    }
    const sections = [...groups].map(([title, rows]) =>
      el("section", {}, el("h3", {}, title), rows),
    );
    const nothing = "Nothing with a place is published now: tags, tables, clouds, cameras.";
    if (!topics.length) sections.push(el("p", { class: "dim" }, nothing));
    this.list.replaceChildren(...sections);
  }

  /** Clouds are off until somebody wants them, except if there is only one. */
  isOn({ name, type }) {
    if (this.on.has(name)) return true;
    const isOnly = this.topics.filter((one) => one.type === POINTS).length === 1;
    return !this.off.has(name) && (type !== POINTS || isOnly);
  }

  change(topic, on) {
    (on ? this.on : this.off).add(topic.name);
    (on ? this.off : this.on).delete(topic.name);
    this.app.storage.set("scene.on", [...this.on].slice(-KEPT));
    this.app.storage.set("scene.off", [...this.off].slice(-KEPT));
    if (on) this.streams.show(topic);
    else this.streams.hide(topic.name);
  }

  /** Asks anew for all that is shown: what is published once would not come again. */
  renew() {
    for (const topic of this.topics) {
      if (!this.streams.open.has(topic.name)) continue;
      this.streams.hide(topic.name);
      this.streams.show(topic);
    }
  }

  tell() {
    const problems = this.streams.problems();
    setText(this.said, problems);
    this.said.hidden = !problems;
  }

  /**
   * @param {string} beside the namespace of a camera, with a slash at its end
   * @returns {HTMLCanvasElement|null} the image that a tile shows of it
   */
  imageBeside(beside) {
    const isOf = (tile) => tile.image?.startsWith(`${beside}image`) && tile.view?.drawn;
    return this.app.tiles.list().find(isOf)?.view.canvas || null;
  }

  close() {
    clearInterval(this.timer);
    for (const off of this.offs) off();
    this.closeFrames();
    this.streams.close();
    this.view.close();
  }
}

/** @type {import("./tools.js").Tool} */
export const tool = {
  name: "scene3d",
  title: "3D",
  icon: "M12 3l8 4.5v9L12 21l-8-4.5v-9zM12 12l8-4.5M12 12v9M12 12L4 7.5",
  wide: true,
  available: () => true,
  open: (element, app) => {
    try {
      const panel = new ScenePanel(element, app);
      return () => panel.close();
    } catch (error) {
      const title = el("strong", {}, "No view in space");
      const empty = { class: "empty", "data-test": "no-webgl" };
      element.append(el("div", empty, title, el("span", {}, error.message)));
      return () => {};
    }
  },
};
