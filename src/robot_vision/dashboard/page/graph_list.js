/** The graph as a list of nodes with their topics, for small screens. */

import { el } from "./dom.js";

/**
 * @param {import("./graph_drawing.js").Shown} what
 * @returns {HTMLElement}
 */
export function listGraph({ topics, rates, levelOf, choose }) {
  const line = (id, ...children) => {
    const attributes = { type: "button", class: "graph-line", "data-id": id };
    return el("button", { ...attributes, onclick: () => choose(id) }, children);
  };
  const topicLine = (sign, { name }) =>
    line(
      "t" + name,
      el("span", { class: "dim" }, sign),
      el("span", { class: "ellipsis grow" }, name),
      el("span", { class: "dim" }, rates.get(name)),
    );
  const nodes = new Set(topics.flatMap((topic) => [...topic.publishers, ...topic.subscribers]));
  const items = [...nodes].sort().map((node) => {
    const dot = el("span", { class: `state-dot ${levelOf(node)}` });
    const inputs = topics.filter(({ subscribers }) => subscribers.includes(node));
    const outputs = topics.filter(({ publishers }) => publishers.includes(node));
    return el(
      "li",
      {},
      line("n" + node, dot, el("strong", { class: "ellipsis" }, node)),
      inputs.map((topic) => topicLine("←", topic)),
      outputs.map((topic) => topicLine("→", topic)),
    );
  });
  return el("ul", { class: "list" }, items);
}
