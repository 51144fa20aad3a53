// A plane NURBS curve whose control points, weights and knots are dragged. No library, nothing is fetched.
function nurbsLabDrag(figure, given) {
  "use strict";
  const [WIDTH, TALL, FLAT, EDGE] = [720, 400, 170, 24]; // of the plane, of the basis functions, of their margin
  const COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"];
  const p = given.degree, count = given.points.length;
  const [low, high] = [given.knots[p], given.knots[count]];
  let { knots, points, weights } = structuredClone(given);
  let chosen = 0;

  // The p + 1 basis functions that are not zero at u, and the number of the first (Piegl and Tiller, A2.2).
  function basis(u) {
    let span = count - 1;
    while (u < knots[span] || knots[span] === knots[span + 1]) span--;
    const values = [1];
    for (let j = 1; j <= p; j++) {
      let saved = 0;
      for (let r = 0; r < j; r++) {
        const [before, after] = [u - knots[span + 1 - j + r], knots[span + r + 1] - u];
        const share = values[r] / (before + after);
        values[r] = saved + after * share;
        saved = before * share;
      }
      values.push(saved);
    }
    return [span - p, values];
  }

  function point(u) {
    const [first, values] = basis(u);
    let [x, y, w] = [0, 0, 0];
    values.forEach((value, k) => {
      const share = value * weights[first + k];
      x += share * points[first + k][0]; y += share * points[first + k][1]; w += share;
    });
    return [x / w, y / w];
  }

  const parameters = () => Array.from({ length: 601 }, (_, k) => low + (high - low) * k / 600);

  // From millimetres and parameters to pixels, with equal scales in the plane.
  const range = (k) => [Math.min(...given.points.map((q) => q[k])), Math.max(...given.points.map((q) => q[k]))];
  const [[left, right], [bottom, top]] = [range(0), range(1)];
  const scale = 0.7 * Math.min(WIDTH / (right - left || 1), TALL / (top - bottom || 1));
  const [across, up] = [(left + right) / 2, (bottom + top) / 2];
  const toPlane = ([x, y]) => [WIDTH / 2 + scale * (x - across), TALL / 2 - scale * (y - up)];
  const toU = (u) => EDGE + (WIDTH - 2 * EDGE) * (u - low) / (high - low);
  const path = (places) => "M" + places.map((q) => q.map((v) => v.toFixed(2)).join(" ")).join("L");

  const rounded = (value) => Number(value.toFixed(3));

  function set(element, attributes) {
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  }

  function add(parent, name, attributes) {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    set(made, attributes);
    return parent.appendChild(made);
  }

  function drawing(height, words) {
    const svg = add(figure, "svg", { viewBox: `0 0 ${WIDTH} ${height}`, role: "group", "aria-label": words });
    svg.style = `display: block; width: 100%; max-width: ${WIDTH}px; background: white; touch-action: none`;
    return svg;
  }

  // Something that a pointer or the arrow keys move; `moved` is told by how many pixels.
  function handle(svg, name, attributes, words, moved) {
    const made = add(svg, name, { tabindex: 0, role: "slider", "aria-label": words, cursor: "grab", ...attributes });
    let last = null;
    made.onpointerdown = (event) => { made.setPointerCapture(event.pointerId); last = event; made.focus(); };
    made.onpointerup = made.onpointercancel = () => { last = null; };
    made.onpointermove = (event) => {
      if (!last) return;
      const zoom = WIDTH / svg.getBoundingClientRect().width;
      moved(zoom * (event.clientX - last.clientX), zoom * (event.clientY - last.clientY));
      last = event;
    };
    made.onkeydown = (event) => {
      const by = { ArrowLeft: [-4, 0], ArrowRight: [4, 0], ArrowUp: [0, -4], ArrowDown: [0, 4] }[event.key];
      if (by) { event.preventDefault(); event.stopPropagation(); moved(...by); }
    };
    return made;
  }

  figure.replaceChildren(); // the stored picture gives way
  const plane = drawing(TALL, "the curve and its control points");
  const drawn = () => path(parameters().map((u) => toPlane(point(u))));
  add(plane, "path", { fill: "none", stroke: "#bbbbbb", "stroke-width": 1.5, d: drawn() }); // as it was given
  const polygon = add(plane, "path", { fill: "none", stroke: "#808080", "stroke-dasharray": "5 4" });
  const line = add(plane, "path", { fill: "none", stroke: "#0072B2", "stroke-width": 2.5, "data-curve": "" });
  const joints = knots.slice(p + 1, count).map(() => add(plane, "rect", { width: 7, height: 7, fill: "#D55E00" }));
  const handles = points.map((_, i) => {
    const one = handle(plane, "circle", { r: 8, stroke: "#202020" }, `control point ${i}`, (dx, dy) => {
      points[i] = [points[i][0] + dx / scale, points[i][1] - dy / scale];
      draw();
    });
    one.onfocus = () => { chosen = i; draw(); };
    return one;
  });

  const bells = drawing(FLAT, "the basis functions over the knots");
  const lines = points.map((_, i) => add(bells, "path", { fill: "none", stroke: COLOURS[i % 7], "stroke-width": 2 }));
  const marks = joints.map((_, k) => handle(bells, "path", { fill: "#D55E00" }, `knot ${p + 1 + k}`, (dx) => {
    const i = p + 1 + k, gap = (high - low) / 100; // at most p inner knots meet
    const wanted = knots[i] + dx * (high - low) / (WIDTH - 2 * EDGE);
    const [least, most] = [Math.max(knots[i - 1], knots[i - p] + gap), Math.min(knots[i + 1], knots[i + p] - gap)];
    knots[i] = Math.min(Math.max(wanted, least), most);
    draw();
  }));

  const label = figure.appendChild(document.createElement("label"));
  const name = label.appendChild(document.createElement("span"));
  const weight = label.appendChild(document.createElement("input"));
  Object.assign(weight, { type: "range", min: -1, max: 1, step: 0.01 }); // the logarithm of the weight
  weight.oninput = () => { weights[chosen] = Number((10 ** weight.value).toPrecision(3)); draw(); };
  const again = figure.appendChild(document.createElement("button"));
  Object.assign(again, { type: "button", textContent: "Start again" });
  again.onclick = () => { ({ knots, points, weights } = structuredClone(given)); draw(); };
  const code = figure.appendChild(document.createElement("code"));
  code.style = "display: block; white-space: pre-wrap; margin: 0.4em 0";

  function draw() {
    const polyline = points.map(toPlane);
    line.setAttribute("d", drawn());
    polygon.setAttribute("d", path(polyline));
    handles.forEach((one, i) => {
      const [cx, cy] = polyline[i];
      set(one, { cx, cy, fill: i === chosen ? "#E69F00" : "white" });
    });
    joints.forEach((one, k) => {
      const [x, y] = toPlane(point(knots[p + 1 + k]));
      set(one, { x: x - 3.5, y: y - 3.5 });
    });
    const bell = points.map(() => []);
    for (const u of parameters()) {
      const [first, values] = basis(u);
      values.forEach((value, k) => bell[first + k].push([toU(u), (FLAT - 40) * (1 - value) + 12]));
    }
    lines.forEach((one, i) => set(one, { d: path(bell[i]) }));
    marks.forEach((one, k) => set(one, { d: `M${toU(knots[p + 1 + k])} ${FLAT - 26}l8 20h-16z` }));
    name.textContent = `weight of control point ${chosen}: ${weights[chosen].toPrecision(3)} `;
    weight.value = Math.log10(weights[chosen]);
    const pairs = points.map((q) => `(${q.map(rounded).join(", ")})`);
    const lists = [knots.map(rounded), pairs, weights.map(rounded)].map((list) => `[${list.join(", ")}]`);
    code.textContent = `nl.NurbsCurve(${p}, ${lists.join(", ")})`;
  }
  draw();
}
