// The panels beside the map: one robot's health, picture, peers, time, counters.

import {drawConfidence, drawEye, drawSteps} from './charts.js';

const $ = id => document.getElementById(id);
const kMood = {mapping: 'good', merged: 'good', degraded: 'warn', starting: 'warn', fault: 'bad'};
const kLedNames = ['status', 'peer', 'fault'];

let lights = null;
fetch('lights.json').then(r => r.json()).then(l => { lights = l; }).catch(() => {});

// Texts are set, never parsed: names come from other robots.
function element(name, text = '', classes = '') {
  const made = document.createElement(name);
  made.textContent = text;
  if (classes) made.className = classes;
  return made;
}

function setChildren(parent, children) {
  parent.replaceChildren(...children);
}

export function swatch(colour) {
  const made = element('span', '', 'swatch');
  made.style.background = colour;
  return made;
}

const fixed = (value, digits) => typeof value === 'number' ? value.toFixed(digits) : '–';

export function showLeds(state) {
  const box = $('leds');
  if (!box.children.length) {
    setChildren(box, kLedNames.map(name => element('span', '', `led ${name}`)));
  }
  const step = Math.floor(performance.now() / 100) % 20;
  const rhythms = lights?.[state];
  [...box.children].forEach((led, i) => led.classList.toggle('on', rhythms?.[i]?.[step] === '#'));
  box.setAttribute('aria-label', `Lights: ${state ?? 'unknown'}`);
}

export function showHealth(robot) {
  const health = robot.lines.health;
  $('health-title').textContent = robot.name;
  $('state').textContent = health?.state ?? '–';
  $('state').className = kMood[health?.state] ?? '';
  $('reason').textContent = health?.reason ?? '';
  const pose = robot.lines.pose, deviation = pose?.covariance ? Math.sqrt(Math.max(pose.covariance[0] + pose.covariance[3], 0)) : null;
  const facts = [
    ['Position', pose ? `${fixed(pose.pose[0], 2)}, ${fixed(pose.pose[1], 2)} m` : '–'],
    ['Heading', pose ? `${fixed(pose.pose[2] * 180 / Math.PI, 1)}°` : '–'],
    ['Uncertain by', deviation !== null ? `${fixed(100 * deviation, 1)} cm` : '–'],
    ['Landmarks', String(robot.maps.get(-1)?.size ?? 0)],
    ['Matched', pose ? `${pose.inliers} of ${pose.candidates} expected` : '–'],
    ['Loops closed', String(health?.map?.loops_closed ?? '–')],
    ['Camera, CAN', health ? `${health.camera?.up ? 'up' : 'DOWN'}, ${health.can?.bus_off ? 'BUS OFF' : health.can?.up ? 'up' : 'DOWN'}` : '–'],
  ];
  setChildren($('facts'), facts.flatMap(([name, value]) => [element('dt', name), element('dd', value)]));
}

// The verdict on camera, wheels and clocks: nothing while it is good.
export function showVerdict(robot) {
  const reasons = Object.entries(robot.lines.verdict?.reasons ?? {});
  setChildren($('reasons'), reasons.map(([code, reason]) => {
    const row = element('li', '', reason.severity === 'wrong' ? 'bad' : 'warn');
    row.append(element('strong', code.replaceAll('_', ' ')), element('span', String(reason.text ?? '')));
    return row;
  }));
  $('reasons').hidden = reasons.length === 0;
}

let eyeImage = null, eyeSerial = -1;

export function showEye(robot, wanted, past) {
  const picture = wanted ? robot.picture : null;
  if (picture && picture.serial !== eyeSerial) {
    eyeSerial = picture.serial;
    const image = new Image();
    image.onload = () => {
      eyeImage = image;
      drawEye($('eye'), image, picture.corners ?? [], picture.width);
      $('eye').dataset.drawn = String(picture.serial);
    };
    image.src = picture.image;
  } else if (!picture && eyeSerial !== -1) {
    eyeSerial = -1;
    eyeImage = null;
    drawEye($('eye'), null, [], 1);
  }
  let note = '';
  if (!wanted) note = 'Not shown: nothing is asked of the robot.';
  else if (!picture) note = past ? 'No picture: nobody looked at that time.' : 'No picture yet.';
  else if (!picture.used) note = 'It stands: this frame told nothing new.';
  $('eye-note').textContent = note;
}

export function showPeers(robot, colourOf, theme) {
  const curves = Object.entries(robot.confidence).filter(([, points]) => points.length)
    .map(([name, points]) => ({colour: colourOf(name), points}));
  $('confidence').hidden = curves.length === 0;
  if (curves.length) drawConfidence($('confidence'), curves, theme);
  const rows = robot.peers().map(peer => {
    const row = element('div', '', 'peer');
    const name = element('span');
    const state = peer.alignment?.state ?? 'apart';
    name.append(swatch(colourOf(peer.name)), peer.name,
                element('span', {merged: 'joined', candidate: 'perhaps', withdrawn: 'withdrawn', apart: 'apart'}[state], `badge ${state}`));
    const facts = [];
    if (peer.alignment) facts.push(`confidence ${fixed(peer.alignment.confidence, 2)}`);
    if (peer.alignment?.correspondences) facts.push(`${peer.alignment.correspondences} in common`);
    if (peer.heard) facts.push(peer.heard.age_s > 3 ? `silent for ${fixed(peer.heard.age_s, 0)} s` : `${peer.heard.landmarks} landmarks told`);
    row.append(name, element('span', facts.join(', ')));
    return row;
  });
  setChildren($('peers'), rows.length ? rows : [element('p', 'No other robot is known.', 'quiet')]);
}

const kDurations = [['step', 'a step'], ['compute', 'computing'], ['age', 'capture to pose'], ['wake_up', 'woken late']];

export function showTime(robot, theme) {
  drawSteps($('steps'), robot.steps, robot.lines.pose?.period_ms, theme, theme.accent);
  const d = robot.lines.deadlines;
  if (!d) return setChildren($('deadlines'), []);
  const head = element('tr');
  head.append(element('th', 'ms'), ...['median', '95 %', '99.9 %', 'most'].map(t => element('td', t)));
  const rows = kDurations.filter(([key]) => d[key]?.count).map(([key, name]) => {
    const row = element('tr');
    row.append(element('th', name), ...['p50_ms', 'p95_ms', 'p999_ms', 'max_ms'].map(k => element('td', fixed(d[key][k], 1))));
    return row;
  });
  const total = d.met + d.missed;
  const missed = element('tr'), cell = element('td', `${d.missed} of ${total}, ${d.explained} for want of a CPU`);
  cell.colSpan = 4;
  missed.append(element('th', 'missed'), cell);
  setChildren($('deadlines'), [head, ...rows, missed]);
}

export function showCounters(robot) {
  if (!$('counters').open) return;
  const list = element('dl');
  for (const [title, line] of [['health', robot.lines.health], ['radio', robot.lines.radio], ['zenith view', robot.lines.view]]) {
    for (const [group, values] of Object.entries(line ?? {})) {
      if (typeof values !== 'object' || values === null) continue;
      for (const [key, value] of Object.entries(values)) {
        list.append(element('dt', `${title} ${group} ${key}`.replaceAll('_', ' ')), element('dd', String(value)));
      }
    }
  }
  setChildren($('counter-list'), [list]);
}
