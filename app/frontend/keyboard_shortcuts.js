// Keys for what the buttons do, folders that open by keys, and one list of all keys of the page: press "?".
(() => {
  const S = window.mapmeld;
  if (S.keys) return;
  const K = {};
  S.keys = K;
  // All keys of the page, as they are listed: key, what it does, and, where it presses a button or turns to a tab of
  // the dock, by what name that goes; a button must be there and not be greyed.
  const GROUPS = [
    ["Work", [["M", "merge", "Merge"], ["Esc", "stop a run; end measuring, placing or erasing; leave the large lesson"],
      ["Ctrl Z", "undo"], ["Ctrl Y", "redo, also Ctrl Shift Z"], ["Enter", "open or close the folder in focus"], ["?", "this list"]]],
    ["Look", [["1", "the map", "Map"], ["2", "the levels as heights", "Heights"], ["3", "the swarm's space", "Swarm space"],
      ["F", "show everything", "Show everything"], ["R", "measure a distance", "Measure"],
      ["drag, wheel", "move and zoom the map"], ["click", "what both maps know of a place"]]],
    ["Compare", [["O", "both maps over each other", "Overlay"], ["B", "the maps take turns", "Blink"],
      ["C", "one map beside the other", "Curtain"], ["← →", "move the curtain, once it is in focus"],
      ["D", "only what differs", "Difference"], ["G", "the merged map as it is given away", "Merged map"]]],
    ["Correct the map, once its folder is open", [["E", "erase with a brush", "Erase with a brush"],
      ["X", "erase a rectangle", "Erase a rectangle"], ["K", "draw a keep-out line", "Draw a keep-out line"]]],
    ["Map 2 by hand, once it is taken up", [["← → ↑ ↓", "one cell; with Shift 1 cm"], ["[ ]", "turn by 0.5°; with Shift 0.1°"],
      ["Shift drag", "turn about robot 2"]]],
    ["Learn", [["L", "the lesson, in and out", "Lesson"], ["P", "the lesson large, for a class", "Present"],
      ["Page↓", "next step", "Next ▶"], ["Page↑", "step before", "◀ Back"]]],
    ["Research", [["4", "the stages of a merge", "Stages", "tab"], ["5", "compare methods", "Compare", "tab"],
      ["6", "sweep a setting", "Sweep", "tab"], ["0", "back from another method's merge", "◀ Back to your own"]]],
  ];
  const KEYS = { "Page↓": "pagedown", "Page↑": "pageup" }; // called otherwise by the browser
  const rows = GROUPS.flatMap(([, listed]) => listed.filter(([, , name]) => name));
  const does = Object.fromEntries(rows.map(([key, , name, tab]) => [KEYS[key] || key.toLowerCase(), { name, tab }]));
  let sheet = null, before = null;

  const writing = (e) => e && (e.isContentEditable || e.tagName === "TEXTAREA" || e.tagName === "SELECT" ||
    (e.tagName === "INPUT" && !/^(checkbox|radio|button|range|file|color)$/.test(e.type)));
  const named = (name) => [...document.querySelectorAll("button")].find((b) => b.textContent.trim() === name && b.offsetParent !== null && !b.disabled);
  function element(kind, text, ...inside) {
    const e = document.createElement(kind);
    if (text) e.textContent = text;
    e.append(...inside);
    return e;
  }
  function build() {
    sheet?.remove();
    sheet = element("dialog"); sheet.className = "mm-keys"; sheet.setAttribute("aria-label", "Keys");
    sheet.dataset.theme = S.dark ? "dark" : "light";
    const close = element("button", "Close"); close.type = "button"; close.onclick = () => sheet.close();
    const grid = element("div"); grid.className = "mm-grid";
    for (const [title, listed] of GROUPS) {
      const list = element("dl");
      for (const [key, words] of listed) {
        const parts = key.split(" ").map((part) => (/^[a-z,]+$/.test(part) ? element("span", part) : element("kbd", part)));
        list.append(element("dt", "", ...parts), element("dd", S.kit.named(words)));
      }
      grid.append(element("section", "", element("h3", S.kit.named(title)), list));
    }
    sheet.append(element("header", "", element("h2", "Keys"), close), grid);
    sheet.onclick = (e) => { if (e.target === sheet) sheet.close(); }; // beside it
    sheet.onclose = () => before?.focus?.();
    document.body.append(sheet);
  }
  K.show = () => { if (sheet?.open) { sheet.close(); return; } before = document.activeElement; build(); sheet.showModal(); };
  document.addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey || e.repeat || writing(document.activeElement)) return;
    if (e.key === "?") { e.preventDefault(); K.show(); return; }
    if (document.querySelector("dialog[open], [role=dialog]")) return;
    if (e.key === "Escape") { if (!e.defaultPrevented && !S.measure?.on) named("Stop")?.click(); return; }
    const chosen = does[e.key.toLowerCase()];
    const tab = chosen?.tab && [...document.querySelectorAll("[role=tab]")].find((each) => each.title === chosen.name && each.offsetParent !== null);
    const there = tab || (chosen && !chosen.tab && named(chosen.name));
    if (!there) return;
    e.preventDefault();
    // viser's tabs take no click of a script, but a key
    if (tab) tab.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", bubbles: true, cancelable: true })); else there.click();
  }, true);

  // viser's folders open by the mouse alone: their heads become buttons, those that appear later, too
  const HEAD = ".mantine-Paper-root:has(> svg[class*=tabler-icon-chevron])";
  function heads() {
    for (const head of document.querySelectorAll(HEAD)) {
      const open = String(head.nextElementSibling?.getAttribute("aria-hidden") !== "true");
      if (head.getAttribute("aria-expanded") !== open) head.setAttribute("aria-expanded", open);
      if (head.tabIndex === 0) continue;
      head.tabIndex = 0; head.setAttribute("role", "button");
    }
  }
  setInterval(heads, 150);
  document.addEventListener("keydown", (e) => {
    if ((e.key !== "Enter" && e.key !== " ") || e.ctrlKey || e.metaKey || e.altKey || !e.target.matches?.(HEAD)) return;
    e.preventDefault(); e.stopPropagation(); // a space would scroll
    if (!e.repeat) { e.target.click(); setTimeout(heads); }
  }, true);

  function adopt(hud) {
    const group = element("span"), button = element("button", "?");
    button.type = "button"; button.title = "All keys of this page. Press ?"; button.setAttribute("aria-label", "Keys");
    button.onclick = K.show;
    group.append(button); group.className = "mm-help";
    S.kit.keep(group);
    hud.querySelector(".mm-tools").append(group);
  }
  S.parts.push({ adopt });

  const style = document.createElement("style");
  style.textContent = `
    .mm-tools .mm-help{order:9}
    ${HEAD}:focus-visible{outline:2px solid #0072B2;outline-offset:2px;border-radius:3px}
    [data-mantine-color-scheme=dark] ${HEAD}:focus-visible{outline-color:#56B4E9}
    .mm-keys{border:0;border-radius:10px;padding:16px 20px 18px;max-width:min(720px,94vw);color:#111827;background:#fff;font:13px/1.4 system-ui,"Segoe UI",sans-serif;box-shadow:0 10px 40px rgba(17,24,39,.35)}
    .mm-keys::backdrop{background:rgba(17,24,39,.35)}
    .mm-keys header{display:flex;justify-content:space-between;align-items:center;margin-bottom:12px}
    .mm-keys h2{font-size:16px;margin:0} .mm-keys h3{font-size:12px;margin:0 0 4px;color:#0072B2;letter-spacing:.02em}
    .mm-keys header button{font:inherit;padding:3px 12px;border:1px solid #CBD5E1;border-radius:6px;background:none;color:inherit;cursor:pointer}
    .mm-grid{columns:2;column-gap:32px} .mm-grid section{break-inside:avoid;padding-bottom:14px}
    .mm-keys dl{display:grid;grid-template-columns:minmax(72px,max-content) 1fr;gap:4px 12px;margin:0;align-items:baseline}
    .mm-keys dt{display:flex;gap:3px;align-items:baseline;white-space:nowrap} .mm-keys dd{margin:0}
    .mm-keys kbd{display:inline-block;min-width:20px;padding:0 5px;border:1px solid #9CA3AF;border-bottom-width:2px;border-radius:4px;font:600 11.5px/18px system-ui,"Segoe UI",sans-serif;text-align:center;box-sizing:border-box}
    .mm-keys dt span{color:#6B7280}
    .mm-keys[data-theme=dark]{color:#F9FAFB;background:#1F2937} .mm-keys[data-theme=dark] h3{color:#56B4E9} .mm-keys[data-theme=dark] dt span{color:#9CA3AF}
    .mm-keys[data-theme=dark] header button{border-color:#4B5563}
    @media (max-width:640px){.mm-grid{columns:1}}`;
  document.head.append(style);
})();
