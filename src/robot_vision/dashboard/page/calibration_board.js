/** The first step of a calibration: which camera, and what is printed on the board. */

import { boardPicture, KINDS } from "./board_picture.js";
import { el, setText } from "./dom.js";

const SERVICE = "set_camera_info";
const IMAGE = "sensor_msgs/Image";
export const MODELS = {
  plumb_bob: "Normal lens",
  rational_polynomial: "Wide lens",
  equidistant: "Fisheye lens",
};
const DEFAULTS = {
  kind: "chessboard",
  columns: 8,
  rows: 6,
  millimetres: 25,
  model: "plumb_bob",
  marker: 18,
  dictionary: "4x4_50",
};

/**
 * The image topics of a graph that a camera may have, those first whose camera takes a calibration.
 * @param {any} graph
 * @returns {string[]}
 */
export function cameraTopics(graph) {
  const services = new Set((graph?.nodes || []).flatMap((node) => node.services));
  const takes = (name) => services.has(name.slice(0, name.lastIndexOf("/") + 1) + SERVICE);
  const rank = (name) => (takes(name) ? 0 : 1) + (/depth|mono$/.test(name) ? 2 : 0);
  return (graph?.topics || [])
    .filter((one) => one.type === IMAGE && one.publishers.length)
    .map((one) => one.name)
    .sort((a, b) => rank(a) - rank(b) || (a < b ? -1 : 1));
}

export class BoardStep {
  /**
   * @param {any} panel
   */
  constructor(panel) {
    this.panel = panel;
    this.app = panel.app;
    this.kept = { ...DEFAULTS, ...this.app.storage.get("calibration", {}) };
    this.build();
    this.update();
    this.showTopics();
  }

  build() {
    this.makeInputs();
    const { topic, kind, columns, rows, millimetres, model, marker, dictionary } = this.inputs;
    const field = (label, control) =>
      el("label", { class: "field grow" }, el("span", {}, label), control);
    const pair = (...fields) => el("div", { class: "row tight" }, fields);
    this.labels = { columns: el("span"), rows: el("span"), square: el("span") };
    this.words = el("p", { class: "dim small-text" });
    this.picture = el("div", { class: "board" });
    this.charuco = pair(field("Side of a marker, mm", marker), field("Markers", dictionary));
    const start = { type: "submit", class: "button primary", "data-test": "calibration-start" };
    this.button = el("button", start, "Show the board");
    this.element = el(
      "form",
      { class: "stack", oninput: () => this.update(), onsubmit: (event) => this.start(event) },
      el("p", {}, "Say which camera it is, and what is printed on the board."),
      field("Images of the camera", topic),
      pair(field("Board", kind), field("Lens", model)),
      this.picture,
      this.words,
      pair(
        field(this.labels.columns, columns),
        field(this.labels.rows, rows),
        field(this.labels.square, millimetres),
      ),
      this.charuco,
      this.panel.controls ? this.button : this.panel.buttons(),
    );
  }

  makeInputs() {
    const made = (tag, name, attributes, ...children) =>
      el(tag, { "data-test": `board-${name}`, ...attributes }, children);
    const number = (name, attributes) =>
      made("input", name, {
        type: "number",
        required: true,
        value: this.kept[name],
        ...attributes,
      });
    const select = (name, entries) => {
      const options = entries.map(([value, text]) => el("option", { value }, text));
      const element = made("select", name, {}, options);
      element.value = this.kept[name];
      return element;
    };
    const count = { min: 3, max: 100, step: 1 };
    const length = { min: 0.1, max: 10000, step: "any" };
    const kinds = Object.entries(KINDS).map(([value, { title }]) => [value, title]);
    this.inputs = {
      topic: el("select", { "data-test": "calibration-topic" }),
      kind: select("kind", kinds),
      columns: number("columns", count),
      rows: number("rows", count),
      millimetres: number("millimetres", length),
      model: select("model", Object.entries(MODELS)),
      marker: number("marker", length),
      dictionary: made("input", "dictionary", { maxlength: 40, value: this.kept.dictionary }),
    };
  }

  /** Shows the board that is described. */
  update() {
    const { kind, columns, rows, marker } = this.inputs;
    const said = KINDS[kind.value];
    for (const [name, label] of Object.entries(this.labels)) setText(label, said[name]);
    setText(this.words, said.words);
    this.charuco.hidden = kind.value !== "charuco";
    marker.disabled = this.charuco.hidden;
    const picture = boardPicture(kind.value, Number(columns.value), Number(rows.value));
    this.picture.replaceChildren(picture);
  }

  showTopics() {
    const { topic } = this.inputs;
    const topics = cameraTopics(this.app.graph);
    const shown = [...topic.options].map((option) => option.value);
    this.button.disabled = !topics.length;
    if (shown.length && shown.join() === topics.join()) return;
    const tiles = this.app.tiles.list();
    const selected = tiles.find((tile) => tile.node && tile.node === this.app.selected);
    const wanted = [topic.value, selected?.image, ...topics];
    const options = topics.map((name) => el("option", { value: name }, name));
    const none = el("option", { value: "" }, "no images are published now");
    topic.replaceChildren(...(options.length ? options : [none]));
    topic.value = wanted.find((name) => topics.includes(name)) || "";
  }

  async start(event) {
    event.preventDefault();
    const { topic, kind, columns, rows, millimetres, model, marker, dictionary } = this.inputs;
    this.app.storage.set("calibration", {
      kind: kind.value,
      columns: Number(columns.value),
      rows: Number(rows.value),
      millimetres: Number(millimetres.value),
      model: model.value,
      marker: Number(marker.value),
      dictionary: dictionary.value,
    });
    const fields = {
      topic: topic.value,
      kind: kind.value,
      columns: Number(columns.value),
      rows: Number(rows.value),
      square: Number(millimetres.value) / 1000,
      model: model.value,
    };
    const more = { marker: Number(marker.value) / 1000, dictionary: dictionary.value };
    if (kind.value === "charuco") Object.assign(fields, more);
    await this.panel.ask("calibration_start", fields, (state) => this.panel.show(state));
  }
}
