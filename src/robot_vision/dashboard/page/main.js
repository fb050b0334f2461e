/** The dashboard: one page to see, tune, teach and record what robot_vision's nodes do. */

import { Connection } from "./connection.js";
import { el } from "./dom.js";
import { Events } from "./events.js";
import { makeHeader } from "./header.js";
import { listenToKeys, shortcut } from "./keys.js";
import { notify, watchConnection } from "./notices.js";
import { Panels } from "./panels.js";
import { Statistics } from "./statistics.js";
import { storage } from "./store.js";
import { switchTheme } from "./theme.js";
import { Tiles } from "./tiles.js";
import { loadTools } from "./tools.js";

/** @returns what all parts of the page share */
function createApp() {
  const events = new Events();
  const url = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/ws`;
  const connection = new Connection(url);
  return {
    el,
    storage,
    notify,
    connection,
    role: "view",
    graph: null,
    selected: "", // the node whose tile is selected
    statistics: new Statistics(),
    tiles: /** @type {Tiles} */ (null),
    panels: /** @type {Panels} */ (null),
    /** "graph", "role", "state" of the connection, and "selected" */
    on: (kind, callback) => events.on(kind, callback),
    /** @param {string} node */
    select(node) {
      if (node === this.selected) return;
      this.selected = node;
      events.emit("selected", node);
    },
    emit: (kind, data) => events.emit(kind, data),
  };
}

/** @typedef {ReturnType<typeof createApp>} App */

/** @param {App} app */
function follow(app) {
  const { connection } = app;
  connection.on("hello", (hello) => {
    if (hello.role !== app.role) {
      app.role = hello.role;
      document.body.dataset.role = hello.role;
      app.emit("role", app.role);
    }
    app.emit("hello", hello);
  });
  connection.on("state", (state) => {
    app.emit("state", state);
    if (state === "open")
      connection.request("graph").catch((error) => notify(error.message, "bad"));
  });
  connection.on("graph", (graph) => {
    app.graph = graph;
    app.emit("graph", graph);
  });
  connection.on("statuses", (statuses) => {
    for (const node of app.graph.nodes) node.status = statuses[node.name] ?? null;
    app.emit("graph", app.graph);
  });
}

async function main() {
  const app = createApp();
  /** @type {any} */ (window).robotVision = app;
  document.body.dataset.frames = "0";
  app.tiles = new Tiles(app);
  app.panels = new Panels(app);
  makeHeader(app);
  watchConnection(app);
  follow(app);
  app.connection.connect();
  for (const tool of await loadTools()) {
    app.panels.add(tool);
    if (tool.idle) app.tiles.setIdleTool(tool.idle(app));
  }
  app.panels.refresh();
  const open = storage.get("panel", "");
  if (app.panels.tabs.has(open) && matchMedia("(min-width: 700px)").matches) app.panels.open(open);
  shortcut("t", "Dark or light", switchTheme);
  shortcut(
    "Escape",
    "Back: shrink the image, close the panel",
    () => app.tiles.enlarge(null) || app.panels.close(), // which takes its tool with it
  );
  listenToKeys();
}

main();
