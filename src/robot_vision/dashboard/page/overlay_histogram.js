/** A histogram as a small chart in the lower left corner. */

const COLORS = {
  blue: "#6ea8ff",
  green: "#3ddc97",
  red: "#ff6b6b",
  gray: "#e8ebf0",
  hue: "#e58fc3",
  saturation: "#ffb000",
  value: "#e8ebf0",
};
const OTHERS = ["#e8ebf0", "#ffb000", "#56b4e9"];

/**
 * The curve of a channel.
 * @param {number[]} counts
 * @param {{x: number, y: number, width: number, height: number}} box
 * @param {number} most the count at the top of the box
 * @returns {{x: number, y: number}[]}
 */
export function histogramCurve(counts, box, most) {
  return counts.map((count, index) => ({
    x: box.x + ((index + 0.5) / counts.length) * box.width,
    y: box.y + box.height * (1 - Math.min(1, count / (most || 1))),
  }));
}

/** @param {import("./overlay_pen.js").Pen} pen */
export function drawHistogram(pen, { region, channels, bins, counts, space }) {
  const { context, unit, size } = pen;
  const whole = region.width === size[0] && region.height === size[1];
  if (region.width && !whole) pen.box(region, "#ffffff", { dashed: true, width: 1 });
  const width = Math.min(240 * unit, 0.6 * size[0]);
  const height = Math.min(100 * unit, 0.4 * size[1]);
  const box = { x: 6 * unit, y: size[1] - height - 6 * unit, width, height };
  context.fillStyle = "rgb(10 13 17 / 75%)";
  context.fillRect(box.x, box.y, width, height);
  const sorted = [...counts].sort((a, b) => b - a);
  // One bin does not flatten all others.
  const most = sorted[Math.min(sorted.length - 1, Math.floor(0.01 * sorted.length))];
  channels.forEach((name, index) => {
    const curve = histogramCurve(counts.slice(index * bins, (index + 1) * bins), box, most);
    const style = { open: true, width: 1.5, origin: 0 };
    pen.polygon(curve, COLORS[name] || OTHERS[index % 3], style);
  });
  pen.label(
    `${space}: ${channels.join(", ")}`,
    { x: box.x, y: box.y + 20 * unit },
    COLORS[channels[0]] || OTHERS[0],
  );
}
