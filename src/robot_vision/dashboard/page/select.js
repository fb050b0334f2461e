/** Selecting, by a rectangle on its image, what a node follows or searches. */

const STATE_TYPE = "robot_vision/TrackStateArray";
const LIST_RATE = 5; // Hz
const WHO = "object_tracker, window_tracker, template_matcher, histogram or segmenter";

/**
 * Whether a node takes rectangles, by its service or its topic.
 * @param {object} app
 * @param {string} name of the node
 */
export function takesSelections(app, name) {
  const node = nodeOf(app, name);
  return Boolean(node) && (node.services.includes(`${name}/select_object`)
    || node.subscribes.includes(`${name}/select`));
}

const nodeOf = (app, name) => (app.graph ? app.graph.nodes : []).find((one) => one.name === name);

const takers = (app) => (app.graph ? app.graph.nodes : [])
  .map((node) => node.name).filter((name) => takesSelections(app, name));

/**
 * What a drag and a click on a tile do: of the panel, and while no tool is open.
 * @param {object} app
 * @param {() => string} label the name that the object gets
 * @param {(text: string, kind?: string) => void} tell the answer; by default in a notice
 */
export function dragTool(app, label = () => "", tell = (text, kind) => app.notify(text, kind)) {
  const clicks = (name) => {
    const node = nodeOf(app, name);
    return Boolean(node) && node.subscribes.includes(`${name}/click`);
  };
  return {
    name: "select",
    hint: "Drag around what is to be followed or searched",
    cursor: "crosshair",
    touches: (tile) => app.role === "control" && takesSelections(app, tile.node),
    onDrag: (tile, rectangle) => {
      const region = whole(rectangle, tile.size);
      const text = `${region.width}x${region.height} px at ${region.x}, ${region.y}`;
      return done(
        app, tell, { op: "select_object", node: tile.node, region, label: label() },
        `${tile.node}: ${text}`,
      );
    },
    onClick: (tile, point) => {
      if (!clicks(tile.node)) return tell(`${tile.node}: drag a rectangle`);
      const [x, y] = [Math.floor(point.x), Math.floor(point.y)];
      const fields = { op: "click", node: tile.node, topic: tile.image, x, y };
      return done(app, tell, fields, `${tile.node}: clicked at ${x}, ${y}`);
    },
  };
}

/** The rectangle in whole pixels inside of the image. */
function whole(rectangle, [width, height]) {
  const within = (value, size) => Math.min(Math.max(Math.round(value), 0), size);
  const [x, y] = [within(rectangle.x, width), within(rectangle.y, height)];
  const right = within(rectangle.x + rectangle.width, width);
  const bottom = within(rectangle.y + rectangle.height, height);
  return { x, y, width: right - x, height: bottom - y };
}

/** Asks the node, and shows its answer: in the panel, or as a notice where there is none. */
async function done(app, tell, { op, ...fields }, what) {
  try {
    const answer = await app.connection.request(op, fields);
    tell((answer && answer.message) || what, "good");
  } catch (error) {
    tell(error.message, "bad");
  }
}

/** The list of what a node follows, each with a button that ends it. */
function followed(app, node) {
  const list = app.el("div", { class: "list", "data-test": "followed", "data-node": node });
  const rows = new Map();
  const forget = (id) => done(
    app, (text, kind) => app.notify(text, kind), { op: "forget_object", node, object: id },
    id < 0 ? `${node} follows nothing any more` : `${node} has forgotten object ${id}`,
  );
  const all = button(app, "Forget all", "forget-all", () => forget(-1));
  const nothing = app.el("p", { class: "dim", "data-test": "follows-nothing" });
  const show = ({ tracks }) => {
    nothing.textContent = "Nothing is followed yet.";
    for (const [id, row] of rows) {
      if (!tracks.some((track) => track.id === id)) {
        row.element.remove();
        rows.delete(id);
      }
    }
    for (const track of tracks) {
      if (!rows.has(track.id)) rows.set(track.id, rowOf(app, list, track, forget));
      rows.get(track.id).show(track);
    }
    nothing.hidden = rows.size > 0;
    all.hidden = rows.size < 2;
  };
  const fail = (text) => {
    show({ tracks: [] });
    nothing.textContent = text;
  };
  show({ tracks: [] });
  const element = app.el("section", { class: "stack" }, app.el("h3", {}, node), nothing, list, all);
  const fields = { topic: `${node}/state`, rate: LIST_RATE };
  return { element, close: app.connection.channel("messages", fields, show, fail) };
}

function rowOf(app, list, track, forget) {
  const state = app.el("span", { class: "badge" });
  const name = app.el("span", { class: "grow" }, `${track.label || "object"} #${track.id}`);
  const element = app.el(
    "div", { class: "row", "data-test": "object", "data-id": String(track.id) },
    name, state, button(app, "Forget", "forget", () => forget(track.id)),
  );
  list.append(element);
  const show = ({ state: now, confidence }) => {
    state.textContent = now === 1 ? `followed ${Math.round(100 * confidence)} %` : "lost";
    state.className = now === 1 ? "badge good" : "badge warn";
  };
  return { element, show };
}

function button(app, text, test, onclick) {
  const disabled = app.role !== "control";
  const attributes = { type: "button", "data-test": test, disabled, onclick };
  return app.el("button", { class: "button small", ...attributes }, text);
}

function open(element, app) {
  const answer = app.el("p", { class: "dim", "aria-live": "polite", "data-test": "select-answer" });
  const label = app.el("input", { type: "text", maxlength: "60", "data-test": "select-label" });
  const hint = app.el("p");
  const lists = app.el("div", { class: "stack" });
  const shown = new Map();
  const update = () => {
    const names = takers(app);
    hint.textContent = names.length
      ? `Drag a rectangle on the image of ${names.join(", ")}.`
      : `No node runs that takes rectangles: ${WHO}.`;
    if (app.role !== "control") hint.textContent += " You can only look: this is a view.";
    const states = (app.graph ? app.graph.topics : []).filter((one) => one.type === STATE_TYPE)
      .map((one) => one.name.replace(/\/state$/, "")).filter((name) => names.includes(name));
    for (const [name, list] of shown) {
      if (states.includes(name)) continue;
      list.close();
      list.element.remove();
      shown.delete(name);
    }
    for (const name of states) {
      if (shown.has(name)) continue;
      shown.set(name, followed(app, name));
      lists.append(shown.get(name).element);
    }
  };
  element.append(app.el(
    "div", { class: "stack" }, hint,
    app.el("label", { class: "field" }, app.el("span", {}, "Name, if it is to have one"), label),
    answer, lists,
  ));
  app.tiles.setTool(dragTool(app, () => label.value.trim(), (text) => {
    answer.textContent = text;
  }));
  const offs = [app.on("graph", update), app.on("role", update)];
  update();
  return () => {
    offs.forEach((off) => off());
    shown.forEach((list) => list.close());
    app.tiles.setTool(null);
  };
}

export const tool = {
  name: "select",
  title: "Select",
  icon: "M4 8V4h4M16 4h4v4M20 16v4h-4M8 20H4v-4M9 9h6v6H9z",
  available: () => true,
  open,
  idle: (app) => ({ ...dragTool(app), onClick: null }),
};
