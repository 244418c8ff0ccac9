// SPDX-License-Identifier: Apache-2.0
// The program beside the path: a listing of any length, and the operations that its comments name.
const ROW = 20;  // px, as in the style

/** A comment that stands alone on its line, without its marks; empty: it is none. */
function commentOf(text) {
  const plain = text.trim(), inside = plain.match(/^\(([^()]*)\)$/) || plain.match(/^;(.*)$/);
  // NC-110 has three-letter commands in brackets: (UOT,0,X10).
  return inside && !/^[A-Z]{3}(,|$)/.test(inside[1]) ? inside[1].trim() : "";
}
/** [{name, from, to}] in lines from 1: headings ("--- Tool 1 ---", "OPERATION 2: ..."), else each comment with motion below it. */
function operationsOf(program, moved) {
  const comments = program.map((text, i) => ({line: i + 1, name: commentOf(text)})).filter(c => /[\p{L}\d]/u.test(c.name));
  const headings = comments.filter(c => /^[-=*#]{2,}|\b(operation|oper|op|tool|toolpath)\b|операц|переход|инструмент/iu.test(c.name));
  const cut = list => list.map((c, i) => ({name: c.name.replace(/^[-=*#\s]+|[-=*#\s]+$/g, ""), from: c.line, to: i + 1 < list.length ? list[i + 1].line - 1 : program.length}))
    .filter(o => moved.some(line => line >= o.from && line <= o.to));
  const named = cut(headings);
  return (named.length > 1 ? named : cut(comments)).slice(0, 500);
}
let OPERATIONS = [];

/** Only the rows in sight exist, so that a program of 80 000 lines scrolls as one of 80. */
function listing(box) {
  const lines = RUN.program, inner = box.appendChild(el("div", {class: "rows", style: `height:${lines.length * ROW}px`})), rows = new Map();
  let longest = 0, marked = 0;
  for (const l of RUN.lines.values()) longest = Math.max(longest, l.total);
  function rowOf(n) {
    const spent = RUN.lines.get(n), bar = el("span", {class: "spent"});
    if (spent) bar.append(el("i", {style: `width:${(100 * spent.total / longest).toFixed(1)}%`}), el("b", {}, num(spent.total, 3) + " " + unit("s")));
    const row = el("div", {class: "row" + (spent ? " used" : "") + (n === marked ? " now" : ""), style: `top:${(n - 1) * ROW}px`},
      el("span", {class: "n"}, String(n)), el("span", {class: "code"}, lines[n - 1] || " "), bar);
    row.addEventListener("pointerenter", () => { S.line = n; emit("line"); });
    if (spent) row.addEventListener("click", () => setCursor(spent.first + 0.5 * RUN.period));
    return row;
  }
  function show(all) {
    const first = all ? 1 : Math.max(1, Math.floor(box.scrollTop / ROW) - 10), last = all ? lines.length : Math.min(lines.length, first + Math.ceil(box.clientHeight / ROW) + 20);
    for (const [n, row] of rows) if (n < first || n > last) { row.remove(); rows.delete(n); }
    for (let n = first; n <= last; ++n) if (!rows.has(n)) rows.set(n, inner.appendChild(rowOf(n)));
  }
  function follow() {
    const line = RUN.lineAt(S.cursor);
    if (line === marked) return;
    if (rows.has(marked)) rows.get(marked).className = rows.get(marked).className.replace(" now", "");
    marked = line;
    if (rows.has(line)) rows.get(line).className += " now";
    const top = (line - 1) * ROW;
    if (S.follow && line > 0 && !S.line && (top < box.scrollTop || top > box.scrollTop + box.clientHeight - 2 * ROW)) box.scrollTop = top - box.clientHeight / 2;
  }
  function again() {
    for (const row of rows.values()) row.remove();
    rows.clear();
    show();
  }
  box.addEventListener("scroll", inNextFrame(() => show()));
  box.addEventListener("pointerleave", () => { S.line = 0; emit("line"); });
  on("cursor", follow);
  on("size", show);
  on("lang", again);
  show();
  follow();
  return {draw() { show(lines.length <= 2000); }, show};
}
