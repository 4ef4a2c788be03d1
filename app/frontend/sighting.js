// A sighting from camera and scan: boxes that are pressed in the image or in the list, and how all of it looks.
(() => {
  const S = window.mapmeld;
  if (S.sighting) return;
  S.sighting = true;

  // --- boxes --------------------------------------------------------------------------------------
  document.addEventListener("click", (e) => {
    const box = e.target.closest?.("[data-mm-box]");
    if (!box) return;
    S.tell("box", { n: Number(box.dataset.mmBox) });
    S.kit.stay(`.${box.classList[0]}[data-mm-box="${box.dataset.mmBox}"]`, 600); // frames: the image is drawn anew
  });
  const light = (e, on) => { // a line and its box in the image are one
    const n = e.target.closest?.("[data-mm-box]")?.dataset.mmBox;
    for (const each of document.querySelectorAll("[data-mm-box]")) each.toggleAttribute("data-lit", on && each.dataset.mmBox === n);
  };
  for (const [kind, on] of [["pointerover", true], ["pointerout", false], ["focusin", true], ["focusout", false]]) {
    document.addEventListener(kind, (e) => { if (e.target.closest?.("[data-mm-box]")) light(e, on); });
  }

  let open = false;
  setInterval(() => { // as with the lesson: only then does the dock that took its place keep a width of its own
    const now = !!document.querySelector(".mm-sighting");
    if (open && !now) S.tell("left");
    open = now;
  }, 100);

  const style = document.createElement("style");
  style.textContent = `
    .mm-sensors{margin:2px 10px 8px;padding:6px 8px 4px;border:1px dashed #9CA3AF;border-radius:6px;font-size:12.5px;line-height:1.4}
    .mm-sensors[data-aim]{border-color:#0072B2;border-style:solid;background:#0072B21f}
    .mm-sensors table{border-collapse:collapse;width:100%}
    .mm-sensors td,.mm-sensors th{padding:1px 0;vertical-align:baseline;text-align:left;font-weight:400;overflow-wrap:anywhere}
    .mm-sensors td:first-child{width:1.3em;color:#009E73} .mm-sensors th{width:76px;white-space:nowrap;padding-right:8px}
    .mm-sensors td:last-child{opacity:.75} .mm-sensors tr[data-missing] td:first-child{color:#9CA3AF}
    .mm-sensors p{margin:3px 0 0;font-size:11.5px;opacity:.65}
    .mm-stood{margin:4px 12px 14px;width:calc(100% - 24px);font-size:12.5px;line-height:1.45;border-collapse:collapse;font-variant-numeric:tabular-nums}
    .mm-stood caption{caption-side:bottom;text-align:right;font-size:11.5px;opacity:.65;padding:0}
    .mm-stood td{padding:0} .mm-stood td:first-child{opacity:.75} .mm-stood td:last-child{text-align:right}
    .mm-sighting{height:0} .mm-outdated{opacity:.4}
    .mm-seen{position:relative;margin:4px 12px 6px;border-radius:4px;overflow:hidden;line-height:0}
    .mm-seen img{display:block;width:100%;height:auto}
    .mm-spot{position:absolute;box-sizing:border-box;min-width:18px;min-height:18px;padding:0;border:0;border-radius:2px;background:transparent;cursor:pointer}
    .mm-spot[aria-pressed=true]{box-shadow:0 0 0 1.5px #fff,0 0 0 2.5px #111827}
    .mm-spot[data-lit]{background:rgba(255,255,255,.22)}
    .mm-spot:focus-visible{outline:3px solid #F0E442;outline-offset:1px}
    .mm-found{display:flex;gap:8px;align-items:flex-start;width:calc(100% - 24px);margin:0 12px 4px;padding:5px 8px;border:1px solid #9CA3AF66;border-left:4px solid #0072B2;border-radius:4px;background:none;color:inherit;font:12.5px/1.4 system-ui,"Segoe UI",sans-serif;text-align:left;cursor:pointer}
    .mm-found[data-state=chosen]{border-left-color:#009E73} .mm-found[data-state=refused]{border-left-color:#D55E00}
    .mm-found[aria-pressed=true]{background:#6B72801f;border-top-color:#6B7280;border-right-color:#6B7280;border-bottom-color:#6B7280}
    .mm-found[data-lit]{background:#0072B21a} .mm-found:focus-visible{outline:2px solid #0072B2;outline-offset:1px}
    [data-mantine-color-scheme=dark] .mm-found:focus-visible{outline-color:#56B4E9}
    .mm-found b{min-width:1.1em;font-variant-numeric:tabular-nums} .mm-found span{min-width:0} .mm-found em{font-style:normal;font-weight:600;margin-right:4px}
    .mm-found small{display:block;font-size:12px;opacity:.85;font-variant-numeric:tabular-nums}
    .mm-aside{margin:4px 12px 6px;font-size:12px;line-height:1.4;opacity:.75}
    .mm-above{margin:10px 12px 4px} .mm-above svg{display:block;width:100%;height:auto} .mm-above .mm-aside,.mm-hog .mm-aside{margin:4px 0 0}
    .mm-hog{display:grid;grid-template-columns:1fr 1fr;gap:6px;margin:10px 12px 12px} .mm-hog img{display:block;width:100%;height:auto;border-radius:3px} .mm-hog .mm-aside{grid-column:1/-1}`;
  document.head.append(style);
})();
