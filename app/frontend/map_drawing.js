// How ink is drawn over a map: signs, lines, particles, words, the scale bar. The page (map_viewer.js) and a
// saved replay (replay/player.js) draw with it alike. Text is drawn, never parsed as HTML.
//
// Whoever draws says in a view where a point of the scene is:
//   project(frame, p)  css px of a point, [x, y]; metres of the scene, or of a map's own frame: "map1", "map2" …
//   maps               by number, where each map lies in the scene: x, y, theta
//   metre              px per metre, seen from above
//   wide, high         px
//   dark               light ink on a dark ground
const mapmeldInk = (() => {
  const ORDER = ["floor", "window", "aug", "box", "trail", "swarm", "rival", "sight", "lesson", "robots", "best", "frame", "axes", "readout", "grip", "drag"];
  const LIGHTER = { "#0072b2": "#56b4e9", "#009e73": "#34d399", "#d55e00": "#fb923c" }; // words on dark ground
  const lerp = (a, b, u) => a + (b - a) * u;
  const smooth = (u) => u * u * (3 - 2 * u);
  const wrap = (a) => a - 2 * Math.PI * Math.round(a / (2 * Math.PI));

  // --- poses: x, y, theta; metres, radians ------------------------------------------------------------
  const STILL = { x: 0, y: 0, theta: 0 };
  const poseOf = (maps, frame) => (frame && maps[frame.slice(3)]) || STILL; // where a frame lies in the scene
  const turn = ([x, y], a) => [Math.cos(a) * x - Math.sin(a) * y, Math.sin(a) * x + Math.cos(a) * y];
  function toScene(pose, point) { const [x, y] = turn(point, pose.theta); return [x + pose.x, y + pose.y]; }
  const toFrame = (pose, [x, y]) => turn([x - pose.x, y - pose.y], -pose.theta); // a point of the scene in it
  // A way from pose to pose that begins at a time, in to.ms; and where on it one is.
  const way = (from, to, began) => ({ from: to.ms ? from : to, to, turn: to.ms ? wrap(to.theta - from.theta) : 0, began, ms: to.ms || 0 });
  function along(w, time) {
    const s = smooth(Math.min(1, (time - w.began) / Math.max(1, w.ms)));
    return { x: lerp(w.from.x, w.to.x, s), y: lerp(w.from.y, w.to.y, s), theta: w.from.theta + w.turn * s };
  }

  function words(g, view, text, x, y, colour, size, align) {
    g.font = `${size || 12}px system-ui, "Segoe UI", sans-serif`;
    g.textAlign = align || "left"; g.textBaseline = "middle";
    g.lineJoin = "round"; g.lineWidth = 4; g.setLineDash([]);
    g.strokeStyle = view.dark ? "rgba(17,24,39,.85)" : "rgba(255,255,255,.9)";
    g.strokeText(text, x, y); g.fillStyle = (view.dark && LIGHTER[colour]) || colour; g.fillText(text, x, y);
  }
  const SHAPES = {
    robot(g, r) { g.moveTo(1.35 * r, 0); g.lineTo(-0.85 * r, 0.8 * r); g.lineTo(-0.45 * r, 0); g.lineTo(-0.85 * r, -0.8 * r); g.closePath(); },
    diamond(g, r) { g.moveTo(r, 0); g.lineTo(0, r); g.lineTo(-r, 0); g.lineTo(0, -r); g.closePath(); },
    dot(g, r) { g.arc(0, 0, r, 0, 7); },
    star(g, r) { for (let i = 0; i < 10; i++) { const q = i % 2 ? 0.45 * r : r, a = Math.PI * (i / 5 - 0.5); g.lineTo(q * Math.cos(a), q * Math.sin(a)); } g.closePath(); },
  };
  function mark(g, view, item) {
    let [x, y] = view.project(item.f, item.p);
    const r = item.r || 8, turn = item.a === undefined ? 0 : item.a + poseOf(view.maps, item.f).theta;
    if (item.arm) { // so many px off its point, the way it looks: a knob
      const end = [x + item.arm * Math.cos(turn), y - item.arm * Math.sin(turn)];
      g.beginPath(); g.moveTo(x, y); g.lineTo(...end); g.setLineDash([]); g.lineWidth = 1.5; g.strokeStyle = item.c; g.stroke();
      [x, y] = end;
    }
    g.save(); g.translate(x, y); g.rotate(-turn); g.setLineDash([]); g.beginPath();
    if (item.s === "none") { /* words alone */ } else if (item.s === "cross" || item.s === "ring") {
      if (item.s === "ring") g.arc(0, 0, r, 0, 7);
      else { g.moveTo(-r, 0); g.lineTo(r, 0); g.moveTo(0, -r); g.lineTo(0, r); }
      g.lineWidth = 5; g.strokeStyle = view.dark ? "#111827" : "#fff"; g.stroke();
      g.lineWidth = 2; g.strokeStyle = item.c; g.stroke();
    } else {
      SHAPES[item.s](g, r);
      g.lineWidth = 4; g.strokeStyle = item.rim || (view.dark ? "#111827" : "#fff"); g.lineJoin = "round"; g.stroke();
      g.fillStyle = item.c; g.fill();
      if (item.rim) { g.lineWidth = 1.5; g.stroke(); }
    }
    g.restore();
    if (item.t) words(g, view, item.t, x + (item.dx ?? r + 5), y + (item.dy ?? 0), item.tc || item.c, item.size, item.align);
  }
  function path(g, view, item) {
    g.beginPath();
    let last = null;
    for (const p of item.p) { const [x, y] = view.project(item.f, p); last ? g.lineTo(x, y) : g.moveTo(x, y); last = [x, y]; }
    if (item.close) g.closePath();
    if (item.fill) { g.fillStyle = item.fill; g.fill(); }
    if (item.round) { g.lineCap = "round"; g.lineJoin = "round"; }
    if (item.c) {
      if (item.halo) { g.setLineDash([]); g.lineWidth = (item.w || 1.5) + 3; g.strokeStyle = view.dark ? "rgba(17,24,39,.8)" : "rgba(255,255,255,.85)"; g.stroke(); }
      g.setLineDash(item.d || []); g.lineWidth = item.w || 1.5; g.strokeStyle = item.c; g.stroke();
    }
    g.lineCap = "butt";
    if (item.t && last) { const at = view.project(item.f, item.tp || item.p[0]); words(g, view, item.t, at[0] + (item.dx || 0), at[1] + (item.dy || 0), item.tc || item.c, item.size || 11, item.align); }
  }
  // A cloud glides from its last state to its new one, so that the eye can follow single particles.
  // Returns whether it is still on its way.
  function cloud(g, view, item, time) {
    const u = item.old ? Math.min(1, (time - item.at) / item.ms) : 1;
    const n = item.n, p = item.p, q = item.old || p, r = item.r || 3, k = item.n3 ? 3 : 2;
    g.setLineDash([]); g.globalAlpha = item.alpha || 0.85;
    g.fillStyle = item.c; g.strokeStyle = item.c; g.lineWidth = 1.2;
    for (let i = 0; i < p.length; i += n) {
      const point = [];
      for (let j = 0; j < k; j++) point.push(lerp(q[i + j], p[i + j], u));
      const s = view.project(item.f, point);
      g.beginPath(); g.arc(s[0], s[1], r, 0, 7); g.fill();
      if (!item.n3 && n > 2) { // the tick looks where map 2's x axis would
        const a = lerp(q[i + 2], p[i + 2], u);
        g.beginPath(); g.moveTo(s[0], s[1]); g.lineTo(s[0] + (r + 6) * Math.cos(a), s[1] - (r + 6) * Math.sin(a)); g.stroke();
      }
    }
    g.globalAlpha = 1;
    return u < 1;
  }
  // Layers with some of them replaced; a cloud takes over from the one that was drawn before.
  function replace(all, news, now) {
    for (const [name, items] of Object.entries(news || {})) {
      (items || []).forEach((item, i) => glide(item, (all[name] || [])[i], now));
      if (items) all[name] = items; else delete all[name];
    }
  }
  // Take over from the cloud that was drawn before, if it is the same one at an earlier time.
  function glide(item, before, now) {
    if (item.k !== "cloud") return;
    const same = before && before.k === "cloud" && before.p.length === item.p.length && item.glide === before.glide;
    item.at = now;
    item.old = same ? before.p : undefined;
    item.ms = same ? Math.min(160, Math.max(30, now - (before.at ?? now - 60))) : 1;
  }
  // All layers, the lowest first; returns whether any of it still moves.
  function layers(g, view, all, time) {
    let moving = false;
    const names = Object.keys(all).sort((a, b) => ORDER.indexOf(a) - ORDER.indexOf(b));
    for (const name of names) for (const item of all[name]) {
      if (item.k === "path") path(g, view, item);
      else if (item.k === "cloud") moving = cloud(g, view, item, time) || moving;
      else mark(g, view, item);
    }
    return moving;
  }
  // A length that is round in metres, and north: the y axis of map 1.
  function scaleBar(g, view) {
    const px = view.metre, most = 130 / px, power = 10 ** Math.floor(Math.log10(most));
    const length = [5, 2, 1].map((k) => k * power).find((k) => k <= most), wide = length * px;
    const x = 18, y = view.high - 22, colour = view.dark ? "#F9FAFB" : "#111827";
    for (const [width, stroke] of [[6, view.dark ? "#111827" : "#fff"], [2, colour]]) {
      g.beginPath(); g.moveTo(x, y - 5); g.lineTo(x, y); g.lineTo(x + wide, y); g.lineTo(x + wide, y - 5);
      g.setLineDash([]); g.lineJoin = "miter"; g.lineWidth = width; g.strokeStyle = stroke; g.stroke();
    }
    const label = length >= 1 ? `${length} m` : length >= 0.01 ? `${Math.round(length * 100)} cm` : `${+(length * 1000).toPrecision(1)} mm`;
    words(g, view, label, x + wide / 2, y - 12, colour, 12, "center");
    const nx = x + wide + 26;
    g.beginPath(); g.moveTo(nx, y - 16); g.lineTo(nx + 5, y); g.lineTo(nx, y - 4); g.lineTo(nx - 5, y); g.closePath();
    g.lineWidth = 4; g.strokeStyle = view.dark ? "#111827" : "#fff"; g.stroke(); g.fillStyle = colour; g.fill();
    words(g, view, "+y", nx, y - 24, colour, 11, "center");
    return colour;
  }
  // The entries of the legend as elements; how they look is up to the page.
  const legend = (entries, prefix, colour = (c) => c) => (entries || []).map((entry) => {
    const chip = document.createElement("span"), swatch = document.createElement("i");
    swatch.className = prefix + entry.s;
    if (entry.s === "scale") {
      swatch.style.background = `linear-gradient(90deg, ${entry.c.join(", ")})`;
      chip.append(entry.low + " ", swatch, " " + entry.high + "  " + entry.t);
    } else { swatch.style.setProperty("--c", colour(entry.c)); chip.append(swatch, entry.t); }
    return chip;
  });
  return { STILL, lerp, wrap, poseOf, toScene, toFrame, way, along, words, replace, layers, scaleBar, legend };
})();
