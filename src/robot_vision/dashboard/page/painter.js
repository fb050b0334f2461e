/** Drawing at the pace of the screen: what asks for it is drawn once before the next frame. */

/** @type {Set<{paint: (now: number) => void}>} */
let waiting = new Set();
/** @type {(() => void)[]} */
let callbacks = [];
let requested = false;

function paintAll() {
  requested = false;
  const views = waiting;
  const done = callbacks;
  waiting = new Set();
  callbacks = [];
  const now = performance.now();
  for (const view of views) {
    try {
      view.paint(now);
    } catch (error) {
      console.error(error);
    }
  }
  for (const callback of done) callback();
}

function request() {
  if (requested) return;
  requested = true;
  requestAnimationFrame(paintAll);
}

/** @param {{paint: (now: number) => void}} view */
export function requestPaint(view) {
  waiting.add(view);
  request();
}

/** @returns {Promise<void>} when all that has asked for it until now is drawn */
export function afterPaint() {
  return new Promise((resolve) => {
    callbacks.push(() => resolve());
    request();
  });
}
