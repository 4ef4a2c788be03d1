// What a person does by hand, as far as the browser does it by itself: keys, entries of the history.
(() => {
  const S = window.mapmeld;
  if (S.handy) return;
  S.handy = true;

  // --- a reload finds everything as it was: see app/web/session_store.py -----------------------------------------
  const KEY = "mapmeld";
  let greeted = false;
  const MODE = "mapmeld-mode", MODES = ["Operator", "Research"];
  const mode = () => { try { return MODES.find((known) => known === localStorage.getItem(MODE)) || ""; } catch { return ""; } };
  const stored = () => { try { return sessionStorage.getItem(KEY) || ""; } catch { return ""; } }; // may be forbidden
  S.heard.push((message) => {
    if (message.channel) { S.tell("hello", { key: stored(), again: greeted, mode: mode() }); greeted = true; }
    if (message.mode) { try { localStorage.setItem(MODE, message.mode); } catch { /* then the next tab opens as the server has it */ } }
    if (message.key) { try { sessionStorage.setItem(KEY, message.key); } catch { /* then a reload starts anew */ } }
  });

  // --- undo and redo --------------------------------------------------------------------------------
  function typing(element) { // a text field has an undo of its own; a menu that can be searched has none worth having
    if (!element || element.getAttribute("aria-haspopup") === "listbox") return false;
    if (element.tagName === "INPUT") return !element.readOnly && /^(text|number|search|email|url|password|)$/.test(element.type);
    return element.tagName === "TEXTAREA" || element.isContentEditable;
  }
  document.addEventListener("keydown", (e) => {
    if (!(e.ctrlKey || e.metaKey) || e.altKey || typing(document.activeElement)) return;
    const key = e.key.toLowerCase();
    const step = key === "z" ? (e.shiftKey ? 1 : -1) : key === "y" && !e.shiftKey ? 1 : 0;
    if (!step) return;
    e.preventDefault(); e.stopPropagation();
    S.tell("step", { by: step });
  }, true);
  document.addEventListener("click", (e) => {
    const entry = e.target.closest?.("button.mm-entry"), step = e.target.closest?.("button.mm-step");
    const suggestion = e.target.closest?.("button[data-mm-suggestion]");
    if (suggestion) S.tell("suggest", { number: Number(suggestion.dataset.mmSuggestion) });
    if (e.target.closest?.("button.mm-take")) S.tell("take");
    if (entry) S.tell("go", { to: Number(entry.dataset.go) });
    if (step) S.tell("step", { by: Number(step.dataset.by) });
  });

  // --- taking hold of things on the map -------------------------------------------------------------
  // S.hand says what can be taken hold of; everything is optional:
  //   mov    {hull, arm, cell, still}: map 2, by the inside of its hull (points of its frame), and turned
  //          by a knob so many px off its anchor; cell in metres; still: it can be turned alone
  //   grips  [{id, f, p, a, vague}]: signs at p in frame f that can be carried; with a heading a, turned
  //          too; a vague one is not known before it is turned
  //   place  {id, f}: the next touch puts this sign down, and a drag from there turns it
  //   draw   {id, r}: a drag draws: "brush", a way r metres wide on both sides, "box", a rectangle, or "line"
  // While something is held the browser draws it by itself; Python is told 15 times a second, and at the end,
  // by which of its own words on where map 2 lies the browser went.
  const REACH = 15, ARM = 34, EVERY = 66, MOST = 100; // px to a sign, px from it to its knob, ms between two words, points of one word
  let hold = null, said = 0, late = null;
  const { wrap, poseOf, toFrame } = mapmeldInk;
  const inFrame = (f, point) => toFrame(poseOf(S.maps, f), point);
  const inside = (point, hull) => {
    let within = false;
    for (let i = 0, j = hull.length - 1; i < hull.length; j = i++) {
      const [xi, yi] = hull[i], [xj, yj] = hull[j];
      if (yi > point[1] !== yj > point[1] && point[0] < (xj - xi) * (point[1] - yi) / (yj - yi) + xi) within = !within;
    }
    return within;
  };
  function knobOf(grip, arm) { // where the heading of a sign is turned, px of the window
    const at = S.pixel(grip.p, grip.f), a = grip.a + poseOf(S.maps, grip.f).theta;
    return [at[0] + arm * Math.cos(a), at[1] - arm * Math.sin(a)];
  }
  function under(x, y) { // what would be taken hold of at a place of the window
    const h = S.hand;
    if (!h || S.view !== "map") return null;
    if (h.draw) return { kind: "draw", ...h.draw };
    if (h.place) return { kind: "place", ...h.place };
    const near = ([a, b]) => Math.hypot(a - x, b - y);
    let best = null, reach = REACH;
    for (const grip of h.grips || []) {
      const body = near(S.pixel(grip.p, grip.f)), knob = grip.a === null || grip.a === undefined ? Infinity : near(knobOf(grip, ARM));
      if (knob < reach) { best = { kind: "knob", ...grip }; reach = knob; }
      if (body < reach) { best = { kind: "body", ...grip }; reach = body; }
    }
    if (best) return best;
    if (h.mov && near(knobOf({ f: "map2", p: [0, 0], a: 0 }, h.mov.arm)) < REACH) return { kind: "turn" };
    return h.mov && inside(inFrame("map2", S.ground(x, y)), h.mov.hull) ? { kind: h.mov.still ? "turn" : "carry" } : null;
  }
  const angleAt = (point, centre) => Math.atan2(point[1] - centre[1], point[0] - centre[0]);
  function drawn() { // what is drawn just now
    const c = "#D55E00", [a, b] = [hold.points[0], hold.points.at(-1)];
    if (hold.id === "box") return { k: "path", p: [a, [b[0], a[1]], b, [a[0], b[1]]], close: true, c, fill: "rgba(213,94,0,.2)", w: 1.5 };
    if (hold.id === "line") return { k: "path", p: [a, b], c, w: 3, halo: true };
    const wide = Math.max(2, 2 * hold.r * S.kit.metre(S.kit.camera()));
    return { k: "path", p: hold.points.length > 1 ? hold.points : [a, [a[0] + 1e-3, a[1]]], c: "rgba(213,94,0,.45)", w: wide, round: true };
  }
  function stroke(last) { // what was drawn is told; of a long way one part after another
    S.tell("draw", { id: hold.id, points: hold.points.flat().map((number) => +number.toFixed(3)) });
    if (!last) hold.points = [hold.points.at(-1)];
  }
  function hover(at) { // the brush where it would touch
    const h = S.hand?.draw;
    if (!h || h.id !== "brush") return;
    S.layers.drag = [{ k: "mark", s: "ring", p: at, c: "#D55E00", r: Math.max(2, h.r * S.kit.metre(S.kit.camera())) }];
    S.dirty = true;
  }
  function sketch() { // the sign that is held, where it is held
    if (hold?.kind === "draw") { S.layers.drag = [drawn()]; S.dirty = true; return; }
    if (!hold || !hold.p) { delete S.layers.drag; S.dirty = true; return; }
    const items = [{ k: "mark", s: "ring", f: hold.f, p: hold.p, c: "#D55E00", r: 12 }];
    if (hold.a !== null && hold.a !== undefined) items.push({ k: "mark", s: "robot", f: hold.f, p: hold.p, a: hold.a, c: "#D55E00", r: 8 });
    S.layers.drag = items; S.dirty = true;
  }
  const round = (number) => Math.round(number * 1e6) / 1e6;
  function report(last) {
    const now = performance.now();
    clearTimeout(late); late = null;
    if (!last && now - said < EVERY) { late = setTimeout(() => report(false), EVERY - (now - said)); return; }
    said = now;
    if (hold.kind === "carry" || hold.kind === "turn") {
      const { x, y, theta } = S.maps[2], at = { x: round(x), y: round(y), theta: round(wrap(theta)) };
      if (last) S.tell("put", { ...at, knew: S.placed }); else S.tell("carry", at);
    } else {
      const known = hold.a !== null && hold.a !== undefined && !(hold.vague && hold.kind === "body");
      S.tell(last ? "drop" : "drag", { id: hold.id, at: hold.p.map(round), heading: known ? [round(wrap(hold.a))] : [] });
    }
  }
  const stop = (e) => { e.preventDefault(); e.stopImmediatePropagation(); };
  addEventListener("pointerdown", (e) => {
    if (hold) { stop(e); return; } // a second finger
    if (e.target !== S.surface() || e.button !== 0) return;
    const found = under(e.clientX, e.clientY);
    if (!found) return;
    stop(e);
    document.activeElement?.blur?.(); // keys belong to the map now
    const at = S.ground(e.clientX, e.clientY);
    hold = { ...found, pointer: e.pointerId, from: at, mov: S.maps[2], moved: false, start: [e.clientX, e.clientY] };
    if (hold.kind === "carry" && (e.shiftKey || e.altKey)) hold.kind = "turn";
    if (hold.kind === "draw") { hold.points = [at]; sketch(); }
    if (hold.kind === "place") { hold.p = inFrame(hold.f, at); hold.a = null; sketch(); }
    S.held = true;
  }, true);
  addEventListener("pointermove", (e) => {
    if (!hold) {
      const canvas = S.surface();
      if (!canvas || e.target !== canvas) return;
      const found = S.hand ? under(e.clientX, e.clientY) : null;
      if (found?.kind === "draw") hover(S.ground(e.clientX, e.clientY));
      const cursor = { place: "crosshair", draw: "crosshair", knob: "grab", turn: "grab", body: "move", carry: e.shiftKey || e.altKey ? "grab" : "move" }[found?.kind] || "";
      if (canvas.style.cursor !== cursor) canvas.style.cursor = cursor;
      return;
    }
    if (e.pointerId !== hold.pointer) return;
    stop(e);
    const at = S.ground(e.clientX, e.clientY);
    if (!hold.moved && Math.hypot(e.clientX - hold.start[0], e.clientY - hold.start[1]) < 3) return;
    hold.moved = true;
    if (hold.kind === "draw") {
      if (hold.id === "brush") hold.points.push(at); else hold.points[1] = at;
      sketch();
      if (hold.points.length >= MOST) stroke(false);
      return;
    }
    if (hold.kind === "carry") {
      S.carry({ x: hold.mov.x + at[0] - hold.from[0], y: hold.mov.y + at[1] - hold.from[1], theta: hold.mov.theta });
    } else if (hold.kind === "turn") { // about the seen robot, which is where map 2 hangs
      const centre = [hold.mov.x, hold.mov.y];
      S.carry({ ...hold.mov, theta: hold.mov.theta + wrap(angleAt(at, centre) - angleAt(hold.from, centre)) });
    } else if (hold.kind === "body") {
      const now = inFrame(hold.f, at), before = inFrame(hold.f, hold.from), first = (S.hand.grips || []).find((g) => g.id === hold.id);
      hold.origin ??= first ? first.p : hold.p;
      hold.p = [hold.origin[0] + now[0] - before[0], hold.origin[1] + now[1] - before[1]];
    } else { // "knob", or the heading of what has just been put down
      if (hold.kind === "place" && Math.hypot(e.clientX - hold.start[0], e.clientY - hold.start[1]) < 8) { hold.a = null; sketch(); return; }
      hold.a = angleAt(inFrame(hold.f, at), hold.p);
    }
    if (hold.p) sketch();
    report(false);
  }, true);
  function release(e) {
    if (!hold || e.pointerId !== hold.pointer) return;
    stop(e);
    if (hold.kind === "draw") { if (hold.moved || hold.id === "brush") stroke(true); }
    else if (hold.moved || hold.kind === "place") report(true);
    hold = null; S.held = false; clearTimeout(late); late = null;
    sketch();
  }
  addEventListener("pointerup", release, true);
  addEventListener("pointercancel", release, true);

  // --- map 2 by the keys ----------------------------------------------------------------------------
  const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  const TURNS = { "[": 1, "]": -1, "{": 1, "}": -1 };
  const busy = (e) => document.querySelector("dialog[open], [role=dialog]") || e && (typing(e) || e.closest?.("input, textarea, select, [role=slider], [role=listbox], [role=tablist], [role=menu]"));
  document.addEventListener("keydown", (e) => {
    if (!S.hand || S.view !== "map" || hold || e.ctrlKey || e.metaKey || e.altKey || busy(document.activeElement)) return;
    if (e.key === "Escape" && (S.hand.place || S.hand.draw)) { stop(e); S.tell("cancel"); return; }
    if (!S.hand.mov) return;
    const step = S.hand.mov.still ? undefined : STEPS[e.key], way = TURNS[e.key];
    if (!step && !way) return;
    stop(e);
    const at = S.ways[2] ? S.ways[2].to : S.maps[2]; // on its way it is stepped from where it is going
    const cell = S.hand.mov.cell, length = e.shiftKey ? Math.min(0.01, cell) : cell, degrees = e.shiftKey ? 0.1 : 0.5;
    const by = { x: step ? step[0] * length : 0, y: step ? step[1] * length : 0, theta: way ? way * degrees * Math.PI / 180 : 0 };
    S.carry({ x: at.x + by.x, y: at.y + by.y, theta: at.theta + by.theta });
    S.tell("nudge", { ...by, knew: S.placed });
  }, true);
  S.heard.push((message) => {
    if (!message.hand) return;
    S.hand = Object.keys(message.hand).length ? message.hand : null;
    document.body.toggleAttribute("data-mm-held", Boolean(S.hand?.mov));
    if (!S.hand && hold) { hold = null; S.held = false; sketch(); }
    if (!S.hand?.draw && !hold && S.layers.drag) sketch();
    if (!S.hand && S.surface()) S.surface().style.cursor = "";
  });
  const style = document.createElement("style");
  style.textContent = `
    .mm-steps{display:flex;gap:8px;margin:6px 10px 2px}
    .mm-step{flex:1;padding:4px 0;border:0;border-radius:4px;background:#E2E8F0;color:#111827;font:600 13px/1.4 system-ui,"Segoe UI",sans-serif;cursor:pointer}
    .mm-step:hover:enabled{background:#CBD5E1} .mm-step:disabled{opacity:.45;cursor:default}
    [data-mantine-color-scheme=dark] .mm-step{background:#374151;color:#F9FAFB} [data-mantine-color-scheme=dark] .mm-step:hover:enabled{background:#4B5563}
    @media (pointer:coarse){.mm-step{min-height:40px}}
    .mm-step:focus-visible{outline:2px solid #0072B2;outline-offset:1px}
    .mm-history{max-height:230px;overflow:auto;margin:2px 10px 8px;border:1px solid #9CA3AF55;border-radius:6px}
    .mm-suggestions{display:grid;grid-template-columns:1fr 1fr;gap:6px;margin:0 10px 10px;font-size:12px;line-height:1.35}
    .mm-suggestions p{grid-column:1/-1;margin:0}
    .mm-suggestions button{display:flex;flex-direction:column;gap:1px;padding:4px;border:1px solid #9CA3AF88;border-radius:6px;background:none;color:inherit;font:inherit;text-align:left;cursor:pointer}
    .mm-suggestions button:hover{border-color:#0072B2;background:#0072B21A} .mm-suggestions button:focus-visible{outline:2px solid #0072B2}
    .mm-suggestions .mm-take{grid-column:1/-1;padding:5px;align-items:center;background:#0072B2;color:#fff;font-weight:600}
    .mm-suggestions .mm-take:hover{background:#005A8E} body:not([data-mm-held]) .mm-take{display:none}
    .mm-suggestions img{width:100%;border-radius:3px;margin-bottom:2px} .mm-suggestions b{font-size:13px} .mm-suggestions small{font-size:11px;opacity:.75}
    .mm-entry{display:flex;gap:7px;align-items:baseline;width:100%;padding:3px 8px;border:0;background:none;color:inherit;font:12.5px/1.4 system-ui,"Segoe UI",sans-serif;text-align:left;cursor:pointer}
    .mm-entry:hover{background:#6B728022} .mm-entry:focus-visible{outline:2px solid #0072B2;outline-offset:-2px}
    .mm-entry span{overflow-wrap:anywhere} .mm-entry i{flex:none;width:7px;height:7px;border-radius:50%}`;
  document.head.append(style);
})();
