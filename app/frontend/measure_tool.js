// A distance on the map: press "Measure", then two places, or drag from one to the other; Escape ends it.
// And words that go to the clipboard at a press.
(() => {
  const S = window.mapmeld;
  if (S.measure) { S.measure.reset(); return; }
  const { metre, words } = S.kit;
  const M = { on: false, line: null };
  S.measure = M;
  M.reset = () => { M.on = false; M.line = null; };
  let sheet = null, switched = null, fixed = false, pressed = null;

  const text = (number, digits) => number.toFixed(digits).replace("-", "−");
  function show() {
    if (!sheet) return;
    const there = S.view === "map" && Boolean(S.hud.measure); // a map to measure on
    if (!there) end();
    sheet.hidden = !M.on;
    switched.parentElement.hidden = !there;
    switched.setAttribute("aria-pressed", M.on);
    S.dirty = true;
  }
  function end() { M.on = false; M.line = null; pressed = null; if (sheet) sheet.hidden = true; switched?.setAttribute("aria-pressed", false); S.dirty = true; }
  function place(e) { // of the pointer; metres of the scene, whose axes are map 1's
    const box = S.kit.canvas().getBoundingClientRect(), camera = S.kit.camera(), px = metre(camera);
    return [(e.clientX - box.left - box.width / 2) / px + camera.position.x, (box.top + box.height / 2 - e.clientY) / px + camera.position.y];
  }
  function set(a, b) {
    const x = b[0] - a[0], y = b[1] - a[1];
    M.line = { a, b, metres: Math.hypot(x, y), degrees: Math.atan2(y, x) * 180 / Math.PI };
    S.dirty = true;
  }
  function adopt(hud, canvas) {
    sheet = document.createElement("div"); sheet.className = "mm-sheet"; sheet.hidden = true;
    sheet.onpointerdown = (e) => {
      if (e.button) return;
      sheet.setPointerCapture(e.pointerId);
      pressed = [e.clientX, e.clientY];
      if (M.line && !fixed) { set(M.line.a, place(e)); fixed = true; } // the second place
      else { set(place(e), place(e)); fixed = false; }
    };
    sheet.onpointermove = (e) => {
      if (M.line && !fixed) set(M.line.a, place(e));
      canvas.dispatchEvent(new PointerEvent(e.type, { clientX: e.clientX, clientY: e.clientY })); // where it is
    };
    sheet.onpointerup = (e) => { // a drag ends where it is let go; a click waits for the second place
      if (pressed && Math.hypot(e.clientX - pressed[0], e.clientY - pressed[1]) > 4) fixed = true;
      pressed = null;
    };
    // the wheel goes on to zoom the map
    sheet.addEventListener("wheel", (e) => { e.preventDefault(); canvas.dispatchEvent(new WheelEvent(e.type, e)); }, { passive: false });
    hud.prepend(sheet);
    S.kit.keep(sheet);
    const group = document.createElement("span");
    switched = document.createElement("button");
    switched.type = "button"; switched.textContent = "Measure";
    switched.title = "A distance in metres: two places on the map, or drag. Escape ends it.";
    switched.onclick = () => { if (M.on) end(); else { M.on = true; fixed = false; } show(); };
    group.append(switched);
    S.kit.keep(group);
    hud.querySelector(".mm-tools").append(group);
    show();
  }
  document.addEventListener("keydown", (e) => { if (e.key === "Escape" && M.on) { end(); show(); } });

  function paint(g, view) {
    if (!M.on || S.view !== "map") return;
    const colour = S.dark ? "#F9FAFB" : "#111827";
    if (!M.line) {
      const head = document.querySelector("#mapmeld-hud .mm-head");
      words(g, view, "Two places, or a drag from one to the other. Esc ends it.", view.wide / 2, head.offsetTop + head.offsetHeight + 16, colour, 12, "center");
      return;
    }
    const a = view.project("scene", M.line.a), b = view.project("scene", M.line.b);
    const along = Math.atan2(b[1] - a[1], b[0] - a[0]), nx = -6 * Math.sin(along), ny = 6 * Math.cos(along);
    for (const [width, stroke] of [[5, S.dark ? "rgba(17,24,39,.9)" : "rgba(255,255,255,.95)"], [2, "#CC79A7"]]) {
      g.setLineDash([]); g.lineWidth = width; g.strokeStyle = stroke; g.lineCap = "round"; g.beginPath();
      g.moveTo(a[0], a[1]); g.lineTo(b[0], b[1]);
      for (const [x, y] of [a, b]) { g.moveTo(x - nx, y - ny); g.lineTo(x + nx, y + ny); }
      g.stroke(); g.lineCap = "butt";
    }
    const [dx, dy] = [M.line.b[0] - M.line.a[0], M.line.b[1] - M.line.a[1]];
    plate(g, view, [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], along, [
      [`${text(M.line.metres, M.line.metres < 10 ? 3 : 2)} m  at ${text(M.line.degrees, 1)}°`, 14],
      [S.kit.named(`Δx ${text(dx, 2)} m, Δy ${text(dy, 2)} m in map 1`), 11],
    ]);
  }
  // Lines of text on a plate beside a line on the map: on the side that is up, and never over it.
  function plate(g, view, [x, y], along, lines) {
    const colour = view.dark ? "#F9FAFB" : "#111827", pad = 7, high = lines.length * 17 + pad;
    const wide = 2 * pad + Math.max(...lines.map(([said, size]) => {
      g.font = `${size}px system-ui, "Segoe UI", sans-serif`;
      return g.measureText(said).width;
    }));
    let [nx, ny] = [-Math.sin(along), Math.cos(along)];
    if (ny > 0) [nx, ny] = [-nx, -ny];
    const off = Math.abs(nx) * wide / 2 + Math.abs(ny) * high / 2 + 9;
    const within = (at, half, most) => Math.min(most - half - 4, Math.max(half + 4, at));
    const cx = within(x + off * nx, wide / 2, view.wide), cy = within(y + off * ny, high / 2, view.high);
    g.beginPath(); g.roundRect(cx - wide / 2, cy - high / 2, wide, high, 6);
    g.fillStyle = view.dark ? "rgba(31,41,55,.94)" : "rgba(255,255,255,.94)"; g.fill();
    g.setLineDash([]); g.lineWidth = 1; g.strokeStyle = "#CC79A7"; g.stroke();
    lines.forEach(([said, size], k) => words(g, view, said, cx, cy + (k - (lines.length - 1) / 2) * 17, colour, size, "center"));
  }
  let seenView = "";
  function frame() { if (S.view !== seenView) { seenView = S.view; show(); } }
  function apply(message) { if (message.hud && ("measure" in message.hud || "case" in message.hud)) { end(); show(); } }
  S.parts.push({ adopt, frame, paint, apply });

  // --- the clipboard ----------------------------------------------------------------------------
  async function copy(words) { // a page that is not served safely has no clipboard: the old way then
    try { await navigator.clipboard.writeText(words); return true; } catch { /* the old way */ }
    const field = document.createElement("textarea");
    field.value = words; field.style.cssText = "position:fixed;opacity:0";
    document.body.append(field); field.select();
    const done = document.execCommand("copy");
    field.remove();
    return done;
  }
  document.addEventListener("click", async (e) => {
    const b = e.target.closest?.("[data-mm-copy]");
    if (!b || b.disabled) return;
    const done = await copy(b.dataset.mmCopy), said = b.dataset.mmSaid || b.textContent;
    b.dataset.mmSaid = said;
    if (!done) { // leave it marked: Ctrl+C is all that is left to do
      const line = b.parentElement.querySelector("code");
      if (line) getSelection().selectAllChildren(line);
    }
    b.textContent = done ? "Copied" : "Press Ctrl+C";
    setTimeout(() => { b.textContent = said; }, 1800);
  });

  const style = document.createElement("style");
  style.textContent = `
    .mm-sheet{position:absolute;inset:0;pointer-events:auto;cursor:crosshair;touch-action:none}
    .mm-sheet[hidden]{display:none}
    .mm-publish{margin:6px 10px 10px;font-size:12.5px}
    .mm-publish p{margin:0 0 3px}
    .mm-publish code{display:block;font:11.5px/1.45 ui-monospace,"DejaVu Sans Mono",monospace;padding:6px 8px;border-radius:4px 4px 0 0;background:rgba(107,114,128,.12);overflow-wrap:anywhere}
    .mm-publish button{display:block;width:100%;border:0;border-radius:0 0 4px 4px;padding:5px;font:600 12.5px/1.4 system-ui,"Segoe UI",sans-serif;color:#111827;background:#E2E8F0;cursor:pointer}
    .mm-publish button:hover:not(:disabled){background:#CBD5E1} .mm-publish button:disabled{cursor:default}
    [data-mantine-color-scheme=dark] .mm-publish button{background:#374151;color:#F9FAFB} [data-mantine-color-scheme=dark] .mm-publish button:hover:not(:disabled){background:#4B5563}
    .mm-publish button:focus-visible{outline:2px solid #0072B2;outline-offset:1px}`;
  document.head.append(style);
})();
