/** Matrices of poses and of views in space: 16 numbers, column by column. */

/** @param {number[]} a @param {number[]} b @returns {number[]} the product */
export function multiply(a, b) {
  const made = Array.from({ length: 16 });
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += a[4 * k + row] * b[4 * column + k];
      made[4 * column + row] = sum;
    }
  }
  return made;
}

/**
 * @param {number[]} position
 * @param {number[]} orientation a quaternion x, y, z, w of any length
 * @returns {number[]}
 */
export function poseMatrix([px, py, pz], [x, y, z, w]) {
  const s = 2 / (x * x + y * y + z * z + w * w || Infinity);
  return [
    1 - s * (y * y + z * z),
    s * (x * y + z * w),
    s * (x * z - y * w),
    0,
    s * (x * y - z * w),
    1 - s * (x * x + z * z),
    s * (y * z + x * w),
    0,
    s * (x * z + y * w),
    s * (y * z - x * w),
    1 - s * (x * x + y * y),
    0,
    px,
    py,
    pz,
    1,
  ];
}

/** @param {number[]} m @param {number[]} point @returns {number[]} x, y, z, w */
export function transform(m, [x, y, z]) {
  return [0, 1, 2, 3].map((row) => m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row]);
}

/**
 * @param {number} aspect
 * @param {number} near
 * @param {number} far
 * @returns {number[]} for an angle of view of 50 degrees
 */
export function perspective(aspect, near, far) {
  const f = 1 / Math.tan((25 * Math.PI) / 180);
  const depth = near - far;
  return [
    f / aspect,
    0,
    0,
    0,
    0,
    f,
    0,
    0,
    0,
    0,
    (far + near) / depth,
    -1,
    0,
    0,
    (2 * far * near) / depth,
    0,
  ];
}

const minus = (a, b) => a.map((value, index) => value - b[index]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export function unit(a) {
  const length = Math.hypot(...a) || 1;
  return a.map((value) => value / length);
}

/** @param {number[]} eye @param {number[]} target @param {number[]} up @returns {number[]} */
export function lookAt(eye, target, up) {
  const back = unit(minus(eye, target));
  const right = unit(cross(up, back));
  const top = cross(back, right);
  return [
    right[0],
    top[0],
    back[0],
    0,
    right[1],
    top[1],
    back[1],
    0,
    right[2],
    top[2],
    back[2],
    0,
    -dot(right, eye),
    -dot(top, eye),
    -dot(back, eye),
    1,
  ];
}

export const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
