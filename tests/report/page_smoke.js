// SPDX-License-Identifier: Apache-2.0
// Runs the report page in node on a stand-in for the browser, with its own libraries but for the one that needs a graphics
// card: every handler is called, and what the page has read from its data is compared with what the C++ side put in.
// usage: node page_smoke.js PAGE.html EXPECTED.json [OTHER.html]
"use strict";
const fs = require("fs"), vm = require("vm");
const html = fs.readFileSync(process.argv[2], "utf8"), expected = JSON.parse(fs.readFileSync(process.argv[3], "utf8"));
const between = (start, end) => html.slice(html.indexOf(start) + start.length, html.indexOf(end, html.indexOf(start) + start.length));
const data = between('<script type="application/json" id="data">', "</script>"), libraries = between('<script id="libraries">\n', "</script>");
const script = between('<script id="page">\n', "</script>").replace(/\}\)\(\);\s*$/, `globalThis.page = {S, run: () => RUN, other: () => OTHER, setWindow, setCursor, timeGrid, bands,
  resolutionWords, operationsOf, operations: () => OPERATIONS, tools, chosen, colouring, stretchesOf, shownBox, lay, tr, emit, report};\n})();`);

const check = (ok, what) => { if (!ok) { console.error("page_smoke: " + what); process.exit(1); } };
const near = (a, b, tolerance, what) => check(Math.abs(a - b) <= tolerance, `${what}: ${a} instead of ${b}`);
process.on("unhandledRejection", e => check(false, e.stack || e));

const drawn = {calls: 0, text: new Set(), rendered: 0};
const context = () => new Proxy({canvas: {}}, {
  get: (o, k) => k in o ? o[k] : (...a) => {
    ++drawn.calls;
    if (k === "fillText") drawn.text.add(String(a[0]));
    for (const v of a) if (typeof v === "number" && !Number.isFinite(v)) throw new Error(`${String(k)}(${a}) is not finite`);
    return {width: 6 * String(a[0] || "").length};
  },
  set: (o, k, v) => ((o[k] = v), true),
});
class Node {
  constructor(tag) {
    Object.assign(this, {tag, tagName: tag.toUpperCase(), children: [], dataset: {}, handlers: {}, attributes: {}, own: "", value: "1", clientWidth: 640, clientHeight: 300,
      offsetWidth: 80, offsetHeight: 30, scrollTop: 0, parent: null});
    this.style = {setProperty() {}, removeProperty() {}};
    this.classList = {toggle() {}, add() {}, remove() {}, contains: () => false};
  }
  append(...c) { for (const child of c) this.appendChild(child); }
  appendChild(c) { this.children.push(c); if (c instanceof Node) c.parent = this; return c; }
  insertBefore(c, at) { this.children.splice(Math.max(0, this.children.indexOf(at)), 0, c); c.parent = this; return c; }
  removeChild(c) { this.children = this.children.filter(o => o !== c); }
  remove() { if (this.parent) this.parent.removeChild(this); }
  replaceChildren(...c) { this.children = []; this.append(...c); }
  after() {}
  setAttribute(k, v) { this.attributes[k] = v; if (k.startsWith("data-")) this.dataset[k.slice(5)] = v; }
  removeAttribute() {}
  addEventListener(type, f) { (this.handlers[type] = this.handlers[type] || []).push(f); }
  removeEventListener(type, f) { this.handlers[type] = (this.handlers[type] || []).filter(g => g !== f); }
  dispatchEvent() { return true; }
  fire(type, e = {}) {
    for (const f of [...this.handlers[type] || []])
      f({type, preventDefault() {}, stopPropagation() {}, stopImmediatePropagation() {}, target: this, currentTarget: this, pointerId: 1, pointerType: "mouse", button: 0, buttons: 1,
        offsetX: 200, offsetY: 100, clientX: 300, clientY: 150, pageX: 300, pageY: 150, movementX: 3, movementY: 2, deltaY: -40, deltaMode: 0, ctrlKey: true, key: "", ...e});
  }
  getContext() { return this.context || (this.context = context()); }
  getBoundingClientRect() { return {left: 0, top: 0, right: 640, bottom: 300, width: 640, height: 300}; }
  getRootNode() { return document; }
  get ownerDocument() { return document; }
  setPointerCapture() {}
  releasePointerCapture() {}
  focus() {}
  querySelectorAll() { return []; }
  get firstChild() { return this.children[0] || null; }
  set textContent(v) { this.own = String(v); this.children = []; }
  get textContent() { return this.own + this.children.map(c => typeof c === "string" ? c : c.textContent).join(" "); }
}
const ids = {}, frames = [];
const byId = id => ids[id] || (ids[id] = new Node(["slider", "compare"].includes(id) ? "input" : "div"));
byId("data").textContent = data;
const buttons = ["en", "ru"].map(lang => { const b = new Node("button"); b.dataset.lang = lang; return b; });
const documentNode = new Node("document");
const document = Object.assign(documentNode, {getElementById: byId, createElement: tag => new Node(tag), createElementNS: (_, tag) => new Node(tag), documentElement: new Node("html"),
  body: new Node("body"), activeElement: null, querySelectorAll: q => q === "[data-lang]" ? buttons : []});
const window = Object.assign(new Node("window"), {innerWidth: 1400, devicePixelRatio: 2, matchMedia: () => ({matches: false, addEventListener() {}, removeEventListener() {}})});
/** Takes what a graphics card would draw; the scene, its geometry and the camera are three.js's own. */
class Renderer {
  constructor() { this.domElement = new Node("canvas"); }
  setPixelRatio() {}
  getContext() { return null; }
  setSize(w, h) { check(w > 0 && h > 0, "a view without a size"); }
  render(scene, camera) {
    ++drawn.rendered;
    check([camera.left, camera.right, camera.top, camera.bottom, camera.near, camera.far, ...camera.position.toArray()].every(Number.isFinite), "the camera looks nowhere");
    scene.traverse(o => {
      if (!o.visible || !o.geometry) return;
      for (const name of ["position", "instanceStart", "color"]) {
        const a = o.geometry.attributes[name];
        if (a) check((a.array || a.data.array).every(Number.isFinite), `${name} of a drawn line is not finite`);
      }
    });
  }
}
const globals = {document, window, self: window, navigator: {userAgent: "", platform: ""}, location: {hash: ""}, devicePixelRatio: 2, performance, console, Path2D: class { moveTo() {} lineTo() {} rect() {} arc() {} closePath() {} addPath() {} bezierCurveTo() {} },
  URLSearchParams, TextDecoder, Blob, Response, DecompressionStream, atob, queueMicrotask, setTimeout, clearTimeout, matchMedia: window.matchMedia,
  addEventListener() {}, removeEventListener() {}, dispatchEvent() {}, CustomEvent: class {}, Event: class {}, HTMLElement: Node, MouseEvent: class {},
  getComputedStyle: () => ({getPropertyValue: () => "#123456"}), requestAnimationFrame: f => frames.push(f), cancelAnimationFrame() {}, ResizeObserver: class { constructor(f) { this.f = f; } observe() { this.f(); } }};
globals.globalThis = globals;
vm.createContext(globals);
vm.runInContext(libraries, globals, {filename: "libraries.js"});
globals.LIBRARIES = {...globals.LIBRARIES, WebGLRenderer: Renderer};

/** Lets frames and unpacking go on until nothing is under way any more. */
async function settle() {
  for (let quiet = 0, n = 0; quiet < 6 && n < 4000; ++n) {
    quiet = frames.length ? 0 : quiet + 1;
    for (const f of frames.splice(0)) f(performance.now());
    await new Promise(r => setTimeout(r, quiet > 1 ? 4 : 0));
  }
}
const everything = node => [node, ...node.children.filter(c => c instanceof Node).flatMap(everything)];
const shows = text => [...drawn.text].some(t => t.includes(text)) || Object.values(ids).some(n => n !== ids.data && n.textContent.includes(text));

function samples(page, run) {
  for (const {t, place, line, signals} of expected.samples) {
    const p = run.placeAt(t);
    [p.x, p.y, p.z].forEach((v, k) => near(v, place[k], expected.tolerance, `place ${k} at ${t}`));
    near(run.lineAt(t), line, 0, `line at ${t}`);
    signals.forEach((s, n) => check(run.signalAt(run.signals[n], t) === s, `signal ${n} at ${t}`));
  }
  for (const [name, peak] of Object.entries(expected.peaks)) {
    const s = run.series.get(name);
    let most = 0;
    for (let n = 0; n < s.low.length; ++n) most = Math.max(most, Math.abs(s.low[n]), Math.abs(s.high[n]));
    near(most, peak, 2e-6 * peak, `peak of ${name}`);
  }
}
/** Zoomed far, each cycle is what was recorded; zoomed out, a band has all of its cycles in it. */
async function cycles(page, run) {
  for (const {t, values} of expected.cycles || []) {
    page.setWindow(t - 0.05, t + 0.05);
    // Unpacking goes on beside this, as long as a busy computer takes.
    for (let n = 0; n < 500 && !page.timeGrid(() => {}).every; ++n) await new Promise(r => setTimeout(r, 20));
    await settle();
    const grid = page.timeGrid(() => {}), k = grid.at.findIndex(at => Math.abs(at - t) < 0.1 * run.period);
    check(grid.every && k >= 0, `cycles around ${t} are not drawn one by one`);
    check(page.resolutionWords(grid).includes("Every cycle"), "the resolution is not said: " + page.resolutionWords(grid));
    for (const [name, value] of Object.entries(values)) {
      const {low, high} = page.bands(run, name, grid);
      // A position is kept to a nanometre, which a derivative multiplies.
      near(low[k], value, Math.max(1e-6, 1e-4 * Math.abs(value), {jerk: 8, acceleration: 4e-3}[name.split(".")[1]] || 0), `${name} at ${t}`);
      check(low[k] === high[k], "one cycle has one value");
    }
  }
  if (!expected.band) return;
  page.setWindow(run.start, run.end);
  const wide = {...page.timeGrid(() => {}), every: false, step: 0.256, first: run.start, at: Float64Array.from({length: Math.floor(run.duration / 0.256)}, (_, k) => run.start + (k + 0.5) * 0.256)};
  const {low, high} = page.bands(run, expected.band.name, wide);
  expected.band.low.forEach((v, k) => {
    near(low[k], v, 1e-5 * expected.band.size, `lower edge of band ${k}`);
    near(high[k], expected.band.high[k], 1e-5 * expected.band.size, `upper edge of band ${k}`);
  });
  check(page.resolutionWords(wide).includes("256 ms"), "a band does not say how long it is: " + page.resolutionWords(wide));
}
function ways(run) {
  const a = run.amounts();
  let total = 0;
  for (let i = 1; i < run.path.n; ++i) {
    const kind = run.kindOf(i), rapid = run.path.rapid[i], line = run.path.line[i];
    check(kind === (rapid === 2 ? "jump" : !rapid ? "feed" : line ? "rapid" : "homing"), `stretch ${i} counts as ${kind}`);
    if (kind !== "jump") total += run.lengthOf(i);
  }
  check(a.feed + a.rapid + a.homing <= total + 1e-6 && a.feed + a.rapid + a.homing >= 0.98 * total, `ways ${JSON.stringify(a)} of ${total}`);
}
/** What limits the speed, as it was put in. */
function bounds(page, run) {
  for (const {t, what, letter} of expected.bounds || []) {
    const found = run.boundAt(t);
    check(found.what === what && found.letter === letter, `at ${t} the speed is limited by ${found.what} ${found.letter} instead of ${what} ${letter}`);
  }
  page.S.colour = "bound";
  const colour = page.colouring();
  for (let i = 1; i < run.path.n; ++i) check((colour(i) || []).length === 3, `stretch ${i} has no colour by what limits its speed`);
  page.S.colour = "speed";
}
/** Filters leave exactly what they name; colours follow what they stand for. */
function filters(page, run) {
  const count = () => page.stretchesOf(run, i => run.kindOf(i) === "feed" && page.chosen(i)).vertices;
  const all = count();
  for (const tool of page.tools()) {
    page.S.tools.add(tool);
    const some = count();
    check(some.length > 0 && some.every(i => run.path.tool[i] === tool), `tool ${tool} shows others`);
    page.S.tools.clear();
  }
  const parts = page.operations().map((o, i) => { page.S.operation = i; return count().length; });
  page.S.operation = -1;
  if (parts.length > 1) check(parts.every(n => n < all.length), "an operation is everything");
  const found = page.operationsOf(["; --- Tool 1: end mill ---", "G1 X1", "; a note", "G1 X2", "(OPERATION 2: drill)", "(UOT,0,X1)", "G1 X3"], [2, 4, 7]);
  check(JSON.stringify(found) === JSON.stringify([{name: "Tool 1: end mill", from: 1, to: 4}, {name: "OPERATION 2: drill", from: 5, to: 7}]), "operations " + JSON.stringify(found));
  if (expected.tools) check(JSON.stringify(page.tools()) === JSON.stringify(expected.tools), `tools ${page.tools()} instead of ${expected.tools}`);
  if (expected.operations) check(JSON.stringify(page.operations().map(o => o.name)) === JSON.stringify(expected.operations), `operations ${JSON.stringify(page.operations())}`);
  for (const key of ["deviation", "speed"]) {
    page.S.colour = key;
    const colour = page.colouring(), order = [...all].sort((a, b) => run.path[key][a] - run.path[key][b]);
    if (run.path[key][order[0]] < 0.5 * run.path[key][order[order.length - 1]])
      check(String(colour(order[0])) !== String(colour(order[order.length - 1])), `least and greatest ${key} have one colour`);
  }
  if (expected.deviation !== undefined) near(Math.max(...all.map(i => run.path.deviation[i])), expected.deviation, 2e-6, "largest deviation");
}
function boxes(page, run) {
  const cut = page.shownBox();
  page.S.whole = true;
  const whole = page.shownBox();
  page.S.whole = false;
  for (let k = 0; k < 2; ++k) check(isFinite(whole.low[k] + cut.high[k]) && (run.turned || (whole.low[k] <= cut.low[k] && cut.high[k] <= whole.high[k])), `the box of the cut leaves the whole in direction ${k}`);
}

async function main() {
  vm.runInContext(script, globals, {filename: "page.js"});
  for (const [, id] of script.matchAll(/(?:[$]|fill)[(]"([a-z0-9-]+)"[,)]/g)) check(html.includes(`id="${id}"`), `the script asks for ${id}, which the page does not have`);
  for (const [, key] of (script + html).matchAll(/\btr[(]"([a-zA-Z0-9.]+)"[,)]/g)) check(script.includes(key + ": [") || script.includes(`"${key}": [`) || key.endsWith("."), `no text of ${key}`);
  for (const [, key] of html.slice(0, html.indexOf("<script")).matchAll(/data-t="([a-zA-Z0-9]+)"/g)) check(script.includes("  " + key + ": ["), `no text of ${key}`);
  for (let n = 0; n < 200 && !globals.page; ++n) await settle();
  check(globals.page, "the page does not come to its end");
  const {page} = globals, run = page.run();
  await settle();
  check(ids.broken === undefined || !ids.broken.textContent, "the page is broken: " + (ids.broken || {}).textContent);
  check(drawn.calls > (expected.samples.length ? 500 : 10), "hardly anything is drawn");
  check(drawn.rendered > 0, "the path is not drawn");
  samples(page, run);
  await cycles(page, run);
  ways(run);
  filters(page, run);
  bounds(page, run);
  boxes(page, run);
  check(byId("cards").textContent.includes(expected.card), "cards show: " + byId("cards").textContent);
  check(!/NaN|undefined|Infinity/.test(Object.values(ids).filter(n => n !== ids.data).map(n => n.textContent).join(" ")), "the page shows what is no number");
  for (const text of expected.shown) check(shows(text), `"${text}" is nowhere on the page`);
  buttons[1].fire("click");
  await settle();
  for (const text of expected.russian || []) check(shows(text), `"${text}" is nowhere on the Russian page`);
  for (const text of expected.english || []) check(!Object.values(ids).some(n => n !== ids.data && n.textContent.includes(text)), `"${text}" stays English on the Russian page`);
  buttons[0].fire("click");

  if (process.argv[4]) {
    await page.lay(fs.readFileSync(process.argv[4], "utf8"));
    await settle();
    near(page.other().begin + page.other().shift, run.begin, 2 * run.period, "the other program begins at");
    page.setWindow(run.start, run.end);
    const {low} = page.bands(page.other(), "path.speed", page.timeGrid(() => {}));
    check(low.some(v => v > 0) && !byId("compare-section").hidden, "the other run is not drawn");
    await page.lay("<html>no report</html>");
    check(byId("compare-trouble").textContent.includes("no report page") && page.other(), "a foreign file is not named, or takes the other run away");
    byId("compare-off").fire("click");
    check(page.other() === null, "the other run stays");
  }
  for (let round = 0; round < 4; ++round) {
    for (const node of [...Object.values(ids).flatMap(everything), document, window])
      for (const type of ["pointermove", "pointerdown", "pointermove", "pointerup", "mousedown", "mousemove", "mouseup", "wheel", "click", "input", "change", "scroll", "pointerenter", "pointerleave"])
        node.fire(type, {clientX: 200 + 90 * round, clientY: 100 + 20 * round, shiftKey: round === 3, target: Object.assign(node, {checked: round % 2 === 0})});
    buttons[round % 2].fire("click");
    await settle();
  }
  for (const key of [" ", "ArrowLeft", "ArrowRight", " "]) document.fire("keydown", {key, target: byId("space"), shiftKey: false});
  window.fire("beforeprint");
  window.fire("afterprint");
  page.setWindow(-5, -4);
  check(page.S.t1 > page.S.t0 && page.S.t0 >= expected.start, "the window left the run");
  page.setWindow(0, 1e9);
  check(page.S.t1 <= run.end, "the window left the run");
  for (const node of Object.values(ids)) node.fire("dblclick");
  await settle();
  console.log(`page_smoke: ok, ${drawn.calls} drawing calls, ${drawn.rendered} pictures of the path`);
  process.exit(0);
}
main();
