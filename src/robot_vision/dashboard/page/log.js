/** What all nodes log. */

import { el, setText } from "./dom.js";
import { ICONS } from "./icons.js";
import { countOf, LEVELS, rowOf } from "./log_rows.js";

const MAX_LINES = 1000;

class LogPanel {
  /** @param {HTMLElement} element @param {any} app */
  constructor(element, app) {
    this.app = app;
    // {entry, row}, the oldest first; an entry is a line, or {left_out}: as many are missing there
    this.entries = [];
    this.paused = [];
    this.isPaused = false;
    this.follows = true;
    const filter = () => this.filter();
    this.level = el(
      "select",
      { "aria-label": "Least level", onchange: filter },
      Object.entries(LEVELS).map(([value, [name]]) => el("option", { value }, name)),
    );
    this.level.value = String(app.storage.get("log_level", 2));
    this.node = el(
      "select",
      { class: "grow", "aria-label": "Node", onchange: filter },
      el("option", { value: "" }, "all nodes"),
    );
    this.text = el("input", {
      type: "search",
      class: "grow",
      placeholder: "Search",
      "aria-label": "Search the log",
      oninput: filter,
    });
    this.pause = el(
      "button",
      {
        type: "button",
        class: "button",
        "aria-pressed": "false",
        onclick: () => this.setPaused(!this.isPaused),
      },
      "Pause",
    );
    this.list = el("div", {
      class: "log",
      role: "log",
      "aria-label": "Log",
      tabindex: 0,
      "data-test": "log",
    });
    this.list.addEventListener("scroll", () => this.scrolled());
    this.newest = el("button", {
      type: "button",
      class: "button small newest",
      hidden: true,
      onclick: () => this.toEnd(),
    });
    this.none = el("div", { class: "empty" }, "Nothing has been logged yet.");
    element.classList.add("filled");
    element.append(
      el("div", { class: "row tight" }, this.level, this.node, this.pause),
      el("div", { class: "row" }, this.text),
      el("div", { class: "log-box" }, this.list, this.none, this.newest),
    );
    this.offs = [
      app.connection.on("log", ({ entries, left_out }) =>
        this.add(left_out ? [{ left_out }, ...entries] : entries),
      ),
      app.connection.whenOpen(() => {
        this.clear();
        app.connection
          .request("log", { level: 1 })
          .catch((error) => app.notify(error.message, "bad"));
      }),
    ];
  }

  add(entries) {
    if (this.isPaused) {
      this.paused.push(...entries);
      const tooMany = this.paused.splice(0, Math.max(0, this.paused.length - MAX_LINES));
      if (tooMany.length) this.paused[0] = { left_out: countOf([...tooMany, this.paused[0]]) };
      setText(this.pause, `Go on (${this.paused.length})`);
      return;
    }
    const fragment = document.createDocumentFragment();
    let unseen = 0;
    for (const entry of entries) {
      const row = rowOf(entry);
      row.hidden = !this.fits(entry);
      if (!row.hidden) unseen += 1;
      fragment.append(row);
      this.entries.push({ entry, row });
      if (entry.node) this.addNode(entry.node);
    }
    this.list.append(fragment);
    this.trim();
    this.none.hidden = this.entries.some(({ row }) => !row.hidden);
    if (this.follows) this.toEnd();
    else if (unseen) this.showUnseen((this.unseen || 0) + unseen);
  }

  /** Forgets the oldest lines; what somebody reads stays where it is. */
  trim() {
    const tooMany = this.entries.splice(0, Math.max(0, this.entries.length - MAX_LINES));
    if (!tooMany.length) return;
    const before = this.list.scrollHeight;
    for (const { row } of tooMany) row.remove();
    if (!this.follows) this.list.scrollTop -= before - this.list.scrollHeight;
  }

  addNode(node) {
    if (![...this.node.options].some((option) => option.value === node)) {
      this.node.append(el("option", { value: node }, node.replace(/^\//, "")));
    }
  }

  fits({ level, node, text, left_out }) {
    if (left_out) return true;
    const word = this.text.value.trim().toLowerCase();
    return (
      level >= Number(this.level.value) &&
      (!this.node.value || node === this.node.value) &&
      (!word || `${node} ${text}`.toLowerCase().includes(word))
    );
  }

  filter() {
    this.app.storage.set("log_level", Number(this.level.value));
    for (const { entry, row } of this.entries) row.hidden = !this.fits(entry);
    const any = this.entries.some(({ row }) => !row.hidden);
    this.none.hidden = any;
    setText(this.none, this.entries.length ? "No line fits." : "Nothing has been logged yet.");
    if (this.follows) this.toEnd();
  }

  scrolled() {
    const { scrollTop, scrollHeight, clientHeight } = this.list;
    this.follows = scrollHeight - scrollTop - clientHeight < 8;
    if (this.follows) this.showUnseen(0);
  }

  showUnseen(count) {
    this.unseen = count;
    this.newest.hidden = !count;
    setText(this.newest, `${count} new below`);
  }

  toEnd() {
    this.list.scrollTop = this.list.scrollHeight;
    this.follows = true;
    this.showUnseen(0);
  }

  setPaused(paused) {
    this.isPaused = paused;
    this.pause.setAttribute("aria-pressed", String(paused));
    setText(this.pause, paused ? "Go on" : "Pause");
    if (!paused) this.add(this.paused.splice(0));
  }

  clear() {
    this.entries = [];
    this.list.replaceChildren();
    this.none.hidden = false;
  }

  close() {
    this.offs.forEach((off) => off());
    this.app.connection.request("close_log").catch(() => {});
  }
}

/** @type {import("./tools.js").Tool} */
export const tool = {
  name: "log",
  title: "Log",
  icon: ICONS.log,
  key: "l",
  wide: true,
  available: () => true,
  open: (element, app) => {
    const panel = new LogPanel(element, app);
    return () => panel.close();
  },
};
