// The lesson and the museum: how their texts, equations and pictures look in the dock, and that each step
// begins at its top, with Back and Next only where they lead anywhere.
(() => {
  if (document.getElementById("mapmeld-lesson")) return;
  const style = document.createElement("style");
  style.id = "mapmeld-lesson";
  style.textContent = `
    .mm-lesson{margin:2px 12px 0;line-height:1.3}
    .mm-lesson{display:flex;align-items:center;justify-content:space-between;gap:10px}
    .mm-lesson h3{margin:2px 0;font-size:17px;font-weight:650;letter-spacing:-.01em}
    .mm-dots{display:inline-flex;gap:2px;flex:none}
    .mantine-ScrollArea-viewport:has(.mm-lesson) p{font-size:14px;line-height:1.4}
    .mantine-ScrollArea-viewport:has(.mm-lesson) p+p{margin-top:.5em}
    .mm-dots i{width:5px;height:5px;border-radius:50%;background:currentColor;opacity:.18}
    .mm-dots i[data-on]{background:#0072B2;opacity:1}
    .mm-eq{display:flex;align-items:center;justify-content:space-between;gap:8px;margin:3px 12px;font-size:14.5px}
    .mm-eq span{min-width:0;flex:1;text-align:center}
    .mm-eq svg{max-width:100%;height:auto;vertical-align:middle}
    .mm-eq small{opacity:.6;white-space:nowrap;font-size:11px}
    .mm-symbols{margin:2px 14px 4px;font-size:12.5px;line-height:1.35}
    .mm-symbols summary{cursor:pointer;opacity:.7}
    .mm-symbols dl{display:grid;grid-template-columns:max-content 1fr;gap:2px 10px;margin:4px 0 0}
    .mm-symbols dd{margin:0}
    .mm-frame{margin:8px 14px 4px}
    .mm-picture{display:block;width:100%;height:auto}
    .mm-wait{padding:26px 10px;text-align:center;opacity:.65;border:1px dashed currentColor;border-radius:6px;font-size:13px}
    .mm-try{margin:8px 12px 3px;padding:7px 10px;border-left:4px solid #E69F00;border-radius:4px;background:#E69F001f;font-size:13px;line-height:1.4}
    .mm-try b{color:#B45309;margin-right:4px}
    [data-mantine-color-scheme=dark] .mm-try b{color:#FBBF24}
    .mm-answer{margin-top:5px;padding-top:5px;border-top:1px solid #E69F0066}
    .mm-foot{margin:6px 12px 10px;font-size:11.5px;opacity:.6}`;
  document.head.append(style);
  let seen = "";
  setInterval(() => { // a new step is read from its top
    const step = document.querySelector(".mm-lesson"), now = step ? step.dataset.step : "";
    if (now === seen) return;
    if (seen && !now) window.mapmeld.tell("left"); // only now does the dock that took its place keep a width of its own
    seen = now;
    const view = step && step.closest(".mantine-ScrollArea-viewport");
    if (!view) return;
    view.scrollTop = 0;
    for (const button of view.querySelectorAll("button")) { // viser's rows of buttons have no such switch
      if (button.textContent === "◀ Back") button.disabled = now === step.dataset.first;
      if (button.textContent === "Next ▶") button.disabled = now === step.dataset.last;
    }
  }, 100);
})();
