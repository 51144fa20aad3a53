// Turns a stored scene under the mouse, a finger or the arrow keys, and stops a moving picture at the frame that a
// slider chooses. No library, nothing is fetched from a network.
(() => {
  "use strict";
  const LEVELS = 16000; // nurbs_lab/plotting/orbit.py quantises coordinates to this many steps
  const VERTEX = `
    attribute vec3 position, normal, colour;
    uniform mat3 turn; uniform vec2 scale; uniform float size, depth;
    varying vec3 n, c;
    void main() {
      vec3 p = turn * position;
      gl_Position = vec4(p.xy * scale, -0.4 * p.z - depth, 1.0);
      gl_PointSize = size; n = turn * normal; c = colour;
    }`;
  const FRAGMENT = `
    precision mediump float;
    uniform float opacity, lit; varying vec3 n, c;
    void main() {
      vec3 m = normalize(n + vec3(0.0, 0.0, 1e-6));
      float light = 0.42 + 0.5 * abs(dot(m, normalize(vec3(0.3, 0.5, 0.9)))) + 0.12 * abs(m.y);
      gl_FragColor = vec4(c * mix(1.0, light, lit), opacity);
    }`;

  // Rows of so many columns, stored as the differences of neighbouring rows, column after column.
  async function inflate(text, Kind, columns) {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    const steps = new Kind(await new Response(stream).arrayBuffer());
    const table = new Kind(steps.length);
    const rows = steps.length / columns;
    for (let k = 0; k < columns; k++) {
      for (let i = 0, sum = 0; i < rows; i++) table[i * columns + k] = sum += steps[k * rows + i];
    }
    return table;
  }

  function faceted(points, cells, colours) {
    const spread = (values) => values && Float32Array.from({ length: 3 * cells.length },
      (_, i) => values[3 * cells[(i / 3) | 0] + (i % 3)]);
    return [spread(points), Uint32Array.from(cells.keys()), spread(colours)];
  }

  function normalsOf(points, cells) {
    const normals = new Float32Array(points.length);
    for (let t = 0; t < cells.length; t += 3) {
      const [a, b, c] = [3 * cells[t], 3 * cells[t + 1], 3 * cells[t + 2]];
      const e = [0, 1, 2].map((k) => points[b + k] - points[a + k]);
      const f = [0, 1, 2].map((k) => points[c + k] - points[a + k]);
      const n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
      for (const corner of [a, b, c]) for (let k = 0; k < 3; k++) normals[corner + k] += n[k];
    }
    for (let i = 0; i < normals.length; i += 3) {
      const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]) || 1;
      for (let k = 0; k < 3; k++) normals[i + k] /= length;
    }
    return normals;
  }

  async function load(gl, part) {
    let points = Float32Array.from(await inflate(part.arrays.points, Int16Array, 3), (x) => x / LEVELS);
    let cells = part.arrays.cells ? await inflate(part.arrays.cells, Int32Array, part.kind === "lines" ? 2 : 3) : null;
    let colours = part.arrays.colours
      ? Float32Array.from(await inflate(part.arrays.colours, Uint8Array, 3), (x) => x / 255) : null;
    const solid = part.kind === "triangles";
    if (solid && !part.smooth) [points, cells, colours] = faceted(points, cells, colours);
    const buffer = (target, data) => {
      const made = gl.createBuffer();
      gl.bindBuffer(target, made);
      gl.bufferData(target, data, gl.STATIC_DRAW);
      return made;
    };
    return {
      ...part, solid, count: cells ? cells.length : points.length / 3,
      position: buffer(gl.ARRAY_BUFFER, points),
      normal: solid ? buffer(gl.ARRAY_BUFFER, normalsOf(points, cells)) : null,
      colours: colours ? buffer(gl.ARRAY_BUFFER, colours) : null,
      cells: cells ? buffer(gl.ELEMENT_ARRAY_BUFFER, cells) : null,
    };
  }

  function program(gl) {
    const made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    gl.useProgram(made);
    return made;
  }

  class Orbit {
    constructor(canvas, views) {
      this.canvas = canvas;
      this.gl = canvas.getContext("webgl2", { alpha: false, antialias: true, preserveDrawingBuffer: true });
      if (!this.gl) throw new Error("this browser has no WebGL");
      this.views = views;
      this.names = views.map(() => []); // elements that follow points
      const [x, y, z] = views[0].towards;
      this.home = [Math.atan2(y, x), Math.asin(z)];
      [this.azimuth, this.height] = this.home;
      this.zoom = 1;
    }

    async start() {
      this.program = program(this.gl);
      this.parts = [];
      for (const view of this.views) {
        const parts = await Promise.all(view.parts.map((part) => load(this.gl, part)));
        const order = (part) => (part.solid ? (part.opacity < 1 ? 3 : 0) : part.kind === "lines" ? 1 : 2);
        this.parts.push(parts.sort((a, b) => order(a) - order(b)));
      }
      this.listen();
      this.draw();
    }

    // Where a point appears, in percent of the canvas.
    place(at, turn, scale, column) {
      const [x, y] = [0, 1].map((k) => scale[k] * (turn[k] * at[0] + turn[3 + k] * at[1] + turn[6 + k] * at[2]));
      return [(100 * (column + 0.5 + x / 2)) / this.views.length, 50 * (1 - y)];
    }

    draw() {
      const { gl, canvas } = this;
      const ratio = window.devicePixelRatio || 1;
      canvas.width = Math.round(canvas.clientWidth * ratio);
      canvas.height = Math.round(canvas.clientHeight * ratio);
      gl.clearColor(1, 1, 1, 1);
      gl.viewport(0, 0, canvas.width, canvas.height);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.enable(gl.DEPTH_TEST);
      gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
      const [a, h] = [this.azimuth, this.height];
      const right = [-Math.sin(a), Math.cos(a), 0];
      const towards = [Math.cos(h) * Math.cos(a), Math.cos(h) * Math.sin(a), Math.sin(h)];
      const up = [-Math.sin(h) * Math.cos(a), -Math.sin(h) * Math.sin(a), Math.cos(h)];
      const rows = [right, up, towards];
      const turn = [0, 1, 2].flatMap((k) => rows.map((row) => row[k]));
      const width = canvas.width / this.views.length;
      this.views.forEach((view, i) => {
        gl.viewport(Math.round(i * width), 0, Math.round(width), canvas.height);
        const tall = (2 * this.zoom) / view.height;
        const scale = [(tall * canvas.height) / width, tall];
        for (const part of this.parts[i]) this.part(part, turn, scale, ratio);
        for (const [element, at] of this.names[i]) {
          const [left, top] = this.place(at, turn, scale, i);
          Object.assign(element.style, { left: `${left}%`, top: `${top}%` });
        }
      });
    }

    part(part, turn, scale, ratio) {
      const { gl } = this;
      const at = (name) => gl.getUniformLocation(this.program, name);
      gl.uniformMatrix3fv(at("turn"), false, turn);
      gl.uniform2fv(at("scale"), scale);
      gl.uniform1f(at("size"), part.size * ratio);
      gl.uniform1f(at("opacity"), part.opacity);
      gl.uniform1f(at("lit"), part.solid ? (part.colours ? 0.3 : 1) : 0); // colours that tell a number stay true
      gl.uniform1f(at("depth"), part.solid ? 0 : 0.004); // lines lie on surfaces, not in them
      if (part.opacity < 1) gl.enable(gl.BLEND); else gl.disable(gl.BLEND);
      gl.depthMask(part.opacity === 1);
      const feed = (name, buffer, constant) => {
        const place = gl.getAttribLocation(this.program, name);
        if (place < 0) return;
        if (buffer) {
          gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
          gl.enableVertexAttribArray(place);
          gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
        } else {
          gl.disableVertexAttribArray(place);
          gl.vertexAttrib3fv(place, constant);
        }
      };
      feed("position", part.position);
      feed("normal", part.normal, [0, 0, 1]);
      feed("colour", part.colours, part.colour);
      if (part.cells) {
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, part.cells);
        gl.drawElements(part.solid ? gl.TRIANGLES : gl.LINES, part.count, gl.UNSIGNED_INT, 0);
      } else gl.drawArrays(gl.POINTS, 0, part.count);
      gl.depthMask(true);
    }

    move(sideways, upwards, zoom = 1) {
      this.azimuth -= sideways;
      this.height = Math.max(-1.55, Math.min(1.55, this.height + upwards));
      this.zoom = Math.max(0.3, Math.min(20, this.zoom * zoom));
      requestAnimationFrame(() => this.draw());
    }

    listen() {
      const { canvas } = this;
      canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
      canvas.addEventListener("pointermove", (event) => {
        if (event.buttons) this.move(event.movementX / 150, event.movementY / 150);
      });
      canvas.addEventListener("wheel", (event) => {
        event.preventDefault();
        this.move(0, 0, Math.exp(-event.deltaY / 600));
      }, { passive: false });
      canvas.addEventListener("dblclick", () => {
        [this.azimuth, this.height] = this.home;
        this.zoom = 1;
        this.draw();
      });
      const keys = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
      canvas.addEventListener("keydown", (event) => {
        const step = keys[event.key] || { "+": [0, 0, 1.2], "-": [0, 0, 1 / 1.2] }[event.key];
        if (step) { event.preventDefault(); this.move(...step); }
      });
      new ResizeObserver(() => this.draw()).observe(canvas);
    }
  }

  function write(figure, text, kind) {
    const span = document.createElement("span");
    span.className = kind;
    span.textContent = text;
    figure.append(span);
    return span;
  }

  async function turn(figure) {
    const picture = figure.querySelector("img");
    const canvas = document.createElement("canvas");
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${picture.alt}. Arrow keys turn it, plus and minus zoom.`);
    canvas.style.cssText = `width:${picture.clientWidth}px;height:${picture.clientHeight}px;max-width:100%;`;
    const script = document.createElement("script");
    script.src = figure.dataset.scene;
    await new Promise((done, failed) => {
      script.onload = done;
      script.onerror = () => failed(new Error(`${script.src} is missing`));
      document.head.append(script);
    });
    const scene = window.nurbsLabScenes[figure.dataset.name];
    picture.replaceWith(canvas);
    scene.views.forEach((view, i) => {
      write(figure, view.title, "title").style.left = `${(100 * (i + 0.04)) / scene.views.length}%`;
    });
    figure.querySelector("button").remove();
    const orbit = new Orbit(canvas, scene.views);
    orbit.names = scene.views.map(({ names = [] }) => names.map(({ text, colour, at }) => {
      const element = write(figure, text, "name");
      element.style.color = `rgb(${colour.map((x) => Math.round(255 * x))})`;
      return [element, at];
    }));
    await orbit.start();
    canvas.focus();
  }

  // A picture that moves stops at the frame that the slider chooses; it does not start for readers who want no motion.
  function still(figure) {
    const picture = figure.querySelector("img");
    const slider = figure.querySelector("input");
    const moving = picture.src;
    const choose = () => { picture.src = `${figure.dataset.frames}${slider.value}.png`; };
    slider.addEventListener("input", choose);
    figure.querySelector("button").addEventListener("click", () => { picture.src = moving; });
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) choose();
  }

  document.addEventListener("DOMContentLoaded", () => {
    document.querySelectorAll("figure.moving").forEach(still);
    for (const figure of document.querySelectorAll("figure.orbit")) {
      figure.querySelector("button").addEventListener("click", () => turn(figure));
    }
  });
})();
