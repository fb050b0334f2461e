/** Menus that open at a button. */

import { el } from "./dom.js";

/**
 * @typedef {Object} Item
 * @property {string} text
 * @property {string} [note] in dim letters behind it
 * @property {boolean} [checked] it is a switch, and this is how it is set
 * @property {boolean} [disabled]
 * @property {() => void} [run] without, it is a heading
 */

let open = null;

/** Closes the menu that is open. */
export function closeMenu() {
  open?.close();
}

/** Puts the menu below its button, or above where there is no room. */
function place(menu, anchor) {
  const at = anchor.getBoundingClientRect();
  const { offsetWidth: width, offsetHeight: height } = menu;
  const left = Math.max(8, Math.min(at.right - width, innerWidth - width - 8));
  const below = at.bottom + 4 + height <= innerHeight - 8;
  menu.style.left = `${left}px`;
  menu.style.top = `${below ? at.bottom + 4 : Math.max(8, at.top - height - 4)}px`;
}

/** @param {Item} item */
function makeItem(item, close) {
  if (!item.run) return el("div", { class: "menu-title" }, item.text);
  const kind = item.checked === undefined ? {} : { "aria-checked": String(item.checked) };
  return el(
    "button",
    {
      type: "button",
      class: "menu-item",
      role: item.checked === undefined ? "menuitem" : "menuitemcheckbox",
      ...kind,
      disabled: item.disabled,
      onclick: () => {
        close();
        item.run();
      },
    },
    el("span", { class: "ellipsis" }, item.text),
    item.note && el("span", { class: "dim note" }, item.note),
  );
}

function moveFocus(event, menu) {
  const items = [...menu.querySelectorAll("button:not(:disabled, [hidden])")];
  const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
  if (!step || !items.length) return;
  event.preventDefault();
  const at = items.indexOf(document.activeElement);
  items[(at < 0 && step < 0 ? items.length - 1 : at + step + items.length) % items.length].focus();
}

/**
 * @param {HTMLElement} anchor
 * @param {Item[]} items
 * @param {{filter?: string, label: string}} options filter: a field above the items that looks
 *   for text in them
 */
export function showMenu(anchor, items, { filter = "", label }) {
  const again = open?.anchor === anchor;
  closeMenu();
  if (again) return;
  const menu = el("div", { class: "menu", role: "menu", "aria-label": label, "data-test": "menu" });
  const outside = (event) =>
    !menu.contains(event.target) && !anchor.contains(event.target) && close();
  const close = () => {
    menu.remove();
    document.removeEventListener("pointerdown", outside, true);
    open = null;
    anchor.focus?.({ preventScroll: true });
  };
  const buttons = items.map((item) => makeItem(item, close));
  if (filter) {
    const none = el("div", { class: "menu-title", hidden: true }, "Nothing fits.");
    const find = (event) => {
      const word = event.target.value.toLowerCase();
      buttons.forEach(
        (button) => (button.hidden = !button.textContent.toLowerCase().includes(word)),
      );
      none.hidden = buttons.some((button) => !button.hidden);
    };
    menu.append(
      el("input", { type: "search", placeholder: filter, "aria-label": filter, oninput: find }),
      none,
    );
  }
  menu.append(el("div", { class: "menu-items" }, buttons));
  menu.addEventListener("keydown", (event) => {
    if (event.key === "Escape") {
      event.stopPropagation();
      close();
    }
    moveFocus(event, menu);
  });
  document.body.append(menu);
  document.addEventListener("pointerdown", outside, true);
  place(menu, anchor);
  open = { anchor, close };
  menu.querySelector("input, button:not(:disabled)")?.focus({ preventScroll: true });
}
