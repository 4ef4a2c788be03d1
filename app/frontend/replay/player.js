// Plays a recorded run: which frame is on, where map 2 and the camera are between two frames, the words
// and curves beside the map. Nothing is computed here and nothing is fetched; what the ink looks like is
// in map_drawing.js, which the live page draws with, too.
(() => {
  const { STILL, lerp, poseOf, toScene, way, along, replace, layers, scaleBar, legend } = mapmeldInk;
  const R = JSON.parse(document.getElementById("recording").textContent);
  const $ = (id) => document.getElementById(id);
  const CAMERA_MS = 220, LAST = R.length;
  const PLAY = '<svg viewBox="0 0 10 10"><path d="M1.5 .8v8.4L9 5z"/></svg>';
  const PAUSE = '<svg viewBox="0 0 10 10"><path d="M1.5 1h2.6v8H1.5zM5.9 1h2.6v8H5.9z"/></svg>';

  // --- every frame as a whole: what has not changed is taken over from the frame before -----------
  // The camera's middle and size glide, the size by its logarithm, as a zoom does; however often it is
  // told another place on its way, it comes near as quickly.
  const boxAt = (look, ms) => {
    const s = 1 - Math.exp(-(ms - look.began) / CAMERA_MS), a = look.from, b = look.to;
    const part = (k) => {
      const wide = Math.exp(lerp(Math.log(a[k + 2] - a[k]), Math.log(b[k + 2] - b[k]), s)) / 2;
      const middle = lerp(a[k] + a[k + 2], b[k] + b[k + 2], s) / 2;
      return [middle - wide, middle + wide];
    };
    const [x0, x1] = part(0), [y0, y1] = part(1);
    return [x0, y0, x1, y1];
  };
  let now = { layers: {}, hud: {}, curves: [], pictures: [], ghost: [0, 0, 0], table: null,
    ways: { 1: way(STILL, STILL, 0), 2: way(STILL, STILL, 0) }, look: null };
  const frames = R.frames.map((told) => {
    const ms = told.t * 1000, before = now;
    now = { ...before, t: told.t, hud: { ...before.hud, ...told.hud } };
    for (const name of ["curves", "pictures", "ghost", "table"]) if (told[name] !== undefined) now[name] = told[name];
    if (told.layers) {
      now.layers = { ...before.layers };
      replace(now.layers, told.layers, ms);
    }
    for (const [number, to] of Object.entries(told.maps || {})) {
      now.ways = { ...now.ways, [number]: way(along(before.ways[number], ms), to, ms) };
    }
    if (told.look) now.look = { from: before.look ? boxAt(before.look, ms) : told.look.box, to: told.look.box, began: ms };
    return now;
  });
  const frameAt = (t) => { // the last frame that is not later
    let low = 0, high = frames.length - 1;
    while (low < high) { const middle = (low + high + 1) >> 1; if (frames[middle].t <= t + 1e-6) low = middle; else high = middle - 1; }
    return frames[low];
  };

  // --- colours: recorded for a light page, translated for a dark one ------------------------------
  const translated = new Map();
  function darker(c) {
    if (!translated.has(c)) {
      const hex = /^#(..)(..)(..)$/.exec(c), rgba = /^rgba\((\d+,\d+,\d+),(.*)\)$/.exec(c);
      const key = hex ? hex.slice(1).map((part) => parseInt(part, 16)).join() : rgba ? rgba[1] : "";
      const to = R.dark[key];
      translated.set(c, !to ? c : rgba ? `rgba(${to},${rgba[2]})` : `rgb(${to})`);
    }
    return translated.get(c);
  }
  const colour = (c) => (P.dark && c ? darker(c) : c);
  const inked = (item) => (P.dark ? { ...item, c: colour(item.c), tc: colour(item.tc), fill: colour(item.fill) } : item);
  function recoloured(image) { // a picture has few colours: each pixel is looked up
    const canvas = document.createElement("canvas");
    canvas.width = image.width; canvas.height = image.height;
    const g = canvas.getContext("2d", { willReadFrequently: true });
    g.drawImage(image, 0, 0);
    const data = g.getImageData(0, 0, canvas.width, canvas.height), p = data.data;
    const table = new Map(Object.entries(R.dark).map(([a, b]) => {
      const [x, y, z] = a.split(",").map(Number);
      return [x << 16 | y << 8 | z, b.split(",").map(Number)];
    }));
    for (let i = 0; i < p.length; i += 4) {
      const to = p[i + 3] && table.get(p[i] << 16 | p[i + 1] << 8 | p[i + 2]);
      if (to) { p[i] = to[0]; p[i + 1] = to[1]; p[i + 2] = to[2]; }
    }
    g.putImageData(data, 0, 0);
    return canvas;
  }

  // --- state and clock ----------------------------------------------------------------------------
  const P = { time: 0, playing: false, speed: 1, dark: matchMedia("(prefers-color-scheme: dark)").matches, own: null, length: LAST };
  let dirty = true, shown = null, ticked = 0;
  const markAt = (t) => { let k = 0; R.marks.forEach((mark, i) => { if (mark.t <= t + 1e-6) k = i; }); return k; };
  P.seek = (t) => { P.time = Math.min(LAST, Math.max(0, t)); dirty = true; };
  P.play = (yes) => {
    if (yes && P.time >= LAST) P.seek(0);
    P.playing = yes; ticked = performance.now(); dirty = true;
  };
  P.step = (by) => { // to the beginning of the next step, or of this one, or of the one before
    const here = markAt(P.time), began = R.marks[here].t;
    if (by > 0) P.seek(here + 1 < R.marks.length ? R.marks[here + 1].t : LAST);
    else P.seek(P.time - began > 0.6 || here === 0 ? began : R.marks[here - 1].t);
  };
  P.theme = (dark) => { P.dark = dark; document.documentElement.dataset.theme = dark ? "dark" : "light"; shown = null; dirty = true; };
  function tick(time) {
    if (P.playing) {
      // A frame's time is when it began, which may be before the click that started the clock.
      const from = P.time, to = Math.min(LAST, from + Math.max(0, time - ticked) / 1000 * P.speed);
      const next = R.marks.find((mark) => mark.t > from + 2e-3); // it is held 1e-3 before a mark
      const halt = $("halt").checked && next && to >= next.t;
      P.time = halt ? next.t - 1e-3 : to;
      if (halt || to >= LAST) P.playing = false;
      dirty = true;
    }
    ticked = Math.max(ticked, time);
  }

  // --- the map ------------------------------------------------------------------------------------
  const map = $("map").querySelector("canvas");
  const scale = () => parseFloat(getComputedStyle(document.documentElement).fontSize) / 16;
  function fit(canvas) { // the canvas as large as its box; returns context and size in px of the design
    const k = scale() * devicePixelRatio, wide = Math.round(canvas.clientWidth * devicePixelRatio), high = Math.round(canvas.clientHeight * devicePixelRatio);
    if (canvas.width !== wide || canvas.height !== high) { canvas.width = wide; canvas.height = high; }
    const g = canvas.getContext("2d");
    g.setTransform(k, 0, 0, k, 0, 0);
    g.clearRect(0, 0, wide / k, high / k);
    return [g, wide / k, high / k];
  }
  function camera(frame, ms, wide, high) {
    if (P.own) return P.own;
    const [x0, y0, x1, y1] = boxAt(frame.look, ms), top = 22, bottom = 62, side = 22;
    const metre = Math.min((wide - 2 * side) / (x1 - x0), (high - top - bottom) / (y1 - y0));
    return { metre, x: (x0 + x1) / 2, y: (y0 + y1) / 2 + (top - bottom) / 2 / metre };
  }
  function pictures(g, frame, view) {
    const [x, y, theta] = frame.ghost, ghost = { x, y, theta };
    for (const number of frame.pictures) {
      const picture = R.pictures[number], image = P.dark ? picture.dark : picture.light;
      const base = picture.frame === "ghost" ? ghost : poseOf(view.maps, picture.frame), [x, y] = view.project("scene", [base.x, base.y]), m = view.metre;
      const [wide, high] = picture.size.map((length) => length * m);
      g.save();
      g.translate(x, y); g.rotate(-base.theta);
      g.translate(picture.at[0] * m, -picture.at[1] * m); g.rotate(-picture.at[2]);
      const to = g.getTransform(), cell = Math.hypot(to.a, to.b) * wide / image.width; // px on the screen
      g.imageSmoothingEnabled = cell < 1.5; // cells are squares with hard edges; from afar they are averaged
      g.imageSmoothingQuality = "high";
      for (let k = picture.thin ? 2 : 1; k; k--) g.drawImage(image, -wide / 2, -high / 2, wide, high); // thin walls stay dark from afar
      g.restore();
    }
  }
  function paintMap(frame) {
    const [g, wide, high] = fit(map), ms = P.time * 1000, c = camera(frame, ms, wide, high);
    g.fillStyle = P.dark ? `rgb(${R.dark["229,231,235"]})` : "rgb(229,231,235)"; g.fillRect(0, 0, wide, high);
    const maps = Object.fromEntries(Object.entries(frame.ways).map(([number, way]) => [number, along(way, ms)]));
    const view = {
      maps, metre: c.metre, wide, high, dark: P.dark,
      project(name, point) {
        const [x, y] = toScene(poseOf(maps, name), point);
        return [wide / 2 + (x - c.x) * c.metre, high / 2 - (y - c.y) * c.metre];
      },
    };
    pictures(g, frame, view);
    const all = {};
    for (const [name, items] of Object.entries(frame.layers)) all[name] = items.map(inked);
    layers(g, view, all, ms);
    scaleBar(g, view);
    P.view = view; P.camera = c;
  }

  // --- words and curves ---------------------------------------------------------------------------
  const element = (name, text, of) => { const e = document.createElement(name); if (text !== undefined) e.textContent = text; if (of) of.append(e); return e; };
  function rows(of, all) {
    const table = element("table", undefined, of);
    for (const row of all) { const tr = element("tr", undefined, table); for (const cell of row) element("td", cell, tr); }
  }
  function showWords(frame) {
    const h = frame.hud, caption = $("caption"), said = h.state || "";
    caption.dataset.mood = h.mood; caption.lastElementChild.textContent = said;
    caption.classList.toggle("long", said.length > 95 && said.length <= 230);
    caption.classList.toggle("longer", said.length > 230);
    $("legend").replaceChildren(...legend(h.legend, "", colour));
    const table = $("table"), told = frame.table;
    table.hidden = !told; $("charts").hidden = !!told;
    $("says").textContent = told ? "" : frame.curves.map((chart) => chart.says || "").join(" ").trim();
    if (told) {
      table.dataset.mood = told.mood || "";
      table.replaceChildren();
      if (told.title) element("h2", told.title, table);
      if (told.says) element("p", told.says, table);
      rows(table, told.rows);
    }
  }
  function paintCharts(frame) {
    if (frame.table) return;
    const [g, wide, high] = fit($("charts"));
    mapmeldCharts.paint(g, frame.curves, wide, high, {
      colour, text: P.dark ? "#F9FAFB" : "#111827", quiet: P.dark ? "#9CA3AF" : "#6B7280", line: P.dark ? "#374151" : "#E5E7EB",
    });
  }
  function paintBar() {
    const share = `${100 * P.time / LAST}%`, seek = $("seek"), here = markAt(P.time);
    seek.querySelector(".track i").style.width = share; seek.querySelector(".knob").style.left = share;
    seek.setAttribute("aria-valuenow", P.time.toFixed(1)); seek.setAttribute("aria-valuetext", `${P.time.toFixed(1)} of ${LAST.toFixed(1)} seconds, ${R.marks[here].name}`);
    $("time").textContent = `${P.time.toFixed(1)} / ${LAST.toFixed(1)} s`;
    const sign = P.playing ? PAUSE : PLAY;
    if ($("play").dataset.sign !== String(P.playing)) { $("play").dataset.sign = P.playing; $("play").innerHTML = sign; $("play").setAttribute("aria-label", P.playing ? "Pause" : "Play"); }
    $("big").hidden = P.playing || P.time > 0;
    $("back").hidden = !P.own;
    [...$("steps").children].forEach((button, k) => {
      button.classList.toggle("done", k <= here);
      if (k === here) button.setAttribute("aria-current", "step"); else button.removeAttribute("aria-current");
    });
  }
  let size = "";
  function loop(time) {
    tick(time);
    const box = [map.clientWidth, map.clientHeight, $("charts").clientHeight, devicePixelRatio].join();
    if (box !== size) { size = box; shown = null; dirty = true; }
    if (dirty) {
      dirty = false;
      const frame = frameAt(P.time);
      if (frame !== shown) { shown = frame; showWords(frame); paintCharts(frame); }
      paintMap(frame); paintBar();
    }
    requestAnimationFrame(loop);
  }

  // --- what a person does -------------------------------------------------------------------------
  const speeds = [...$("speed").options].map((option) => option.value);
  const setSpeed = (k) => { $("speed").selectedIndex = Math.min(speeds.length - 1, Math.max(0, k)); P.speed = Number($("speed").value); };
  const KEYS = {
    " ": () => P.play(!P.playing), k: () => P.play(!P.playing), ArrowRight: () => P.step(1), ArrowLeft: () => P.step(-1),
    ArrowUp: () => setSpeed($("speed").selectedIndex + 1), ArrowDown: () => setSpeed($("speed").selectedIndex - 1),
    Home: () => P.seek(0), End: () => P.seek(LAST), d: () => P.theme(!P.dark), i: () => $("facts").showModal(),
  };
  const taken = (e) => !KEYS[e.key.length > 1 ? e.key : e.key.toLowerCase()] || $("facts").open || e.target.tagName === "SELECT" || e.ctrlKey || e.metaKey || e.altKey;
  document.addEventListener("keydown", (e) => { if (!taken(e)) { e.preventDefault(); KEYS[e.key.length > 1 ? e.key : e.key.toLowerCase()](); } });
  document.addEventListener("keyup", (e) => { if (e.key === " " && !taken(e)) e.preventDefault(); }); // or the button in focus is pressed, too
  $("play").onclick = $("big").onclick = () => P.play(!P.playing);
  $("dark").onclick = () => P.theme(!P.dark);
  $("about").onclick = () => $("facts").showModal();
  $("speed").onchange = () => setSpeed($("speed").selectedIndex);
  $("back").onclick = () => { P.own = null; dirty = true; };
  const dragTo = (e) => { const box = $("seek").getBoundingClientRect(); P.seek((e.clientX - box.left) / box.width * LAST); };
  $("seek").addEventListener("pointerdown", (e) => { $("seek").setPointerCapture(e.pointerId); dragTo(e); });
  $("seek").addEventListener("pointermove", (e) => { if ($("seek").hasPointerCapture(e.pointerId)) dragTo(e); });
  map.addEventListener("wheel", (e) => {
    e.preventDefault();
    const c = P.camera, box = map.getBoundingClientRect(), k = scale(), zoom = Math.exp(-Math.max(-100, Math.min(100, e.deltaY)) / 300);
    const x = ((e.clientX - box.left) / k - P.view.wide / 2) / c.metre, y = (P.view.high / 2 - (e.clientY - box.top) / k) / c.metre;
    P.own = { metre: c.metre * zoom, x: c.x + x * (1 - 1 / zoom), y: c.y + y * (1 - 1 / zoom) };
    dirty = true;
  }, { passive: false });
  map.addEventListener("pointerdown", (e) => map.setPointerCapture(e.pointerId));
  map.addEventListener("pointermove", (e) => {
    if (!map.hasPointerCapture(e.pointerId) || !(e.movementX || e.movementY)) return;
    const c = P.camera, k = scale() * c.metre;
    P.own = { metre: c.metre, x: c.x - e.movementX / k, y: c.y + e.movementY / k };
    dirty = true;
  });

  // --- the page -----------------------------------------------------------------------------------
  $("name").textContent = R.name;
  $("made").textContent = `${R.method} · seed ${R.seed}${R.version === "unknown" ? "" : ` · mapmeld ${R.version}`}`;
  R.marks.forEach((mark, k) => {
    const button = element("button", `${mark.name}`, $("steps"));
    button.title = `To this step (← →)`;
    button.onclick = () => P.seek(mark.t);
    const tickMark = element("b", undefined, $("seek"));
    tickMark.style.left = `${100 * mark.t / LAST}%`;
  });
  $("seek").append($("seek").querySelector(".knob")); // above the marks
  $("seek").setAttribute("aria-valuemax", LAST);
  for (const note of R.notes) element("p", note, $("told"));
  element("h3", "Verdict", $("told")); element("p", R.verdict, $("told"));
  element("h3", "The run", $("told")); rows($("told"), R.facts);
  element("h3", "Settings", $("told")); rows($("told"), R.settings);
  P.theme(P.dark);
  window.replay = P;
  Promise.all(R.pictures.map(async (picture) => {
    const image = new Image();
    image.src = picture.data;
    await image.decode();
    picture.light = image; picture.dark = recoloured(image);
  }).concat(R.frames.flatMap((told) => told.curves || []).filter((chart) => chart.image).map((chart) => {
    chart.picture = new Image();
    chart.picture.src = chart.image;
    return chart.picture.decode();
  }))).then(() => { $("page").hidden = false; P.ready = true; requestAnimationFrame(loop); });
})();
