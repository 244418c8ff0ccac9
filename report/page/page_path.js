// SPDX-License-Identifier: Apache-2.0
// The path in space, drawn by three.js: plan, front, side or any other direction of one parallel projection.
const DIRECTIONS = {plan: [0, -1e-6, 1], front: [0, -1, 0], side: [1, 0, 0], iso: [0.62, -1, 0.75]};
const FAT_MOST = 15000;      // stretches that are drawn two pixels wide; more are hairlines, and all without a graphics card
const TURNING_MOST = 30000;  // stretches while the view turns: a computer without a graphics card keeps up
const TURNED_COPIES = 24;  // of a turned contour around its axis; fewer of a long one

function pathView(box) {
  const {BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineDashedMaterial, LineMaterial, LineSegments, LineSegments2,
    LineSegmentsGeometry, OrbitControls, OrthographicCamera, Scene, Vector3, WebGLRenderer} = LIBRARIES;
  let renderer;
  try {
    renderer = new WebGLRenderer({antialias: true, alpha: true, preserveDrawingBuffer: true});
  } catch (error) {
    box.append(el("p", {class: "quiet", "data-t": "noWebgl"}, tr("noWebgl")));
    return {draw() {}, look() {}};
  }
  const gl = renderer.getContext(), info = gl && gl.getExtension("WEBGL_debug_renderer_info");
  const fatMost = info && /swiftshader|llvmpipe|software|basic render/i.test(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) ? 0 : FAT_MOST;
  renderer.outputColorSpace = "srgb-linear";  // colours come as the style has them
  box.append(renderer.domElement);
  const layer = box.appendChild(el("div", {class: "labels"})), tool = layer.appendChild(el("i", {class: "tool"})), tip = box.appendChild(el("div", {class: "tip"}));
  const scene = new Scene(), camera = new OrthographicCamera(-1, 1, 1, -1, -1, 1);
  camera.up.set(0, 0, 1);
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.zoomToCursor = true;
  [controls.minZoom, controls.maxZoom] = [0.2, 1e4];

  const steady = object => Object.assign(object, {frustumCulled: false});  // their geometry changes
  const plain = material => scene.add(steady(new LineSegments(new BufferGeometry(), material))).children.at(-1);
  const fat = (width, options) => scene.add(new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({linewidth: width, ...options}))).children.at(-1);
  const grid = plain(new LineBasicMaterial()), frame = plain(new LineBasicMaterial()), travel = plain(new LineDashedMaterial());
  const rapid = plain(new LineDashedMaterial()), homing = plain(new LineDashedMaterial());
  const other = fat(1.6, {transparent: true, opacity: 0.6}), otherHair = plain(new LineBasicMaterial({transparent: true, opacity: 0.6})), feed = fat(2, {vertexColors: true}), hair = plain(new LineBasicMaterial({vertexColors: true})), coarse = plain(new LineBasicMaterial({vertexColors: true})), mark = fat(8, {transparent: true, opacity: 0.45, depthTest: false});
  const turned = scene.add(new Group()).children.at(-1), shell = new BufferGeometry();
  let seen = [], direction = "iso", reach = 1, size = "", asked = "iso";

  const setPlain = (object, positions) => {
    object.geometry.dispose();
    object.geometry.setAttribute("position", new BufferAttribute(Float32Array.from(positions), 3));
    if (object.material.isLineDashedMaterial) object.computeLineDistances();
    object.visible = positions.length > 0;
  };
  const setFat = (object, positions, colours) => {
    object.visible = positions.length > 0;
    if (!object.visible) return;
    object.geometry.dispose();
    object.geometry = new LineSegmentsGeometry();
    object.geometry.setPositions(positions);
    if (colours) object.geometry.setColors(colours);
  };
  const paint = (object, name) => object.material.color.setRGB(...rgb(css(name)));

  function fillScene() {
    for (const [object, name] of [[grid, "--grid"], [frame, "--axis-line"], [travel, "--faint"], [rapid, "--rapid"], [homing, "--homing"], [other, "--other"], [otherHair, "--other"], [mark, "--mark"]]) paint(object, name);
    const kind = wanted => stretchesOf(RUN, i => RUN.kindOf(i) === wanted && (wanted !== "feed" || chosen(i)), wanted === "feed" ? colouring() : null);
    const cut = kind("feed"), [fast, home] = S.rapids ? [kind("rapid"), kind("homing")] : [{positions: [], vertices: []}, {positions: [], vertices: []}];
    const many = cut.vertices.length > fatMost, none = new Float32Array(0);
    setFat(feed, many ? none : cut.positions, cut.colours);
    setPlain(hair, many ? cut.positions : none);
    if (many) hair.geometry.setAttribute("color", new BufferAttribute(cut.colours, 3));
    const rough = coarser(cut, TURNING_MOST);
    setPlain(coarse, rough.positions);
    coarse.geometry.setAttribute("color", new BufferAttribute(rough.colours, 3));
    turning(false);
    setPlain(rapid, fast.positions);
    setPlain(homing, home.positions);
    const laid = OTHER ? stretchesOf(OTHER, i => OTHER.kindOf(i) === "feed").positions : none, manyLaid = laid.length > 6 * fatMost;
    setFat(other, manyLaid ? none : laid);
    setPlain(otherHair, manyLaid ? laid : none);
    seen = [...cut.vertices, ...fast.vertices, ...home.vertices];
    setPlain(travel, S.whole && travelOf(0) && travelOf(1) ? rectangle(travelOf(0), travelOf(1)) : []);
    revolve(cut);
    markLine();
    draw();
  }
  const rectangle = ([x0, x1], [y0, y1]) => [x0, y0, 0, x1, y0, 0, x1, y0, 0, x1, y1, 0, x1, y1, 0, x0, y1, 0, x0, y1, 0, x0, y0, 0];
  /** While it turns a path is drawn in hairlines, a long one coarsely. */
  function turning(now) {
    const drawn = object => object.geometry.attributes.position.count > 0;
    coarse.visible = now && drawn(coarse);
    hair.visible = !now && drawn(hair);
    feed.visible = !now && !drawn(hair) && drawn(coarse);
  }
  /** A turned contour stands around the spindle: mirrored on the other side, thinly all around. */
  function revolve(cut) {
    turned.clear();
    if (!RUN.turned || !cut.vertices.length) return;
    shell.dispose();
    shell.setAttribute("position", new BufferAttribute(cut.positions, 3));
    shell.setAttribute("color", new BufferAttribute(cut.colours, 3));
    const copies = clamp(Math.floor(6e5 / cut.vertices.length), 2, TURNED_COPIES) & ~1;
    for (let k = 1; k < copies; ++k) {
      const opposite = 2 * k === copies, copy = steady(new LineSegments(shell, new LineBasicMaterial({vertexColors: true, transparent: true, opacity: opposite ? 0.75 : 0.16})));
      copy.rotation.x = 2 * Math.PI * k / copies;
      turned.add(copy);
    }
    const circles = new BufferGeometry(), material = new LineBasicMaterial({transparent: true, opacity: 0.35});
    circles.setAttribute("position", new BufferAttribute(Float32Array.from(ringsOf(cut.positions)), 3));
    material.color.setRGB(...rgb(css("--axis-line")));
    turned.add(steady(new LineSegments(circles, material)));
  }
  function markLine() {
    const line = S.line || RUN.lineAt(S.cursor);
    if (line === mark.line && mark.of === seen) return;
    [mark.line, mark.of] = [line, seen];
    setFat(mark, line ? stretchesOf(RUN, i => RUN.path.line[i] === line).positions : new Float32Array(0));
  }

  /** Shows the whole box from a direction. */
  function look(name) {
    const view = shownBox(), centre = [0, 1, 2].map(k => (view.low[k] + view.high[k]) / 2);
    asked = direction = name;
    reach = Math.max(1e-3, Math.hypot(...[0, 1, 2].map(k => view.high[k] - view.low[k])) / 2);
    const far = 20 * Math.max(reach, ...[0, 1, 2].map(k => RUN.box.high[k] - RUN.box.low[k]));
    [camera.near, camera.far, camera.zoom] = [-far, far, 1];
    controls.target.set(...centre);
    camera.position.set(...centre).addScaledVector(new Vector3(...DIRECTIONS[name]).normalize(), reach);
    camera.lookAt(controls.target);
    camera.updateMatrixWorld();
    let [rx, ry] = [1e-3, 1e-3];
    for (let n = 0; n < 8; ++n) {
      const p = new Vector3(...[0, 1, 2].map(k => (n >> k & 1 ? view.high : view.low)[k])).applyMatrix4(camera.matrixWorldInverse);
      [rx, ry] = [Math.max(rx, Math.abs(p.x)), Math.max(ry, Math.abs(p.y))];
    }
    const [w, h] = [Math.max(box.clientWidth, 2), Math.max(box.clientHeight, 2)], unitsPerPixel = Math.max(2 * rx / Math.max(w - 90, 10), 2 * ry / Math.max(h - 70, 10));
    [camera.left, camera.right, camera.top, camera.bottom] = [-w, w, h, -h].map(v => v / 2 * unitsPerPixel);
    camera.updateProjectionMatrix();
    controls.update();
    render();
  }
  /** Pixels of a place: a parallel projection is one matrix. */
  function projector() {
    camera.updateMatrixWorld();
    const [w, h] = [box.clientWidth, box.clientHeight], m = camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse).elements;
    return (x, y, z) => [(m[0] * x + m[4] * y + m[8] * z + m[12] + 1) * w / 2, (1 - m[1] * x - m[5] * y - m[9] * z - m[13]) * h / 2];
  }
  const fromAbove = () => Math.abs(camera.position.x - controls.target.x) + Math.abs(camera.position.y - controls.target.y) < 1e-3 * reach;
  const labelPool = [];
  let labels = 0;
  function label(text, [x, y], kind, colour) {
    const out = labelPool[labels] || (labelPool[labels] = layer.appendChild(el("span")));
    ++labels;
    out.textContent = text;
    out.className = kind;
    out.style.cssText = `left:${x}px;top:${y}px;` + (colour ? `color:${colour}` : "");
  }
  /** The floor's grid: over all that is in sight from above, else under the box. */
  function floor(at) {
    const view = shownBox(), lines = [], above = fromAbove(), k2 = view.low[2];
    const wide = (camera.right - camera.left) / camera.zoom, high = (camera.top - camera.bottom) / camera.zoom, c = controls.target;
    const range = above ? [[c.x - wide / 2, c.x + wide / 2], [c.y - high / 2, c.y + high / 2]] : [0, 1].map(k => [view.low[k], view.high[k]]);
    const step = ticks(...range[0], above ? box.clientWidth / 90 : 8);
    labels = 0;
    [0, 1].forEach(k => {
      const [low, up] = range[1 - k], times = RUN.shownTimes(RUN.view[k]);
      for (let n = Math.ceil(range[k][0] / step.step); n * step.step <= range[k][1]; ++n) {
        const v = n * step.step, from = k ? [low, v, k2] : [v, low, k2], to = k ? [up, v, k2] : [v, up, k2], text = fixed(v * times, step.decimals), [px, py] = at(...from);
        lines.push(...from, ...to);
        if (above) label(text, k ? [6, py] : [px, box.clientHeight - 12], k ? "tick left" : "tick");
        else if (view.high[k] - view.low[k] > 0) label(text, [px, py + 10], "tick");
      }
    });
    setPlain(grid, lines);
    setPlain(frame, above ? [] : edgesOf(view));
    const shown = RUN.view.map(letter => letter && RUN.shownName(letter));
    if (above) {
      if (shown[0]) label(shown[0] + " →", [box.clientWidth - 26, box.clientHeight - 30], "letter", axisColour(RUN.view[0]));
      if (shown[1]) label("↑ " + shown[1], [24, 14], "letter", axisColour(RUN.view[1]));
    } else {
      shown.forEach((letter, k) => {
        const end = view.low.map((v, n) => n === k ? view.high[n] + 0.06 * reach : v);
        if (letter) label(letter, at(...end), "letter", axisColour(RUN.view[k]));
      });
    }
    for (const out of labelPool.splice(labels)) out.remove();
  }
  function render() {
    const now = box.clientWidth + "x" + box.clientHeight + "@" + devicePixelRatio;
    if (now !== size) {
      size = now;
      renderer.setPixelRatio(devicePixelRatio);
      renderer.setSize(box.clientWidth, box.clientHeight);
      if (asked) return look(asked);
    }
    // Dashes keep their length on the screen.
    const pixel = (camera.right - camera.left) / camera.zoom / Math.max(box.clientWidth, 1);
    for (const [object, dash, gap] of [[rapid, 5, 4], [homing, 1.5, 3.5], [travel, 8, 4]]) [object.material.dashSize, object.material.gapSize] = [dash * pixel, gap * pixel];
    floor(projector());
    renderer.render(scene, camera);
    placeTool();
  }
  function placeTool() {
    const place = RUN.placeAt(S.cursor);
    tool.style.display = place ? "block" : "none";
    if (!place) return;
    const [x, y] = projector()(place.x, place.y, place.z);
    tool.style.transform = `translate(${x}px,${y}px)`;
  }
  const draw = inNextFrame(render);
  const follow = () => {
    const was = mark.line;
    markLine();
    if (mark.line !== was) draw(); else placeTool();
  };

  function hover(e) {
    const r = box.getBoundingClientRect(), [x, y] = [e.clientX - r.left, e.clientY - r.top], p = RUN.path, at = projector();
    const found = nearest(seen, i => at(p.x[i], p.y[i], p.z[i]), x, y);
    box.classList.toggle("found", found >= 0);
    tip.style.display = found < 0 ? "none" : "block";
    if (found < 0) return;
    const t = RUN.timeAt(found), place = RUN.placeAt(t), i = Math.ceil(found);
    setCursor(t);
    const where = RUN.view.map((letter, k) => letter && RUN.shownName(letter) + " " + fixed([place.x, place.y, place.z][k] * RUN.shownTimes(letter), 3)).filter(Boolean);
    tip.textContent = where.join("  ") + "\n" + tr("line") + " " + (p.line[i] || "–") + (p.tool[i] ? " · T" + p.tool[i] : "") + " · " + num(RUN.valueAt("path.speed", t)) + " " +
      unit("mm/s") + " · " + fixed(t, 3) + " " + unit("s") + "\n" + tr("deviation") + " " + num(p.deviation[i] * 1000, 3) + " " + unit("µm") + boundWords(t);
    tip.style.left = clamp(x + 14, 4, Math.max(4, box.clientWidth - tip.offsetWidth - 4)) + "px";
    tip.style.top = clamp(y + 16, 4, Math.max(4, box.clientHeight - tip.offsetHeight - 4)) + "px";
  }
  let pressed = false, moved = null;
  const hoverSoon = inNextFrame(() => { if (moved && !pressed) hover(moved); });
  box.addEventListener("pointerdown", () => { pressed = true; tip.style.display = "none"; box.focus({preventScroll: true}); }, {capture: true});
  for (const type of ["pointerup", "pointercancel"]) window.addEventListener(type, () => { pressed = false; });
  box.addEventListener("pointermove", e => { moved = e; hoverSoon(); });
  box.addEventListener("pointerleave", () => { moved = null; tip.style.display = "none"; });
  // The page scrolls until somebody has clicked into the view.
  box.addEventListener("wheel", e => { controls.enableZoom = e.ctrlKey || e.metaKey || document.activeElement === box; }, {capture: true, passive: true});
  box.addEventListener("dblclick", () => look(direction));
  controls.addEventListener("start", () => turning(true));
  controls.addEventListener("end", () => { turning(false); draw(); });
  controls.addEventListener("change", () => { asked = null; draw(); });
  const refill = inNextFrame(fillScene);
  for (const type of ["theme", "rapids", "colour", "tools", "operation", "other"]) on(type, refill);
  for (const type of ["size", "lang"]) on(type, draw);
  for (const type of ["cursor", "line"]) on(type, follow);
  fillScene();
  look(direction);
  return {draw: render, look, camera, controls, renderer};
}
