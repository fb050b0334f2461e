/** Tuning a colour of hsv_tracker: click it, look at the mask, move the limits, save. */

import { holding } from "./color_spaces.js";
import { ColorView } from "./color_view.js";
import { liveMask } from "./live_mask.js";

const NAMES = {
  low: ["low_1", "low_2", "low_3"], high: ["high_1", "high_2", "high_3"],
};
const HSV_NAMES = {
  low: ["h_low", "s_low", "v_low"], high: ["h_high", "s_high", "v_high"],
};

/** The range of the colour that a node's live parameters show. */
function rangeOf(values) {
  const names = values.space === "hsv" ? HSV_NAMES : NAMES;
  const limits = (which) => names[which].map((name) => values[name]);
  return { space: values.space, low: limits("low"), high: limits("high") };
}

/** The names of the nodes that have a mask, which they have some time after they have started. */
function withMasks(app) {
  const nodes = app.graph ? app.graph.nodes : [];
  const has = ({ name, publishes }) => publishes.includes(`${name}/mask`);
  return nodes.filter(has).map(({ name }) => name);
}

/** The nodes that have named colours. */
async function trackers(app) {
  const found = [];
  for (const node of withMasks(app)) {
    const { names, shown } = await app.connection.request("color_names", { node });
    if (names.length) found.push({ node, names, shown });
  }
  return found;
}

/** The panel while it is open. */
class ColorPanel {
  constructor(element, app) {
    this.app = app;
    this.closed = false;
    this.trackers = [];
    this.node = "";
    this.range = null; // that of the colour which is chosen
    this.said = null; // what the node's parameters were last, as it told
    this.picked = null; // the range around a pixel that waits for the name of a new colour
    this.before = null; // as it was when it was chosen
    this.mask = null;
    this.waiting = null; // the newest range that the node has not been told
    this.told = Promise.resolve();
    this.view = new ColorView(element, app, {
      chooseNode: (node) => this._choose(node),
      chooseColor: (name) => this._set({ color: name }, true),
      choose: () => this._hint(),
      named: () => this.picked && this._apply(this.picked),
      chooseSpace: (space) => this._set({ space }),
      range: (range) => this._apply(range),
      save: () => this._save(),
      undo: () => this._undo(),
    });
    this._show();
    this.offs = [
      app.on("graph", () => this._look()),
      app.on("role", () => this._show()),
      app.connection.on("values", ({ node, values }) => this._changed(node, values)),
      app.connection.on("state", (state) => state === "open" && this.node && this._load(false)),
    ];
    this._hint();
    this._look();
  }

  /** Says what a click on an image does now. */
  _hint() {
    const tunes = this.node && this.app.role === "control";
    const name = this.view.chosenName() || "the new colour";
    const hint = tunes ? `Click what is to be ${name}` : "Click a colour in an image";
    if (hint === this.hint) return;
    this.hint = hint;
    this.app.tiles.setTool({
      name: "color",
      hint,
      cursor: "crosshair",
      touches: () => true,
      onClick: (tile, point) => this._pick(tile, point),
    });
  }

  /** Looks for nodes when masks have come or gone. */
  async _look() {
    const nodes = withMasks(this.app).join(" ");
    if (nodes === this.looked) return;
    this.looked = nodes;
    let found = [];
    try {
      found = await trackers(this.app);
    } catch (error) {
      this.looked = ""; // it is tried again with the next news of the graph
      this._say(error.message, "bad");
    }
    if (this.closed) return;
    this.trackers = found;
    const known = found.some((one) => one.node === this.node);
    if (!known) await this._choose(found.length ? found[0].node : "");
    this._show();
  }

  async _choose(node) {
    this.left = this.node;
    this.node = node;
    this.range = this.said = this.waiting = null; // what waits is of the tracker before
    this._leave();
    this.mask = node ? liveMask(this.app, node) : null;
    if (node) await this._load(true);
  }

  /** Asks what the node's parameters are, and is told from now on what changes. */
  async _load(anew) {
    const { node } = this;
    this.said = null; // until something is pushed, which is newer than the answer
    await this._try(async () => {
      const { values } = await this.app.connection.request("parameters", { node });
      if (node === this.node) this._take({ ...values, ...this.said }, anew);
    });
  }

  /** Takes what the node's live parameters are now. */
  _take(values, anew) {
    const tracker = this.trackers.find((one) => one.node === this.node);
    if (!tracker || this.closed) return;
    this.said = values;
    tracker.shown = values.color || tracker.shown;
    if (!tracker.names.includes(tracker.shown)) {
      tracker.names.push(tracker.shown); // it has just been added
      this.view.endNaming();
      anew = true; // the range before was another colour's
    }
    this.range = rangeOf(values);
    if (anew) this.before = this.range;
    this._show();
  }

  /** Somebody has changed the node's parameters; what is being set here comes back by itself. */
  _changed(node, values) {
    if (node !== this.node) return;
    this.said = values;
    if (!this.waiting && !this.busy) this._take(values, false);
  }

  /** Shows again what the node has, as it has not taken what was to be set. */
  _restore() {
    if (this.said && !this.waiting) this._take(this.said, false);
  }

  async _set(values, anew = false) {
    if (!this.node) return;
    const { node } = this;
    await this._try(async () => {
      const answer = await this.app.connection.request("set_parameters", { node, values });
      if (node !== this.node) return; // Another one was chosen, which has other values.
      this._refused(answer);
      this._take(answer.values, anew);
    }, () => this._restore());
  }

  /** Gives the colour that is chosen the range back that it had; a new one is not made at all. */
  _undo() {
    this.picked = null;
    this.view.endNaming();
    this.view.tell("", "info");
    return this._apply({ ...this.before });
  }

  /** A click: shows the colour, and gives the range around it to the colour that is chosen. */
  async _pick(tile, { x, y }) {
    const { node } = this;
    await this._try(async () => {
      const fields = { topic: tile.image, x: Math.floor(x), y: Math.floor(y) };
      const picked = await this.app.connection.request("color_at", fields);
      this.view.showPicked(picked);
      if (node !== this.node || !this.range || this.app.role !== "control") return;
      const { space } = this.range;
      const around = picked.ranges[space];
      if (!around) return;
      const { widened, ...range } = holding(space, around, picked[space] || around.low);
      const name = this.view.chosenName();
      if (!name) this.picked = range;
      this.isSaved = false;
      const undo = this.view.naming.hidden ? " Undo gives the last one back." : "";
      const pale = widened ? " It is wide, as this colour is pale or dark: narrow it below." : "";
      this.view.tell(name && `${name} has the range around it.${undo}${pale}`);
      await this._apply(range);
    });
  }

  /** Tells the node a range; while it answers only the newest of the next ones is kept. */
  _apply(range) {
    if (this.isSaved) this.view.tell("Changed since it was saved.");
    this.isSaved = false;
    this.range = range;
    this._show();
    const idle = !this.waiting;
    this.waiting = range;
    if (idle) this.told = this.told.then(() => this._tell());
    return this.told;
  }

  async _tell() {
    if (!this.waiting) return;
    const { space, low, high } = this.waiting;
    this.waiting = null;
    const name = this.view.chosenName();
    if (!name) {
      this._say("Give the new colour a name first.", "bad");
      return;
    }
    this.busy = true;
    const { node } = this;
    await this._try(async () => {
      this.picked = null;
      const fields = { node, name, space, low, high };
      const answer = await this.app.connection.request("use_color", fields);
      if (node !== this.node) return;
      this._refused(answer);
      if (this.waiting) return;
      this._take(answer.values, false);
      this.view.endNaming(); // a name that is there already is taken, too
    }, () => this._restore());
    this.busy = false;
  }

  async _save() {
    await this._try(async () => {
      const { node } = this;
      await this.told;
      const { message } = await this.app.connection.request("save_parameters", { node });
      this._say(message, "good");
      if (node !== this.node) return;
      this.before = this.range;
      this.isSaved = true;
    });
  }

  _refused({ refused }) {
    const texts = Object.values(refused || {});
    if (texts.length) this._say([...new Set(texts)].join("; "), "bad");
  }

  async _try(work, otherwise = () => {}) {
    try {
      await work();
    } catch (error) {
      this._say(error.message, "bad");
      otherwise();
    }
  }

  _say(text, kind) {
    if (!this.closed) this.view.tell(text, kind);
  }

  _show() {
    this.view.show(this.trackers, this.node, this.range, this.before);
    if (!this.closed && this.hint) this._hint();
  }

  /** Ends what came from a node. */
  _leave() {
    if (this.mask) this.mask();
    this.mask = null;
    if (!this.left || this.app.connection.state !== "open") return;
    this.app.connection.request("close_parameters", { node: this.left }).catch(() => {});
  }

  close() {
    this.closed = true;
    this.offs.forEach((off) => off());
    this.left = this.node;
    this._leave();
    this.app.tiles.setTool(null);
  }
}

export const tool = {
  name: "color",
  title: "Color",
  icon: "M12 3s6 6.6 6 11a6 6 0 0 1-12 0c0-4.4 6-11 6-11zM9 14a3 3 0 0 0 3 3",
  available: () => true,
  open: (element, app) => {
    const panel = new ColorPanel(element, app);
    return () => panel.close();
  },
};
