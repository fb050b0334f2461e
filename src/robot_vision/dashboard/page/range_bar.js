/** A slider with two ends, for the limits of a channel; those of a hue may go around the circle. */

const LARGE_STEP = 10; // of the keys Page Up and Page Down

const STEPS = {
  ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -LARGE_STEP,
  PageUp: LARGE_STEP, Home: -Infinity, End: Infinity,
};

/**
 * @param {object} app
 * @param {{name: string, test: string, highest: number, circular: boolean,
 *   disabled: boolean}} options
 * @param {(low: number, high: number) => void} onChange called with each step
 * @returns {{element: Element, set: (low: number, high: number, background: string) => void}}
 */
export function rangeBar(app, options, onChange) {
  const limits = [0, options.highest];
  const track = app.el("div", { class: "range-track" });
  const fills = [app.el("div", { class: "range-fill" }), app.el("div", { class: "range-fill" })];
  const ends = ["low", "high"].map((which) => endOf(app, options, which));
  const text = app.el("output", { class: "range-text" });
  const bar = app.el("div", { class: "range-bar" }, track, ...fills, ...ends);
  const element = app.el(
    "div", { class: "range", "data-test": `range-${options.test}` },
    app.el("span", { class: "range-name" }, options.name), bar, text,
  );
  const show = () => draw(options, limits, fills, ends, text);
  const move = (end, value) => {
    const moved = clipped(options, limits, end, Math.round(value));
    if (moved === limits[end]) return;
    limits[end] = moved;
    show();
    onChange(limits[0], limits[1]);
  };
  if (!options.disabled) {
    ends.forEach((handle, end) => addKeys(handle, (step) => move(end, limits[end] + step)));
    addPointer(bar, options, limits, ends, move);
  }
  show();
  const set = (low, high, background) => {
    limits.splice(0, 2, low, high);
    track.style.backgroundImage = background;
    show();
  };
  return { element, set };
}

function endOf(app, options, which) {
  return app.el("div", {
    class: "range-end",
    role: "slider",
    tabindex: options.disabled ? "-1" : "0",
    "aria-label": `${options.name}, ${which === "low" ? "lowest" : "highest"}`,
    "aria-valuemin": "0",
    "aria-valuemax": String(options.highest),
    "aria-disabled": String(options.disabled),
    "data-test": `range-${options.test}-${which}`,
  });
}

function clipped(options, limits, end, value) {
  const lowest = end === 1 && !options.circular ? limits[0] : 0;
  const highest = end === 0 && !options.circular ? limits[1] : options.highest;
  return Math.min(Math.max(value, lowest), highest);
}

function draw(options, limits, fills, ends, text) {
  const part = (value) => `${(100 * value) / options.highest}%`;
  const [low, high] = limits;
  const spans = low <= high ? [[low, high], [0, 0]] : [[low, options.highest], [0, high]];
  fills.forEach((fill, index) => {
    fill.style.left = part(spans[index][0]);
    fill.style.width = part(spans[index][1] - spans[index][0]);
  });
  ends.forEach((handle, end) => {
    handle.style.left = part(limits[end]);
    handle.setAttribute("aria-valuenow", String(limits[end]));
  });
  text.textContent = `${low}–${high}`;
}

function addKeys(handle, step) {
  handle.addEventListener("keydown", (event) => {
    if (!(event.key in STEPS)) return;
    event.preventDefault();
    event.stopPropagation();
    step(STEPS[event.key]);
  });
}

/** Pressing on the bar takes the nearer end along. */
function addPointer(bar, options, limits, ends, move) {
  const valueAt = (event) => {
    const box = bar.getBoundingClientRect();
    return (options.highest * (event.clientX - box.left)) / box.width;
  };
  let taken = -1;
  bar.addEventListener("pointerdown", (event) => {
    const value = valueAt(event);
    const [low, high] = limits;
    const nearHigh = low === high ? value > low : Math.abs(value - high) < Math.abs(value - low);
    taken = nearHigh ? 1 : 0;
    bar.setPointerCapture(event.pointerId);
    ends[taken].focus();
    event.preventDefault();
    move(taken, value);
  });
  bar.addEventListener("pointermove", (event) => {
    if (taken >= 0) move(taken, valueAt(event));
  });
  for (const kind of ["pointerup", "pointercancel"]) {
    bar.addEventListener(kind, () => {
      taken = -1;
    });
  }
}
