/** The last two steps of a calibration: its result, and the camera that gets it. */

import { MODELS } from "./calibration_board.js";
import { el, setText } from "./dom.js";

const GOOD_ERROR = 0.5; // px

function verdict({ unsure, error }) {
  if (unsure) return ["warn", "Not sure yet"];
  if (error <= GOOD_ERROR) return ["good", "A good calibration"];
  return ["warn", "A large error: is the board flat, and were the counts right?"];
}

/**
 * @param {any} panel
 * @returns {HTMLElement}
 */
export function resultStep(panel) {
  const { topic, views, settings, result } = panel.state;
  const [kind, said] = verdict(result);
  const save = () => saveFile("camera.yaml", result.yaml);
  return el(
    "div",
    { class: "stack" },
    el("p", {}, "See whether the result is as good as you need it, or show more views."),
    el(
      "div",
      { class: "row" },
      el("strong", { class: kind, "data-test": "calibration-verdict" }, said),
      el("span", { class: "badge" }, `error ${result.error.toFixed(3)} px`),
    ),
    result.advice && el("p", { class: "warn" }, result.advice),
    el(
      "pre",
      { class: "card mono lines", "data-test": "calibration-lines" },
      result.lines.join("\n"),
    ),
    panel.buttons(
      panel.button("Give it to the camera", "calibration-next", () => panel.give(true), "primary"),
      panel.button("More views", "calibration-more", () => panel.ask("calibration_more", {})),
      result.yaml && panel.button("Save as a file", "calibration-file", save),
      panel.stopButton(),
    ),
    el("p", { class: "dim small-text" }, `${topic}, ${views} views, ${MODELS[settings.model]}`),
  );
}

/**
 * @param {any} panel
 * @returns {HTMLElement}
 */
export function cameraStep(panel) {
  const { topic } = panel.state;
  const value = topic.slice(0, topic.lastIndexOf("/"));
  const node = el("input", { maxlength: 255, value, "data-test": "calibration-node" });
  const answer = el("p", { role: "status", "data-test": "calibration-answer" });
  const say = (text, kind) => {
    setText(answer, text);
    answer.className = kind;
  };
  const give = async () => {
    say(`Asking ${node.value || `the camera of ${topic}`} ...`, "dim");
    try {
      const fields = { node: node.value };
      const { message } = await panel.app.connection.request("calibration_commit", fields);
      say(`${message}, and will have it after its next start, too.`, "good");
    } catch (error) {
      say(error.message, "bad");
    }
  };
  return el(
    "div",
    { class: "stack" },
    el("p", {}, "Give the result to the camera node, which keeps it."),
    el("label", { class: "field" }, el("span", {}, "Camera node"), node),
    panel.buttons(
      panel.button("Give it to the camera", "calibration-commit", give, "primary"),
      panel.button("Back", "calibration-back", () => panel.give(false)),
      panel.stopButton("Done"),
    ),
    answer,
  );
}

function saveFile(name, text) {
  const url = URL.createObjectURL(new Blob([text], { type: "text/yaml" }));
  el("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}
