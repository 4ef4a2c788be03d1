// The part of the page that the browser does by itself: a camera that reads like a map, and a layer
// of ink over it (robots, lines, particles, labels, scale bar) that keeps its size at any zoom.
//
// The server sends plain data with `mapmeld.apply({...})`; nothing here computes a result. All
// positions are metres of the scene: x right, y up, z towards the eye; heights stand on the floor
// after the turn that the server has applied. Text is drawn, never parsed as HTML.
(() => {
  if (window.mapmeld) { window.mapmeld.reset(); return; }
  const viewer = () => window.__viserMutable;
  const FOV = 4 * Math.PI / 180; // far and narrow: as good as parallel
  const { STILL, poseOf, toScene, toFrame, way, along, words, replace, layers, scaleBar, legend } = mapmeldInk;

  const blank = () => ({
    layers: {}, view: "map", follow: true, look: null, dark: false, hud: {}, dirty: true,
    maps: { 1: STILL, 2: STILL }, ways: {}, placed: 0, applied: 0, // by number: where each map lies, and where it goes
  });
  const S = blank();
  let hooked = null, canvas = null, ink = null, hud = null, pointer = null, seen = "", painted = "";
  // What other scripts add to the page: adopt(hud, canvas) once there is a canvas, frame(time) before every
  // frame, paint(g, view) over the ink, apply(message) of the server; all of them may be left out.
  S.parts = [];
  const each = (hook, ...given) => { for (const part of S.parts) if (part[hook]) part[hook](...given); };

  // --- the camera -------------------------------------------------------------------------------
  function lock(k) {
    const flat = S.view === "map";
    k.minPolarAngle = flat ? Math.PI / 2 : 0.15;
    k.maxPolarAngle = flat ? Math.PI / 2 : Math.PI / 2 - 0.03;
    k.minAzimuthAngle = flat ? 0 : -Infinity;
    k.maxAzimuthAngle = flat ? 0 : Infinity;
    k.mouseButtons.left = flat ? 2 : 1; // pan; turn
    k.touches.one = flat ? 128 : 64;
    k.dollyToCursor = true;
    k.minDistance = 5; k.maxDistance = 2e5;
  }
  function aim(animate, look = S.look) {
    const m = viewer(), k = m && m.cameraControl;
    if (!k || !look || !canvas) return;
    const box = canvas.getBoundingClientRect();
    const top = 92, bottom = look.view === "map" ? 64 : 40, side = 18; // what the words above and below cover
    const wide = Math.max(60, box.width - 2 * side), high = Math.max(60, box.height - top - bottom);
    const turning = S.view !== look.view;
    S.view = look.view;
    k.smoothTime = 0.28;
    if (look.view === "map") {
      const [x0, y0, x1, y1] = look.box;
      const metre = Math.min(wide / (x1 - x0), high / (y1 - y0)); // px per metre
      const distance = box.height / 2 / metre / Math.tan(FOV / 2);
      const cx = (x0 + x1) / 2, cy = (y0 + y1) / 2 + (top - bottom) / 2 / metre;
      lock(k);
      k.setLookAt(cx, cy, distance, cx, cy, 0, animate && !turning);
    } else {
      const metre = Math.min(wide, high) / 2 / look.radius;
      const distance = box.height / 2 / metre / Math.tan(FOV / 2);
      const [x, y, z] = look.centre, p = look.polar, a = look.azimuth;
      lock(k);
      k.setLookAt(x + distance * Math.sin(p) * Math.sin(a), y + distance * Math.cos(p),
        z + distance * Math.sin(p) * Math.cos(a), x, y, z, false);
    }
  }
  function within([x0, y0, x1, y1]) { // whether a rectangle can be seen whole, between the words
    const box = canvas.getBoundingClientRect();
    const [left, low] = S.ground(box.left, box.bottom - 20), [right, top] = S.ground(box.right, box.top + 70);
    return x0 >= left && y0 >= low && x1 <= right && y1 <= top;
  }
  const fingers = new Map(); // on the screen: where each is
  function pinch(e) { // two fingers keep what lies under them: the camera's speed is for one distance between them
    if (e.pointerType !== "touch") return;
    if (e.type === "pointerup" || e.type === "pointercancel") fingers.delete(e.pointerId);
    else if (e.type === "pointerdown" || fingers.has(e.pointerId)) fingers.set(e.pointerId, [e.clientX, e.clientY]);
    const [a, b] = [...fingers.values()];
    if (hooked && b) hooked.dollySpeed = 320 / Math.max(40, Math.hypot(a[0] - b[0], a[1] - b[1]));
  }
  for (const kind of ["pointerdown", "pointermove", "pointerup", "pointercancel"]) addEventListener(kind, pinch, true);
  addEventListener("wheel", () => { if (hooked) hooked.dollySpeed = 0.3; }, { capture: true, passive: true }); // viser's own
  function clip(camera) { // near and far follow the distance, so that the layers never fight for depth
    const k = viewer().cameraControl, near = k.distance * 0.3, far = k.distance * 3;
    if (Math.abs(camera.near / near - 1) > 0.01 || Math.abs(camera.fov - 4) > 1e-6) {
      camera.near = near; camera.far = far; camera.fov = 4; camera.updateProjectionMatrix();
    }
  }

  // --- where things are -------------------------------------------------------------------------
  function move(time) { // the maps that are on their way
    for (const [number, way] of Object.entries(S.ways)) {
      S.maps[number] = along(way, time);
      if (time - way.began >= way.ms) delete S.ways[number];
      S.moved = S.dirty = true;
    }
  }
  function placeMaps() {
    for (const [number, { x, y, theta }] of Object.entries(S.maps)) {
      const node = viewer().nodeRefFromName[`/world/map${number}`];
      if (!node) continue;
      node.position.set(x, y, node.position.z);
      node.quaternion.set(0, 0, Math.sin(theta / 2), Math.cos(theta / 2));
    }
  }
  function project(camera, frame, p) { // metres -> css px of the canvas
    const [x, y] = toScene(poseOf(S.maps, frame), p), z = p.length > 2 ? p[2] : 0;
    const v = new camera.position.constructor(x, y, z).project(camera);
    return [(v.x + 1) / 2 * ink.clientWidth, (1 - v.y) / 2 * ink.clientHeight, v.z];
  }
  const metre = (camera) => ink.clientHeight / 2 / Math.tan(FOV / 2) / Math.max(1e-6, camera.position.z); // px

  // --- ink: how it is drawn is in map_drawing.js ----------------------------------------------------------
  const viewOf = (camera) => ({
    project: (frame, p) => project(camera, frame, p),
    maps: S.maps, metre: metre(camera), wide: ink.clientWidth, high: ink.clientHeight, dark: S.dark,
  });
  // A sentence on robot 1 and map 2 with the robots' names in it, as algorithms/common/robot_names.py has it.
  const named = (text) => (S.hud.names ? text.replace(/\b([Rr]obot|[Mm]ap) ([12])('s)?/g, (_, what, n, s) => {
    const name = S.hud.names[n - 1];
    return /r/i.test(what[0]) ? name + (s || "") : `${name}'s${s ? "" : " map"}`;
  }) : text);
  const mapped = () => (S.hud.frames || []).some(Boolean); // an empty page has nothing to measure or to explain
  function readings(g, view, camera, colour) { // what a click and the pointer read off the map
    const x = 18, y = view.high - 22;
    if (S.hud.readout) words(g, view, S.hud.readout, x, y - 62, colour, 12);
    if (pointer && S.hud.frames) {
      const at = [(pointer[0] - view.wide / 2) / view.metre + camera.position.x, (view.high / 2 - pointer[1]) / view.metre + camera.position.y];
      const places = Object.values(S.maps).map((pose) => toFrame(pose, at)); // the same place in every map
      const within = (k) => S.hud.frames[k] && places[k][0] >= S.hud.frames[k][2] && places[k][1] >= S.hud.frames[k][3]
        && places[k][0] <= S.hud.frames[k][4] && places[k][1] <= S.hud.frames[k][5];
      const k = Math.max(0, places.findIndex((_, n) => within(n))), frame = S.hud.frames[k];
      if (frame) words(g, view, named(`x ${(places[k][0] + frame[0]).toFixed(2)} m   y ${(places[k][1] + frame[1]).toFixed(2)} m   in map ${k + 1}`.replaceAll("-", "−")), x, y - 42, colour, 11);
    }
  }
  function paint(time) {
    const m = viewer();
    if (!m || !m.canvas || !m.cameraControl) return;
    if (canvas !== m.canvas) adopt(m.canvas);
    if (hooked !== m.cameraControl) {
      hooked = m.cameraControl;
      hooked.addEventListener("controlstart", () => { S.follow = false; hooked.smoothTime = 0.05; });
      lock(hooked); aim(false);
    }
    const camera = m.cameraControl.camera; // the one that draws; viser's own "camera" is another
    clip(camera);
    move(time);
    each("frame", time);
    const frame = canvas.getBoundingClientRect(), size = [frame.width, frame.height].join();
    if (size !== seen) {
      seen = size;
      ink.width = frame.width * devicePixelRatio; ink.height = frame.height * devicePixelRatio;
      ink.style.width = frame.width + "px"; ink.style.height = frame.height + "px";
      if (S.follow) aim(false);
      if (S.hud.readout) { S.hud.readout = ""; S.tell("resized"); } // a click of another view
      S.dirty = true;
    }
    const eye = camera.matrixWorldInverse.elements.join() + camera.projectionMatrix.elements.join();
    harden(); // before a new picture is seen: never blurred, and neither built nor sent to the card twice
    if (!S.dirty && eye === painted) return;
    painted = eye; S.dirty = false;
    if (S.moved) { placeMaps(); m.requestRender(); S.moved = S.dirty = Object.keys(S.ways).length > 0; }
    const g = ink.getContext("2d");
    g.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
    g.clearRect(0, 0, ink.clientWidth, ink.clientHeight);
    const view = viewOf(camera);
    if (layers(g, view, S.layers, time)) S.dirty = true;
    if (S.view === "map" && mapped()) readings(g, view, camera, scaleBar(g, view));
    each("paint", g, view);
  }

  // --- words over the map -----------------------------------------------------------------------
  function adopt(element) {
    canvas = element;
    ink?.remove(); hud?.remove();
    ink = document.createElement("canvas"); ink.id = "mapmeld-ink";
    ink.style.cssText = "position:absolute;left:0;top:0;pointer-events:none;z-index:1";
    hud = document.createElement("div"); hud.id = "mapmeld-hud";
    hud.innerHTML = '<div class="mm-head"><div class="mm-title"><b>mapmeld</b><span class="mm-case"></span></div>' +
      '<div class="mm-tools"></div><div class="mm-state"><i></i><span><b></b><span></span></span></div><div class="mm-bar"><i></i></div></div><div class="mm-legend"></div><div class="mm-said" role="status"></div>';
    const parent = canvas.parentElement;
    parent.append(ink, hud);
    each("adopt", hud, canvas);
    canvas.addEventListener("pointermove", (e) => {
      const box = canvas.getBoundingClientRect(); pointer = [e.clientX - box.left, e.clientY - box.top]; S.dirty = true;
    });
    canvas.addEventListener("pointerleave", () => { pointer = null; S.dirty = true; });
    seen = ""; showHud();
  }
  function showHud() {
    if (!hud) return;
    const h = S.hud, put = (name, text) => { const e = hud.querySelector(name); if (e.textContent !== (text || "")) e.textContent = text || ""; };
    hud.dataset.theme = S.dark ? "dark" : "light";
    document.body.dataset.mmMode = h.research ? "research" : "operator";
    put(".mm-case", h.case);
    const [first] = (h.state || "").match(/^.+?[.!?](?= \p{Lu}|$)/u) || [h.state || ""];
    put(".mm-state b", first); put(".mm-state span span", (h.state || "").slice(first.length));
    put(".mm-said", ["accepted", "bent", "refused", "failed"].includes(h.mood) && h.state); // for screen readers: steps would be too many
    hud.querySelector(".mm-state").dataset.mood = h.mood || "idle";
    hud.querySelector(".mm-state").classList.toggle("mm-long", (h.state || "").length > 110);
    const line = hud.querySelector(".mm-state>span");
    line.tabIndex = line.scrollHeight > line.clientHeight ? 0 : -1; // what scrolls is reached by Tab
    const bar = hud.querySelector(".mm-bar");
    bar.style.visibility = h.progress === null || h.progress === undefined ? "hidden" : "visible";
    bar.firstChild.style.width = `${100 * (h.progress || 0)}%`;
    const entries = (mapped() && h.legend) || [], key = JSON.stringify([entries, S.dark]);
    const shown = hud.querySelector(".mm-legend");
    if (shown.dataset.key === key) return;
    shown.dataset.key = key;
    shown.replaceChildren(...legend(entries, "mm-"));
  }
  const style = document.createElement("style");
  style.textContent = `
    #mapmeld-hud{position:absolute;inset:0;pointer-events:none;z-index:2;font:13px/1.35 system-ui,"Segoe UI",sans-serif;color:#111827}
    button.mantine-Button-root[aria-pressed=true]{background:#0072B2!important;color:#fff!important;border-color:#0072B2!important}
    [data-mantine-color-scheme=dark] .mantine-Button-root[style*="--button-bg: #e2e8f0"]{--button-bg:#374151!important;--button-hover:#4B5563!important;--button-color:#F9FAFB!important} /* palette.QUIET, in the dark */
    button.mantine-Button-root[aria-pressed]{padding-left:3px!important;padding-right:3px!important;min-width:0}
    *:has(> p > label:empty){display:none}
    #webgl-software-rendering,button:has(.tabler-icon-adjustments){display:none!important} /* viser's own words and settings */
    :root[data-mantine-color-scheme=light]{--mantine-color-dimmed:#4B5563!important} :root[data-mantine-color-scheme=dark]{--mantine-color-dimmed:#C1C7D0!important}
    [data-mantine-color-scheme=light] .mantine-Button-root[data-variant=outline]:not([aria-pressed=true]){--button-color:#005A8C!important;--button-bd:1px solid #0072B2!important}
    .mm-said{position:absolute;width:1px;height:1px;overflow:hidden;clip-path:inset(50%)}
    @media (pointer:coarse){ /* fingers */
      .mantine-Button-root,.mantine-Input-input,.mm-tools button{min-height:40px!important;min-width:40px}
      .mantine-Slider-root,.mantine-Checkbox-body{min-height:40px;display:flex;align-items:center}
    }
    .mantine-Notifications-root{top:auto!important;bottom:84px!important}
    .mantine-ScrollArea-viewport>div{padding-right:8px} /* the scroll bar lies over what it scrolls */
    #mapmeld-hud[data-theme=dark]{color:#F9FAFB}
    .mm-head{display:flex;flex-wrap:wrap;align-items:center;column-gap:8px;position:absolute;left:12px;right:12px;top:10px;padding:7px 12px 8px;border-radius:8px;background:rgba(255,255,255,.92);box-shadow:0 1px 4px rgba(17,24,39,.16)}
    [data-theme=dark] .mm-head{background:rgba(31,41,55,.94)}
    .mm-title{flex:1 1 90px;font-size:12px;color:#6B7280;overflow:hidden;white-space:nowrap;text-overflow:ellipsis}
    .mm-title b{color:#0072B2;font-size:13px;letter-spacing:.01em;margin-right:8px}
    [data-theme=dark] .mm-title{color:#9CA3AF} [data-theme=dark] .mm-title b{color:#56B4E9}
    .mm-state{flex:1 0 100%;font-size:15px;display:flex;gap:8px;align-items:baseline;min-height:20px;margin:5px -12px -8px;padding:6px 12px 8px;border-left:5px solid transparent;border-radius:0 0 8px 8px;overflow-wrap:anywhere}
    .mm-tools{display:flex;flex-wrap:wrap;gap:4px 6px;min-height:22px;max-width:100%}
    .mm-tools>span{display:inline-flex;flex-wrap:wrap;border:1px solid #CBD5E1;border-radius:6px;overflow:hidden}
    .mm-tools button{pointer-events:auto;font:inherit;font-size:11.5px;line-height:20px;padding:0 7px;border:0;background:transparent;color:inherit;cursor:pointer}
    .mm-tools button+button{border-left:1px solid #CBD5E1}
    .mm-tools button:hover{background:rgba(0,114,178,.10)}
    .mm-tools button:focus-visible{outline:2px solid #0072B2;outline-offset:-2px}
    [data-theme=dark] .mm-tools>span,[data-theme=dark] .mm-tools button+button{border-color:#4B5563}
    [data-theme=dark] .mm-tools button:hover{background:rgba(86,180,233,.18)}
    [data-theme] .mm-tools button[aria-pressed=true]{background:#0072B2;color:#fff}
    .mm-tools [hidden]{display:none}
    .mm-state.mm-long{font-size:13px}
    .mm-state b{font-weight:550} .mm-state>span{max-height:42vh;overflow-y:auto;pointer-events:auto}
    .mm-state i{width:9px;height:9px;border-radius:50%;flex:none;background:#9CA3AF}
    .mm-state[data-mood=running] i{background:#0072B2;animation:mm-pulse 1s infinite}
    .mm-state[data-mood=accepted]{background:rgba(0,158,115,.16);border-left-color:#009E73}
    .mm-state[data-mood=bent]{background:rgba(230,159,0,.2);border-left-color:#E69F00}
    .mm-state[data-mood=refused],.mm-state[data-mood=failed]{background:rgba(213,94,0,.14);border-left-color:#D55E00}
    .mm-state[data-mood=accepted] i{background:#009E73} .mm-state[data-mood=accepted] span{color:#00593F}
    .mm-state[data-mood=refused] i,.mm-state[data-mood=failed] i{background:#D55E00}
    .mm-state[data-mood=refused] span,.mm-state[data-mood=failed] span{color:#8A3C00}
    [data-theme=dark] .mm-state[data-mood=accepted] span{color:#34D399}
    [data-theme=dark] .mm-state[data-mood=refused] span,[data-theme=dark] .mm-state[data-mood=failed] span{color:#FB923C}
    .mm-state[data-mood=stopped] i,.mm-state[data-mood=bent] i{background:#E69F00}
    .mm-state[data-mood=bent] span{color:#664400}
    [data-theme=dark] .mm-state[data-mood=bent] span{color:#FBBF24}
    @keyframes mm-pulse{50%{opacity:.25}}
    .mm-bar{position:absolute;left:0;right:0;bottom:0;height:3px;border-radius:0 0 8px 8px;overflow:hidden;background:rgba(0,114,178,.12)}
    .mm-bar i{display:block;height:100%;background:#0072B2}
    .mm-legend{position:absolute;right:12px;bottom:10px;max-width:calc(100% - 232px);display:flex;flex-wrap:wrap;justify-content:flex-end;gap:2px 12px;padding:4px 10px;border-radius:6px;background:rgba(255,255,255,.88);font-size:11.5px}
    [data-theme=dark] .mm-legend{background:rgba(31,41,55,.9)}
    .mm-legend:empty{display:none}
    .mm-legend span{display:inline-flex;align-items:center;gap:5px;white-space:pre}
    .mm-legend i{width:10px;height:10px;background:var(--c)}
    .mm-legend i.mm-square{box-shadow:0 0 0 1px rgba(107,114,128,.5)}
    .mm-legend i.mm-dot{border-radius:50%;width:8px;height:8px}
    .mm-legend i.mm-line{height:0;width:16px;background:none;border-top:2px dashed var(--c)}
    .mm-legend i.mm-scale{width:84px;height:9px;border-radius:2px}
    .mm-legend i.mm-star,.mm-legend i.mm-diamond{border-radius:1px;transform:rotate(45deg);width:8px;height:8px;outline:1px solid #374151}
    #mapmeld-hud{container-type:inline-size}
    @container (max-width:460px){ /* a small window, or a page that is zoomed */
      .mm-tools button{padding:0 5px}
      .mm-legend{bottom:54px;max-width:calc(100% - 24px);gap:1px 10px;font-size:11px}
    }`;
  document.head.append(style);

  // --- what the page tells ----------------------------------------------------------------------
  // An event with the fields that app/web/browser_events.py expects of it. Sent past viser's own throttle, which
  // keeps only the last message of every 50 ms; the number tells two equal events apart.
  let told = 0;
  S.heard = []; // functions of further scripts that are told every message of the server
  S.tell = (name, fields) => {
    const m = viewer();
    if (!m || !S.channel) return;
    told += 1;
    m.sendMessage({ type: "GuiUpdateMessage", uuid: S.channel, updates: { value: JSON.stringify([told, name, fields || {}]) } });
  };

  // --- what the server sends --------------------------------------------------------------------
  S.reset = () => { Object.assign(S, blank()); canvas = null; };
  S.pixel = (point, frame) => { // where a point of the scene is in the window; for tests
    const box = canvas.getBoundingClientRect(), at = project(hooked.camera, frame || "scene", point);
    return [box.left + at[0], box.top + at[1]];
  };
  S.ground = (x, y) => { // the point of the scene under a place of the window, seen from above
    const box = canvas.getBoundingClientRect(), camera = hooked.camera, px = metre(camera);
    return [(x - box.left - box.width / 2) / px + camera.position.x, (box.height / 2 - y + box.top) / px + camera.position.y];
  };
  S.carry = (pose) => { delete S.ways[2]; S.maps[2] = pose; S.moved = S.dirty = true; }; // put map 2 there, at once
  S.surface = () => canvas;
  S.apply = (message) => {
    const now = performance.now();
    replace(S.layers, message.layers, now);
    if (!S.held) for (const [number, to] of Object.entries(message.maps || {})) { // what a person holds is where they hold it
      move(now);
      S.ways[number] = way(S.maps[number], to, now);
      S.placed = to.placed;
      move(now);
    }
    if (message.dark !== undefined) S.dark = message.dark;
    if (message.hud) Object.assign(S.hud, message.hud);
    if (message.follow) S.follow = true;
    if (message.look) {
      const turning = S.look && S.look.view !== message.look.view;
      S.look = message.look;
      if ((S.follow || turning) && !(S.look.need && !turning && hooked && canvas && within(S.look.box))) aim(true);
    }
    if (message.channel) S.channel = message.channel;
    if (message.background && viewer() && viewer().canvas) viewer().canvas.style.background = message.background;
    S.background = message.background || S.background;
    for (const hear of S.heard) hear(message);
    S.applied += 1; S.dirty = true;
    each("apply", message);
    showHud();
  };
  function press() { // viser's groups of buttons do not show which one is chosen
    const pressed = [...(S.hud.pressed || []), S.hud.measure];
    for (const button of document.querySelectorAll("button.mantine-Button-root[data-size^=compact]")) {
      const on = String(pressed.includes(button.textContent.trim()));
      if (button.getAttribute("aria-pressed") !== on) button.setAttribute("aria-pressed", on);
    }
  }
  // What lies over the map and takes the pointer keeps it: the map below is neither clicked nor dragged.
  const keep = (element) => {
    for (const kind of ["pointerdown", "pointerup", "mousedown", "mouseup", "click", "dblclick", "contextmenu"]) {
      element.addEventListener(kind, (e) => e.stopPropagation());
    }
  };
  S.kit = { keep, viewer, metre, words, named, aim, camera: () => hooked && hooked.camera, canvas: () => canvas };
  window.mapmeld = S;
  document.title = "mapmeld";

  // Cells are squares with hard edges: viser has no nearest filter, and makes a new texture with
  // every new image.
  function harden() {
    const m = viewer();
    if (!m || !m.scene) return;
    if (m.canvas && S.background && m.canvas.style.background !== S.background) m.canvas.style.background = S.background;
    let changed = false;
    m.scene.traverse((node) => {
      const map = node.material && node.material.map;
      if (node.isMesh && map && node.material.depthTest) { // flat pictures: the higher one is on top
        const material = node.material;
        material.depthTest = material.depthWrite = false;
        // an excerpt in cells of their own takes the place of a part of a pooled picture: see zoom_detail.js
        const excerpt = material.userData.closer = { closerHole: { value: [0, 0, 0, 0] }, closerCells: { value: null } };
        material.onBeforeCompile = (shader) => {
          Object.assign(shader.uniforms, { closerHole: excerpt.closerHole, closerCells: excerpt.closerCells });
          shader.fragmentShader = "uniform vec4 closerHole; uniform sampler2D closerCells;\n" + shader.fragmentShader.replace("#include <map_fragment>", `
            vec4 cells = texture2D(map, vMapUv);
            if (closerHole.z > closerHole.x) {
              vec2 at = (vec2(vMapUv.x, 1.0 - vMapUv.y) - closerHole.xy) / (closerHole.zw - closerHole.xy);
              vec4 closer = texture2D(closerCells, at);
              if (all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, vec2(1.0)))) cells = closer;
            }
            diffuseColor *= cells;
            diffuseColor.a = min(1.0, 2.0 * diffuseColor.a);`); // thin walls stay dark from afar
        };
        material.needsUpdate = true;
        changed = true;
      }
      if (node.isMesh && map) node.renderOrder = Math.round(10 * node.matrixWorld.elements[14]);
      if (node.isLineSegments2 && node.material.toneMapped) { // colours of a scale are colours of a scale
        node.material.toneMapped = false; node.material.needsUpdate = true; changed = true;
      }
      if (map && map.magFilter !== 1003) { map.magFilter = 1003; map.anisotropy = 4; map.needsUpdate = true; changed = true; }
    });
    if (changed) m.requestRender();
  }
  setInterval(press, 100);
  const loop = (time) => { try { paint(performance.now()); } catch (error) { console.error("mapmeld:", error); } requestAnimationFrame(loop); };
  requestAnimationFrame(loop);
})();
