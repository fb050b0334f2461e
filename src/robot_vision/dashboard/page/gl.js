/** Lines, triangles and points in space, and images on planes, by WebGL. */

const VERTEX = `
attribute vec3 position;
attribute vec4 color;
uniform mat4 view;
uniform float size;
varying vec4 shade;
void main() {
  gl_Position = view * vec4(position, 1.0);
  gl_PointSize = clamp(size / gl_Position.w, 1.0, 12.0);
  shade = color;
}`;
const FRAGMENT = `
precision mediump float;
varying vec4 shade;
void main() { gl_FragColor = shade; }`;
const IMAGE_VERTEX = `
attribute vec3 position;
attribute vec2 place;
uniform mat4 view;
varying vec2 at;
void main() {
  gl_Position = view * vec4(position, 1.0);
  at = place;
}`;
const IMAGE_FRAGMENT = `
precision mediump float;
varying vec2 at;
uniform sampler2D image;
void main() { gl_FragColor = vec4(texture2D(image, at).rgb, 0.9); }`;

export class Renderer {
  /**
   * @param {HTMLCanvasElement} canvas
   * @throws {Error} there is no WebGL
   */
  constructor(canvas) {
    const gl = canvas.getContext("webgl", { antialias: true, alpha: false });
    if (!gl) throw new Error("This browser has no WebGL, which the view in space needs.");
    this.gl = gl;
    this.plain = this.program(VERTEX, FRAGMENT, ["position", "color"], ["view", "size"]);
    this.textured = this.program(IMAGE_VERTEX, IMAGE_FRAGMENT, ["position", "place"], ["view"]);
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  }

  program(vertex, fragment, attributes, uniforms) {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [kind, source] of [
      [gl.VERTEX_SHADER, vertex],
      [gl.FRAGMENT_SHADER, fragment],
    ]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    attributes.forEach((name, index) => gl.bindAttribLocation(program, index, name));
    gl.linkProgram(program);
    return {
      program,
      uniforms: Object.fromEntries(
        uniforms.map((name) => [name, gl.getUniformLocation(program, name)]),
      ),
    };
  }

  /**
   * Begins an image.
   * @param {number} width px
   * @param {number} height px
   * @param {number[]} color of the background, 0 to 1
   */
  begin(width, height, color) {
    const { gl } = this;
    gl.viewport(0, 0, width, height);
    gl.clearColor(color[0], color[1], color[2], 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  /**
   * Data on the graphics card: all positions (3 floats each), then all colors (4 bytes each).
   * @param {ArrayBufferView} data
   * @param {number} count
   * @param {"lines"|"triangles"|"points"} kind
   * @param {any} [before] a batch that is replaced
   */
  batch(data, count, kind, before) {
    const { gl } = this;
    const buffer = before?.buffer || gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    return { buffer, count, kind };
  }

  /**
   * @param {any} batch
   * @param {number[]} view
   * @param {number} pointSize px of a point that is 1 m away
   */
  draw(batch, view, pointSize = 1) {
    const { gl } = this;
    if (!batch.count) return;
    const { program, uniforms } = this.plain;
    const seeThrough = batch.kind === "triangles";
    gl.useProgram(program);
    gl.uniformMatrix4fv(uniforms.view, false, new Float32Array(view));
    gl.uniform1f(uniforms.size, pointSize);
    gl.bindBuffer(gl.ARRAY_BUFFER, batch.buffer);
    gl.enableVertexAttribArray(0);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.vertexAttribPointer(1, 4, gl.UNSIGNED_BYTE, true, 0, 12 * batch.count);
    gl[seeThrough ? "enable" : "disable"](gl.BLEND);
    gl.depthMask(!seeThrough);
    gl.drawArrays(
      { lines: gl.LINES, triangles: gl.TRIANGLES, points: gl.POINTS }[batch.kind],
      0,
      batch.count,
    );
    gl.depthMask(true);
  }

  /**
   * An image on a plane.
   * @param {TexImageSource|null} image null: the one before
   * @param {number[][]} corners top left, top right, bottom left, bottom right
   * @param {number[]} view
   * @param {any} [before] what this has returned for the image before
   */
  drawImage(image, corners, view, before) {
    const { gl } = this;
    const made = before || { texture: gl.createTexture(), buffer: gl.createBuffer() };
    const places = [
      [0, 0],
      [1, 0],
      [0, 1],
      [1, 1],
    ];
    gl.useProgram(this.textured.program);
    gl.uniformMatrix4fv(this.textured.uniforms.view, false, new Float32Array(view));
    gl.bindTexture(gl.TEXTURE_2D, made.texture);
    if (image) gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, image);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T])
      gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(gl.TEXTURE_2D, name, gl.LINEAR);
    gl.bindBuffer(gl.ARRAY_BUFFER, made.buffer);
    gl.bufferData(
      gl.ARRAY_BUFFER,
      new Float32Array(corners.flatMap((corner, index) => [...corner, ...places[index]])),
      gl.DYNAMIC_DRAW,
    );
    gl.enableVertexAttribArray(0);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 20, 0);
    gl.vertexAttribPointer(1, 2, gl.FLOAT, false, 20, 12);
    gl.enable(gl.BLEND);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    return made;
  }

  /** @param {any} batch of batch() or drawImage() */
  forget(batch) {
    this.gl.deleteBuffer(batch.buffer);
    if (batch.texture) this.gl.deleteTexture(batch.texture);
  }
}
