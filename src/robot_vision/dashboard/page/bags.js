/** Recording: what is recorded into a bag, and the bags that are there. */

import { ask } from "./asking.js";
import { BagForm } from "./bag_form.js";
import { isWhole, sizeText, timeText } from "./bag_offers.js";
import { bagRow, unfinishedRow } from "./bag_rows.js";
import { el, setText } from "./dom.js";

class BagsPanel {
  constructor(element, app) {
    this.app = app;
    this.controls = app.role === "control";
    this.closed = false;
    this.liveName = "";
    this.live = el("div", { class: "stack card recording", "data-test": "recording" });
    this.form = new BagForm(app, (fields) =>
      this.ask("bag_record", fields, (status) => this.showRecording(status)),
    );
    this.folder = el("p", { class: "dim small-text", "data-test": "bag-folder" });
    this.bags = el("ul", { class: "list", "data-test": "bags" });
    const parts = [this.live, this.form.element, el("h3", {}, "Bags"), this.bags, this.folder];
    element.append(el("div", { class: "stack" }, parts));
    this.offs = [
      app.on("graph", () => this.form.show()),
      app.connection.on("recording", (status) => this.onRecording(status)),
      app.connection.on("bags", () => this.list()),
    ];
    this.showRecording(null);
    this.offs.push(app.connection.whenOpen(() => this.list()));
  }

  onRecording(status) {
    this.showRecording(status.active ? status : null);
    if (status.active) return;
    this.app.notify(`${status.name}: ${status.state}`, isWhole(status.state) ? "good" : "bad");
    this.list();
  }

  /** @param {any} status null: nothing is being recorded */
  showRecording(status) {
    this.live.hidden = !status;
    this.form.element.hidden = Boolean(status) || !this.controls;
    if (!status) {
      this.liveName = "";
      return;
    }
    if (this.liveName !== status.name) this.buildLive(status);
    const { text, counts, meter, words } = this.parts;
    const messages = status.messages === null ? "" : `, ${status.messages} messages`;
    setText(text, `${timeText(status.seconds)}, ${sizeText(status.size)}${messages}`);
    setText(words, status.state);
    words.classList.toggle("warn", status.state !== "recording");
    meter.style.width = `${Math.min(100, (100 * status.size) / status.max_size)}%`;
    for (const { name, count } of status.topics) setText(counts.get(name), String(count ?? ""));
  }

  buildLive({ name, topics }) {
    this.liveName = name;
    const text = el("span", { class: "grow", "data-test": "recording-numbers" });
    const words = el("span", { class: "badge", "data-test": "recording-state" });
    const meter = el("div");
    const counts = new Map(topics.map((topic) => [topic.name, el("span", { class: "mono" })]));
    const stop = el("button", { type: "button", class: "button primary", "data-test": "bag-stop" });
    stop.append("Stop");
    stop.hidden = !this.controls;
    stop.onclick = async () => {
      stop.disabled = true;
      await this.ask("bag_stop", {});
      stop.disabled = false;
    };
    this.parts = { text, counts, meter, words };
    const dot = el("span", { class: "rec-dot", "aria-hidden": "true" });
    const rows = [...counts].map(([topic, count]) =>
      el("div", { class: "row tight" }, el("span", { class: "ellipsis grow dim" }, topic), count),
    );
    this.live.replaceChildren(
      el("div", { class: "row" }, dot, el("strong", { class: "ellipsis grow" }, name), words),
      el("div", { class: "row" }, text, stop),
      el("div", { class: "meter" }, meter),
      el("div", { class: "small-text" }, rows),
    );
  }

  list() {
    return this.ask("bags", {}, (listed) => {
      this.form.setLimit(listed.max_megabytes);
      this.showRecording(listed.recording);
      setText(this.folder, `${listed.folder}, ${sizeText(listed.free)} free`);
      const remove = this.controls
        ? (name, unfinished) => this.remove(name, unfinished)
        : undefined;
      const rows = [
        ...listed.unfinished.map((name) => unfinishedRow(name, remove)),
        ...listed.bags.map((bag) => bagRow(bag, remove)),
      ];
      const nothing = { class: "dim", "data-test": "no-bags" };
      if (!rows.length) rows.push(el("li", nothing, "Nothing has been recorded yet."));
      this.bags.replaceChildren(...rows);
    });
  }

  remove(name, unfinished) {
    const told = () => this.app.notify(`${name} is deleted`, "good");
    return this.ask("bag_delete", { name, unfinished }, told);
  }

  ask(op, fields, then) {
    return ask(this, op, fields, then);
  }

  close() {
    this.closed = true;
    for (const off of this.offs) off();
  }
}

/** @type {import("./tools.js").Tool} */
export const tool = {
  name: "bags",
  title: "Record",
  icon: "M12 4a8 8 0 1 0 0 16 8 8 0 0 0 0-16zM12 9a3 3 0 1 0 0 6 3 3 0 0 0 0-6z",
  available: () => true,
  open: (element, app) => {
    const panel = new BagsPanel(element, app);
    return () => panel.close();
  },
};
