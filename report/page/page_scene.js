// SPDX-License-Identifier: Apache-2.0
// What of a path is shown and in which colours, as plain numbers.
const RAMP = {
  light: [[68, 34, 120], [49, 94, 168], [22, 142, 132], [110, 170, 44], [214, 120, 10]],
  dark: [[140, 110, 240], [80, 160, 250], [52, 208, 180], [170, 222, 90], [255, 176, 64]],
};
/** Colour of a ratio from 0 to 1, as three numbers from 0 to 1. */
function rampColour(ratio, dark) {
  const ramp = RAMP[dark ? "dark" : "light"], x = clamp(ratio, 0, 1) * (ramp.length - 1), i = Math.min(Math.floor(x), ramp.length - 2);
  return ramp[i].map((c, k) => (c + (x - i) * (ramp[i + 1][k] - c)) / 255);
}
/** Whether tool and operation of the stretch that ends at vertex i are chosen. */
function chosen(i) {
  const {line, tool} = RUN.path;
  if (S.tools.size && !S.tools.has(tool[i])) return false;
  const operation = OPERATIONS[S.operation];
  return !operation || (line[i] >= operation.from && line[i] <= operation.to);
}
function tools() { return [...new Set(RUN.path.tool.filter((tool, i) => tool > 0 && i > 0 && RUN.kindOf(i) === "feed"))].sort((a, b) => a - b); }
const BOUNDS = ["feed", "velocity", "acceleration", "jerk", "tolerance", "rest"];
/** Largest value of what colours the feed, of all that is chosen. */
function colourMax() {
  const {path} = RUN, list = S.colour === "deviation" ? path.deviation : path.speed;
  let most = 0;
  for (let i = 1; i < path.n; ++i) if (!path.rapid[i] && list[i] > most && chosen(i)) most = list[i];
  return most || 1;
}
/** Colour of the stretch that ends at a vertex, by what the reader chose. */
function colouring() {
  const {path} = RUN, dark = isDark(), most = colourMax();
  if (S.colour === "deviation") return i => rampColour(path.deviation[i] / most, dark);
  if (S.colour === "tool") {
    const colours = new Map(tools().map((tool, n) => [tool, rgb(css("--axis-" + n % 8))])), none = rgb(css("--accent"));
    return i => colours.get(path.tool[i]) || none;
  }
  if (S.colour === "bound") {
    const colours = new Map(BOUNDS.map((what, n) => [what, rgb(css("--axis-" + n))]));
    return i => colours.get(RUN.boundOn(i));
  }
  return i => rampColour((path.speed[i] + path.speed[i - 1]) / 2 / most, dark);
}
/** What limits the speed at t, as a line of its own; empty where nothing of the program moves. */
function boundWords(t) {
  const {what, letter} = RUN.boundAt(t);
  return what === "rest" || !RUN.lineAt(t) ? "" : "\n" + tr("bound") + ": " + tr("bound." + what) + (letter && " " + letter);
}
/** Ends of the stretches for which keep(i), and their colours: {positions, colours, vertices}. */
function stretchesOf(run, keep, colour) {
  const {path} = run, vertices = [];
  for (let i = 1; i < path.n; ++i) if (path.rapid[i] !== 2 && keep(i)) vertices.push(i);
  const positions = new Float32Array(6 * vertices.length), colours = new Float32Array(colour ? 6 * vertices.length : 0);
  vertices.forEach((i, n) => {
    positions.set([path.x[i - 1], path.y[i - 1], path.z[i - 1], path.x[i], path.y[i], path.z[i]], 6 * n);
    if (!colour) return;
    const c = colour(i);
    colours.set(c, 6 * n);
    colours.set(c, 6 * n + 3);
  });
  return {positions, colours, vertices};
}
/** Travel of the machine along axis k of the view, [low, high]; null where it has no end. */
function travelOf(k) {
  const axis = RUN.axis(RUN.view[k]), limits = axis && axis.report.limits;
  return limits && limits.travel_max !== undefined ? [limits.travel_min, limits.travel_max] : null;
}
/** What the view shows when it fits: the cut, or all there is with the travel of the machine; a turned part whole. */
function shownBox() {
  const from = S.whole ? RUN.box : RUN.cut, box = {low: [...from.low], high: [...from.high]};
  if (S.whole) [0, 1].forEach(k => {
    const ends = travelOf(k);
    if (ends) [box.low[k], box.high[k]] = [Math.min(box.low[k], ends[0]), Math.max(box.high[k], ends[1])];
  });
  if (RUN.turned) {
    const r = Math.max(Math.abs(box.low[1]), Math.abs(box.high[1]));
    if (!S.whole) [box.low[1], box.high[1], box.low[2], box.high[2]] = [-r, r, -r, r];
  }
  return box;
}
/** The same path with fewer stretches, at most about `most`: those that follow one another are joined by threes, tens ... */
function coarser({vertices, colours}, most) {
  const {x, y, z} = RUN.path, each = Math.ceil(vertices.length / most), positions = [], kept = [];
  for (let n = 0; n < vertices.length;) {
    let end = n;
    while (end + 1 < vertices.length && end + 1 - n < each && vertices[end + 1] === vertices[end] + 1) ++end;
    const [a, b] = [vertices[n] - 1, vertices[end]];
    positions.push(x[a], y[a], z[a], x[b], y[b], z[b]);
    kept.push(...colours.subarray(6 * n, 6 * n + 6));
    n = end + 1;
  }
  return {positions: Float32Array.from(positions), colours: Float32Array.from(kept)};
}
/** Circles around the turning axis through the ends of at most 300 stretches, as pairs of points. */
function ringsOf(positions) {
  const out = [], each = Math.max(1, Math.ceil(positions.length / 6 / 300)), points = 48;
  for (let n = 0; n < positions.length; n += 6 * each)
    for (let k = 0; k < points; ++k)
      for (const a of [k, k + 1].map(step => 2 * Math.PI * step / points)) out.push(positions[n + 3], positions[n + 4] * Math.cos(a), positions[n + 4] * Math.sin(a));
  return out;
}
/** Lines of a box as pairs of points. */
function edgesOf(box) {
  const corner = n => [0, 1, 2].map(k => (n >> k & 1 ? box.high : box.low)[k]), out = [];
  for (let n = 0; n < 8; ++n) for (let k = 0; k < 3; ++k) if (!(n >> k & 1)) out.push(...corner(n), ...corner(n | 1 << k));
  return out;
}
/** Nearest stretch within 12 px of a place on the screen: fractional vertex index, or -1. `at(i)`: [x, y] of a vertex. */
function nearest(vertices, at, x, y) {
  let best = 12 * 12, found = -1;
  for (const i of vertices) {
    const [ax, ay] = at(i - 1), [bx, by] = at(i), ux = bx - ax, uy = by - ay, u2 = ux * ux + uy * uy;
    const s = u2 > 0 ? clamp(((x - ax) * ux + (y - ay) * uy) / u2, 0, 1) : 1, d = (ax + s * ux - x) ** 2 + (ay + s * uy - y) ** 2;
    if (d < best) [best, found] = [d, i - 1 + s];
  }
  return found;
}
