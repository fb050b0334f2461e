/** The calibration of a camera, in four steps: board, views, result, and who gets it. */

import { ask } from "./asking.js";
import { BoardStep } from "./calibration_board.js";
import { cameraStep, resultStep } from "./calibration_result.js";
import { drawCorners, ViewsStep } from "./calibration_views.js";
import { el } from "./dom.js";

const STEPS = ["Board", "Views", "Result", "Camera"];
const [BOARD, VIEWS, RESULT, CAMERA] = [0, 1, 2, 3];

class CalibrationPanel {
  constructor(element, app) {
    this.app = app;
    this.controls = app.role === "control";
    this.state = { topic: "" };
    this.giving = false; // the result, to a camera
    this.shown = ""; // the step, and what its parts were made of
    this.closed = false;
    const items = STEPS.map((name) => el("li", {}, name));
    this.steps = el("ol", { class: "steps" }, items);
    this.body = el("div");
    element.append(el("div", { class: "stack" }, this.steps, this.body));
    this.offs = [
      app.connection.on("calibration", (state) => this.show(state)),
      app.on("graph", () => this.board?.showTopics()),
    ];
    this.show(this.state);
    this.offs.push(app.connection.whenOpen(() => this.look()));
  }

  /** Asks what is known, and is told from now on what changes. */
  look() {
    return this.ask("calibration", {}, (state) => this.show(state));
  }

  /** @param {any} state as the server tells it; topic "": nobody calibrates */
  show(state) {
    if (this.closed) return;
    this.state = state;
    if (!state.result) this.giving = false;
    const step = this.wantedStep();
    const shown = JSON.stringify([step, state.topic, state.settings, state.result]);
    if (shown !== this.shown) this.build(step);
    this.shown = shown;
    this.views?.show(state);
    this.drawCorners();
  }

  wantedStep() {
    if (!this.state.topic) return BOARD;
    if (!this.state.result) return VIEWS;
    return this.giving ? CAMERA : RESULT;
  }

  build(step) {
    [...this.steps.children].forEach((item, index) => {
      item.classList.toggle("done", index < step);
      if (index === step) item.setAttribute("aria-current", "step");
      else item.removeAttribute("aria-current");
    });
    this.board = step === BOARD ? new BoardStep(this) : null;
    this.views = step === VIEWS ? new ViewsStep(this) : null;
    const part = this.board || this.views;
    const element = part ? part.element : (step === RESULT ? resultStep : cameraStep)(this);
    this.body.dataset.test = `calibration-step-${step + 1}`;
    this.body.replaceChildren(element);
  }

  /** @param {boolean} giving */
  give(giving) {
    this.giving = giving;
    this.show(this.state);
  }

  /** A row of buttons, for those who may control. */
  buttons(...buttons) {
    if (this.controls) return el("div", { class: "row" }, buttons);
    return el("p", { class: "dim" }, "This address may look, but not control.");
  }

  button(text, test, onclick, kind = "") {
    const attributes = { type: "button", class: `button ${kind}`, "data-test": test, onclick };
    return el("button", attributes, text);
  }

  stopButton(text = "Stop") {
    return this.button(text, "calibration-stop", () => this.ask("calibration_stop", {}));
  }

  /** Draws the points of the board on the tile that shows these images. */
  drawCorners() {
    const { topic, corners, result, solving } = this.state;
    const wanted = topic && !result && !solving;
    const tile = wanted && this.app.tiles.list().find((one) => one.image === topic);
    if (tile !== this.tile) this.removeCorners?.();
    this.tile = tile;
    if (!tile) return;
    this.removeCorners = this.app.tiles.draw(tile, "calibration", (context, scale) =>
      drawCorners(context, scale, corners),
    );
  }

  ask(op, fields, then) {
    return ask(this, op, fields, then);
  }

  close() {
    this.closed = true;
    for (const off of this.offs) off();
    this.removeCorners?.();
    const { connection } = this.app;
    if (connection.state === "open") connection.request("close_calibration", {}).catch(() => {});
  }
}

/** @type {import("./tools.js").Tool} */
export const tool = {
  name: "calibration",
  title: "Calibrate",
  icon: "M4 4h16v16H4zM4 9.3h16M4 14.7h16M9.3 4v16M14.7 4v16",
  available: () => true,
  open: (element, app) => {
    const panel = new CalibrationPanel(element, app);
    return () => panel.close();
  },
};
