/** What the page says while it shows no image. */

import { el } from "./dom.js";

const COMMAND = "roslaunch robot_vision demo.launch";

export class EmptyPage {
  /** @param {any} tiles */
  constructor(tiles) {
    this.tiles = tiles;
    this.element = el("div", { class: "empty" });
    this.shown = "";
  }

  /** @returns {[string, string, string]} title, sentence, command */
  texts() {
    const { connection, graph } = this.tiles.app;
    if (connection.state !== "open" || !graph) {
      return ["Connecting ...", "to the dashboard of this robot.", ""];
    }
    if (this.tiles.tiles.size) {
      const text = "The menu of the arrangement, at the top, shows them again.";
      return ["All images are hidden", text, ""];
    }
    const text = "As soon as a camera or a node of robot_vision runs, its image is here.";
    return ["No images yet", text, COMMAND];
  }

  update() {
    this.element.hidden = this.tiles.visible().length > 0;
    const [title, sentence, command] = this.texts();
    if (this.element.hidden || this.shown === title) return;
    this.shown = title;
    const code = command && el("code", {}, command);
    this.element.replaceChildren(el("strong", {}, title), el("span", {}, sentence), code || "");
  }
}
