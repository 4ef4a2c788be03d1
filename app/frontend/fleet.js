// The lists of a fleet in the panel: which robot, eye or pair was pressed.
(() => {
  const S = window.mapmeld;
  if (S.fleet) return;
  S.fleet = true;
  const KINDS = ["robot", "eye", "pair"];
  const ROWS = KINDS.map((what) => `button[data-mm-${what}]`).join();
  const named = (row) => row && KINDS.filter((what) => row.hasAttribute(`data-mm-${what}`)).map((what) => `button[data-mm-${what}="${row.getAttribute(`data-mm-${what}`)}"]`)[0];
  // While robots run the lists are drawn anew every second: a press begins on a row that may be gone when it ends, and the focus goes with it.
  let pressed, focused;
  document.addEventListener("pointerdown", (e) => { pressed = named(e.target.closest?.(ROWS)); focused = undefined; }, true);
  document.addEventListener("focusin", (e) => { focused = named(e.target.closest?.(ROWS)); });
  new MutationObserver(() => {
    if (focused && document.activeElement === document.body) document.querySelector(focused)?.focus({ preventScroll: true });
  }).observe(document.body, { childList: true, subtree: true });
  document.addEventListener("click", (e) => {
    let row = e.target.closest?.(ROWS);
    if (!row && pressed) row = document.elementFromPoint(e.clientX, e.clientY)?.closest(pressed);
    for (const what of row ? KINDS : []) {
      const n = row.getAttribute(`data-mm-${what}`);
      if (n !== null) S.tell("fleet", { what, n: Number(n) });
    }
  });
  const style = document.createElement("style");
  style.textContent = `
    .mm-fleet{display:flex;flex-direction:column;gap:2px;margin:2px 10px 8px;font-size:12.5px;line-height:1.35}
    .mm-fleet button{border:0;background:none;color:inherit;font:inherit;text-align:left;cursor:pointer;border-radius:5px;padding:4px 6px}
    .mm-fleet button:hover{background:#6B728022} .mm-fleet button:focus-visible{outline:2px solid #0072B2;outline-offset:-2px}
    .mm-robot{display:flex;align-items:stretch}
    .mm-robot>button:first-child{flex:1;display:flex;align-items:baseline;gap:7px;min-width:0}
    .mm-robot>button[aria-pressed=true]:first-child{background:#0072B21f}
    .mm-robot i{flex:none;width:10px;height:10px;border-radius:2px} .mm-robot abbr{text-decoration:none;opacity:.7}
    .mm-robot b{flex:1;overflow-wrap:anywhere} .mm-robot span{opacity:.8;font-size:12px;text-align:right}
    .mm-pair{display:flex;flex-direction:column;border-left:4px solid #9CA3AF !important;border-radius:3px !important}
    .mm-pair b{overflow-wrap:anywhere} .mm-pair span{font-size:11.5px;opacity:.8}
    .mm-pair[data-mood=accepted]{border-left-color:#009E73 !important} .mm-pair[data-mood=refused]{border-left-color:#D55E00 !important}
    .mm-pair[data-mood=bent]{border-left-color:#E69F00 !important}
    .mm-robot>button:first-child{flex-wrap:wrap} .mm-robot em{flex:1 0 100%;padding-left:17px;font-style:normal;font-size:11.5px;opacity:.75}
    .mm-robot em[data-mood=bent]{color:#B45309;opacity:1} .mm-robot em[data-mood=refused]{color:#D55E00;opacity:1}
    .mm-robot[data-mood=accepted] span{color:#009E73} .mm-robot[data-mood=refused] span{color:#D55E00}
    .mm-quiet{margin:2px 12px 8px;font-size:12px;opacity:.8}`;
  document.head.append(style);
})();
