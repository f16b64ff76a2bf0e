// Two papers to draw on with the same pen: a canvas, and an SVG text. All in pixels.

export class CanvasPaper {
  constructor(context) { this.c = context; }
  rect(x, y, w, h, fill) { this.c.fillStyle = fill; this.c.fillRect(x, y, w, h); }
  line(points, stroke, width = 1, dash = []) {
    if (points.length < 2) return;
    const c = this.c;
    c.beginPath();
    points.forEach(([x, y], i) => i ? c.lineTo(x, y) : c.moveTo(x, y));
    c.strokeStyle = stroke; c.lineWidth = width; c.lineJoin = c.lineCap = 'round';
    c.setLineDash(dash); c.stroke(); c.setLineDash([]);
  }
  polygon(points, fill, stroke = null, width = 1) {
    const c = this.c;
    c.beginPath();
    points.forEach(([x, y], i) => i ? c.lineTo(x, y) : c.moveTo(x, y));
    c.closePath();
    if (fill) { c.fillStyle = fill; c.fill(); }
    if (stroke) { c.strokeStyle = stroke; c.lineWidth = width; c.stroke(); }
  }
  ellipse(x, y, a, b, angle, fill, stroke = null, width = 1, alpha = 1) {
    const c = this.c;
    c.globalAlpha = alpha;
    c.beginPath(); c.ellipse(x, y, a, b, angle, 0, 2 * Math.PI);
    if (fill) { c.fillStyle = fill; c.fill(); }
    if (stroke) { c.strokeStyle = stroke; c.lineWidth = width; c.stroke(); }
    c.globalAlpha = 1;
  }
  text(x, y, text, fill, size = 13, align = 'left', halo = null, bold = false) {
    const c = this.c;
    c.font = `${bold ? '600 ' : ''}${size}px system-ui, "DejaVu Sans", sans-serif`;
    c.textAlign = align; c.textBaseline = 'middle';
    if (halo) { c.strokeStyle = halo; c.lineWidth = 4; c.lineJoin = 'round'; c.strokeText(text, x, y); }
    c.fillStyle = fill; c.fillText(text, x, y);
  }
}

const n = value => Number(value.toFixed(2));
const escape = text => text.replace(/[&<>"]/g, c => ({'&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;'})[c]);

export class SvgPaper {
  constructor(width, height) {
    this.parts = [`<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" ` +
                  `viewBox="0 0 ${width} ${height}">`];
  }
  #put(part) { this.parts.push(part); }
  #points(points) { return points.map(([x, y]) => `${n(x)},${n(y)}`).join(' '); }
  #pen(fill, stroke, width) {
    return `fill="${fill ?? 'none'}"` + (stroke ? ` stroke="${stroke}" stroke-width="${n(width)}"` : '');
  }
  rect(x, y, w, h, fill) { this.#put(`<rect x="${n(x)}" y="${n(y)}" width="${n(w)}" height="${n(h)}" fill="${fill}"/>`); }
  line(points, stroke, width = 1, dash = []) {
    if (points.length < 2) return;
    const dashes = dash.length ? ` stroke-dasharray="${dash.join(' ')}"` : '';
    this.#put(`<polyline points="${this.#points(points)}" ${this.#pen(null, stroke, width)} ` +
              `stroke-linejoin="round" stroke-linecap="round"${dashes}/>`);
  }
  polygon(points, fill, stroke = null, width = 1) {
    this.#put(`<polygon points="${this.#points(points)}" ${this.#pen(fill, stroke, width)}/>`);
  }
  ellipse(x, y, a, b, angle, fill, stroke = null, width = 1, alpha = 1) {
    const degrees = angle * 180 / Math.PI;
    const opacity = alpha < 1 ? ` opacity="${n(alpha)}"` : '';
    this.#put(`<ellipse rx="${n(a)}" ry="${n(b)}" transform="translate(${n(x)} ${n(y)}) ` +
              `rotate(${n(degrees)})" ${this.#pen(fill, stroke, width)}${opacity}/>`);
  }
  text(x, y, text, fill, size = 13, align = 'left', halo = null, bold = false) {
    const anchor = {left: 'start', center: 'middle', right: 'end'}[align];
    const rim = halo ? ` paint-order="stroke" stroke="${halo}" stroke-width="4" stroke-linejoin="round"` : '';
    this.#put(`<text x="${n(x)}" y="${n(y)}" fill="${fill}" font-size="${size}" text-anchor="${anchor}" ` +
              `dominant-baseline="middle" font-family="system-ui, DejaVu Sans, sans-serif"` +
              `${bold ? ' font-weight="600"' : ''}${rim}>${escape(text)}</text>`);
  }
  toString() { return this.parts.join('\n') + '\n</svg>\n'; }
}
