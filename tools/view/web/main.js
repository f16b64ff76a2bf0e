// The page: asks /live for what is new, ten times a second while it is seen, and shows it.

import {Fleet} from './state.js';
import {MapView} from './map.js';
import {showCounters, showEye, showHealth, showLeds, showPeers, showTime, showVerdict, swatch} from './panels.js';

const $ = id => document.getElementById(id);
const kAskEvery_ms = 100;
const kLost_ms = 2500;
// Told apart by most colour-blind people too (Okabe and Ito).
const kColours = {
  light: ['#0062b2', '#d55e00', '#008a5c', '#7846b4', '#966e00', '#0096be', '#b41e3c', '#5a5a5a', '#3c781e'],
  dark: ['#5cb8ff', '#ff9d4d', '#3ddc97', '#c79bff', '#f2c230', '#5ee0ec', '#ff8095', '#b9c2cc', '#9ed36a'],
};

const fleet = new Fleet();
let chosen = 0;              // robot
let chosenName = null;
let socket = null;
let asked_at = 0, answered_at = 0;
let control = null;          // for the next request
let past = false;            // of live robots: what was, not what is
let asked_past = false;
let sliding = false;
let dirty = true;

// --- theme and colours ---------------------------------------------------------------------------

function theme() {
  const style = getComputedStyle(document.documentElement);
  const get = name => style.getPropertyValue(name).trim();
  return {card: get('--card'), ink: get('--ink'), soft: get('--soft'), grid: get('--grid'),
          accent: get('--accent'), bad: get('--bad'), good: get('--good'),
          colours: kColours[matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light']};
}
let current = theme();
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { current = theme(); dirty = true; });

const numbers = new Map();  // robots keep theirs
function colourOf(name) {
  if (numbers.size > 1000) numbers.clear();
  if (!numbers.has(name)) numbers.set(name, numbers.size);
  return current.colours[numbers.get(name) % current.colours.length];
}

const map = new MapView($('map'), () => current);
map.onmove = () => { dirty = true; showFollow(); };

// --- asking --------------------------------------------------------------------------------------

function connect() {
  // The token of the page's own address opens the socket, too.
  const token = new URLSearchParams(location.search).get('token');
  socket = new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/live` +
                         (token ? `?token=${encodeURIComponent(token)}` : ''));
  socket.onopen = () => { fleet.epoch = 0; asked_at = 0; ask(); };
  socket.onmessage = event => {
    answered_at = performance.now();
    fleet.take(JSON.parse(event.data));
    if (asked_past && fleet.clock?.live) past = false;  // it has begun anew and knows no past
    dirty = true;
    setTimeout(ask, Math.max(0, kAskEvery_ms - (performance.now() - asked_at)));
  };
  socket.onclose = () => { socket = null; showConnection(); setTimeout(connect, 1000); };
}

function ask() {
  if (socket?.readyState !== WebSocket.OPEN) return;
  if (document.hidden) { setTimeout(ask, 500); return; }
  const robot = fleet.robots[chosen];
  if (past !== asked_past) fleet.epoch = 0;
  asked_past = past;
  const request = {epoch: fleet.epoch, seen: fleet.seen};
  if (past) request.past = true;
  if ($('look').checked) {
    request.picture = chosen;
    request.picture_seen = robot?.picture?.serial ?? 0;
  }
  if (control) { request.control = control; control = null; }
  asked_at = performance.now();
  socket.send(JSON.stringify(request));
}

// --- showing -------------------------------------------------------------------------------------

function choose(index) {
  chosen = index;
  chosenName = fleet.robots[index]?.name ?? null;
  dirty = true;
}

function showTabs() {
  const nav = $('robots');
  const names = fleet.robots.map(r => r.name + (r.up ? '' : '!')).join('\n') + `\n${chosen}${current.card}`;
  if (nav.dataset.names === names) return;
  nav.dataset.names = names;
  const focused = nav.contains(document.activeElement);
  nav.replaceChildren(...fleet.robots.map((robot, i) => {
    const tab = document.createElement('button');
    tab.setAttribute('role', 'tab');
    tab.setAttribute('aria-selected', String(i === chosen));
    tab.tabIndex = i === chosen ? 0 : -1;
    tab.append(swatch(colourOf(robot.name)), robot.name);
    if (!robot.up) {
      const badge = document.createElement('span');
      badge.className = 'badge lost';
      badge.textContent = 'silent';
      tab.append(badge);
    }
    tab.onclick = () => choose(i);
    return tab;
  }));
  if (focused) nav.children[chosen]?.focus();
}

function showConnection() {
  const element = $('connection'), note = $('map-note');
  const open = socket?.readyState === WebSocket.OPEN && performance.now() - answered_at < kLost_ms;
  const robot = fleet.robots[chosen];
  let text, lost = false;
  if (!open) {
    lost = true;
    text = 'connection lost; zenith view may have ended';
  } else if (past) {
    text = 'past';
  } else if (fleet.clock && !fleet.clock.live) {
    text = 'replay';
  } else if (robot && !robot.up) {
    lost = true;
    text = `${robot.name}: ${robot.lines.link?.why ?? 'silent'}`;
  } else {
    text = 'live';
  }
  element.textContent = open ? (lost ? 'robot silent' : text) : 'connection lost';
  element.className = lost ? 'lost' : open ? 'live' : '';
  document.body.classList.toggle('stale', lost);
  note.hidden = !lost;
  note.textContent = lost ? text + (fleet.robots.length ? '. What is shown is old.' : '') : '';
}

function clockText(seconds) {
  const whole = Math.floor(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')}`;
}

function showPlayer() {
  const clock = fleet.clock;
  $('player').hidden = !clock || clock.duration_s <= 0;
  if (!clock) return;
  $('play').hidden = $('speed').hidden = Boolean(clock.live);
  $('to-live').hidden = !past;
  const slider = $('slider');
  slider.max = clock.duration_s;
  if (!sliding) slider.value = clock.position_s;
  slider.setAttribute('aria-valuetext', clockText(clock.position_s));
  $('clock').textContent = `${clockText(clock.position_s)} / ${clockText(clock.duration_s)}`;
  $('play').textContent = clock.playing ? '❙❙' : '▶';
  $('play').setAttribute('aria-label', clock.playing ? 'Pause' : 'Play');
  if (document.activeElement !== $('speed')) $('speed').value = String(clock.speed);
  const marks = $('marks');
  if (marks.childElementCount !== clock.marks.length) {
    marks.replaceChildren(...clock.marks.map(mark => {
      const line = document.createElement('i');
      line.style.left = `${100 * mark.t_s / clock.duration_s}%`;
      line.title = mark.text;
      return line;
    }));
  }
}

function showLegend() {
  $('legend').replaceChildren(...map.layers.map(layer => {
    const item = document.createElement('li');
    const note = layer.own ? '' : layer.placed ? ', joined' : ', not joined';
    item.append(swatch(layer.colour), `${layer.name}: ${layer.landmarks.length} landmarks${note}`);
    return item;
  }));
}

function showFollow() { $('follow').setAttribute('aria-pressed', String(map.following)); }

let slow_at = 0;
function frame(now) {
  requestAnimationFrame(frame);
  const robot = fleet.robots[chosen];
  showLeds(document.body.classList.contains('stale') ? null : robot?.lines.health?.state);
  if (now - slow_at > 250) { slow_at = now; showConnection(); dirty = true; }
  if (!dirty) return;
  dirty = false;
  fleet.robots.forEach(r => colourOf(r.name));
  if (chosenName && robot?.name !== chosenName) {
    const same = fleet.robots.findIndex(r => r.name === chosenName);
    if (same >= 0) chosen = same;
  }
  showTabs();
  showPlayer();
  if (!robot) return;
  map.update(fleet, robot, colourOf);
  map.draw();
  showLegend();
  showHealth(robot);
  showVerdict(robot);
  showEye(robot, $('look').checked, past);
  showPeers(robot, colourOf, current);
  showTime(robot, current);
  showCounters(robot);
}

// --- hands ---------------------------------------------------------------------------------------

function save(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

$('zoom-in').onclick = () => { map.zoom(1.25); dirty = true; };
$('zoom-out').onclick = () => { map.zoom(0.8); dirty = true; };
$('fit').onclick = () => { map.fit(); showFollow(); dirty = true; };
$('follow').onclick = () => { map.follow(!map.following); showFollow(); dirty = true; };
$('show-ellipses').onchange = e => { map.ellipses = e.target.checked; dirty = true; };
$('show-paths').onchange = e => { map.paths = e.target.checked; dirty = true; };
$('save-png').onclick = async () => save(await map.png(), 'zenith-map.png');
$('save-svg').onclick = () => save(new Blob([map.svg()], {type: 'image/svg+xml'}), 'zenith-map.svg');
$('play').onclick = () => { control = {play: !fleet.clock?.playing}; };
$('speed').onchange = e => { control = {speed: Number(e.target.value)}; };
$('slider').oninput = e => {
  sliding = true;
  const to_s = Number(e.target.value);
  // A request that was not sent yet has to take along that it begins.
  const begins = fleet.clock?.live || control?.look_back !== undefined;
  control = begins ? {look_back: to_s} : {seek: to_s, play: false};
  if (begins) past = true;
};
$('to-live').onclick = () => { past = false; control = null; };
$('slider').onchange = () => { sliding = false; };
$('robots').onkeydown = e => {
  const step = {ArrowRight: 1, ArrowLeft: -1}[e.key];
  if (!step || !fleet.robots.length) return;
  choose((chosen + step + fleet.robots.length) % fleet.robots.length);
  showTabs();
  $('robots').children[chosen]?.focus();
};
document.addEventListener('keydown', e => {
  if (e.target.matches('input, select, textarea, summary') || e.ctrlKey || e.metaKey || e.altKey) return;
  if (e.key === '0') $('fit').click();
  else if (e.key === 'f') $('follow').click();
  else if (e.key === 'l' && past) $('to-live').click();
  else if (e.key === ' ' && fleet.clock && !fleet.clock.live && !e.target.matches('button')) $('play').click();
  else return;
  e.preventDefault();
});
addEventListener('resize', () => { dirty = true; });

// For the browser's console, and tests.
window.zenith = {fleet, map, theme};
connect();
requestAnimationFrame(frame);
