/**
 * The panel beside the images, and the rail of tabs that opens it. On a phone it is a sheet from
 * below.
 */

import { el, icon, iconButton, setText } from "./dom.js";
import { ICONS } from "./icons.js";
import { shortcut } from "./keys.js";

export class Panels {
  /** @param {any} app */
  constructor(app) {
    this.app = app;
    this.rail = document.getElementById("rail");
    this.panel = document.getElementById("panel");
    this.title = el("h2", { class: "grow ellipsis" });
    this.body = el("div", { class: "panel-body", id: "panel-body" });
    this.wideButton = iconButton(ICONS.wide, "Wider or narrower", () =>
      this.setWide(!this.isWide()),
    );
    this.panel.append(
      el(
        "div",
        { class: "panel-head" },
        this.title,
        this.wideButton,
        iconButton(ICONS.close, "Close the panel", () => this.close(), {
          "data-test": "close-panel",
        }),
      ),
      this.body,
    );
    /** @type {Map<string, {tool: import("./tools.js").Tool, button: HTMLElement}>} */
    this.tabs = new Map();
    this.current = "";
    this.usable = false; // whether the open tool was available when it was opened
    this.closeTool = null;
    app.on("graph", () => this.refresh());
    app.on("role", () => this.reopen());
  }

  /** @param {import("./tools.js").Tool} tool */
  add(tool) {
    const button = el(
      "button",
      {
        type: "button",
        class: "tab",
        title: tool.key ? `${tool.title} (${tool.key})` : tool.title,
        "aria-expanded": "false",
        "aria-controls": "panel-body",
        "data-test": "tool-" + tool.name,
        onclick: () => this.toggle(tool.name),
      },
      icon(tool.icon),
      el("span", {}, tool.title),
    );
    this.rail.append(button);
    this.tabs.set(tool.name, { tool, button });
    if (tool.key) shortcut(tool.key, tool.title, () => this.toggle(tool.name));
  }

  isAvailable(tool) {
    try {
      return Boolean(tool.available(this.app));
    } catch {
      return false; // it looks at a graph that is not there yet
    }
  }

  refresh() {
    for (const { tool, button } of this.tabs.values()) {
      button.classList.toggle("unavailable", !this.isAvailable(tool));
    }
    const tab = this.tabs.get(this.current);
    if (tab && !this.usable && this.isAvailable(tab.tool)) this.reopen();
  }

  toggle(name) {
    if (this.current === name) this.close();
    else this.open(name);
  }

  /** @param {string} name */
  open(name) {
    this.stop();
    const { tool, button } = this.tabs.get(name);
    this.current = name;
    this.app.storage.set("panel", name);
    button.setAttribute("aria-expanded", "true");
    setText(this.title, tool.title);
    this.panel.hidden = false;
    this.panel.dataset.tool = name;
    this.setWide(this.app.storage.get("wide." + name, Boolean(tool.wide)));
    this.usable = this.isAvailable(tool);
    if (!this.usable) {
      this.body.append(
        el(
          "div",
          { class: "empty" },
          el("strong", {}, "Nothing here works with this yet."),
          el("span", {}, tool.missing || "It appears as soon as a node for it runs."),
        ),
      );
      return;
    }
    try {
      this.closeTool = tool.open(this.body, this.app);
    } catch (error) {
      console.error(error);
      this.body.replaceChildren(
        el("div", { class: "empty" }, "This panel has an error: " + error.message),
      );
    }
  }

  reopen() {
    if (this.current) this.open(this.current);
  }

  stop() {
    const close = this.closeTool;
    this.closeTool = null;
    try {
      close?.();
    } catch (error) {
      console.error(error);
    }
    this.app.tiles.setTool(null);
    this.body = el("div", { class: "panel-body", id: "panel-body" });
    this.panel.lastElementChild.replaceWith(this.body);
    this.tabs.get(this.current)?.button.setAttribute("aria-expanded", "false");
  }

  close() {
    if (!this.current) return false;
    this.stop();
    const { button } = this.tabs.get(this.current);
    this.current = "";
    this.app.storage.set("panel", "");
    this.panel.hidden = true;
    if (this.panel.contains(document.activeElement) || document.activeElement === document.body)
      button.focus();
    return true;
  }

  isWide() {
    return document.body.classList.contains("wide");
  }

  setWide(wide) {
    document.body.classList.toggle("wide", wide);
    this.app.storage.set("wide." + this.current, wide);
  }
}
