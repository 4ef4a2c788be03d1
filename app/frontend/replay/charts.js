// Small charts on a canvas: lines, areas, dashes, dots, or a picture with a scale of colours; axes with round numbers.
const mapmeldCharts = (() => {
  const LEFT = 44, RIGHT = 14, TITLE = 26, KEYS = 18, FOOT = 40;

  function ticks(low, high, most) { // round numbers between low and high
    const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= rough) || power;
    const found = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
    return { found, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
  }
  const TURNS = { 180: [0, 45, 90, 135, 180], 360: [-180, -90, 0, 90, 180] }; // degrees have round numbers of their own

  function chart(g, c, x, y, wide, high, ink) {
    let left = x + LEFT, right = x + wide - RIGHT;
    const top = y + TITLE + KEYS, foot = y + high - FOOT;
    if (c.image) { // a metre is as long upwards as it is across
      left += 16;
      right = Math.min(right, left + (foot - top) * (c.x[1] - c.x[0]) / (c.y[1] - c.y[0]));
    }
    const px = (v) => left + (v - c.x[0]) / (c.x[1] - c.x[0]) * (right - left);
    const py = (v) => foot - (Math.min(c.y[1], Math.max(c.y[0], v)) - c.y[0]) / (c.y[1] - c.y[0]) * (foot - top);
    const say = (text, at, line, align, size, colour) => {
      g.font = `${size}px system-ui, "Segoe UI", sans-serif`; g.textAlign = align; g.textBaseline = "middle";
      g.fillStyle = colour; g.fillText(text, at, line);
    };
    g.setLineDash([]);
    say(c.title, x + 14, y + 15, "left", 14, ink.text);
    let key = x + 14;
    for (const s of c.series) {
      g.fillStyle = ink.colour(s.c);
      if (s.k === "dots") { g.beginPath(); g.arc(key + 5, y + 34, 4, 0, 7); g.fill(); }
      else if (s.k === "area") g.fillRect(key, y + 30, 10, 8);
      else g.fillRect(key, y + 33, 10, 2);
      say(s.t, key + 14, y + 34, "left", 11, ink.quiet);
      key += 26 + g.measureText(s.t).width;
    }
    if (c.scale) {
      const [dark, bright] = c.scale.ends, strip = 90;
      say(dark, key, y + 34, "left", 11, ink.quiet);
      key += g.measureText(dark).width + 6;
      const colours = g.createLinearGradient(key, 0, key + strip, 0);
      c.scale.stops.forEach((stop, i, all) => colours.addColorStop(i / (all.length - 1), stop));
      g.fillStyle = colours; g.fillRect(key, y + 30, strip, 8);
      say(bright, key + strip + 6, y + 34, "left", 11, ink.quiet);
    }
    const across = c.label.includes("°") && TURNS[c.x[1] - c.x[0]];
    const xs = across ? { found: across, digits: 0 } : ticks(c.x[0], c.x[1], 6), ys = ticks(c.y[0], c.y[1], 5);
    const sign = (v, digits) => v.toFixed(digits).replace("-", "−");
    if (c.image) {
      g.imageSmoothingEnabled = false;
      g.drawImage(c.picture, left, top, right - left, foot - top);
      g.save(); g.translate(x + 12, (top + foot) / 2); g.rotate(-Math.PI / 2);
      say(c.up, 0, 0, "center", 11.5, ink.quiet);
      g.restore();
    }
    g.lineWidth = 1; g.strokeStyle = ink.line;
    for (const v of ys.found) {
      g.beginPath(); g.moveTo(c.image ? left - 4 : left, py(v)); g.lineTo(c.image ? left : right, py(v)); g.stroke();
      say(sign(v, ys.digits), left - 6, py(v), "right", 11, ink.quiet);
    }
    for (const v of xs.found) {
      g.beginPath(); g.moveTo(px(v), foot); g.lineTo(px(v), foot + 4); g.stroke();
      say(sign(v, xs.digits), px(v), foot + 13, "center", 11, ink.quiet);
    }
    say(c.label, (left + right) / 2, foot + 29, "center", 11.5, ink.quiet);
    g.save(); g.beginPath(); g.rect(left - 7, top - 7, right - left + 14, foot - top + 8); g.clip();
    for (const s of c.series) {
      g.strokeStyle = g.fillStyle = ink.colour(s.c); g.lineWidth = 1.8; g.lineJoin = "round";
      g.setLineDash(s.k === "dash" ? [4, 5] : []);
      if (s.k === "dots") {
        for (let i = 0; i < s.x.length; i++) {
          g.beginPath(); g.arc(px(s.x[i]), py(s.y[i]), s.r, 0, 7); g.fill();
          if (s.rim) { g.strokeStyle = s.rim; g.lineWidth = 1.5; g.stroke(); }
        }
        continue;
      }
      g.beginPath();
      for (let i = 0; i < s.x.length; i++) g.lineTo(px(s.x[i]), py(s.y[i]));
      if (s.k === "area") {
        g.lineWidth = 1; if (!s.c.startsWith("rgba")) g.stroke();
        g.lineTo(px(s.x[s.x.length - 1]), foot); g.lineTo(px(s.x[0]), foot); g.closePath();
        if (!s.c.startsWith("rgba")) g.globalAlpha = 0.35;
        g.fill(); g.globalAlpha = 1;
      } else g.stroke();
    }
    g.restore();
  }
  // All charts one below the other, in a box of css px.
  function paint(g, charts, wide, high, ink) {
    const each = Math.min(430, high / Math.max(1, charts.length));
    charts.forEach((c, i) => chart(g, c, 0, i * each, wide, each, ink));
  }
  return { paint };
})();
