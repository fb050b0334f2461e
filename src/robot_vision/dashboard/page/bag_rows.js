/** The bags that are there: what is in each, and what can be done with it. */

import { sizeText, timeText } from "./bag_offers.js";
import { el } from "./dom.js";
import { isSimulated } from "./stamps.js";

/**
 * @param {any} bag
 * @param {(name: string, unfinished: boolean) => Promise<void>} [remove] none: one only looks
 * @returns {HTMLElement}
 */
export function bagRow(bag, remove) {
  const when = new Date((isSimulated(bag.start) ? bag.changed : bag.start) * 1000);
  const date = when.toLocaleString([], { dateStyle: "medium", timeStyle: "short" });
  const what = [sizeText(bag.size), bag.topics || bag.duration ? timeText(bag.duration) : "", date];
  const row = el(
    "li",
    { class: "stack tight-stack", "data-test": "bag", "data-name": bag.name },
    el("strong", { class: "ellipsis", title: bag.name }, bag.name),
    el("span", { class: "dim small-text" }, what.filter(Boolean).join(", ")),
    bag.topics ? topicList(bag.topics) : el("span", { class: "warn small-text" }, bag.problem),
  );
  if (!remove) return row;
  const href = `/bags/${encodeURIComponent(bag.name)}`;
  const load = { class: "button small", href, download: bag.name, "data-test": "bag-download" };
  row.append(buttons(() => remove(bag.name, false), el("a", load, "Download")));
  return row;
}

/**
 * @param {string} name of a bag that was not finished
 * @param {(name: string, unfinished: boolean) => Promise<void>} [remove]
 * @returns {HTMLElement}
 */
export function unfinishedRow(name, remove) {
  const file = `${name}.active`;
  return el(
    "li",
    { class: "stack tight-stack", "data-test": "unfinished-bag", "data-name": name },
    el("strong", { class: "ellipsis" }, file),
    el(
      "span",
      { class: "warn small-text" },
      "Its recording was not finished. Make a bag of it with ",
      el("code", {}, `rosbag reindex ${file}`),
    ),
    remove && buttons(() => remove(name, true)),
  );
}

function topicList(topics) {
  return el(
    "details",
    { class: "small-text" },
    el("summary", {}, `${topics.length} ${topics.length === 1 ? "topic" : "topics"}`),
    topics.map(({ name, type, count }) =>
      el(
        "div",
        { class: "row tight", title: type },
        el("span", { class: "ellipsis grow" }, name),
        el("span", { class: "mono" }, String(count)),
      ),
    ),
  );
}

/** Buttons of a bag; deleting asks first. */
function buttons(remove, ...first) {
  const row = el("div", { class: "row" });
  const button = (text, test, kind, onclick) =>
    el(
      "button",
      { type: "button", class: `button small ${kind}`, "data-test": test, onclick },
      text,
    );
  const rest = () => row.replaceChildren(...first, button("Delete", "bag-delete", "danger", ask));
  const ask = () => {
    const keep = button("Keep", "bag-keep", "", rest);
    row.replaceChildren(
      el("span", { class: "grow" }, "Delete it for good?"),
      button("Delete", "bag-delete-sure", "danger", () => remove().then(rest)),
      keep,
    );
    keep.focus();
  };
  rest();
  return row;
}
