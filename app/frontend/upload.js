// Files on their way to the server, each by a connection of its own: viser's own way is to send all of a file
// by the connection that every control needs. How far they are is told below the head, once that takes longer
// than a moment; Stop, there or in the panel, leaves them. The server's side is app/web/upload.py.
(() => {
  const S = window.mapmeld;
  if (S.sending) { S.sending.reset(); return; }
  const SOON = 400, HARDLY = 300; // ms: what takes no longer, or will be there by then, is not worth a word
  const LATELY = 4000, SILENT = 5000, READ = 12000; // ms: a rate is of this time; no news for so long is news; a note stays
  const STEP = 150, RESERVE = 600; // ms of the line that one part takes, and all that is on its way: as much still comes after Stop
  const LONGEST = 255; // letters of a name that the server takes
  const F = { going: new Set(), paths: new WeakMap() }; // where in its folder a file was
  S.sending = F;
  let card = null, what = null, much = null, bar = null, leave = null, clock = 0;
  let shown = false, there = { size: 0, began: 0 }, lately = [], note = "", noted = 0;

  // --- one file -----------------------------------------------------------------------------------
  function address() { // beside the page, in whatever folder a proxy has put it
    const at = new URL(location.href);
    at.protocol = at.protocol.replace("http", "ws");
    at.pathname = at.pathname.replace(/\/?(index\.html)?$/, "/upload");
    at.search = at.hash = "";
    return at.href;
  }
  const pathOf = (file) => (F.paths.get(file) || file.webkitRelativePath || file.name).slice(-LONGEST);
  function send(file, button) {
    const one = { file, button, socket: new WebSocket(address()), sent: 0, arrived: 0, least: 0, most: 0, ahead: 0, pumping: false };
    F.going.add(one);
    clock ||= setInterval(show, 250);
    one.socket.onopen = () => one.socket.send(JSON.stringify({ button, name: pathOf(file), kind: file.type, size: file.size }));
    one.socket.onmessage = (e) => {
      const { over, ...news } = JSON.parse(e.data);
      Object.assign(one, news);
      if (news.arrived) lately.push([performance.now(), far()]);
      if (!over) pump(one);
      else if (over === "arrived" || over === "refused") done(one, over === "arrived");
      else { if (over === "lost") lost(one); end(button, false); }
    };
    one.socket.onclose = () => { if (F.going.has(one)) { lost(one); end(button, false); } };
  }
  function room(one) { // bytes that may be sent now, as much as the line has been seen to carry in a moment
    const each = pace(performance.now()) / F.going.size;
    const of = (ms, least, most) => Math.min(most, Math.max(least, Math.round(ms * each)));
    return one.sent - one.arrived < of(RESERVE, 4 * one.least, one.ahead) ? of(STEP, one.least, one.most) : 0;
  }
  async function pump(one) {
    if (one.pumping) return;
    one.pumping = true;
    for (let size; F.going.has(one) && one.sent < one.file.size && (size = room(one)); ) {
      const part = await one.file.slice(one.sent, one.sent + size).arrayBuffer().catch(() => null);
      if (!F.going.has(one)) return;
      if (!part?.byteLength) { say(`${one.file.name} cannot be read any more. Choose it again.`); done(one, false); return; }
      one.socket.send(part);
      one.sent += part.byteLength;
    }
    one.pumping = false;
  }
  function drop(one) {
    F.going.delete(one);
    one.socket.close();
  }

  // --- several files ------------------------------------------------------------------------------
  // Those that are chosen at once go one by one, and so do those that are chosen for the same button meanwhile; in
  // the end the page is told how many have arrived, to be taken together.
  const choices = new Map(); // by button
  F.several = (files, button) => {
    if (!files.length) return;
    if (!choices.size) { there = { size: 0, began: performance.now() }; lately = []; }
    const choice = choices.get(button) || { rest: [], arrived: 0, days: [] };
    choice.rest.push(...files);
    if (choices.has(button)) return;
    choices.set(button, choice);
    note = "";
    send(choice.rest.shift(), button);
  };
  function done(one, arrived) { // the next one
    const choice = choices.get(one.button);
    drop(one);
    if (arrived) { choice.arrived += 1; choice.days.push(+(one.file.lastModified / 864e5).toFixed(5)); there.size += one.file.size; }
    if (choice.rest.length) send(choice.rest.shift(), one.button); else end(one.button, true);
    show();
  }
  function end(button, whole) { // not whole: it was left, and nothing of it counts
    for (const one of F.going) if (one.button === button) drop(one);
    const choice = choices.get(button);
    choices.delete(button);
    if (choice) S.tell("sent", { button, count: choice.arrived, whole, days: choice.days.length <= 200 ? choice.days : [] });
    show();
  }
  function lost(one) {
    const choice = choices.get(one.button), several = choice && choice.rest.length + choice.arrived > 0;
    say(`${one.file.name} did not arrive: the connection broke off. Choose ${several ? "all of them" : "it"} again.`);
  }
  function say(words) { note = words; noted = performance.now(); }
  F.reset = () => { for (const one of F.going) { lost(one); drop(one); } choices.clear(); show(); }; // another connection, another page
  // viser's button has its own way of sending: it is not told of the choice
  window.addEventListener("change", (e) => {
    const input = e.target;
    if (!(input instanceof HTMLInputElement) || input.type !== "file" || !input.id.startsWith("file_upload_")) return;
    e.stopImmediatePropagation();
    const chosen = [...input.files];
    input.value = ""; // the same file may be chosen again
    F.several(chosen, input.id.slice("file_upload_".length));
  }, true);

  // --- words --------------------------------------------------------------------------------------
  const sum = (name) => [...F.going].reduce((total, one) => total + name(one), 0);
  const waiting = () => [...choices.values()].flatMap((choice) => choice.rest);
  const far = () => there.size + sum((one) => one.arrived);
  function pace(now) { // bytes per ms
    while (lately.length > 2 && now - lately[0][0] > LATELY) lately.shift();
    const [first, last] = [lately[0], lately.at(-1)];
    return lately.length > 1 && last[0] > first[0] ? (last[1] - first[1]) / (last[0] - first[0]) : 0;
  }
  function left(ms) {
    if (ms > 90000) return `about ${Math.round(ms / 60000)} min left`;
    return ms > 10000 ? `about ${5 * Math.round(ms / 5000)} s left` : "a few seconds left";
  }
  function show() {
    const now = performance.now(), rest = waiting(), done = far(),
      all = there.size + sum((one) => one.file.size) + rest.reduce((total, file) => total + file.size, 0), rate = pace(now);
    if (!F.going.size) {
      shown = false;
      if (!note || now - noted > READ) { note = ""; clearInterval(clock); clock = 0; }
    } else if (now - there.began > SOON && !(rate && (all - done) / rate < HARDLY)) shown = true;
    if (!card) return;
    card.hidden = !shown && !note;
    if (card.hidden) return;
    leave.hidden = bar.hidden = !shown;
    if (!shown) { what.textContent = note; much.textContent = ""; return; }
    const unit = all < 1e6 ? ["kB", 1e3] : ["MB", 1e6], digits = all / unit[1] < 10 ? 1 : 0;
    const names = [...[...F.going].map((one) => one.file), ...rest].map((file) => file.name), count = (bytes) => (bytes / unit[1]).toFixed(digits);
    const quiet = now - (lately.at(-1)?.[0] ?? there.began) > SILENT;
    what.textContent = `Sending ${names.length > 2 ? `${names.length} files` : names.join(" and ")}`;
    much.textContent = `${count(done)} of ${count(all)} ${unit[0]}` +
      (quiet ? ", nothing gets through just now" : rate && now - there.began > 2000 ? `, ${left((all - done) / rate)}` : "");
    bar.setAttribute("aria-valuenow", Math.round(100 * done / all));
    bar.firstChild.style.width = `${100 * done / all}%`;
  }
  function make(kind, name) { const e = document.createElement(kind); e.className = name; return e; }
  function adopt(hud) {
    card = make("div", "mm-sending"); what = make("span", "mm-file"); much = make("span", "mm-much");
    bar = make("div", "mm-way"); leave = make("button", "mm-leave");
    bar.append(make("i", ""));
    bar.setAttribute("role", "progressbar"); bar.setAttribute("aria-label", "Files on their way");
    leave.type = "button"; leave.textContent = "✕"; leave.title = "Stop sending. Nothing of it stays.";
    leave.setAttribute("aria-label", "Stop sending");
    leave.onclick = () => { S.tell("unsend"); for (const button of [...choices.keys()]) end(button, false); };
    card.append(what, much, leave, bar);
    S.kit.keep(card);
    hud.querySelector(".mm-head").append(card);
    show();
  }
  S.parts.push({ adopt });

  const style = document.createElement("style");
  style.textContent = `
    .mm-sending{position:absolute;left:0;top:calc(100% + 6px);max-width:100%;box-sizing:border-box;display:flex;align-items:center;gap:10px;padding:5px 12px 7px;border-radius:8px;overflow:hidden;background:rgba(255,255,255,.94);box-shadow:0 1px 4px rgba(17,24,39,.16);font-size:12.5px}
    [data-theme=dark] .mm-sending{background:rgba(31,41,55,.96)}
    .mm-sending[hidden]{display:none}
    .mm-file{overflow:hidden;white-space:nowrap;text-overflow:ellipsis;font-weight:550}
    .mm-much{flex:none;min-width:216px;font-variant-numeric:tabular-nums;color:#6B7280} [data-theme=dark] .mm-much{color:#9CA3AF}
    .mm-much:empty{display:none} .mm-file:has(+ .mm-much:empty){white-space:normal}
    .mm-leave{flex:none;pointer-events:auto;font:inherit;line-height:18px;width:20px;padding:0;border:0;border-radius:5px;background:transparent;color:inherit;cursor:pointer}
    .mm-leave:hover{background:rgba(0,114,178,.12)} [data-theme=dark] .mm-leave:hover{background:rgba(86,180,233,.2)}
    .mm-leave:focus-visible{outline:2px solid #0072B2;outline-offset:-2px} [data-theme=dark] .mm-leave:focus-visible{outline-color:#56B4E9}
    .mm-leave[hidden]{display:none}
    .mm-way{position:absolute;left:0;right:0;bottom:0;height:3px;background:rgba(0,114,178,.12)}
    .mm-way i{display:block;height:100%;background:#0072B2;transition:width .15s linear} [data-theme=dark] .mm-way i{background:#56B4E9}
    .mm-way[hidden]{display:none}
    @container (max-width:460px){.mm-sending{flex-wrap:wrap;row-gap:0} .mm-file{flex:1 1 100%} .mm-much{flex:1 1 0;min-width:0}}`;
  document.head.append(style);
})();
