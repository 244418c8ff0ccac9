// SPDX-License-Identifier: Apache-2.0
// Runs the report page in node on a stand-in for the browser: every handler is called once, and what the page has read
// from its data is compared with what the C++ side put in. usage: node page_smoke.js PAGE.html EXPECTED.json
"use strict";
const fs = require("fs"), vm = require("vm");
const html = fs.readFileSync(process.argv[2], "utf8"), expected = JSON.parse(fs.readFileSync(process.argv[3], "utf8"));
const between = (start, end) => html.slice(html.indexOf(start) + start.length, html.indexOf(end, html.indexOf(start) + start.length));
const data = between('<script type="application/json" id="data">', "</script>");
let script = between("<script>\n", "</script>");
script = script.replace(/\}\)\(\);\s*$/, "globalThis.page = {S, D, PATH, SERIES, SIGNALS, LINES, placeAt, lineAt, valueAt, signalAt, setWindow, T_END, num, kindOf, amounts, shownBox};\n})();");

const drawn = {calls: 0, text: new Set()};
const context = () => new Proxy({}, {
  get: (o, k) => k in o ? o[k] : (...a) => {
    ++drawn.calls;
    if (k === "fillText") drawn.text.add(String(a[0]));
    for (const v of a) if (typeof v === "number" && !Number.isFinite(v)) throw new Error(`${String(k)}(${a}) is not finite`);
    return {width: 6 * String(a[0] || "").length};
  },
  set: (o, k, v) => ((o[k] = v), true),
});
class Node {
  constructor(tag) { Object.assign(this, {tag, children: [], dataset: {}, style: {}, handlers: {}, attributes: {}, own: "", value: "1", clientWidth: 640, clientHeight: 300, offsetWidth: 80, offsetHeight: 30, offsetTop: 0, tagName: tag.toUpperCase()}); this.classList = {toggle() {}, add: c => { this.marked = c; }, remove: () => { this.marked = ""; }}; }
  append(...c) { this.children.push(...c); }
  appendChild(c) { this.children.push(c); return c; }
  replaceChildren(...c) { this.children = c; }
  after() {}
  setAttribute(k, v) { this.attributes[k] = v; if (k.startsWith("data-")) this.dataset[k.slice(5)] = v; }
  addEventListener(type, f) { (this.handlers[type] = this.handlers[type] || []).push(f); }
  fire(type, e = {}) { for (const f of this.handlers[type] || []) f({preventDefault() {}, target: this, pointerId: 1, offsetX: 200, offsetY: 100, clientX: 300, clientY: 150, buttons: 1, deltaY: -40, ctrlKey: true, key: "", ...e}); }
  getContext() { return context(); }
  getBoundingClientRect() { return {left: 0, top: 0}; }
  setPointerCapture() {}
  focus() {}
  querySelectorAll() { return []; }
  get lastChild() { return this.children[this.children.length - 1]; }
  set textContent(v) { this.own = String(v); this.children = []; }
  get textContent() { return this.own + this.children.map(c => typeof c === "string" ? c : c.textContent).join(" "); }
}
const ids = {}, frames = [];
const byId = id => ids[id] || (ids[id] = new Node(id === "slider" ? "input" : "div"));
byId("data").textContent = data;
const buttons = ["en", "ru"].map(lang => { const b = new Node("button"); b.dataset.lang = lang; return b; });
const windowHandlers = {};
const document = {getElementById: byId, createElement: tag => new Node(tag), documentElement: new Node("html"), body: new Node("body"), activeElement: null,
  handlers: {}, addEventListener(type, f) { this.handlers[type] = f; }, querySelectorAll: q => q === "[data-lang]" ? buttons : []};
const globals = {document, JSON, Math, Array, Object, Map, Set, Float32Array, Int32Array, Uint8Array, DataView, URLSearchParams, Infinity, NaN, isFinite, String, performance, console,
  atob: t => Buffer.from(t, "base64").toString("latin1"), getComputedStyle: () => ({getPropertyValue: () => "#123456"}), location: {hash: ""},
  requestAnimationFrame: f => frames.push(f), cancelAnimationFrame() {}, Path2D: class { moveTo() {} lineTo() {} rect() {} }, ResizeObserver: class { constructor(f) { this.f = f; } observe() { this.f(); } }};
globals.window = {innerWidth: 1400, devicePixelRatio: 2, matchMedia: () => ({matches: false, addEventListener() {}}), addEventListener: (t, f) => { windowHandlers[t] = f; }};
globals.globalThis = globals;
vm.runInNewContext(script, globals, {filename: "page.js"});
const page = globals.page;
const settle = () => { for (let n = 0; frames.length && n < 400; ++n) frames.shift()(performance.now()); };
const check = (ok, what) => { if (!ok) { console.error("page_smoke: " + what); process.exit(1); } };
const near = (a, b, tolerance, what) => check(Math.abs(a - b) <= tolerance, `${what}: ${a} instead of ${b}`);

for (const [, id] of script.matchAll(/[$](?:[(]"|ById[(]")([a-z0-9-]+)"[)]/g)) check(html.includes(`id="${id}"`), `the script asks for ${id}, which the page does not have`);
settle();
check(drawn.calls > (expected.samples.length ? 500 : 10), "hardly anything is drawn");
for (const {t, place, line, signals} of expected.samples) {
  const p = page.placeAt(t);
  [p.x, p.y, p.z].forEach((v, k) => near(v, place[k], expected.tolerance, `place ${k} at ${t}`));
  near(page.lineAt(t), line, 0, `line at ${t}`);
  signals.forEach((s, n) => check(page.signalAt(page.SIGNALS[n], t) === s, `signal ${n} at ${t}`));
}
for (const [name, peak] of Object.entries(expected.peaks)) {
  const s = page.SERIES.get(name);
  let most = 0;
  for (let n = 0; n < s.low.length; ++n) most = Math.max(most, Math.abs(s.low[n]), Math.abs(s.high[n]));
  near(most, peak, 1e-5 * peak, `peak of ${name}`);
}
const ways = page.amounts();
let total = 0;
for (let i = 1; i < page.PATH.n; ++i) {
  const kind = page.kindOf(i), rapid = page.PATH.rapid[i], line = page.PATH.line[i];
  check(kind === (rapid === 2 ? "jump" : !rapid ? "feed" : line ? "rapid" : "homing"), `stretch ${i} counts as ${kind}`);
  if (kind !== "jump") total += Math.hypot(page.PATH.x[i] - page.PATH.x[i - 1], page.PATH.y[i] - page.PATH.y[i - 1], page.PATH.z[i] - page.PATH.z[i - 1]);
}
check(ways.feed + ways.rapid + ways.homing <= total + 1e-6 && ways.feed + ways.rapid + ways.homing >= 0.98 * total, `ways ${JSON.stringify(ways)} of ${total}`);
const cut = page.shownBox();
page.S.whole = true;
const whole = page.shownBox();
page.S.whole = false;
for (let k = 0; k < 3; ++k) check(whole.low[k] <= cut.low[k] && cut.high[k] <= whole.high[k] && isFinite(whole.low[k] + cut.high[k]), `the box of the cut leaves the whole in direction ${k}`);
check(byId("title") !== null && byId("cards").textContent.includes(expected.card), "cards show: " + byId("cards").textContent);
for (const text of expected.shown) check([...drawn.text].some(t => t.includes(text)) || Object.values(ids).some(n => n !== ids.data && n.textContent.includes(text)), `"${text}" is nowhere on the page`);

const everything = node => [node, ...node.children.filter(c => c instanceof Node).flatMap(everything)];
for (let round = 0; round < 4; ++round) {
  globals.window.innerWidth = round % 2 ? 400 : 1400;
  for (const node of Object.values(ids).flatMap(everything)) {
    for (const type of ["pointermove", "pointerdown", "pointermove", "pointerup", "wheel", "click", "input", "change", "pointerenter", "pointerleave"])
      node.fire(type, {clientX: 200 + 90 * round, shiftKey: round === 3});
  }
  buttons[round % 2].fire("click");
  settle();
}
for (const key of [" ", "ArrowLeft", "ArrowRight"]) document.handlers.keydown({key, target: byId("plan"), preventDefault() {}, shiftKey: false});
windowHandlers.beforeprint();
windowHandlers.afterprint();
page.setWindow(-5, -4);
check(page.S.t1 > page.S.t0 && page.S.t0 >= expected.start, "the window left the run");
page.setWindow(0, 1e9);
check(page.S.t1 <= page.T_END, "the window left the run");
for (const node of Object.values(ids)) node.fire("dblclick");
settle();
console.log("page_smoke: ok, " + drawn.calls + " drawing calls");
