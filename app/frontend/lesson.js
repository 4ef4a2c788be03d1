// The lesson and the museum: how their texts, equations and pictures look in the dock, that each step begins at
// its top, with Back and Next only where they lead anywhere; links to a step, and the view for a class.
(() => {
  if (document.getElementById("mapmeld-lesson")) return;
  const S = window.mapmeld;
  const style = document.createElement("style");
  style.id = "mapmeld-lesson";
  style.textContent = `
    .mm-lesson{margin:2px 12px 0;line-height:1.3}
    .mm-lesson{display:flex;flex-wrap:wrap;align-items:center;justify-content:space-between;gap:2px 10px}
    .mm-lesson h3{flex:1 0 100%;margin:2px 0;font-size:17px;font-weight:650;letter-spacing:-.01em}
    .mm-aids{display:inline-flex;gap:6px}
    .mm-aids button,.mm-link button{font:inherit;font-size:12px;padding:1px 9px;border:1px solid #9CA3AF;border-radius:5px;background:none;color:inherit;cursor:pointer}
    .mm-aids button:hover,.mm-link button:hover{background:#0072B21f}
    .mm-aids button:focus-visible,.mm-link button:focus-visible{outline:2px solid #0072B2;outline-offset:1px}
    .mm-dots{display:inline-flex;gap:2px;flex:none}
    .mantine-ScrollArea-viewport:has(.mm-lesson) p{font-size:14px;line-height:1.4}
    .mantine-ScrollArea-viewport:has(.mm-lesson) p+p{margin-top:.5em}
    .mm-dots i{width:5px;height:5px;border-radius:50%;background:currentColor;opacity:.18}
    .mm-dots i[data-on]{background:#0072B2;opacity:1}
    .mm-eq{display:flex;align-items:center;justify-content:space-between;gap:8px;margin:3px 12px;font-size:14.5px}
    .mm-eq span{min-width:0;flex:1;text-align:center}
    .mm-eq svg{max-width:100%;height:auto;vertical-align:middle}
    .mm-eq small{opacity:.6;white-space:nowrap;font-size:11px}
    .mm-symbols,.mm-notes{margin:2px 14px 4px;font-size:12.5px;line-height:1.35}
    .mm-symbols summary,.mm-notes summary{cursor:pointer;opacity:.7}
    .mm-notes p{margin:4px 0 0}
    .mm-symbols dl{display:grid;grid-template-columns:max-content 1fr;gap:2px 10px;margin:4px 0 0}
    .mm-symbols dd{margin:0}
    .mm-frame{margin:8px 14px 4px}
    .mm-picture{display:block;width:100%;height:auto}
    .mm-grip{cursor:grab;touch-action:none} [data-mm-held],[data-mm-held] .mm-grip{cursor:grabbing;user-select:none}
    .mm-wait{padding:26px 10px;text-align:center;opacity:.65;border:1px dashed currentColor;border-radius:6px;font-size:13px}
    .mm-try{margin:8px 12px 3px;padding:7px 10px;border-left:4px solid #E69F00;border-radius:4px;background:#E69F001f;font-size:13px;line-height:1.4}
    .mm-try b{color:#B45309;margin-right:4px}
    [data-mantine-color-scheme=dark] .mm-try b{color:#FBBF24}
    .mm-answer{margin-top:5px;padding-top:5px;border-top:1px solid #E69F0066}
    .mm-check,.mm-missing{margin:8px 12px 3px;padding:7px 10px;border-left:4px solid #0072B2;border-radius:4px;background:#0072B21a;font-size:13px;line-height:1.4}
    .mm-check[data-mm-done]{border-left-color:#009E73;background:#009E731f}
    .mm-missing{border-left-color:#9CA3AF;background:#9CA3AF1f}
    .mm-lesson small{font-size:12px;opacity:.7}
    .mm-foot{margin:6px 12px 10px;font-size:11.5px;opacity:.6}
    .mm-link{border:0;border-radius:10px;padding:16px 20px 18px;width:min(480px,92vw);color:#111827;background:#fff;font:14px/1.4 system-ui,"Segoe UI",sans-serif;box-shadow:0 10px 40px rgba(17,24,39,.35)}
    .mm-link::backdrop{background:rgba(17,24,39,.35)} .mm-link h2{font-size:16px;margin:0 0 8px}
    .mm-link p{margin:8px 0 0} .mm-link div{display:flex;gap:6px} .mm-link input{flex:1;min-width:0;font:inherit;padding:3px 8px;border:1px solid #9CA3AF;border-radius:5px;color:#111827;background:#F9FAFB}
    .mm-link figure{margin:12px auto 0;width:min(320px,60vh)} .mm-link figure svg{display:block;width:100%;height:auto}
    /* for a class: the dock takes the window, the picture the left of it, nothing is smaller than 24 px */
    [data-mm-presenter] [data-mm-dock],[data-mm-presenter] [data-mm-dock]>div>div{width:100%!important}
    [data-mm-presenter] [data-mm-dock]{z-index:1000!important}
    [data-mm-presenter] [data-mm-sheet]{display:grid;grid-template-columns:minmax(0,64%) minmax(0,1fr);grid-auto-rows:min-content;column-gap:8px}
    [data-mm-presenter] [data-mm-sheet]>*{grid-column:2}
    [data-mm-presenter] [data-mm-sheet]>*:has(.mm-frame){position:fixed;left:0;top:0;bottom:0;width:64%;z-index:5;background:var(--mantine-color-body);display:flex;align-items:center}
    [data-mm-presenter] [data-mm-sheet] div:has(>.mm-frame),[data-mm-presenter] .mm-frame{flex:1;min-width:0}
    [data-mm-presenter] .mm-picture{max-height:calc(100vh - 16px)}
    [data-mm-presenter] .mm-frame{margin:8px}
    [data-mm-presenter] [data-mm-sheet] :where(p,dt,dd,div,button,label,summary,small,input,span):not(svg *,.mm-dots){font-size:25px!important;line-height:1.3!important}
    [data-mm-presenter] [data-mm-sheet] :is(sub,sup){font-size:24px!important}
    [data-mm-presenter] .mm-lesson h3{font-size:38px;line-height:1.15}
    [data-mm-presenter] .mm-eq{font-size:27px} [data-mm-presenter] .mm-eq span{font-size:27px!important}
    [data-mm-presenter] [data-mm-sheet] button:not(.mm-aids *){height:auto!important;min-height:52px}
    [data-mm-presenter] [data-mm-sheet] input{height:48px!important;min-height:48px}
    [data-mm-presenter] [data-mm-sheet] .mantine-NumberInput-root{width:110px!important;min-width:110px}
    [data-mm-presenter] .mm-foot,[data-mm-presenter] .mm-dots{display:none}`;
  document.head.append(style);

  // --- the address: #lesson=9&sample=corridor_r3_r2 is step 9 on that sample --------------------------------------
  const asked = () => new URLSearchParams(window.mapmeldPlace || location.hash.slice(1)); // see startup_check.js
  function follow() { // an address that was opened
    const number = Number.parseInt(asked().get("lesson") ?? "", 10);
    if (Number.isFinite(number)) S.tell("place", { lesson: number, sample: (asked().get("sample") || "").slice(0, 200) });
    window.mapmeldPlace = "";
  }
  function rename(place) { // the address is that of the step that is shown: a reload, a bookmark and a copy find it
    if (!place && !asked().has("lesson")) return;
    history.replaceState(null, "", location.pathname + location.search + (place && `#${place}`));
  }
  addEventListener("hashchange", follow);

  // --- a link for others ------------------------------------------------------------------------------------------
  let sheet = null;
  function element(kind, text = "", ...inside) {
    const e = document.createElement(kind);
    if (text) e.textContent = text;
    e.append(...inside);
    return e;
  }
  function share() {
    sheet?.remove();
    sheet = element("dialog"); sheet.className = "mm-link"; sheet.setAttribute("aria-label", "A link to this step");
    const field = element("input"), copy = element("button", "Copy"), close = element("button", "Close");
    field.readOnly = true; field.value = location.href; field.setAttribute("aria-label", "Address of this step");
    field.onfocus = () => field.select();
    copy.onclick = async () => {
      field.focus();
      try { await navigator.clipboard.writeText(field.value); } catch { document.execCommand("copy"); } // plain http has no clipboard
      copy.textContent = "Copied";
    };
    close.onclick = () => sheet.close();
    sheet.append(element("h2", "A link to this step"), element("div", "", field, copy, close), element("figure"));
    if (/^(localhost|127\.|\[::1\])/.test(location.hostname)) {
      sheet.append(element("p", "Only this computer finds this address. For a class start mapmeld with --host and the name of this computer, and open the page by that."));
    }
    sheet.onclick = (e) => { if (e.target === sheet) sheet.close(); }; // beside it
    document.body.append(sheet);
    sheet.showModal();
    S.tell("link", { address: location.href });
  }
  S.heard.push((message) => {
    if (message.channel) follow(); // after the page has said hello: map_editing.js
    const figure = sheet?.querySelector("figure");
    if (message.link && figure && message.link.address === sheet.querySelector("input").value) figure.innerHTML = message.link.code;
  });

  // --- questions that were answered: the tab keeps them over a reload --------------------------------------------
  const KEY = "mapmeld-lesson-done";
  let told = "";
  function keepDone(steps) {
    if (!steps || steps === told) return;
    told = steps;
    try { sessionStorage.setItem(KEY, steps); } catch { /* then a reload forgets them */ }
  }
  function tellDone() {
    let steps = "";
    try { steps = sessionStorage.getItem(KEY) || ""; } catch { /* none were kept */ }
    const numbers = steps.split(",").filter(Boolean).map(Number).filter(Number.isInteger);
    if (numbers.length) S.tell("done", { steps: numbers });
  }
  S.heard.push((message) => { if (message.channel) tellDone(); });

  // --- for a class ------------------------------------------------------------------------------------------------
  const body = document.body;
  function present(yes) {
    body.toggleAttribute("data-mm-presenter", yes);
    for (const button of document.querySelectorAll("button[data-mm-presenter]")) {
      button.setAttribute("aria-pressed", yes); button.textContent = yes ? "End" : "Present";
    }
  }
  document.addEventListener("click", (e) => {
    if (e.target.closest?.("button[data-mm-link]")) share();
    if (e.target.closest?.("button[data-mm-presenter]")) present(!body.hasAttribute("data-mm-presenter"));
  });
  document.addEventListener("keydown", (e) => {
    if (e.key === "Escape" && body.hasAttribute("data-mm-presenter") && !document.querySelector("dialog[open]")) {
      e.preventDefault(); present(false); // before a run is stopped: keyboard_shortcuts.js
    }
  }, true);

  // --- pictures in the hand: a handle moves what sliders move, app/drawing/svg/svg_canvas.py says how ---------------
  let held = null, waits = null;
  const along = ([dial, p, u, q, v], at) => [dial, u + (at - p) / (q - p) * (v - u)];
  function grasped(e) { // what the sliders are to show
    const svg = document.querySelector("svg.mm-picture:has([data-mm-grip])");
    if (!svg) return null;
    const { x, y } = new DOMPoint(e.clientX, e.clientY).matrixTransform(svg.getScreenCTM().inverse()), moves = [];
    if (held.x) moves.push(along(held.x, x));
    if (held.y) moves.push(along(held.y, y));
    if (held.r) moves.push([held.r[0], Math.hypot(x - held.r[1], y - held.r[2]) * held.r[3]]);
    if (held.a) {
      const [dial, cx, cy, zero, least] = held.a, off = Math.atan2(cy - y, x - cx) * 180 / Math.PI - zero - least;
      moves.push([dial, least + (off % 360 + 360) % 360]);
    }
    return { dials: moves.map(([dial]) => dial), values: moves.map(([, value]) => value) };
  }
  const say = (fields) => { if (fields) S.tell("grip", fields); };
  document.addEventListener("pointerdown", (e) => {
    const grip = e.button === 0 && e.target.closest?.("[data-mm-grip]");
    if (!grip) return;
    e.preventDefault();
    held = JSON.parse(grip.dataset.mmGrip); body.dataset.mmHeld = "";
  });
  document.addEventListener("pointermove", (e) => {
    if (!held) return;
    const first = waits === null;
    waits = grasped(e);
    if (first) setTimeout(() => { say(waits); waits = null; }, 40); // the newest of those that came meanwhile
  });
  for (const kind of ["pointerup", "pointercancel"]) document.addEventListener(kind, (e) => {
    if (!held) return;
    if (kind === "pointerup") say(grasped(e));
    held = null; delete body.dataset.mmHeld;
  });

  // --- a new step -------------------------------------------------------------------------------------------------
  let seen = "";
  setInterval(() => {
    const step = document.querySelector(".mm-lesson"), now = step ? step.dataset.step : "";
    const place = step ? `lesson=${now}${step.dataset.sample ? `&sample=${step.dataset.sample}` : ""}` : "";
    if (step) keepDone(step.dataset.done);
    const view = step && step.closest(".mantine-ScrollArea-viewport");
    if (view) { // viser makes its elements anew
      step.parentElement.parentElement.dataset.mmSheet = "";
      let dock = view;
      while (dock.parentElement && dock.style.position !== "absolute") dock = dock.parentElement;
      dock.dataset.mmDock = "";
      for (const button of step.querySelectorAll("button[data-mm-presenter][aria-pressed=false]")) {
        if (body.hasAttribute("data-mm-presenter")) present(true);
      }
    }
    if (place === seen) return;
    if (seen && !now) { S.tell("left"); present(false); } // only now does the dock that took its place keep a width of its own
    const moved = now !== (/lesson=(\d+)/.exec(seen) || ["", ""])[1];
    seen = place;
    rename(place);
    if (!view || !moved) return;
    view.scrollTop = 0; // it is read from its top
    for (const button of view.querySelectorAll("button")) { // viser's rows of buttons have no such switch
      if (button.textContent === "◀ Back") button.disabled = now === step.dataset.first;
      if (button.textContent === "Next ▶") button.disabled = now === step.dataset.last;
    }
  }, 100);
})();
