/** Letting go of a camera, and taking it again. */

const WORDS = { start: "Start the camera", stop: "Stop the camera" };

/**
 * The items of a tile's menu that do it; none if its node is no camera that can.
 * @param {any} app
 * @param {string} name of the node
 * @returns {import("./menu.js").Item[]}
 */
export function captureItems(app, name) {
  const node = (app.graph?.nodes || []).find((one) => one.name === name);
  const has = (word) => node?.services.includes(`${name}/${word}_capture`);
  const can = Object.keys(WORDS).filter(has);
  return can.map((word) => ({
    text: WORDS[word],
    disabled: app.role !== "control",
    run: () =>
      app.connection.request("capture", { node: name, start: word === "start" }).then(
        ({ message }) => app.notify(message, "good"),
        (error) => app.notify(error.message, "bad"),
      ),
  }));
}
