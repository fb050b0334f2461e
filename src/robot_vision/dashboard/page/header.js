/** The line above everything: name, connection, role, and what concerns the whole page. */

import { el, iconButton, setText } from "./dom.js";
import { ICONS } from "./icons.js";
import { showHelp } from "./keys.js";
import { switchTheme } from "./theme.js";

const STATES = {
  connecting: ["connecting", "warn"],
  open: ["connected", "good"],
  closed: ["no connection", "bad"],
};

/** @param {any} app */
export function makeHeader(app) {
  const state = el("span", { class: "badge", "data-test": "state" });
  const role = el("span", { class: "badge", "data-test": "role" });
  const name = el("span", { class: "dim ellipsis", id: "server-name" }, location.host);
  const showState = () => {
    const [text, kind] = STATES[app.connection.state];
    setText(state, text);
    state.className = `badge dot ${kind}`;
  };
  const showRole = () => {
    setText(role, app.role === "control" ? "control" : "view only");
    role.title =
      app.role === "control"
        ? "You can change parameters and use all tools."
        : "You can see everything. To change something, open the address with the other token.";
  };
  app.on("state", showState);
  app.on("role", showRole);
  app.on("hello", (hello) => setText(name, `${location.host} ${hello.node}`));
  showState();
  showRole();
  document.getElementById("header").append(
    el("img", { src: "/page/icon.svg", alt: "", width: 26, height: 26 }),
    el("h1", {}, "robot_vision"),
    name,
    state,
    role,
    el("span", { class: "grow" }),
    iconButton(
      ICONS.add,
      "Add an image topic (a)",
      (event) => app.tiles.showPicker(event.currentTarget),
      { "data-test": "add-image" },
    ),
    iconButton(
      ICONS.layout,
      "Arrangement of the images",
      (event) => app.tiles.showMenu(event.currentTarget),
      { "data-test": "layout-menu" },
    ),
    iconButton(ICONS.sun, "Dark or light (t)", switchTheme, { "data-test": "theme" }),
    iconButton(ICONS.help, "Keyboard shortcuts (?)", showHelp, {
      class: "icon-button wide-only",
      "data-test": "help",
    }),
  );
}
