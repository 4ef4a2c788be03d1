// Large maps: the scene's pictures of them are pooled. Where a person looks closely the server sends an
// excerpt in cells of their own; it takes the place of that part of the picture, and goes where it goes.
// The server is told where the camera rests: see app/page/zoom_controller.py.
(() => {
  const S = window.mapmeld;
  if (S.closer) { S.closer.reset(); return; }
  const { viewer, metre } = S.kit;
  const STILL = 150, EVERY = 500; // ms until what rests is told, and between two words of what moves on
  const C = { laid: {}, newest: {} }; // by the picture's name: what lies over it, what was sent last
  S.closer = C;
  let seen = null, since = 0, told = -EVERY, news = false;
  C.reset = () => { C.laid = {}; C.newest = {}; seen = null; };

  // --- where the camera rests -------------------------------------------------------------------
  function look(time) {
    const camera = S.kit.camera(), canvas = S.kit.canvas();
    if (S.view !== "map" || !S.channel || !camera || !canvas) return;
    const px = metre(camera), { x, y } = camera.position;
    const w = canvas.clientWidth / 2 / px, h = canvas.clientHeight / 2 / px;
    const box = [x - w, y - h, x + w, y + h], { x: mx, y: my, theta } = S.maps[2];
    const inMov = [[box[0], box[1]], [box[2], box[3]]].flatMap((corner) => mapmeldInk.toFrame(S.maps[2], corner));
    const now = [...box, ...inMov];
    if (!seen || now.some((value, k) => Math.abs(value - seen[k]) > 1 / px)) { seen = now; since = time; news = true; }
    if (!news || (time - since < STILL && time - told < EVERY)) return;
    news = time - since < STILL; // it moves on: there is more to tell
    told = time;
    S.tell("look", { box, mov: [mx, my, theta], density: px * devicePixelRatio });
  }

  // --- what is sent -----------------------------------------------------------------------------
  function* materials(name) {
    const found = [];
    viewer().nodeRefFromName[name]?.traverse((mesh) => { if (mesh.isMesh && mesh.material.userData.closer) found.push(mesh.material); });
    yield* found;
  }
  function lay() { // again and again: the scene may have made a picture anew
    let changed = false;
    for (const [name, laid] of Object.entries(C.laid)) for (const material of materials(name)) {
      const uniforms = material.userData.closer;
      if (uniforms.laid === laid) continue;
      uniforms.laid = laid;
      uniforms.closerHole.value = laid.hole;
      uniforms.closerCells.value = laid.bitmap && (laid.texture ??= textureOf(laid.bitmap, material.map));
      changed = true;
    }
    if (changed) viewer().requestRender();
  }
  function textureOf(bitmap, like) {
    const texture = new like.constructor(bitmap);
    texture.colorSpace = like.colorSpace;
    texture.flipY = texture.premultiplyAlpha = false;
    texture.magFilter = 1003; texture.minFilter = 1008; // squares from near, averages from afar
    texture.needsUpdate = true;
    texture.onUpdate = () => bitmap.close(); // it is on the graphics card now
    return texture;
  }
  const BARE = [0, 0, 0, 0];
  async function bitmapOf(png) {
    const sent = await fetch(`data:image/png;base64,${png}`); // of nobody: the browser unpacks it by itself
    return createImageBitmap(await sent.blob(), { premultiplyAlpha: "none", colorSpaceConversion: "none" });
  }
  async function take(sent) { // all of one message at once: no picture is seen sharp beside a pooled one
    Object.assign(C.newest, sent);
    const decoded = await Promise.all(Object.values(sent).map((excerpt) => excerpt && bitmapOf(excerpt.png)));
    for (const [k, [name, excerpt]] of Object.entries(sent).entries()) {
      if (C.newest[name] !== excerpt) continue; // overtaken while it was decoded
      const old = C.laid[name];
      C.laid[name] = excerpt ? { hole: excerpt.hole, bitmap: decoded[k] } : { hole: BARE, bitmap: null };
      old?.texture?.dispose();
    }
    lay();
  }
  S.parts.push({
    frame: (time) => { look(time); lay(); },
    apply: (message) => { if (message.closer) take(message.closer).catch((error) => console.error("mapmeld:", error)); },
  });
})();
