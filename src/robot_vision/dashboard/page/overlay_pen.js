/**
 * Lines, marks and words over an image: of the same width at any zoom, and legible on any image.
 */

import { freePlace } from "./label_places.js";

/**
 * Okabe and Ito's colors, which people of all kinds of color vision can tell apart; the darkest are
 * made lighter.
 */
export const PALETTE = [
  "#56b4e9",
  "#ffb000",
  "#3ddc97",
  "#ff7f50",
  "#f0e442",
  "#e58fc3",
  "#8fa8ff",
  "#c8f169",
];
export const GOOD = "#3ddc97";
export const BAD = "#ff6b6b";
export const CASING = "rgb(0 0 0 / 55%)";
const BOX = "rgb(10 13 17 / 80%)";
const FONT = '600 12px system-ui, "Segoe UI", Roboto, "Noto Sans", sans-serif';
const MAX_TEXT = 60; // characters
// Px: points of messages are counted from the middle of the first pixel, boxes from its corner.
const CENTER = 0.5;

/**
 * The same color for the same thing.
 * @param {string} label
 * @param {number} [id] of what is followed; -1: it is not
 */
export function colorOf(label, id = -1) {
  if (id >= 0) return PALETTE[id % PALETTE.length];
  let hash = 7;
  for (const character of label) hash = (hash * 31 + character.codePointAt(0)) % 65521;
  return PALETTE[hash % PALETTE.length];
}

/**
 * @param {any} value a number of a message; JSON has no NaN
 * @param {number} [digits]
 */
export function number(value, digits = 0) {
  return Number.isFinite(value) ? value.toFixed(digits) : "–";
}

export class Pen {
  /**
   * @param {CanvasRenderingContext2D} context its unit is a pixel of the image
   * @param {{scale: number, ratio: number, size: [number, number]}} view px of the canvas for one
   *   of the image, and for
   *   one of CSS; px of the image
   */
  constructor(context, { scale, ratio, size }) {
    this.context = context;
    this.size = size;
    this.unit = ratio / scale; // px of the image for one of CSS
    this.words = 0; // lines in the corner
    /** @type {{text: string, color: string, left: number, top: number}[]} */
    this.labels = [];
    context.lineJoin = "round";
    context.lineCap = "round";
  }

  /**
   * Strokes the path that `make` makes, with a dark rim.
   * @param {string} color
   * @param {(context: CanvasRenderingContext2D) => void} make
   * @param {{width?: number, dashed?: boolean, fill?: boolean, origin?: number}} [style] width in
   *   CSS px; origin: px from the image's corner that the path is counted from, both ways
   */
  stroke(color, make, { width = 2, dashed = false, fill = false, origin = CENTER } = {}) {
    const { context, unit } = this;
    context.beginPath();
    context.translate(origin, origin);
    make(context);
    context.translate(-origin, -origin);
    if (fill) {
      context.fillStyle = color;
      context.globalAlpha = 0.18;
      context.fill();
      context.globalAlpha = 1;
    }
    context.setLineDash(dashed ? [5 * unit, 5 * unit] : []);
    context.lineWidth = (width + 2) * unit;
    context.strokeStyle = CASING;
    context.stroke();
    context.lineWidth = width * unit;
    context.strokeStyle = color;
    context.stroke();
    context.setLineDash([]);
  }

  box({ x_offset: x, y_offset: y, width, height }, color, style) {
    const make = (context) => context.rect(x, y, width, height);
    this.stroke(color, make, { ...style, origin: 0 });
  }

  /** @param {{x: number, y: number}[]} points */
  polygon(points, color, style = {}) {
    if (points.length < 2) return;
    this.stroke(
      color,
      (context) => {
        points.forEach(({ x, y }) => context.lineTo(x, y));
        if (!style.open) context.closePath();
      },
      style,
    );
  }

  circle({ x, y }, radius, color, style) {
    this.stroke(color, (context) => context.arc(x, y, Math.max(radius, 0), 0, 2 * Math.PI), style);
  }

  /**
   * All points in one go.
   * @param {{x: number, y: number}[]} points
   * @param {number} [radius] CSS px
   * @param {number} [origin] see stroke
   */
  dots(points, color, radius = 2.5, origin = CENTER) {
    const { context, unit } = this;
    for (const [fill, size] of [
      [CASING, radius + 1],
      [color, radius],
    ]) {
      context.beginPath();
      for (const point of points) {
        const [x, y] = [point.x + origin, point.y + origin];
        context.moveTo(x + size * unit, y);
        context.arc(x, y, size * unit, 0, 2 * Math.PI);
      }
      context.fillStyle = fill;
      context.fill();
    }
  }

  line(from, to, color, style) {
    this.polygon([from, to], color, { open: true, ...style });
  }

  /** A line with a head of the size of the page, not of the image. */
  arrow(from, to, color, style) {
    const angle = Math.atan2(to.y - from.y, to.x - from.x);
    const length = Math.min(8 * this.unit, Math.hypot(to.x - from.x, to.y - from.y));
    if (length < this.unit) return;
    const [back, side] = [length * Math.cos(0.5), length * Math.sin(0.5)];
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    this.stroke(
      color,
      (context) => {
        context.moveTo(from.x, from.y);
        context.lineTo(to.x, to.y);
        context.moveTo(to.x - back * cos + side * sin, to.y - back * sin - side * cos);
        context.lineTo(to.x, to.y);
        context.lineTo(to.x - back * cos - side * sin, to.y - back * sin + side * cos);
      },
      style,
    );
  }

  /**
   * Words in a dark box above a place, inside of the image; `finish` writes them.
   * @param {string} text
   * @param {{x: number, y: number}} place
   */
  label(text, { x, y }, color) {
    if (text) this.labels.push({ text, color, left: x / this.unit - 1, top: y / this.unit - 20 });
  }

  /** Writes all words: over all lines, and beside each other. */
  finish() {
    const { context, unit, size } = this;
    const bounds = { width: size[0] / unit, height: size[1] / unit }; // CSS px, as all below
    const taken = [];
    context.save();
    context.font = FONT;
    context.textBaseline = "middle";
    const texts = this.labels.map(({ text }) => this.fitting(text));
    const widths = texts.map((text) => context.measureText(text).width + 12);
    context.scale(unit, unit);
    this.labels.forEach(({ color, left, top }, index) => {
      const wanted = { left, top, width: widths[index], height: 18 };
      const place = freePlace(wanted, taken, bounds);
      taken.push(place);
      context.fillStyle = BOX;
      context.fillRect(place.left, place.top, place.width, place.height);
      context.fillStyle = color;
      context.fillRect(place.left, place.top, 3, place.height);
      context.fillStyle = "#fff";
      context.fillText(texts[index], place.left + 7, place.top + 9.5);
    });
    context.restore();
  }

  /** As much of a text as there is room for in the image. @param {string} text */
  fitting(text) {
    const room = this.size[0] / this.unit - 12; // CSS px
    const width = this.context.measureText(text).width;
    const most = Math.min(
      MAX_TEXT,
      width > room ? Math.floor((text.length * room) / width) : text.length,
    );
    return text.length > most ? text.slice(0, Math.max(1, most - 1)) + "…" : text;
  }

  /** A line of words in the upper left corner, each below the one before. */
  corner(text, color) {
    this.words += 1;
    this.label(text, { x: 6 * this.unit, y: (6 + 20 * this.words) * this.unit }, color);
  }

  /**
   * The axes of a frame whose x, y and z ends are these points.
   * @param {{x: number, y: number}} origin
   * @param {{x: number, y: number}[]} ends
   */
  axes(origin, ends) {
    ends.forEach((end, index) => this.arrow(origin, end, ["#ff6b6b", "#3ddc97", "#56b4e9"][index]));
  }
}
