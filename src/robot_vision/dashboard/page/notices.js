/** Short messages at the edge of the page, and the bar that tells of a lost connection. */

import { el, iconButton, setText } from "./dom.js";
import { ICONS } from "./icons.js";

const SHOWN = { info: 5000, good: 4000, bad: 12000 }; // ms
const MAX_NOTICES = 4;

/**
 * @param {string} text
 * @param {"info"|"good"|"bad"} [kind]
 */
export function notify(text, kind = "info") {
  const area = document.getElementById("notices");
  const same = [...area.children].find(
    (notice) => notice.querySelector("span").textContent === text,
  );
  same?.remove();
  const notice = el(
    "div",
    { class: `notice ${kind}`, "data-test": "notice", "data-kind": kind },
    el("span", {}, text),
    iconButton(ICONS.close, "Close", () => notice.remove(), { class: "icon-button small" }),
  );
  area.append(notice);
  while (area.children.length > MAX_NOTICES) area.firstChild.remove();
  let timer = setTimeout(() => notice.remove(), SHOWN[kind]);
  notice.onpointerenter = () => clearTimeout(timer);
  notice.onpointerleave = () => (timer = setTimeout(() => notice.remove(), SHOWN[kind]));
}

/**
 * Why there is no connection. A browser does not tell of a WebSocket; the page's own address does.
 * @returns {Promise<string>}
 */
async function reason() {
  try {
    const { status } = await fetch("/", { redirect: "manual", cache: "no-store" });
    if (status === 401 || status === 403) {
      return "The dashboard asks for its token: open the address that it has printed.";
    }
    return "The dashboard takes no further connection.";
  } catch {
    return "The connection to the dashboard is lost: is it still running?";
  }
}

/**
 * Shows the bar while there is no connection, or the dashboard has none to the master.
 * @param {any} app
 */
export function watchConnection(app) {
  const bar = document.getElementById("bar");
  const text = el("span", { class: "grow" });
  const wait = el("span", { class: "mono" });
  const retry = () => app.connection.retry();
  const button = el("button", { class: "button small", onclick: retry }, "Try now");
  bar.append(text, wait, button);
  app.on("graph", ({ problem }) => {
    bar.hidden = !problem;
    wait.hidden = button.hidden = true;
    setText(text, problem);
  });
  app.connection.on("state", async (state) => {
    document.body.dataset.state = state;
    if (state === "open") bar.hidden = true;
    if (state !== "closed") return;
    if (bar.hidden || button.hidden) setText(text, "The connection to the dashboard is lost.");
    bar.hidden = wait.hidden = button.hidden = false;
    const found = await reason();
    if (app.connection.state !== "open") setText(text, found);
  });
  setInterval(() => {
    const left = (app.connection.nextAttempt - performance.now()) / 1000;
    setText(
      wait,
      app.connection.state === "closed" && left > 0
        ? `again in ${Math.ceil(left)} s`
        : "trying ...",
    );
  }, 250);
}
