// The tabs "Compare" and "Sweep": what is pressed in their cards, charts and maps, the way back from another
// method's merge, and how all of it looks.
(() => {
  const S = window.mapmeld;
  if (S.research) return;
  S.research = true;

  // --- what is pressed --------------------------------------------------------------------------
  // Python writes a card anew after each press; whoever uses the keyboard stays where they were.
  let staying = 0; // who has pressed something else is not brought back
  function stay(selector, frames = 60, mine = ++staying) {
    if (mine !== staying) return;
    const at = document.activeElement;
    if (at && at !== document.body && document.contains(at)) { if (at.matches(selector)) requestAnimationFrame(() => frames && stay(selector, frames - 1, mine)); return; }
    document.querySelector(selector)?.focus({ preventScroll: true });
    if (frames) requestAnimationFrame(() => stay(selector, frames - 1, mine));
  }
  S.kit.stay = stay;
  // What was opened stays open in the next result, though Python writes it anew; researchers find the numbers open.
  const folds = {};
  document.addEventListener("click", (e) => {
    const fold = e.target.closest?.("details[data-mm-fold]>summary")?.parentElement;
    if (fold) folds[fold.dataset.mmFold] = !fold.open;
  });
  new MutationObserver(() => {
    document.querySelectorAll("details[data-mm-fold]:not([data-mm-known])").forEach((fold) => {
      const name = fold.dataset.mmFold;
      fold.dataset.mmKnown = "";
      fold.open = folds[name] ?? (name === "numbers" && document.body.dataset.mmMode === "research");
    });
    // viser's sliders and their numbers say nothing to a screen reader; the label stands in the same row
    document.querySelectorAll('[role=slider][aria-label=""],.mantine-NumberInput-input:not([aria-label])').forEach((e) => {
      const label = e.closest(".mantine-Flex-root:has(label)")?.querySelector("label");
      if (label && label.htmlFor !== e.id) e.setAttribute("aria-label", `${label.textContent}${e.role === "slider" ? "" : ", number"}`);
    });
  }).observe(document.body, { childList: true, subtree: true });

  document.addEventListener("change", (e) => {
    const method = e.target.dataset?.mmPick;
    if (!method) return;
    S.tell("pick", { method, yes: e.target.checked });
    stay(`[data-mm-pick="${method}"]`);
  });
  document.addEventListener("click", (e) => {
    const card = e.target.closest?.("[data-mm-show]"), point = e.target.closest?.("[data-mm-point]");
    if (card) { S.tell("show", { method: card.dataset.mmShow }); stay(`[data-mm-show="${card.dataset.mmShow}"]`); }
    if (point) { S.tell("point", { n: Number(point.dataset.mmPoint) }); stay(`button[data-mm-point="${point.dataset.mmPoint}"]`); }
    const over = e.target.closest?.(".u-over"), curve = over && curveOf(over);
    if (curve) { // where along its axis, from 0 to 1: the nearest point is found in Python
      const box = over.getBoundingClientRect();
      S.tell("along", { share: (e.clientX - box.left) / box.width });
    }
  });
  // The chart of the sweep is the first one after its mark.
  function curveOf(over) {
    const mark = document.querySelector(".mm-curve");
    const chart = mark && [...document.querySelectorAll(".u-over")].find((each) => mark.compareDocumentPosition(each) & Node.DOCUMENT_POSITION_FOLLOWING);
    return chart === over ? chart : null;
  }

  // --- the way back -----------------------------------------------------------------------------
  let back = null;
  function adopt(hud) {
    back = document.createElement("span"); back.className = "mm-back"; back.hidden = true;
    const button = document.createElement("button");
    button.type = "button"; button.textContent = "◀ Back to your own";
    button.onclick = () => S.tell("back");
    back.append(button);
    S.kit.keep(back);
    hud.querySelector(".mm-tools").append(back);
    show();
  }
  function show() {
    if (!back) return;
    const guest = S.hud.guest || "";
    back.hidden = !guest;
    back.firstChild.title = `You are looking at what “${guest}” has found. Press 0 to go back.`;
  }
  S.parts.push({ adopt, apply: (message) => { if (message.hud && "guest" in message.hud) show(); } });

  const style = document.createElement("style");
  style.textContent = `
    .mm-tools .mm-back{order:-1;border-color:#D55E00!important} .mm-tools .mm-back button{background:#D55E00;color:#fff;font-weight:600}
    [data-theme] .mm-tools .mm-back button:hover{background:#A34700}
    .mm-family{margin:10px 12px 2px;font-size:12px;font-weight:650;opacity:.7}
    .mm-method{margin:0 8px 3px}
    .mm-method label{display:flex;gap:7px;align-items:center;padding:2px 4px;font-size:13px;line-height:1.35;cursor:pointer}
    .mm-method label:hover{background:#6B728018;border-radius:4px}
    .mm-method input{accent-color:#0072B2;width:14px;height:14px;margin:0;flex:none}
    .mm-method input:focus-visible{outline:2px solid #0072B2;outline-offset:1px}
    .mm-card{display:flex;gap:8px;align-items:flex-start;width:100%;height:90px;padding:5px;border:1px solid #9CA3AF66;border-radius:6px;background:none;color:inherit;font:12px/1.35 system-ui,"Segoe UI",sans-serif;text-align:left;box-sizing:border-box;overflow:hidden;margin-bottom:5px}
    button.mm-card{cursor:pointer} button.mm-card:hover{border-color:#0072B2;background:#0072B20d}
    button.mm-card:focus-visible{outline:2px solid #0072B2;outline-offset:1px}
    button.mm-card[aria-pressed=true]{border-color:#D55E00;box-shadow:inset 0 0 0 1px #D55E00;background:#D55E0014}
    .mm-card[data-old]{opacity:.5}
    .mm-thumb{width:104px;height:78px;flex:none;border-radius:3px;background:#9CA3AF2e;display:flex;align-items:center;justify-content:center;font-style:normal;opacity:.9}
    [data-state=runs] .mm-thumb{animation:mm-pulse 1s infinite}
    .mm-card>span{min-width:0;flex:1;display:flex;flex-direction:column;height:100%;gap:1px}
    .mm-card b{font-weight:650;font-size:11.5px;letter-spacing:-.02em;flex:none} .mm-card b[data-mood=accepted]{color:#006B4E} .mm-card b[data-mood=bent]{color:#7A5200} .mm-card b[data-mood=refused]{color:#A34700}
    [data-mantine-color-scheme=dark] .mm-card b[data-mood=accepted]{color:#34D399} [data-mantine-color-scheme=dark] .mm-card b[data-mood=bent]{color:#FBBF24} [data-mantine-color-scheme=dark] .mm-card b[data-mood=refused]{color:#FB923C}
    .mm-card small{font-size:11px;line-height:1.3;opacity:.85;display:-webkit-box;-webkit-box-orient:vertical;-webkit-line-clamp:3;overflow:hidden;flex:0 1 auto}
    .mm-card em{font-style:normal;font-size:11px;opacity:.7;margin-top:auto;white-space:nowrap;overflow:hidden;text-overflow:ellipsis;font-variant-numeric:tabular-nums;flex:none}
    .mm-says{margin:2px 12px 4px;font-size:12.5px;line-height:1.4} .mm-says span{display:block;min-height:1.4em}
    .mm-says div{height:4px;border-radius:2px;background:#0072B21f;overflow:hidden;margin-top:3px} .mm-says i{display:block;height:100%;background:#0072B2}
    .mm-curve{height:0} .mm-curve+*{cursor:pointer}
    .mm-points{margin:2px 8px 8px;font-size:12px;font-variant-numeric:tabular-nums}
    .mm-points p,.mm-points button{display:grid;grid-template-columns:1.2fr 1fr .7fr .8fr;gap:6px;width:100%;margin:0;padding:2px 6px;text-align:right;font:inherit;color:inherit}
    .mm-points p{opacity:.6;font-size:11px;padding-left:7px} .mm-points p>:first-child,.mm-points button>:first-child{text-align:left}
    .mm-points button{border:1px solid transparent;border-radius:4px;background:none;cursor:pointer}
    .mm-points button:hover{background:#0072B214} .mm-points button:focus-visible{outline:2px solid #0072B2;outline-offset:-1px}
    .mm-points button[aria-pressed=true]{background:#CC79A733;border-color:#CC79A7}
    .mm-heat{margin:4px 10px} .mm-heat rect[data-mm-point]{cursor:pointer} .mm-heat rect[data-mm-point]:hover{stroke:currentColor;stroke-width:1.5}`;
  document.head.append(style);
})();
