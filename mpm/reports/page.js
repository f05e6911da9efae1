"use strict";
(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const numeric = column => column.values.some(value => typeof value === "number");
  const kinds = column => {  // what is swept in words: its places, named
    const names = [...new Set(column.values)];
    return { ...column, names, values: column.values.map(value => names.indexOf(value)) };
  };
  const columns = data.columns.filter(column => column.swept || numeric(column)).map(column => numeric(column) ? column : kinds(column));
  const count = data.status.length;
  const byId = id => document.getElementById(id);
  const movie = byId("movie"), play = byId("play");
  if (movie && play) {
    const moving = movie.src;
    play.hidden = false;
    play.addEventListener("click", () => {
      const stops = play.textContent === "Stop the movie";
      if (stops) {
        const canvas = document.createElement("canvas");
        canvas.width = movie.naturalWidth; canvas.height = movie.naturalHeight;
        canvas.getContext("2d").drawImage(movie, 0, 0);
        movie.src = canvas.toDataURL();
      } else { movie.src = moving; }
      play.textContent = stops ? "Play the movie" : "Stop the movie";
    });
  }
  if (!columns.length || count < 2) { return; }
  byId("controls").hidden = false;
  const ns = "http://www.w3.org/2000/svg";
  const draw = (parent, name, attributes, text) => {
    const made = document.createElementNS(ns, name);
    for (const [key, value] of Object.entries(attributes)) { made.setAttribute(key, value); }
    if (text !== undefined) { made.textContent = text; }
    parent.appendChild(made);
    return made;
  };
  const short = (value, step = 0) => {  // digits enough to tell `step` apart
    if (typeof value !== "number") { return value === null ? "–" : value; }
    const digits = step > 0 && value !== 0 ? Math.ceil(Math.log10(Math.abs(value) / step)) + 1 : 4;
    return Number(value.toPrecision(Math.min(15, Math.max(4, digits)))).toString();
  };
  const said = (column, value, step) => column.names ? column.names[value] : short(value, step);
  const tick = (column, value, step) => { const text = String(said(column, value, step)); return text.length > 12 ? text.slice(0, 11) + "…" : text; };
  const ticks = (column, [low, high]) => column.names && column.names.length < 9 ? column.names.map((name, k) => k) : [0, 1, 2, 3, 4, 5].map(k => low + (high - low) * k / 5);
  const range = column => {
    const numbers = column.values.filter(value => typeof value === "number");
    const low = Math.min(...numbers), high = Math.max(...numbers);
    return low === high ? [low - 0.5, high + 0.5] : [low, high];
  };
  const brushes = new Map();
  const inside = i => [...brushes].every(([k, [low, high]]) => {
    const value = columns[k].values[i];
    return typeof value === "number" && value >= low && value <= high;
  });
  const hue = share => {
    const stops = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [222, 205, 40]];
    const at = Math.max(0, Math.min(0.9999, share)) * (stops.length - 1), k = Math.floor(at);
    return "rgb(" + stops[k].map((one, j) => Math.round(one + (at - k) * (stops[k + 1][j] - one))).join(",") + ")";
  };
  const chart = byId("chart"), parallel = byId("parallel"), told = byId("told");
  const selects = ["across", "up", "colour"].map(byId);
  const swept = columns.findIndex(column => column.swept), answer = columns.findIndex(column => !column.swept);
  selects.forEach((select, place) => {
    columns.forEach((column, k) => {
      const option = document.createElement("option");
      option.value = k; option.textContent = column.label;
      select.appendChild(option);
    });
    const other = columns.findIndex((column, k) => column.swept && k !== swept);
    select.value = [Math.max(swept, 0), answer >= 0 ? answer : 0, other >= 0 ? other : Math.max(swept, 0)][place];
    select.addEventListener("change", scatter);
  });
  let marks = [], lines = [], current = -1;
  const say = i => {
    current = i;
    marks.forEach((mark, j) => { if (mark) { mark.classList.toggle("on", i === j); } });
    told.textContent = columns.map(column => column.label + ": " + said(column, column.values[i])).join("; ") + "; " + data.status[i];
  };
  function scatter() {
    chart.replaceChildren();
    const [x, y, c] = selects.map(select => columns[Number(select.value)]);
    const [left, right, top, bottom] = [80, 780, 15, 360], [x0, x1] = range(x), [y0, y1] = range(y), [c0, c1] = range(c);
    const px = value => left + (value - x0) / (x1 - x0) * (right - left), py = value => bottom - (value - y0) / (y1 - y0) * (bottom - top);
    ticks(y, [y0, y1]).forEach(value => {
      draw(chart, "line", { class: "grid", x1: left, x2: right, y1: py(value), y2: py(value) });
      draw(chart, "text", { x: left - 8, y: py(value) + 4, "text-anchor": "end" }, tick(y, value, (y1 - y0) / 5));
    });
    ticks(x, [x0, x1]).forEach(value => draw(chart, "text", { x: px(value), y: bottom + 18, "text-anchor": "middle" }, tick(x, value, (x1 - x0) / 5)));
    draw(chart, "line", { class: "axis", x1: left, x2: right, y1: bottom, y2: bottom });
    draw(chart, "line", { class: "axis", x1: left, x2: left, y1: top, y2: bottom });
    draw(chart, "text", { x: (left + right) / 2, y: bottom + 42, "text-anchor": "middle" }, x.label);
    draw(chart, "text", { x: 14, y: (top + bottom) / 2, "text-anchor": "middle", transform: "rotate(-90 14 " + (top + bottom) / 2 + ")" }, y.label);
    marks = data.status.map((status, i) => {
      const [vx, vy, vc] = [x.values[i], y.values[i], c.values[i]];
      if (typeof vx !== "number" || typeof vy !== "number") { return null; }
      const mark = draw(chart, "circle", { class: "mark", cx: px(vx), cy: py(vy), r: count > 300 ? 3.5 : 6, fill: typeof vc === "number" ? hue((vc - c0) / (c1 - c0)) : "gray" });
      mark.addEventListener("pointerenter", () => say(i));
      return mark;
    });
    fade();
  }
  chart.addEventListener("keydown", event => {
    const way = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!way) { return; }
    event.preventDefault();
    for (let k = 1; k <= count; k++) {
      const i = (current + way * k + count * k) % count;
      if (marks[i]) { say(i); return; }
    }
  });
  function fade() {
    let kept = 0;
    for (let i = 0; i < count; i++) {
      const within = inside(i);
      kept += within;
      if (marks[i]) { marks[i].classList.toggle("out", !within); }
      if (lines[i]) { lines[i].classList.toggle("out", !within); }
    }
    byId("kept").textContent = brushes.size ? kept + " of " + count + " points kept" : "";
  }
  const shown = columns.slice(0, 9), top = 50, bottom = 290;
  const at = k => shown.length > 1 ? 60 + k * 680 / (shown.length - 1) : 400;
  const ranges = shown.map(range);
  const height = (k, value) => bottom - (value - ranges[k][0]) / (ranges[k][1] - ranges[k][0]) * (bottom - top);
  lines = data.status.map((status, i) => {
    const places = shown.map((column, k) => [k, column.values[i]]).filter(([, value]) => typeof value === "number");
    return places.length > 1 ? draw(parallel, "polyline", { class: "run", points: places.map(([k, value]) => at(k) + "," + height(k, value)).join(" ") }) : null;
  });
  shown.forEach((column, k) => {
    draw(parallel, "line", { class: "axis", x1: at(k), x2: at(k), y1: top, y2: bottom });
    const name = column.label.length > 22 ? column.label.slice(0, 21) + "…" : column.label;
    draw(parallel, "text", { x: k ? (k === shown.length - 1 ? 795 : at(k)) : 5, y: k % 2 ? 16 : 32, "text-anchor": k ? (k === shown.length - 1 ? "end" : "middle") : "start" }, name);
    draw(parallel, "text", { x: at(k), y: top - 4, "text-anchor": "middle" }, tick(column, ranges[k][1], ranges[k][1] - ranges[k][0]));
    draw(parallel, "text", { x: at(k), y: bottom + 16, "text-anchor": "middle" }, tick(column, ranges[k][0], ranges[k][1] - ranges[k][0]));
    const brush = draw(parallel, "rect", { class: "brush", x: at(k) - 7, width: 14, y: 0, height: 0, visibility: "hidden" });
    const handle = draw(parallel, "rect", { class: "handle", x: at(k) - 14, width: 28, y: top - 8, height: bottom - top + 16 });
    let began = null;
    const value = event => {
      const box = parallel.getBoundingClientRect(), y = (event.clientY - box.top) / box.height * 320;
      return ranges[k][0] + (bottom - Math.max(top, Math.min(bottom, y))) / (bottom - top) * (ranges[k][1] - ranges[k][0]);
    };
    handle.addEventListener("pointerdown", event => { began = value(event); handle.setPointerCapture(event.pointerId); });
    handle.addEventListener("pointermove", event => {
      if (began === null) { return; }
      const ends = [began, value(event)].sort((a, b) => a - b);
      brushes.set(k, ends);
      brush.setAttribute("visibility", "visible");
      brush.setAttribute("y", height(k, ends[1]));
      brush.setAttribute("height", Math.max(1, height(k, ends[0]) - height(k, ends[1])));
      fade();
    });
    handle.addEventListener("pointerup", event => {
      if (began !== null && Math.abs(height(k, began) - height(k, value(event))) < 3) { brushes.delete(k); brush.setAttribute("visibility", "hidden"); }
      began = null;
      fade();
    });
    byId("clear").addEventListener("click", () => { brushes.delete(k); brush.setAttribute("visibility", "hidden"); fade(); });
  });
  scatter();
}());
