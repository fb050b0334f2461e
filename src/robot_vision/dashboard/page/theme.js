/** Dark or light: as the system has it, until somebody switches. */

import { storage } from "./store.js";

const light = matchMedia("(prefers-color-scheme: light)");

/** @returns {"dark"|"light"} what is shown */
export function theme() {
  const chosen = storage.get("theme", "");
  return chosen === "dark" || chosen === "light" ? chosen : light.matches ? "light" : "dark";
}

function show() {
  document.documentElement.dataset.theme = theme();
}

/** Switches to the other one, and back to the system's choice where both are the same. */
export function switchTheme() {
  const other = theme() === "dark" ? "light" : "dark";
  storage.set("theme", (other === "light") === light.matches ? null : other);
  show();
}

light.addEventListener("change", show);
show();
