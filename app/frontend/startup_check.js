// Stands in the page as it is served, before anything else runs: says what is wrong where the rest of the
// page cannot. Without WebGL the server never hears of the tab; without a connection it cannot be told.
(() => {
  // viser connects to the page's address, in which no fragment may stand then; lesson.js puts it back
  window.mapmeldPlace = location.hash.slice(1);
  if (window.mapmeldPlace) history.replaceState(history.state, "", location.pathname + location.search);

  const style = document.createElement("style");
  style.textContent = `
    .mm-notice{position:fixed;z-index:100000;font:16px/1.5 system-ui,"Segoe UI",sans-serif;color:#111827;background:#fff}
    .mm-notice b.mm-name{color:#0072B2;font-size:20px}
    .mm-notice h1{font-size:24px;line-height:1.25;margin:12px 0 8px}
    .mm-notice code{display:block;font:12.5px/1.5 ui-monospace,Menlo,Consolas,monospace;background:#F3F4F6;border-radius:6px;padding:8px 10px;margin:6px 0;white-space:nowrap;overflow-x:auto}
    .mm-notice li{margin:6px 0} .mm-notice button{font:inherit;padding:6px 16px;border:0;border-radius:6px;background:#0072B2;color:#fff;cursor:pointer}
    #mm-nowebgl{inset:0;overflow:auto;background:#F3F4F6}
    #mm-nowebgl>div{max-width:680px;margin:6vh auto;padding:28px 36px;background:#fff;border-radius:12px;box-shadow:0 1px 6px rgba(17,24,39,.16)}
    #mm-lost{left:50%;top:84px;transform:translateX(-50%);width:min(480px,90vw);padding:16px 22px;border-radius:10px;border-left:5px solid #D55E00;box-shadow:0 4px 24px rgba(17,24,39,.28);font-size:14.5px}
    #mm-lost h1{font-size:18px;margin:0 0 6px;color:#A34700} #mm-lost p{margin:6px 0}
    @media (prefers-color-scheme:dark){#mm-nowebgl{background:#111827} .mm-notice,#mm-nowebgl>div{background:#1F2937;color:#F9FAFB} .mm-notice code{background:#111827} #mm-lost h1{color:#FB923C} .mm-notice b.mm-name{color:#56B4E9}}`;
  document.head.append(style);

  // Every text is fixed and written here: none comes from a user or a server.
  function notice(id, html) {
    if (document.getElementById(id)) return;
    const box = document.createElement("div");
    box.id = id; box.className = "mm-notice"; box.setAttribute("role", "alert"); box.innerHTML = html;
    box.querySelector("button")?.addEventListener("click", () => location.reload());
    (document.body || document.documentElement).append(box);
  }
  const remove = (id) => document.getElementById(id)?.remove();

  // --- a browser that cannot draw -----------------------------------------------------------------
  function draws() {
    try {
      const gl = document.createElement("canvas").getContext("webgl2");
      gl?.getExtension("WEBGL_lose_context")?.loseContext();
      return !!gl;
    } catch { return false; }
  }
  const NO_WEBGL = `<div><b class="mm-name">mapmeld</b>
    <h1>This browser cannot draw the page: WebGL 2 is missing.</h1>
    <p>The maps are drawn with the graphics card, or a stand-in for it, and this browser offers neither. Try this:</p>
    <ul>
      <li>Chrome, Chromium, Edge: in Settings, System, switch on <i>Use graphics acceleration when available</i>, then start the browser again.</li>
      <li>Firefox: in about:config set <i>webgl.disabled</i> to false.</li>
      <li>Another browser, or a browser on another machine. The server may stay where it is: <i>mapmeld serve --help</i> says how.</li>
    </ul>
    <p>The command line needs no browser. It merges the same maps with the same method:</p>
    <code>mapmeld merge map1.yaml map2.yaml --observation observation.yaml --out result</code>
    <p>And a run can be watched as a recording, which needs no WebGL:</p>
    <code>mapmeld replay map1.yaml map2.yaml --observation observation.yaml --out merge.html</code>
    <p><button>Try again</button></p></div>`;
  const LOST_WEBGL = `<h1>The browser has taken the graphics away.</h1>
    <p>That happens when the graphics driver starts anew, or too many tabs draw at once. Reload the page: what was loaded comes back.</p>
    <p><button>Reload</button></p>`;
  const ready = (go) => (document.body ? go() : document.addEventListener("DOMContentLoaded", go));
  if (!draws()) ready(() => notice("mm-nowebgl", NO_WEBGL));
  // A context that was lost is given back by the browser as a rule; only where it is not, there is something to say.
  let waiting = 0;
  document.addEventListener("webglcontextlost", (e) => {
    if (!e.target.isConnected) return;
    clearTimeout(waiting); waiting = setTimeout(() => notice("mm-lost", LOST_WEBGL), 3000);
  }, true);
  document.addEventListener("webglcontextrestored", () => { clearTimeout(waiting); remove("mm-lost"); }, true);

  // --- a connection that is gone ------------------------------------------------------------------
  const LOST = `<h1>The connection to mapmeld is lost.</h1>
    <p>What you see is the last that came; nothing answers until the connection is back. The page tries again every second while this window is in front.</p>
    <p>Is <i>mapmeld serve</i> still running? If not, start it again on the same port. A server that was started anew knows nothing of what was loaded here.</p>
    <p><button>Reload</button></p>`;
  const OTHER = `<h1>This page is of another version of mapmeld.</h1>
    <p>The server has changed since the page was loaded.</p><p><button>Reload</button></p>`;
  const GRACE = 1500; // ms; a connection that is back by then was not missed
  let gone = 0, leaving = false;
  window.addEventListener("pagehide", () => { leaving = true; });
  window.addEventListener("pageshow", () => { leaving = false; });
  function heard(data) { // what viser's worker tells its page of the connection
    if (!data || leaving) return;
    if (data.type === "connected") { clearTimeout(gone); gone = 0; remove("mm-lost"); }
    if (data.type === "closed" && !gone) {
      const words = data.versionMismatch ? OTHER : LOST;
      gone = setTimeout(() => { if (!document.getElementById("mm-nowebgl")) notice("mm-lost", words); }, GRACE);
    }
  }
  const Usual = window.Worker;
  window.Worker = class extends Usual {
    constructor(...how) { super(...how); this.addEventListener("message", (e) => heard(e.data)); }
  };
})();
