// Makes tests/unit/drivers/odometry/dbc_table.txt: DBC files as other programs write them, with what
// another reader finds in them, and frames with the values of their signals.
//
//   npm install candied@2.2.0 && node tests/support/dbc_table.mjs > \
//     tests/unit/drivers/odometry/dbc_table.txt
//
// The signals' fields are those that candied (ISC licence) parses. The values come from the bit
// reader below and not from candied's: that one takes the start bit of Motorola signals for their
// last one, and reads no floats.
//
//   node tests/support/dbc_table.mjs FILE.dbc CANDUMP.log
//
// prints the same for a file and a log that exist, each frame once that carries signals; with
// NODE_PATH or node_modules where candied is.

import { createRequire } from 'node:module';
import { readFileSync } from 'node:fs';

const require = createRequire(import.meta.url);
let Dbc;
try {
  Dbc = require('candied').Dbc;
} catch {
  Dbc = createRequire(process.cwd() + '/')('candied').Dbc;
}

// Of the same numbers everywhere (mulberry32).
function random_of(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

const kTexts = ['plain', 'a; semicolon', 'over\n two lines', 'BO_ 1 TRAP: 8 X', '6\' wheel', ''];

// The bits of a signal in the order of their weight, the greatest first: [byte, bit].
function bits_of(start, length, motorola) {
  const bits = [];
  let at = start;
  for (let i = 0; i < length; ++i) {
    bits.push([at >> 3, at & 7]);
    at = motorola ? (at % 8 === 0 ? at + 15 : at - 1) : at + 1;
  }
  return motorola ? bits : bits.reverse();
}

function fits(start, length, motorola) {
  return bits_of(start, length, motorola).every(([byte]) => byte < 8);
}

function make_file(random, number) {
  const pick = (n) => Math.floor(random() * n);
  const eol = number % 3 === 1 ? '\r\n' : '\n';
  let text = `VERSION "${number}"\n\nNS_ :\n\tCM_\n\tBA_DEF_\n\tSIG_VALTYPE_\n\nBS_:\n\nBU_: BASE PC\n\n`;
  let tail = '';
  for (let m = 0; m < 4; ++m) {
    const extended = random() < 0.4;
    const id = extended ? 0x80000000 + pick(0x1fffffff) : 16 + m * 256 + pick(200);
    const multiplexed = m === 3;
    text += `BO_ ${id} MESSAGE_${m}: 8 BASE\n`;
    if (multiplexed) text += ' SG_ PAGE M : 0|8@1+ (1,0) [0|0] "" PC\n';
    for (let s = 0; s < 4; ++s) {
      const kind = pick(multiplexed ? 3 : 4);  // unsigned, signed, float, double
      const motorola = random() < 0.5;
      let start, length;
      do {
        length = kind === 2 ? 32 : kind === 3 ? 64 : 1 + pick(40);
        start = pick(64);
      } while (!fits(start, length, motorola));
      const factor = [1, 0.001, 0.01, -0.5, 0.000125, 3][pick(6)];
      const offset = [0, 0, -40, 12.5, 1e6][pick(5)];
      const unit = ['m', 'km/h', '', 'rad/s'][pick(4)];
      const mux = multiplexed ? `m${s % 2} ` : '';
      const name = `SIGNAL_${m}_${s}`;
      text += ` SG_ ${name} ${mux}: ${start}|${length}@${motorola ? 0 : 1}${kind === 0 ? '+' : '-'}` +
              ` (${factor},${offset}) [0|0] "${unit}" PC\n`;
      if (kind >= 2) tail += `SIG_VALTYPE_ ${id} ${name} : ${kind - 1};\n`;
      if (random() < 0.4) tail = `CM_ SG_ ${id} ${name} "${kTexts[pick(kTexts.length)]}";\n` + tail;
      if (random() < 0.2) tail = `VAL_ ${id} ${name} 1 "on" 0 "off" ;\n` + tail;
    }
    text += '\n';
  }
  text += 'BA_DEF_ BO_ "Cycle" INT 0 1000;\nBA_DEF_DEF_ "Cycle" 10;\n' + tail;
  return text.replaceAll('\n', eol);
}

function signals_of(text) {
  const dbc = new Dbc();
  const data = dbc.load(text);
  const signals = [];
  for (const message of data.messages.values()) {
    for (const signal of message.signals.values()) {
      const kind = { float: 'f', double: 'd' }[signal.dataType] ?? (signal.signed ? 's' : 'u');
      signals.push({ message: message.name, name: signal.name, id: message.id % 0x80000000,
                     extended: message.id >= 0x80000000 ? 1 : 0, start: signal.startBit,
                     length: signal.length, motorola: signal.endian === 'Motorola' ? 1 : 0, kind,
                     scale: signal.factor, offset: signal.offset,
                     mux: signal.multiplex ?? '' });
    }
  }
  return signals;
}

function raw_of(signal, bytes) {
  let raw = 0n;
  for (const [byte, bit] of bits_of(signal.start, signal.length, signal.motorola === 1)) {
    raw = (raw << 1n) | BigInt((bytes[byte] >> bit) & 1);
  }
  return raw;
}

function value_of(signal, raw) {
  const view = new DataView(new ArrayBuffer(8));
  let value;
  if (signal.kind === 'f') {
    view.setUint32(0, Number(raw));
    value = view.getFloat32(0);
  } else if (signal.kind === 'd') {
    view.setBigUint64(0, raw);
    value = view.getFloat64(0);
  } else {
    value = Number(signal.kind === 's' ? BigInt.asIntN(signal.length, raw) : raw);
  }
  return signal.scale * value + signal.offset;
}

function hex(bytes) {
  return [...bytes].map((b) => b.toString(16).padStart(2, '0')).join('');
}

function print_signals(signals) {
  for (const s of signals) {
    console.log(`signal ${s.message} ${s.name} ${s.id} ${s.extended} ${s.start} ${s.length} ` +
                `${s.motorola} ${s.kind} ${s.scale} ${s.offset} ${s.mux || '-'}`);
  }
}

function print_frame(signals, id, extended, bytes) {
  const mine = signals.filter((s) => s.id === id && s.extended === extended);
  const selector = mine.find((s) => s.mux === 'M');
  const lines = [];
  for (const s of mine) {
    if (!bits_of(s.start, s.length, s.motorola === 1).every(([byte]) => byte < bytes.length)) continue;
    if (s.mux !== '' && s.mux !== 'M') {
      if (!selector || Number(raw_of(selector, bytes)) !== Number(s.mux.slice(1))) continue;
    }
    const raw = raw_of(s, bytes);
    lines.push(`value ${s.message} ${s.name} ${raw} ${value_of(s, raw)}`);
  }
  if (lines.length === 0) return;
  console.log(`frame ${id} ${extended} ${hex(bytes)}`);
  for (const line of lines) console.log(line);
}

function generated() {
  console.log('# Made by tests/support/dbc_table.mjs; see there.');
  const random = random_of(20260101);
  for (let number = 0; number < 24; ++number) {
    const text = make_file(random, number);
    const signals = signals_of(text);
    console.log(`file ${number} ${text.includes('\r') ? 'crlf' : 'lf'}`);
    for (const line of text.replaceAll('\r', '').split('\n')) console.log('|' + line);
    print_signals(signals);
    const messages = new Map(signals.map((s) => [`${s.id} ${s.extended}`, s]));
    for (const { id, extended } of messages.values()) {
      for (let f = 0; f < 4; ++f) {
        const bytes = Uint8Array.from({ length: 8 }, () => Math.floor(random() * 256));
        if (f > 0) bytes[0] = f % 2;  // a page of multiplexed messages
        print_frame(signals, id, extended, bytes);
      }
    }
  }
}

function of_log(dbc, log) {
  const signals = signals_of(readFileSync(dbc, 'latin1'));
  print_signals(signals);
  const seen = new Set();
  for (const line of readFileSync(log, 'latin1').split('\n')) {
    const match = /^\([0-9.]+\) \S+ ([0-9A-Fa-f]+)#((?:[0-9A-Fa-f]{2})*)/.exec(line);
    if (!match || seen.has(match[1] + match[2])) continue;
    seen.add(match[1] + match[2]);
    print_frame(signals, parseInt(match[1], 16), match[1].length === 8 ? 1 : 0,
                Buffer.from(match[2], 'hex'));
  }
}

if (process.argv.length === 4) {
  of_log(process.argv[2], process.argv[3]);
} else {
  generated();
}
