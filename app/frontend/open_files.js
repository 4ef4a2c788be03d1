// Files that are dropped anywhere on the page, or on a panel of their own; folders of them; and the list of those
// that were opened. upload.js sends them.
(() => {
  const S = window.mapmeld;
  if (S.openFiles) return;
  S.openFiles = true;
  const MOST = 2000, DEEPEST = 8; // files of a choice, folders in folders

  // --- folders ------------------------------------------------------------------------------------
  // In a folder there may be anything: of it are sent files whose names end as those that the button offers.
  const useful = (path) => {
    const parts = path.toLowerCase().split("/");
    return !parts.some((part) => part.startsWith(".")) && S.hud.open.suffixes.some((end) => path.toLowerCase().endsWith(end));
  };
  const fileOf = (entry) => new Promise((done) => entry.file(done, () => done(null)));
  const entriesOf = (reader) => new Promise((done) => reader.readEntries(done, () => done([])));
  async function walk(entry, found, deep = 0) {
    if (found.length >= MOST || deep > DEEPEST) return;
    if (entry.isFile) {
      const path = entry.fullPath.replace(/^\//, "");
      const file = !deep || useful(path) ? await fileOf(entry) : null;
      if (file) { S.sending.paths.set(file, path); found.push(file); }
      return;
    }
    const reader = entry.createReader(), inside = [];
    for (let part; (part = await entriesOf(reader)).length && inside.length < MOST; ) inside.push(...part); // a hundred at a time
    for (const each of inside.sort((a, b) => (a.name < b.name ? -1 : 1))) await walk(each, found, deep + 1);
  }
  async function open(transfer) {
    const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean); // gone once the event is over
    const found = [];
    for (const entry of entries) await walk(entry, found);
    S.sending.several(entries.length ? found : [...transfer.files].slice(0, MOST), S.hud.open.button);
  }

  // --- dropping -----------------------------------------------------------------------------------
  // A panel may have a place of its own; elsewhere files are for the whole page.
  const zoneOf = (e) => e.target.closest?.("[data-mm-files]");
  const files = (e) => [...(e.dataTransfer?.types || [])].includes("Files");
  const veil = document.createElement("div");
  veil.className = "mm-veil";
  veil.hidden = true;
  veil.append(Object.assign(document.createElement("p"), { textContent: "Drop files, a folder or a zip: maps, recordings, what is known, a fleet, what a robot saw" }));
  document.body.append(veil);
  function aim(zone, page) {
    for (const each of document.querySelectorAll("[data-mm-files]")) each.toggleAttribute("data-aim", each === zone);
    veil.hidden = !page;
  }
  window.addEventListener("dragover", (e) => {
    if (!files(e)) return;
    e.preventDefault();
    const zone = zoneOf(e);
    e.dataTransfer.dropEffect = zone || S.hud.open ? "copy" : "none";
    aim(zone, !zone && !!S.hud.open);
  });
  window.addEventListener("dragleave", (e) => { if (!e.relatedTarget) aim(null, false); });
  window.addEventListener("drop", (e) => {
    if (!files(e)) return;
    e.preventDefault();
    const zone = zoneOf(e);
    aim(null, false);
    if (zone) S.sending.several([...e.dataTransfer.files], zone.dataset.mmFiles);
    else if (S.hud.open) open(e.dataTransfer);
  });

  // --- the list -----------------------------------------------------------------------------------
  document.addEventListener("click", (e) => {
    if (e.target.closest?.("button[data-mm-folder]")) {
      const input = Object.assign(document.createElement("input"), { type: "file", webkitdirectory: true });
      input.onchange = () => {
        const path = (file) => file.webkitRelativePath;
        const found = [...input.files].filter((file) => useful(path(file))).sort((a, b) => (path(a) < path(b) ? -1 : 1));
        S.sending.several(found.slice(0, MOST), S.hud.open.button);
      };
      input.click();
      return;
    }
    const button = e.target.closest?.("button[data-mm-file]");
    if (!button) return;
    const { mmFile: what, n } = button.dataset;
    S.tell("file", { what, n: Number(n) });
    // it is written anew: whoever uses the keyboard stays in this line, or where the list has ended
    const swap = "button[data-mm-file=swap]", line = `.mm-given li button[data-n="${n}"]`;
    S.kit.stay(what === "swap" ? swap : `${line}, button[data-mm-folder]`);
  });
  setInterval(() => { // viser's button offers to choose one file alone
    for (const input of document.querySelectorAll("input[type=file][id^=file_upload_]:not([multiple])")) input.multiple = true;
  }, 100);

  const style = document.createElement("style");
  style.textContent = `
    .mm-given{margin:2px 12px 8px;font-size:12.5px;line-height:1.4}
    .mm-given p{margin:2px 0 4px;font-size:12px;opacity:.8}
    .mm-given ul{list-style:none;margin:0;padding:0;max-height:264px;overflow-y:auto}
    .mm-given li{display:flex;flex-wrap:wrap;gap:2px 6px;align-items:baseline;padding:1px 0} .mm-given i{flex:none;width:1em;font-style:normal;color:#6B7280}
    .mm-given li span{flex:1 1 150px;min-width:0;overflow-wrap:anywhere} .mm-given b{font-weight:550}
    .mm-given [data-state=used] i{color:#009E73} .mm-given [data-state=refused] i,.mm-given [data-state=refused] span{color:#C04A00}
    [data-mantine-color-scheme=dark] .mm-given [data-state=refused] :is(i,span){color:#F0A070}
    .mm-given button{flex:none;font:inherit;font-size:12px;line-height:18px;padding:1px 7px;border:1px solid #9CA3AF;border-radius:5px;background:none;color:inherit;cursor:pointer}
    .mm-given button[data-mm-file=remove]{border-color:transparent}
    .mm-given button:hover{background:#6B728022} .mm-given button:focus-visible{outline:2px solid #0072B2;outline-offset:1px}
    .mm-given li>div{display:flex;gap:4px;margin-left:auto} .mm-given ul:focus-visible{outline:2px solid #0072B2}
    .mm-given>div{display:flex;flex-wrap:wrap;gap:6px;margin-top:4px}
    @media (pointer:coarse){.mm-given button{min-height:40px;min-width:40px}}
    .mm-veil{position:fixed;inset:0;z-index:1000;pointer-events:none;display:flex;align-items:center;justify-content:center;border:4px dashed #0072B2;background:rgba(0,114,178,.16)}
    .mm-veil[hidden]{display:none}
    .mm-veil p{margin:16px;padding:12px 18px;border-radius:8px;background:#fff;color:#111827;font:550 16px/1.4 system-ui,"Segoe UI",sans-serif;box-shadow:0 2px 12px rgba(17,24,39,.3)}
    [data-mantine-color-scheme=dark] .mm-veil p{background:#1F2937;color:#F9FAFB}`;
  document.head.append(style);
})();
