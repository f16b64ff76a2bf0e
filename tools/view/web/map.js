// The map: pans, zooms, follows; draws on the canvas or into an SVG.

import {apply, layBeside, layersSeenBy} from './state.js';
import {CanvasPaper, SvgPaper} from './paper.js';

const kFollowScale = 60;    // pixels a metre, at least, while following
const kMoving = 0.18;       // of the way that a map glides to its place in a frame

export class MapView {
  constructor(canvas, theme) {
    this.canvas = canvas;
    this.theme = theme;
    this.centre = [0, 0];
    this.scale = 40;
    this.fitting = true;     // until the user moves the map
    this.following = false;
    this.ellipses = true;
    this.paths = true;
    this.shown = new Map();  // name -> T as drawn: maps glide when they are joined
    this.layers = [];
    this.#listen();
  }

  // --- what is drawn ---------------------------------------------------------------------------

  update(fleet, viewer, colourOf) {
    if (!viewer) return;
    const changed = this.viewer !== viewer.name;
    this.viewer = viewer.name;
    this.layers = layersSeenBy(fleet, viewer);
    layBeside(this.layers, extentOf);
    for (const layer of this.layers) {
      layer.colour = colourOf(layer.name);
      layer.shownT = this.#glide(layer, changed);
    }
    for (const name of [...this.shown.keys()]) {
      if (!this.layers.some(l => l.name === name)) this.shown.delete(name);
    }
    if (this.following && viewer.pose) {
      this.centre = [viewer.pose[0], viewer.pose[1]];
      this.scale = Math.max(this.scale, kFollowScale);
    } else if (this.fitting) {
      this.#fitNow();
    }
  }

  #glide(layer, jump) {
    const before = this.shown.get(layer.name);
    const calm = matchMedia('(prefers-reduced-motion: reduce)').matches;
    if (!before || jump || calm) {
      this.shown.set(layer.name, [...layer.T]);
      return layer.T;
    }
    const turn = Math.atan2(Math.sin(layer.T[2] - before[2]), Math.cos(layer.T[2] - before[2]));
    before[0] += kMoving * (layer.T[0] - before[0]);
    before[1] += kMoving * (layer.T[1] - before[1]);
    before[2] += kMoving * turn;
    return before;
  }

  fit() { this.fitting = true; this.following = false; this.#fitNow(); }
  follow(on) { this.following = on; if (on) this.fitting = false; }
  zoom(factor, x = this.width / 2, y = this.height / 2) {
    const at = this.#toWorld(x, y);
    this.scale = Math.min(Math.max(this.scale * factor, 2), 2000);
    const now = this.#toWorld(x, y);
    this.centre = [this.centre[0] + at[0] - now[0], this.centre[1] + at[1] - now[1]];
    this.fitting = false;
  }
  pan(dx, dy) {
    this.centre = [this.centre[0] - dx / this.scale, this.centre[1] + dy / this.scale];
    this.fitting = this.following = false;
  }

  get width() { return this.canvas.clientWidth; }
  get height() { return this.canvas.clientHeight; }

  #fitNow() {
    let box = null;
    for (const layer of this.layers) box = joined(box, extentOf(layer, layer.T));
    if (!box) return;
    const margin = 46, top = 60;
    const w = Math.max(box.maxX - box.minX, 2), h = Math.max(box.maxY - box.minY, 2);
    this.scale = Math.min((this.width - 2 * margin) / w, (this.height - margin - top - 30) / h, 220);
    this.centre = [(box.minX + box.maxX) / 2, (box.minY + box.maxY) / 2 + (top - margin) / 2 / this.scale];
  }

  #toWorld(x, y) {
    return [this.centre[0] + (x - this.width / 2) / this.scale,
            this.centre[1] - (y - this.height / 2) / this.scale];
  }
  #toPage([x, y]) {
    return [this.width / 2 + (x - this.centre[0]) * this.scale,
            this.height / 2 - (y - this.centre[1]) * this.scale];
  }

  // --- drawing ---------------------------------------------------------------------------------

  draw() {
    const ratio = window.devicePixelRatio || 1;
    if (this.canvas.width !== Math.round(this.width * ratio)) this.canvas.width = Math.round(this.width * ratio);
    if (this.canvas.height !== Math.round(this.height * ratio)) this.canvas.height = Math.round(this.height * ratio);
    const context = this.canvas.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.#drawOn(new CanvasPaper(context));
  }

  svg() {
    const paper = new SvgPaper(this.width, this.height);
    this.#drawOn(paper);
    return paper.toString();
  }

  // Twice as fine as the screen.
  png() {
    const canvas = document.createElement('canvas');
    canvas.width = 2 * this.width; canvas.height = 2 * this.height;
    const context = canvas.getContext('2d');
    context.scale(2, 2);
    this.#drawOn(new CanvasPaper(context));
    return new Promise(done => canvas.toBlob(done, 'image/png'));
  }

  #drawOn(paper) {
    const t = this.theme();
    paper.rect(0, 0, this.width, this.height, t.card);
    this.#drawGrid(paper, t);
    const order = [...this.layers].sort((a, b) => a.own - b.own);
    for (const layer of order) this.#drawLandmarks(paper, layer);
    if (this.paths) for (const layer of order) this.#drawPath(paper, layer, t);
    for (const layer of order) this.#drawRobot(paper, layer, t);
    for (const layer of order) this.#drawName(paper, layer, t);
    this.#drawScale(paper, t);
  }

  #gridStep() { return [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100].find(m => m * this.scale >= (this.width < 500 ? 36 : 70)) ?? 200; }

  #drawGrid(paper, t) {
    const step = this.#gridStep();
    const [x0, y1] = this.#toWorld(0, 0), [x1, y0] = this.#toWorld(this.width, this.height);
    for (let x = Math.ceil(x0 / step) * step; x <= x1; x += step) {
      const [px] = this.#toPage([x, 0]);
      paper.line([[px, 0], [px, this.height]], t.grid, 1);
    }
    for (let y = Math.ceil(y0 / step) * step; y <= y1; y += step) {
      const [, py] = this.#toPage([0, y]);
      paper.line([[0, py], [this.width, py]], t.grid, 1);
    }
  }

  #drawScale(paper, t) {
    const step = this.#gridStep(), w = step * this.scale;
    const x = this.width - 18 - w, y = this.height - 20;
    paper.line([[x, y - 5], [x, y], [x + w, y], [x + w, y - 5]], t.soft, 1.5);
    paper.text(x + w / 2, y - 12, `${step} m`, t.soft, 12, 'center', t.card);
  }

  #drawLandmarks(paper, layer) {
    const faint = layer.placed ? 1 : 0.62;
    const dot = Math.min(Math.max(0.06 * this.scale, 0.8), 2);
    for (const row of layer.landmarks) {
      const [x, y] = this.#toPage(apply(layer.shownT, row[1], row[2]));
      if (x < -50 || y < -50 || x > this.width + 50 || y > this.height + 50) continue;
      const {a, b, angle} = ellipseOf(row, layer.shownT[2]);
      const major = 2 * a * this.scale, minor = 2 * b * this.scale;
      // Pale where it is uncertain.
      const sure = Math.min(1, Math.max(0.12, 0.22 / (a + 0.12)));
      if (this.ellipses && major > 2.2 && a < 1.5) {
        paper.ellipse(x, y, major, Math.max(minor, 0.6), -angle, null, layer.colour, 1, 0.45 * sure * faint);
      }
      paper.ellipse(x, y, dot, dot, 0, layer.colour, null, 1, sure * faint);
    }
  }

  #drawPath(paper, layer, t) {
    const points = layer.path.map(p => this.#toPage(apply(layer.shownT, p[0], p[1])));
    if (layer.pose) points.push(this.#toPage(apply(layer.shownT, layer.pose[0], layer.pose[1])));
    paper.line(points, t.card, 5);
    paper.line(points, layer.colour, 2.2, layer.placed ? [] : [1, 5]);
    const [x, y] = this.#toPage(apply(layer.shownT, 0, 0));
    paper.ellipse(x, y, 5, 5, 0, t.card, layer.colour, 2.2);
  }

  #drawRobot(paper, layer, t) {
    if (!layer.pose) return;
    const [x, y] = this.#toPage(apply(layer.shownT, layer.pose[0], layer.pose[1]));
    const heading = layer.shownT[2] + layer.pose[2];
    const corner = (forward, left) => [x + Math.cos(heading) * forward - Math.sin(heading) * left,
                                       y - Math.sin(heading) * forward - Math.cos(heading) * left];
    const size = Math.min(Math.max(0.32 * this.scale, 11), 26);
    paper.polygon([corner(size, 0), corner(-0.7 * size, 0.68 * size), corner(-0.36 * size, 0),
                   corner(-0.7 * size, -0.68 * size)], layer.colour, t.card, 2);
  }

  #drawName(paper, layer, t) {
    const at = layer.pose ?? (layer.landmarks.length ? [0, 0] : null);
    if (!at) return;
    const [x, y] = this.#toPage(apply(layer.shownT, at[0], at[1]));
    const note = layer.placed ? '' : layer.state === 'candidate' ? ' (perhaps it fits)' : ' (not joined)';
    const half = 4 * (layer.name + note).length + 8;  // stays on the page
    const inside = Math.max(Math.min(x, this.width - half), half);
    paper.text(inside, y - 26, layer.name + note, t.ink, 14, 'center', t.card, true);
  }

  // --- hands -----------------------------------------------------------------------------------

  #listen() {
    const fingers = new Map();
    const canvas = this.canvas;
    canvas.addEventListener('pointerdown', e => {
      fingers.set(e.pointerId, [e.offsetX, e.offsetY]);
      canvas.setPointerCapture(e.pointerId);
    });
    canvas.addEventListener('pointermove', e => {
      const before = fingers.get(e.pointerId);
      if (!before) return;
      const now = [e.offsetX, e.offsetY];
      if (fingers.size === 1) this.pan(now[0] - before[0], now[1] - before[1]);
      if (fingers.size === 2) {
        const other = [...fingers].find(([id]) => id !== e.pointerId)[1];
        const gap = p => Math.hypot(p[0] - other[0], p[1] - other[1]);
        this.zoom(gap(now) / Math.max(gap(before), 1), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
      }
      fingers.set(e.pointerId, now);
      this.onmove?.();
    });
    for (const end of ['pointerup', 'pointercancel']) {
      canvas.addEventListener(end, e => fingers.delete(e.pointerId));
    }
    canvas.addEventListener('wheel', e => {
      e.preventDefault();
      this.zoom(Math.exp(-e.deltaY * 0.0015), e.offsetX, e.offsetY);
      this.onmove?.();
    }, {passive: false});
    canvas.addEventListener('keydown', e => {
      const moves = {ArrowLeft: [60, 0], ArrowRight: [-60, 0], ArrowUp: [0, 60], ArrowDown: [0, -60]};
      if (moves[e.key]) this.pan(...moves[e.key]);
      else if (e.key === '+' || e.key === '=') this.zoom(1.25);
      else if (e.key === '-') this.zoom(0.8);
      else return;
      e.preventDefault();
      this.onmove?.();
    });
  }
}

// Half axes (one sigma, metres) and direction of a landmark's covariance, turned with its map.
export function ellipseOf(row, turn) {
  const [, , , , xx, xy, yy] = row;
  const mean = (xx + yy) / 2, half = (xx - yy) / 2, root = Math.hypot(half, xy);
  return {a: Math.sqrt(Math.max(mean + root, 0)), b: Math.sqrt(Math.max(mean - root, 0)),
          angle: 0.5 * Math.atan2(2 * xy, xx - yy) + turn};
}

// The box of a layer's landmarks (of those that are sure enough) and path.
function extentOf(layer, T) {
  let box = null;
  const add = (x, y) => {
    const [px, py] = apply(T, x, y);
    box = joined(box, {minX: px, maxX: px, minY: py, maxY: py});
  };
  for (const row of layer.landmarks) if (row[4] < 0.3 && row[6] < 0.3) add(row[1], row[2]);
  for (const point of layer.path) add(point[0], point[1]);
  if (layer.pose) add(layer.pose[0], layer.pose[1]);
  return box;
}

function joined(a, b) {
  if (!a) return b;
  if (!b) return a;
  return {minX: Math.min(a.minX, b.minX), maxX: Math.max(a.maxX, b.maxX),
          minY: Math.min(a.minY, b.minY), maxY: Math.max(a.maxY, b.maxY)};
}
