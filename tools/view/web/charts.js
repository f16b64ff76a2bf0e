// Small curves over time, and the picture with its corners.

import {CanvasPaper} from './paper.js';

function paperOf(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const w = canvas.clientWidth, h = canvas.clientHeight;
  canvas.width = Math.round(w * ratio);
  canvas.height = Math.round(h * ratio);
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, w, h);
  return {paper: new CanvasPaper(context), w, h};
}

const kLeft = 30, kBottom = 16, kTop = 8, kRight = 4;

function axes(paper, w, h, t, marks, bottom, top, unit) {
  const y = value => h - kBottom - (value - bottom) / (top - bottom) * (h - kBottom - kTop);
  for (const mark of marks) {
    paper.line([[kLeft, y(mark)], [w - kRight, y(mark)]], t.grid, 1);
    paper.text(kLeft - 5, y(mark), String(mark), t.soft, 11, 'right');
  }
  paper.text(w - kRight, h - 6, unit, t.soft, 11, 'right');
  return y;
}

// curves: [{colour, points: [[t, value]]}]
export function drawConfidence(canvas, curves, t, seconds = 120) {
  const {paper, w, h} = paperOf(canvas);
  const y = axes(paper, w, h, t, [0, 0.5, 1], 0, 1, `last ${seconds / 60} minutes`);
  const last = Math.max(...curves.map(c => c.points.at(-1)?.[0] ?? 0), 0);
  const x = time => w - kRight - (last - time) / seconds * (w - kRight - kLeft);
  paper.line([[kLeft, y(0.5)], [w - kRight, y(0.5)]], t.soft, 1, [4, 4]);
  for (const curve of curves) {
    paper.line(curve.points.filter(p => last - p[0] <= seconds).map(p => [x(p[0]), y(p[1])]), curve.colour, 2);
  }
}

export function drawSteps(canvas, steps, period, t, colour, seconds = 30) {
  const {paper, w, h} = paperOf(canvas);
  const last = steps.at(-1)?.[0] ?? 0;
  const shown = steps.filter(p => last - p[0] <= seconds);
  const most = Math.max(period || 0, ...shown.map(p => p[1]), 1) * 1.12;
  const step = [1, 2, 5, 10, 20, 50, 100, 200, 500].find(s => most / s <= 4) ?? 1000;
  const marks = [];
  for (let m = 0; m <= most; m += step) marks.push(m);
  const y = axes(paper, w, h, t, marks, 0, most, `ms, last ${seconds} s`);
  const x = time => w - kRight - (last - time) / seconds * (w - kRight - kLeft);
  if (period) {
    paper.line([[kLeft, y(period)], [w - kRight, y(period)]], t.bad, 1.5, [5, 4]);
    paper.text(kLeft + 4, y(period) + 9, 'deadline', t.bad, 11, 'left', t.card);
  }
  for (const [time, ms] of shown) {
    paper.line([[x(time), y(0)], [x(time), y(ms)]], ms > period && period ? t.bad : colour, 2);
  }
}

const kKinds = ['#6db9ff', '#ffb02e', '#2fd07f'];

// The level image has its first row at the robot's right: u grows forward, v grows left. On the page
// forward points up, as one looks along the robot, and left to the left.
export function drawEye(canvas, image, corners, size) {
  const context = canvas.getContext('2d');
  const w = canvas.width, scale = w / size;
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.clearRect(0, 0, w, w);
  if (!image) return;
  // (u, v) -> (x, y) = (size - v, size - u)
  context.setTransform(0, -scale, -scale, 0, w, w);
  context.drawImage(image, 0, 0, size, size);
  context.setTransform(1, 0, 0, 1, 0, 0);
  const at = (u, v) => [w - (v + 0.5) * scale, w - (u + 0.5) * scale];
  for (let i = 0; i + 4 < corners.length; i += 5) {
    const [u, v, kind, pu, pv] = corners.slice(i, i + 5);
    const [x, y] = at(u, v);
    context.strokeStyle = kKinds[kind];
    context.lineWidth = kind ? 3 : 2;
    if (kind) {
      const [px, py] = at(pu, pv);
      context.beginPath(); context.moveTo(px, py); context.lineTo(x, y); context.stroke();
    }
    context.beginPath(); context.arc(x, y, kind ? 8 : 5, 0, 2 * Math.PI); context.stroke();
  }
}
