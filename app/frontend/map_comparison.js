// Both maps compared where they lie: overlay, blink, curtain, difference; what came of them; and the places where they
// contradict each other, ringed and numbered. The server shows the pictures that a mode needs and says
// which modes there are; what moves with the hand or the clock is done here.
(() => {
  const S = window.mapmeld;
  if (S.compare) { S.compare.reset(); return; }
  const { viewer, metre, named } = S.kit;
  const NAMES = { overlay: "Overlay", blink: "Blink", curtain: "Curtain", difference: "Difference", result: "Merged map" };
  const HINTS = {
    overlay: "What there is now.",
    blink: "Map 1 and map 2 take turns.",
    curtain: "Map 1 to the left of a line that you drag, map 2 to its right.",
    difference: "Only walls that the other map denies stand out.",
    result: "The merged map as it is given away, with what was corrected in it.",
  };
  const TURN = 1200; // ms that each map is seen while they take turns: slow enough to look
  const PICTURES = { 1: ["/world/map1/free", "/world/map1/walls"], 2: ["/world/map2/free", "/world/map2/walls"] };
  const ALL = 1e6, NONE = -1e6; // a plane that far away cuts nothing, or everything
  const calm = window.matchMedia("(prefers-reduced-motion: reduce)");

  const blank = () => ({ modes: [], mode: "overlay", places: [], colours: {}, chosen: null, at: 0.5, shown: 0, held: calm.matches });
  const C = Object.assign({}, blank());
  S.compare = C;
  C.reset = () => Object.assign(C, blank());
  let head = null, group = null, curtain = null, turns = null, began = 0, planes = null, seenView = "";

  const make = (tag, className, ...inside) => {
    const element = document.createElement(tag);
    element.className = className;
    element.append(...inside);
    return element;
  };
  const button = (text, hint, press) => {
    const b = make("button", "", text);
    b.type = "button"; b.title = hint; b.onclick = press;
    return b;
  };
  const redraw = () => { S.dirty = true; viewer()?.requestRender(); };
  const active = () => (S.view === "map" && C.modes.includes(C.mode) ? C.mode : "overlay");

  // --- what each half shows ---------------------------------------------------------------------
  // Two planes, one for the pictures of each map: a curtain is a plane, a blink is one that cuts all.
  function cut(camera) {
    if (!planes) {
      const normal = (x) => new camera.position.constructor(x, 0, 0);
      planes = { 1: { normal: normal(-1), constant: 0 }, 2: { normal: normal(1), constant: 0 } };
      planes.cuts = { 1: [planes[1]], 2: [planes[2]] };
    }
    const mode = active();
    if (mode === "curtain") {
      const x = camera.position.x + (C.at - 0.5) * S.kit.canvas().clientWidth / metre(camera);
      planes[1].constant = x; planes[2].constant = -x;
    } else {
      planes[1].constant = mode === "blink" && C.shown === 1 ? NONE : ALL;
      planes[2].constant = mode === "blink" && C.shown === 0 ? NONE : ALL;
    }
  }
  function before(renderer, scene, camera) {
    if (!renderer.localClippingEnabled) { renderer.localClippingEnabled = true; redraw(); }
    cut(camera);
  }
  function clip() {
    const cutting = active() === "blink" || active() === "curtain";
    for (const [side, names] of Object.entries(PICTURES)) for (const name of names) {
      viewer().nodeRefFromName[name]?.traverse((mesh) => {
        if (!mesh.isMesh || !mesh.material.map) return;
        mesh.onBeforeRender = before;
        const wanted = cutting && planes ? planes.cuts[side] : null;
        if (mesh.material.clippingPlanes !== wanted) { mesh.material.clippingPlanes = wanted; redraw(); }
      });
    }
  }

  // --- blink ------------------------------------------------------------------------------------
  function hold(shown) { // stay on one map, or go on
    C.held = shown !== null;
    if (C.held) C.shown = shown; else began = performance.now() - TURN * C.shown;
    show(); redraw();
  }
  function blink(time) {
    if (active() !== "blink" || C.held) return;
    const now = Math.floor((time - began) / TURN) % 2;
    if (now !== C.shown) { C.shown = now; show(); redraw(); }
  }

  // --- curtain ----------------------------------------------------------------------------------
  function draw(at) {
    C.at = Math.min(0.98, Math.max(0.02, at));
    curtain.style.left = `${100 * C.at}%`;
    const handle = curtain.querySelector("[role=slider]");
    handle.setAttribute("aria-valuenow", Math.round(100 * C.at));
    redraw();
  }
  function makeCurtain() {
    const handle = make("div", "mm-handle", "◂▸"), line = make("div", "mm-rule");
    handle.setAttribute("role", "slider"); handle.tabIndex = 0; handle.title = "Drag, or use the arrow keys.";
    handle.setAttribute("aria-valuemin", 2); handle.setAttribute("aria-valuemax", 98);
    handle.onkeydown = (e) => {
      const step = { ArrowLeft: -0.01, ArrowRight: 0.01, PageDown: -0.1, PageUp: 0.1 }[e.key];
      if (step) { draw(C.at + step); e.preventDefault(); e.stopPropagation(); }
    };
    for (const part of [handle, line]) {
      part.onpointerdown = (e) => { part.setPointerCapture(e.pointerId); part.dataset.held = ""; handle.focus(); e.preventDefault(); };
      part.onpointermove = (e) => {
        if (!("held" in part.dataset)) return;
        const box = S.kit.canvas().getBoundingClientRect();
        draw((e.clientX - box.left) / box.width);
      };
      part.onpointerup = part.onpointercancel = () => { delete part.dataset.held; };
    }
    return make("div", "mm-curtain", line, make("b", "mm-left"), make("b", "mm-right"), handle);
  }

  // --- words and buttons ------------------------------------------------------------------------
  function adopt(hud) {
    group = make("span", "");
    group.setAttribute("role", "group"); group.setAttribute("aria-label", "Compare");
    curtain = makeCurtain();
    turns = make("div", "mm-turns", button("", "", () => hold(0)), button("", "", () => hold(1)),
      button("", "", () => hold(C.held ? null : C.shown)));
    hud.prepend(curtain);
    hud.append(turns);
    head = hud.querySelector(".mm-head");
    hud.querySelector(".mm-tools").prepend(group);
    for (const element of [group, curtain, turns]) S.kit.keep(element);
    show();
  }
  function name() { // who the two maps are
    const sides = [named("map 1"), named("map 2")];
    curtain.querySelector("[role=slider]").setAttribute("aria-label", named("Curtain between map 1 and map 2"));
    sides.forEach((side, k) => {
      curtain.querySelectorAll("b")[k].textContent = turns.children[k].textContent = side;
      turns.children[k].title = named(`Stay on map ${k + 1}.`);
    });
    for (const b of group.children) b.title = named(HINTS[b.dataset.mode]);
  }
  function show() {
    if (!group) return;
    const modes = S.view === "map" ? C.modes : [];
    group.hidden = modes.length === 0;
    if (group.dataset.modes !== modes.join()) {
      group.dataset.modes = modes.join();
      group.replaceChildren(...modes.map((mode) => {
        const b = button(NAMES[mode], "", () => S.tell("compare", { mode }));
        b.dataset.mode = mode;
        return b;
      }));
    }
    for (const b of group.children) b.setAttribute("aria-pressed", b.dataset.mode === C.mode);
    name();
    const mode = active();
    curtain.hidden = mode !== "curtain";
    turns.hidden = mode !== "blink";
    below();
    for (const element of [curtain, turns]) {
      element.style.setProperty("--c1", C.colours.map1 || "#0072b2"); element.style.setProperty("--c2", C.colours.map2 || "#009e73");
    }
    const [one, two, pause] = turns.children;
    one.setAttribute("aria-pressed", C.shown === 0); two.setAttribute("aria-pressed", C.shown === 1);
    pause.textContent = C.held ? "▶ take turns" : "❚❚ hold";
    pause.title = C.held ? "Let the maps take turns." : "Stay on the map that is seen now.";
    mark();
  }

  function below() { // the words above the map: they may take two lines or three
    const foot = `${head.offsetTop + head.offsetHeight + 6}px`;
    if (curtain.style.top !== foot) curtain.style.top = turns.style.top = foot;
  }

  // --- the places where the maps contradict each other ------------------------------------------
  const listed = (target) => target.closest?.("[data-mm-place]");
  document.addEventListener("click", (e) => {
    const keep = e.target.closest?.("[data-mm-keep]");
    if (keep) S.tell("keep", { n: Number(keep.dataset.mmAt), does: keep.dataset.mmKeep });
    const row = listed(e.target);
    if (!row || row.disabled) return;
    const n = Number(row.dataset.mmPlace), place = C.places.find((one) => one.n === n);
    C.chosen = place && C.chosen !== n ? n : null;
    if (C.chosen) {
      const [x, y] = place.at, r = Math.max(1.5, 2.2 * place.r);
      S.follow = false;
      S.kit.aim(true, { view: "map", box: [x - r, y - r, x + r, y + r] });
    } else { S.follow = true; S.kit.aim(true); }
    mark(); redraw();
  });
  function mark() { // the rows of the list are made by the server, again and again
    for (const row of document.querySelectorAll("[data-mm-place]")) {
      const on = String(C.chosen !== null && Number(row.dataset.mmPlace) === C.chosen);
      if (row.getAttribute("aria-pressed") !== on) row.setAttribute("aria-pressed", on);
    }
  }
  function ring(g, view, place) {
    const [x, y] = view.project("scene", place.at), strong = place.n === C.chosen;
    const r = Math.max(11, (place.r + 0.25) * view.metre), colour = C.colours.conflict || "#d55e00";
    g.setLineDash([]); g.beginPath(); g.arc(x, y, r, 0, 7);
    g.lineWidth = strong ? 6 : 4.5; g.strokeStyle = S.dark ? "rgba(17,24,39,.85)" : "rgba(255,255,255,.9)"; g.stroke();
    g.lineWidth = strong ? 3 : 1.6; g.strokeStyle = colour; g.stroke();
    const k = Math.SQRT1_2 * r, size = strong ? 10 : 8.5;
    g.beginPath(); g.arc(x + k, y - k, size, 0, 7); g.fillStyle = colour; g.fill();
    g.font = `bold ${strong ? 12 : 10.5}px system-ui, "Segoe UI", sans-serif`;
    g.textAlign = "center"; g.textBaseline = "middle"; g.fillStyle = "#fff"; g.fillText(place.n, x + k, y - k + 0.5);
  }
  function paint(g, view) {
    if (S.view !== "map" || !C.modes.length) return;
    const rings = C.places.filter((place) => place.n === C.chosen || active() === "difference");
    for (const place of rings.reverse()) ring(g, view, place); // the largest on top
  }

  function apply(message) {
    const news = message.compare;
    if (message.hud?.names !== undefined) show();
    if (!news) return;
    if (news.mode && news.mode !== C.mode) { began = performance.now(); C.shown = 0; C.held = calm.matches; }
    if (news.places) C.chosen = null;
    Object.assign(C, news);
    show(); redraw();
  }
  function frame(time) {
    if (S.view !== seenView) { seenView = S.view; show(); }
    blink(time);
    clip();
    if (!planes) cut(S.kit.camera());
  }
  setInterval(() => { mark(); if (head && active() !== "overlay") below(); }, 150);
  S.parts.push({ adopt, frame, paint, apply });

  const style = document.createElement("style");
  style.textContent = `
    .mm-curtain{position:absolute;top:98px;bottom:0;width:0;left:50%}
    .mm-curtain[hidden],.mm-turns[hidden]{display:none}
    .mm-rule{position:absolute;top:0;bottom:0;left:-9px;width:18px;cursor:ew-resize;pointer-events:auto;touch-action:none}
    .mm-rule::after{content:"";position:absolute;left:8px;width:2px;top:0;bottom:0;background:#111827;box-shadow:0 0 0 1.5px rgba(255,255,255,.9)}
    [data-theme=dark] .mm-rule::after{background:#F9FAFB;box-shadow:0 0 0 1.5px rgba(17,24,39,.9)}
    .mm-handle{position:absolute;left:-15px;top:22%;width:30px;height:30px;border-radius:50%;background:#111827;color:#fff;display:flex;align-items:center;justify-content:center;font-size:12px;letter-spacing:2px;text-indent:2px;cursor:ew-resize;pointer-events:auto;touch-action:none;box-shadow:0 0 0 2px #fff,0 2px 6px rgba(17,24,39,.4)}
    [data-theme=dark] .mm-handle{background:#F9FAFB;color:#111827;box-shadow:0 0 0 2px #111827}
    .mm-handle:focus-visible{outline:3px solid #56B4E9;outline-offset:2px}
    .mm-curtain b{position:absolute;top:0;font-size:12px;padding:1px 8px;border-radius:9px;color:#fff;white-space:nowrap}
    .mm-left{right:10px;background:var(--c1)} .mm-right{left:10px;background:var(--c2)}
    .mm-turns{position:absolute;top:98px;left:50%;transform:translateX(-50%);display:flex;border-radius:8px;overflow:hidden;background:rgba(255,255,255,.94);box-shadow:0 1px 4px rgba(17,24,39,.25)}
    [data-theme=dark] .mm-turns{background:rgba(31,41,55,.96)}
    .mm-turns button{pointer-events:auto;font:inherit;font-size:12px;line-height:24px;padding:0 10px;border:0;background:transparent;color:inherit;cursor:pointer;white-space:nowrap}
    .mm-turns button:nth-child(1)[aria-pressed=true]{background:var(--c1);color:#fff}
    .mm-turns button:nth-child(2)[aria-pressed=true]{background:var(--c2);color:#fff}
    .mm-turns button:nth-child(3){min-width:92px;border-left:1px solid #CBD5E1}
    .mm-turns button:focus-visible{outline:2px solid #56B4E9;outline-offset:-2px}
    .mm-places{margin:0 10px 8px;font-size:12.5px;font-variant-numeric:tabular-nums}
    .mm-places p{margin:0 0 4px;line-height:1.4}
    .mm-places .mm-keep{display:none;gap:4px;margin:3px 0 6px 26px}
    .mm-places [aria-pressed=true]+.mm-keep{display:flex}
    .mm-places button{display:grid;grid-template-columns:22px 50px 1fr auto;align-items:center;gap:4px;width:100%;text-align:left;font:inherit;color:inherit;padding:3px 6px 3px 3px;border:1px solid transparent;border-radius:6px;background:transparent;cursor:pointer}
    .mm-places button:hover:not(:disabled){background:rgba(213,94,0,.10)}
    .mm-places button:focus-visible{outline:2px solid #0072B2}
    .mm-places button[aria-pressed=true]{background:rgba(213,94,0,.14);border-color:#D55E00}
    .mm-places button:disabled{cursor:default}
    .mm-places .mm-keep button{display:block;flex:1;width:auto;padding:3px 2px;font-size:12px;text-align:center;border-color:#9CA3AF88}
    .mm-places .mm-keep button[aria-pressed=true]{background:#0072B2;border-color:#0072B2;color:#fff}
    @media (pointer:coarse){.mm-places button{min-height:40px}}
    .mm-places i{font-style:normal;font-size:11px;font-weight:700;text-align:center;line-height:18px;width:18px;height:18px;border-radius:50%;background:#D55E00;color:#fff}
    .mm-places small{font-size:11.5px;opacity:.75}`;
  document.head.append(style);
})();
