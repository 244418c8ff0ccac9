// SPDX-License-Identifier: Apache-2.0
// Puts the page together: controls, the transport bar at the foot, the run that is laid over this one.
function speedKey() {
  const stops = Array.from({length: 9}, (_, k) => "rgb(" + rampColour(k / 8, isDark()).map(c => Math.round(255 * c)).join(",") + ")").join(","), most = colourMax();
  const scale = S.colour === "deviation" ? num(most * 1000, 3) + " " + unit("µm") : num(most, 3) + " " + unit("mm/s");
  const named = S.colour === "tool" ? tools().map((tool, n) => ["T" + tool, n % 8]) : S.colour === "bound" ? BOUNDS.map((what, n) => [tr("bound." + what), n]) : null;
  const keys = named ? named.map(([name, n]) => el("span", {class: "key", style: `--c:var(--axis-${n})`}, name)) :
    [el("span", {}, "0"), el("i", {style: `background:linear-gradient(90deg,${stops})`}), el("span", {}, scale)];
  fill("speed-key", ...keys, el("span", {class: "key dash"}, tr("rapidPath")), el("span", {class: "key dots"}, tr("homingPath")), OTHER ? el("span", {class: "key line"}, tr("otherRun")) : null);
}
/** What of the path is shown: tools as switches, operations as a list. */
function filters() {
  const all = tools();
  fill("tools", ...(all.length > 1 ? all : []).map(tool => el("button", {class: "chip" + (S.tools.size && !S.tools.has(tool) ? " out" : ""), style: "--c:var(--accent)", onclick: () => {
    if (!S.tools.delete(tool)) S.tools.add(tool);
    emit("tools");
  }}, "T" + tool)));
  $("operation").hidden = OPERATIONS.length < 2;
  fill("operation", el("option", {value: "-1"}, tr("allOperations")), ...OPERATIONS.map((o, i) => el("option", {value: String(i)}, o.name)));
  $("operation").value = String(S.operation);
  fill("colour", ...["speed", "bound", "deviation", ...(all.length > 1 ? ["tool"] : [])].map(key => el("option", {value: key}, tr("colour." + key))));
  $("colour").value = S.colour;
}
function axisSwitches() {
  fill("axis-switches", ...RUN.axes.map(a => el("button", {class: "chip" + (S.hidden.has(a.letter) ? " out" : ""), style: `--c:${axisColour(a.letter)}`, onclick: () => {
    if (!S.hidden.delete(a.letter)) S.hidden.add(a.letter);
    axisSwitches();
    emit("series");
  }}, a.letter)));
}
function texts() {
  const R = report();
  document.documentElement.lang = S.lang;
  for (const e of document.querySelectorAll("[data-t]")) e.textContent = tr(byFinger() && TEXTS[e.dataset.t + "Finger"] ? e.dataset.t + "Finger" : e.dataset.t);
  const clean = R.finished && !R.alarms.length;
  $("state").textContent = tr(R.finished ? "finished" : "unfinished");
  $("state").className = "badge " + (clean ? "good" : "bad");
  for (const b of document.querySelectorAll("[data-lang]")) b.classList.toggle("chosen", b.dataset.lang === S.lang);
  const p = R.provenance, clock = p.clock === "virtual" ? tr("virtual") : p.clock;
  $("sub").textContent = [clock, p.dialect, p.machine && p.machine.path, ("servogate " + p.version + (p.commit ? " (" + p.commit + ")" : "")).trim()].filter(Boolean).join(" · ");
  $("verdict").className = "verdict " + (clean ? "good" : "bad");
  fill("verdict", sentence(R.verdict.text), R.verdict.remedy ? el("div", {class: "note"}, sentence(R.verdict.remedy)) : null);
  $("forced").textContent = R.forces ? tr("forced") + ": " + R.forces.map(f => f.name + " = " + f.value).join(", ") : "";
  $("dropped").textContent = R.trace_dropped ? tr("dropped", num(R.trace_dropped, 9)) : "";
  if (!RUN) return;
  const unitOf = letter => unit((RUN.axis(letter) || {report: {unit: "mm"}}).report.unit);
  const stretch = (letter, low, high) => RUN.shownName(letter) + " " + num(low * RUN.shownTimes(letter), 6) + " … " + num(high * RUN.shownTimes(letter), 6) + " " + unitOf(letter);
  const others = RUN.axes.filter(a => !RUN.view.includes(a.letter)).map(a => [a.letter, RUN.placesOf(a.letter)]).filter(o => o[1]);
  $("extents").textContent = !RUN.path.n ? "" : tr("extents") + ": " + [...RUN.view.map((letter, k) => letter && stretch(letter, RUN.box.low[k], RUN.box.high[k])),
    ...others.map(([letter, [low, high]]) => stretch(letter, low, high))].filter(Boolean).join(" · ");
  $("turned").textContent = RUN.turned ? tr("turned", RUN.view[1]) : "";
  const steady = steadySignals(), names = (key, list) => list.length ? tr(key) + " — " + list.join(", ") : "";
  $("steady").textContent = steady.count && !S.constant ? tr("steady") + ": " + [names("on", steady.on), names("off", steady.off)].filter(Boolean).join("; ") : "";
  cards(); findings(); limitBars(); threads(); touches(); alarms(); timing(); provenance(); speedKey(); filters(); axisSwitches(); comparison(); readout(); resolution();
}
function resolution() { if (RUN.line.length) $("resolution").textContent = resolutionWords(timeGrid(() => emit("unpacked"))); }
function readout() {
  const place = RUN.placeAt(S.cursor), parts = [];
  const places = RUN.axes.map(a => {
    const v = RUN.view.indexOf(a.letter);
    return v >= 0 && place ? [place.x, place.y, place.z][v] : RUN.valueAt(a.letter + ".position", S.cursor);
  });
  // As the program writes it; the machine's own coordinate stands beside it, smaller.
  RUN.axes.forEach((a, i) => {
    const machine = fixed(places[i] * RUN.shownTimes(a.letter), 3), work = RUN.workAt(i, S.cursor, places);
    parts.push(el("span", {class: "pos", style: `--c:${axisColour(a.letter)}`, title: tr(work === null ? "machinePlace" : "workPlace")},
      el("b", {}, RUN.shownName(a.letter)), work === null ? machine : fixed(work, 3), work === null ? null : el("small", {}, machine)));
  });
  parts.push(el("span", {class: "pos"}, el("b", {}, "F"), num(RUN.valueAt("path.speed", S.cursor), 4) + " " + unit("mm/s")));
  parts.push(el("span", {class: "pos"}, el("b", {}, tr("line")), String(RUN.lineAt(S.cursor) || "–")));
  parts.push(el("span", {class: "pos"}, boundWords(S.cursor).trim()));
  fill("readout", ...parts);
  $("now").textContent = fixed(S.cursor, 3) + " " + unit("s");
  $("slider").value = S.cursor;
  $("play").textContent = S.playing ? "❚❚" : "▶";
  $("play").title = tr(S.playing ? "pause" : "play");
}
function play() {
  S.playing = S.playing ? 0 : performance.now();
  if (S.playing && S.cursor >= RUN.end - RUN.period) setCursor(RUN.start);
  let last = performance.now();
  const step = now => {
    if (!S.playing) return;
    const t = S.cursor + (now - last) / 1000 * +$("pace").value;
    last = now;
    if (t >= RUN.end) S.playing = 0;
    setCursor(t);
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
  readout();
}
function setTheme(theme) {
  S.theme = theme;
  if (theme) document.documentElement.dataset.theme = theme; else delete document.documentElement.dataset.theme;
  emit("theme");
  texts();
}

/** The data of another page of this program; null when the text is no such page. */
function dataOf(html) {
  // In pieces: whole, these would end the element in which this stands.
  const start = "<" + 'script type="application/json" id="data">', at = html.indexOf(start), end = html.indexOf("</" + "script>", at);
  if (at < 0 || end < 0) return null;
  const data = JSON.parse(html.slice(at + start.length, end));
  return data.schema === D.schema && data.run.axes.length ? data : null;
}
/** Lays another run over this one, so that both programs begin to move at the same time. */
async function lay(html) {
  let data = null;
  try { data = dataOf(html); } catch (error) { data = null; }
  $("compare-trouble").textContent = data ? "" : tr("noPage");
  if (data) {
    OTHER = await Run.of(data);
    OTHER.shift = RUN.begin - OTHER.begin;
  }
  $("compare-off").hidden = !OTHER;
  texts();
  emit("other");
}

function controls(plan) {
  for (const b of document.querySelectorAll("[data-lang]")) b.addEventListener("click", () => { S.lang = b.dataset.lang; texts(); emit("lang"); });
  $("theme").addEventListener("click", () => setTheme(isDark() ? "light" : "dark"));
  for (const name of Object.keys(DIRECTIONS)) $("look-" + name).addEventListener("click", () => plan.look(name));
  $("whole").addEventListener("click", () => setWindow(RUN.start, RUN.end));
  $("rapids").addEventListener("change", e => { S.rapids = e.target.checked; emit("rapids"); });
  $("whole-path").addEventListener("change", e => { S.whole = e.target.checked; emit("rapids"); plan.look("iso"); });
  $("colour").addEventListener("change", e => { S.colour = e.target.value; emit("colour"); });
  $("operation").addEventListener("change", e => { S.operation = +e.target.value; emit("operation"); });
  for (const type of ["colour", "tools", "operation", "other"]) on(type, () => { speedKey(); filters(); });
  $("constant").addEventListener("change", e => { S.constant = e.target.checked; texts(); emit("constant"); });
  $("follow").addEventListener("change", e => { S.follow = e.target.checked; });
  $("compare").addEventListener("change", async e => { if (e.target.files && e.target.files[0]) await lay(await e.target.files[0].text()); });
  $("compare-off").addEventListener("click", () => { OTHER = null; $("compare-off").hidden = true; $("compare").value = ""; texts(); emit("other"); });
  $("slider").min = RUN.start;
  $("slider").max = RUN.end;
  $("slider").step = RUN.period;
  $("slider").addEventListener("input", e => setCursor(+e.target.value));
  $("play").addEventListener("click", play);
  document.addEventListener("keydown", e => {
    if (e.target.tagName === "INPUT" || e.target.tagName === "SELECT") return;
    if (e.key === " " && e.target.tagName !== "BUTTON") { e.preventDefault(); play(); }
    if (e.key === "ArrowLeft" || e.key === "ArrowRight") setCursor(S.cursor + (e.key === "ArrowLeft" ? -1 : 1) * (e.shiftKey ? 100 : 1) * RUN.period);
  });
}

async function start() {
  const asked = new URLSearchParams(location.hash.slice(1));  // report.html#t=12.3&theme=dark&lang=ru
  if (asked.get("lang")) S.lang = asked.get("lang") === "ru" ? "ru" : "en";
  texts();  // what came of the run and why stands there whatever this browser cannot do
  RUN = await Run.of(D);
  [S.t0, S.t1] = [RUN.start, RUN.end];
  OPERATIONS = operationsOf(RUN.program, [...RUN.lines.keys()]);
  if (report().alarms.length) $("cards").after($("alarm-section"));
  for (const id of ["path-section", "motion-section", "signal-section", "transport"]) $(id).hidden = !RUN.line.length;
  // Sizes are taken from what is shown.
  $("signals").hidden = RUN.signals.length === 0;
  $("no-signals").hidden = RUN.signals.length > 0;
  const drawn = [];
  if (RUN.program.length) drawn.push(listing($("listing"))); else $("program").hidden = true;
  const plan = pathView($("space"));
  drawn.push(plan);
  for (const spec of chartSpecs()) drawn.push(chart($("charts"), spec));
  drawn.push(lanes($("lanes")));
  controls(plan);
  on("cursor", readout);
  for (const type of ["window", "unpacked"]) on(type, resolution);
  const resized = inNextFrame(() => emit("size"));
  new ResizeObserver(resized).observe(document.body);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { if (!S.theme) setTheme(null); });
  window.addEventListener("beforeprint", () => { document.documentElement.dataset.theme = "light"; const was = S.theme; S.theme = "light"; texts(); drawn.forEach(d => d.draw()); S.theme = was; });
  window.addEventListener("afterprint", () => setTheme(S.theme));
  setTheme(asked.get("theme"));
  const first = report().alarms[0];
  setCursor(asked.get("t") ? +asked.get("t") : first ? first.t : RUN.start + 0.5 * RUN.duration);
}
try {
  await start();
} catch (error) {
  $("broken").textContent = tr("broken", String(error));
  $("broken").hidden = false;
  throw error;
}
