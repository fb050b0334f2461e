/** Where nodes and topics are in the drawing of the graph. Nothing here knows the page. */

/** Topics that every node has, and that tell nothing about what it does with images. */
const DULL =
  /^\/(rosout|rosout_agg|clock|diagnostics)$|\/(parameter_descriptions|parameter_updates|bond)$/;
/** The same images again, for subscribers elsewhere. */
const TRANSPORT = /\/(compressed|compressedDepth|theora|zstd|rvl|shm|h264)$/;
const SWEEPS = 6;

/**
 * @typedef {Object} Item
 * @property {string} id "n" or "t", and the name
 * @property {"node"|"topic"} kind
 * @property {string} name
 * @property {number} layer from 0, at the left
 * @property {number} place in its layer, from 0, at the top
 * @property {string} [text] as it is drawn, see graph_drawing.js
 * @property {number} [width] px, of its box
 * @property {number} [x] px, of its left edge
 * @property {number} [y] px, of its middle
 */

/**
 * Those topics that are drawn.
 * @param {any[]} topics of the graph
 * @param {boolean} all
 * @param {string} [own] the dashboard's node: what it listens to is what somebody looks at
 */
export function shownTopics(topics, all, own = "") {
  if (all) return topics;
  const others = (names) => names.filter((name) => name !== own);
  const known = topics.map((topic) => ({
    ...topic,
    publishers: others(topic.publishers),
    subscribers: others(topic.subscribers),
  }));
  return known.filter(
    ({ name, publishers, subscribers }) =>
      publishers.length && subscribers.length && !DULL.test(name) && !TRANSPORT.test(name),
  );
}

/**
 * @param {any[]} topics those that are shown
 * @param {string[]} nodes all names
 * @param {boolean} all nodes that no shown topic has, too
 * @returns {{items: Item[], edges: [string, string][]}}
 */
export function layoutGraph(topics, nodes, all) {
  /** @type {[string, string][]} */
  const edges = [];
  for (const { name, publishers, subscribers } of topics) {
    for (const node of publishers) edges.push(["n" + node, "t" + name]);
    for (const node of subscribers) edges.push(["t" + name, "n" + node]);
  }
  const ids = new Set([...topics.map(({ name }) => "t" + name), ...edges.flat()]);
  if (all) for (const node of nodes) ids.add("n" + node);
  const layers = layersOf([...ids], edges);
  const rows = [];
  for (const id of [...ids].sort()) (rows[layers.get(id)] ||= []).push(id);
  const columns = rows.filter(Boolean);
  orderRows(columns, edges);
  const items = columns.flatMap((column, layer) =>
    column.map((id, place) => ({
      id,
      kind: /** @type {"node"|"topic"} */ (id[0] === "n" ? "node" : "topic"),
      name: id.slice(1),
      layer,
      place,
    })),
  );
  return { items, edges };
}

/**
 * The longest way to each from those that nothing leads to; edges that close a circle do not count.
 */
function layersOf(ids, edges) {
  const next = new Map(ids.map((id) => [id, []]));
  for (const [from, to] of edges) next.get(from).push(to);
  const targets = new Set(edges.map(([, to]) => to));
  const state = new Map(); // 1: on the way, 2: done
  /** @type {string[]} each before all it leads to, but for circles */
  const order = [];
  const back = new Set();
  const visit = (start) => {
    const stack = [[start, 0]];
    state.set(start, 1);
    while (stack.length) {
      const top = stack[stack.length - 1];
      const [id, at] = /** @type {[string, number]} */ (top);
      const to = next.get(id)[at];
      top[1] = at + 1;
      if (to === undefined) {
        state.set(id, 2);
        order.unshift(id);
        stack.pop();
      } else if (state.get(to) === 1) {
        back.add(id + "\n" + to);
      } else if (!state.has(to)) {
        state.set(to, 1);
        stack.push([to, 0]);
      }
    }
  };
  for (const id of [...ids].sort((a, b) => Number(targets.has(a)) - Number(targets.has(b))))
    if (!state.has(id)) visit(id);
  const layers = new Map(ids.map((id) => [id, 0]));
  for (const id of order) {
    for (const to of next.get(id)) {
      if (!back.has(id + "\n" + to)) layers.set(to, Math.max(layers.get(to), layers.get(id) + 1));
    }
  }
  return layers;
}

/** Puts each beside what it is connected to, so that few lines cross. */
function orderRows(columns, edges) {
  const around = new Map();
  const connect = (a, b) => (around.get(a) || around.set(a, []).get(a)).push(b);
  for (const [from, to] of edges) {
    connect(from, to);
    connect(to, from);
  }
  const place = new Map();
  const note = (column) =>
    column.forEach((id, index) => place.set(id, (index + 0.5) / column.length));
  columns.forEach(note);
  for (let sweep = 0; sweep < SWEEPS; ++sweep) {
    for (const column of sweep % 2 ? [...columns].reverse() : columns) {
      const mean = new Map(
        column.map((id) => {
          const others = around.get(id) || [];
          return [
            id,
            others.length
              ? others.reduce((sum, other) => sum + place.get(other), 0) / others.length
              : place.get(id),
          ];
        }),
      );
      column.sort((a, b) => mean.get(a) - mean.get(b));
      note(column);
    }
  }
}
