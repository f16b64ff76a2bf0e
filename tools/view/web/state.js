// What the page knows of the robots: answers of /live put together. docs/view.md describes them.
// No drawing, no page: tests run it by itself.

export class Robot {
  constructor(index) {
    this.index = index;
    this.name = '';
    this.lines = Object.create(null);  // "pose", "health", "alignment/bert", ...
    this.maps = new Map();  // owner's slot (-1: own) -> Map(id -> row)
    this.path = [];
    this.steps = [];
    this.confidence = Object.create(null);  // by peer: names are anybody's, also "__proto__"
    this.picture = null;
  }

  take(change) {
    this.name = change.name;
    for (const key of change.drop ?? []) {
      delete this.lines[key];
      if (key.startsWith('confidence/')) delete this.confidence[key.slice('confidence/'.length)];
    }
    Object.assign(this.lines, change.set ?? {});
    for (const [slot, news] of Object.entries(change.maps ?? {})) this.#takeMap(Number(slot), news);
    if (change.path) splice(this.path, change.path);
    if (change.steps) splice(this.steps, change.steps);
    for (const [peer, curve] of Object.entries(change.confidence ?? {})) {
      splice(this.confidence[peer] ??= [], curve);
    }
    if (change.picture) this.picture = change.picture;
  }

  #takeMap(slot, news) {
    let map = this.maps.get(slot);
    if (!map || news.clear) this.maps.set(slot, map = new Map());
    for (const row of news.rows ?? []) map.set(row[0], row);
    for (const id of news.gone ?? []) map.delete(id);
  }

  get pose() { return this.lines.pose?.pose ?? null; }
  get up() { return this.lines.link?.up ?? false; }

  // [{name, slot, state, pose, confidence, ...}] of all peers that it knows.
  peers() {
    const peers = new Map();
    for (const [key, line] of Object.entries(this.lines)) {
      const [kind, ...rest] = key.split('/');
      const name = rest.join('/');
      if (kind !== 'alignment' && kind !== 'peer') continue;
      const peer = peers.get(name) ?? {name, slot: -1, alignment: null, heard: null};
      if (line.peer >= 0) peer.slot = line.peer;
      if (kind === 'alignment') peer.alignment = line; else peer.heard = line;
      peers.set(name, peer);
    }
    return [...peers.values()].sort((a, b) => a.name.localeCompare(b.name));
  }
}

function splice(list, news) {
  list.length = Math.min(list.length, news.from);
  for (const point of news.points) list.push(point);
}

export class Fleet {
  constructor() {
    this.robots = [];
    this.clock = null;
    this.seen = 0;
    this.epoch = 0;
  }

  take(answer) {
    if (answer.reset) this.robots = [];
    this.epoch = answer.epoch;
    this.seen = answer.seen;
    this.clock = answer.clock;
    answer.robots.forEach((change, i) => {
      this.robots[i] ??= new Robot(i);
      this.robots[i].take(change);
    });
  }

  byName(name) { return this.robots.find(robot => robot.name === name) ?? null; }
}

// --- the plane: poses [x, y, theta] ----------------------------------------------------------

export function compose(a, b) {
  const c = Math.cos(a[2]), s = Math.sin(a[2]);
  return [a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], a[2] + b[2]];
}
export function apply(pose, x, y) {
  const c = Math.cos(pose[2]), s = Math.sin(pose[2]);
  return [pose[0] + c * x - s * y, pose[1] + s * x + c * y];
}

// Everything that is to be drawn, seen by one robot: layers
//   {name, colour, own, placed, T, state, landmarks: [rows], path, pose}
// T takes the layer's coordinates into the viewer's. A map that is not joined has no T.
export function layersSeenBy(fleet, viewer) {
  const layers = [{name: viewer.name, own: true, placed: true, T: [0, 0, 0], state: 'own',
                   landmarks: [...(viewer.maps.get(-1)?.values() ?? [])],
                   path: viewer.path, pose: viewer.pose}];
  const named = new Set([viewer.name]);
  for (const peer of viewer.peers()) {
    const itself = fleet.byName(peer.name);
    const merged = peer.alignment?.state === 'merged';
    const told = peer.slot >= 0 ? viewer.maps.get(peer.slot) : undefined;
    const map = told?.size || !itself ? told : itself.maps.get(-1);
    if (!map?.size && !itself && !peer.alignment) continue;  // it has no map: an observer
    layers.push({name: peer.name, own: false, placed: merged,
                 T: merged ? peer.alignment.pose : null,
                 state: peer.alignment?.state ?? 'apart',
                 landmarks: [...(map?.values() ?? [])],
                 path: itself?.path ?? [],
                 pose: itself?.pose ?? peer.heard?.pose ?? null});
    named.add(peer.name);
  }
  for (const robot of fleet.robots) {
    if (named.has(robot.name)) continue;
    layers.push({name: robot.name, own: false, placed: false, T: null, state: 'apart',
                 landmarks: [...(robot.maps.get(-1)?.values() ?? [])],
                 path: robot.path, pose: robot.pose});
  }
  return layers;
}

// A map that is not joined is laid beside those that are, with some room between.
export function layBeside(layers, extent) {
  let right = null;
  for (const layer of layers.filter(l => l.placed)) {
    const box = extent(layer, layer.T);
    if (box) right = right === null ? box.maxX : Math.max(right, box.maxX);
  }
  right ??= 0;
  for (const layer of layers.filter(l => !l.placed)) {
    const box = extent(layer, [0, 0, 0]);
    const gap = 3;
    layer.T = [right + gap - (box?.minX ?? 0), 0, 0];
    right += gap + (box ? box.maxX - box.minX : 0);
  }
}
