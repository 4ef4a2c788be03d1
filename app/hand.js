// What a person does by hand, as far as the browser does it by itself: keys, entries of the history.
(() => {
  const S = window.mapmeld;
  if (S.handy) return;
  S.handy = true;

  // --- a reload finds everything as it was: see app/keep.py -----------------------------------------
  const KEY = "mapmeld";
  let greeted = false;
  const stored = () => { try { return sessionStorage.getItem(KEY) || ""; } catch { return ""; } }; // may be forbidden
  S.heard.push((message) => {
    if (message.channel) { S.tell("hello", { key: stored(), again: greeted }); greeted = true; }
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
    if (entry) S.tell("go", { to: Number(entry.dataset.go) });
    if (step) S.tell("step", { by: Number(step.dataset.by) });
  });
  const style = document.createElement("style");
  style.textContent = `
    .mm-steps{display:flex;gap:8px;margin:6px 10px 2px}
    .mm-step{flex:1;padding:4px 0;border:0;border-radius:4px;background:#E2E8F0;color:#111827;font:600 13px/1.4 system-ui,"Segoe UI",sans-serif;cursor:pointer}
    .mm-step:hover{background:#CBD5E1} .mm-step:disabled{opacity:.45;cursor:default;background:#E2E8F0}
    .mm-step:focus-visible{outline:2px solid #0072B2;outline-offset:1px}
    .mm-history{max-height:230px;overflow:auto;margin:2px 10px 8px;border:1px solid #9CA3AF55;border-radius:6px}
    .mm-entry{display:flex;gap:7px;align-items:baseline;width:100%;padding:3px 8px;border:0;background:none;color:inherit;font:12.5px/1.4 system-ui,"Segoe UI",sans-serif;text-align:left;cursor:pointer}
    .mm-entry:hover{background:#6B728022} .mm-entry:focus-visible{outline:2px solid #0072B2;outline-offset:-2px}
    .mm-entry span{overflow-wrap:anywhere} .mm-entry i{flex:none;width:7px;height:7px;border-radius:50%}`;
  document.head.append(style);
})();
