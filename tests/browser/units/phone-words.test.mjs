// Words: who may speak when, the catalogues, the preferences, and the files that a gap needs.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import test from 'node:test';
import {
  preferencesMessage, preferencesOf,
} from '../../../src/palms/server/web/phone/preferences.js';
import { contains, placeIn } from '../../../src/palms/server/web/phone/rooms.js';
import { GAP_S, SILENCE, dueNow, offered } from '../../../src/palms/server/web/phone/talk.js';
import {
  LANGUAGES, filled, languageFor,
} from '../../../src/palms/server/web/phone/texts.js';

const WEB = new URL('../../../src/palms/server/web/', import.meta.url);
const read = (path) => readFileSync(new URL(path, WEB), 'utf8');
const filesOf = (folder) => readdirSync(new URL(folder, WEB));
const catalogues = Object.fromEntries(
  LANGUAGES.map((language) => [language, JSON.parse(read(`phone/texts/${language}.json`))]));

/** What is said of sentences offered at times: [time, text]. */
function spoken(offers) {
  let talk = SILENCE;
  const said = [];
  for (const [time_s, sentence] of offers) {
    let now;
    [talk, now] = dueNow(talk, time_s);
    if (now) said.push([time_s, now]);
    if (!sentence) continue;
    [talk, now] = offered(talk, sentence, time_s);
    if (now) said.push([time_s, now]);
  }
  return said;
}

test('never two unasked sentences in five seconds, whatever is offered', () => {
  let seed = 11;
  const offers = Array.from({ length: 3000 }, (_, i) => {
    seed = (seed * 48271) % 2147483647;
    const is = (bit, rare) => ((seed >> bit) & rare) === 0;
    const how = { asked: is(3, 31), urgent: is(8, 63), passing: is(14, 3) };
    return [i / 5, is(17, 1) ? null : { text: `${i}`, ...how }];
  });
  const unasked = spoken(offers).filter(([, { asked, urgent }]) => !asked && !urgent);
  assert.ok(unasked.length > 50);
  unasked.slice(1).forEach(([time_s], i) => assert.ok(time_s - unasked[i][0] >= GAP_S));
});

test('what was asked for, and what is urgent, is said at once', () => {
  const texts = spoken([
    [0, { text: 'a' }], [1, { text: 'b', asked: true }], [2, { text: 'c', urgent: true }],
  ]).map(([, { text }]) => text);
  assert.deepEqual(texts, ['a', 'b', 'c']);
});

test('the latest waits its turn; what is passing is left out', () => {
  const said = spoken([
    [0, { text: 'a' }], [1, { text: 'b' }], [2, { text: 'c' }], [3, { text: 'd', passing: true }],
    [4.9, null], [5, null], [11, null],
  ]).map(([time_s, { text }]) => [time_s, text]);
  assert.deepEqual(said, [[0, 'a'], [5, 'c']]);
});

test('all catalogues have the same texts with the same placeholders', () => {
  const holes = (catalogue) => Object.fromEntries(Object.entries(catalogue).map(([key, text]) =>
    [key, (text.match(/\{\w+\}/g) ?? []).sort().join()]));
  for (const language of LANGUAGES) {
    assert.deepEqual(holes(catalogues[language]), holes(catalogues.en), language);
    assert.ok(Object.values(catalogues[language]).every((text) => text.trim()));
  }
});

test('each text that page and scripts name is there, and none is there in vain', () => {
  const scripts = filesOf('phone').filter((name) => name.endsWith('.js'));
  const sources = [...scripts, 'index.html'].map((name) => read(`phone/${name}`)).join('\n');
  const groups = [...new Set(Object.keys(catalogues.en).map((key) => key.split('.')[0]))];
  const quoted = `(?<=["'\`])(${groups.join('|')})(\\.\\w+)*(?=["'\`])`;
  const named = sources.match(new RegExp(quoted, 'g'));
  const patterns = sources.match(/(?<=`)[a-z]+\.(\w+\.)?(?=\$\{)/g);
  for (const key of named.filter((each) => each.includes('.') && !each.endsWith('.js'))) {
    assert.ok(key in catalogues.en, key);
  }
  for (const key of Object.keys(catalogues.en)) {
    assert.ok(named.includes(key) || patterns.some((start) => key.startsWith(start)), key);
  }
});

test('a language without a catalogue is English', () => {
  assert.deepEqual(
    [languageFor(['de-AT', 'en']), languageFor(['fr', 'de']), languageFor(['fr']), languageFor([])],
    ['de', 'de', 'en', 'en']);
  assert.equal(filled('{percent} of {what}', { percent: 5 }), '5 of {what}');
});

test('preferences that make no sense are the default', () => {
  const plain = preferencesOf(null);
  assert.equal(plain.voice, 'reader');
  const nonsense = { voice: 'song', step_cm: '9000', units: 3, quiet: 'yes' };
  assert.deepEqual(preferencesOf(nonsense), plain);
  const chosen = preferencesOf({ units: 'steps', step_cm: '65', directions: 'words', quiet: true });
  assert.deepEqual(preferencesMessage(chosen, 'de'), {
    type: 'preferences', units: 'steps', step_m: 0.65, language: 'de', directions: 'words',
    details: false, quiet: true,
  });
});

test('a room holds what lies in it; five metres from one is near it', () => {
  const room = [[0, 0], [4, 0], [4, 3], [0, 3]];
  assert.deepEqual([[2, 1], [5, 1], [2, -1], [-1, 1]].map((place) => contains(room, place)),
    [true, false, false, false]);
  const plan = { rooms: [{ name: 'Room 1', polygon_m: room }, { name: '', polygon_m: room }] };
  assert.equal(placeIn(plan, [1, 1]).key, 'other.foundRoom');
  assert.deepEqual(placeIn(plan, [8, 1]), { key: 'other.foundNear', room: 'Room 1' });
  assert.equal(placeIn(plan, [40, 1]).key, 'other.found');
});

test('the worker keeps all that the page loads, and nothing that is not there', () => {
  const listed = [...read('phone/worker.js').matchAll(/'([\w./-]+\.\w+)'/g)]
    .map(([, path]) => path);
  const own = filesOf('phone').filter((name) => /\.(js|css|webmanifest)$/.test(name));
  const wanted = [...own, ...filesOf('phone/texts').map((name) => `texts/${name}`)];
  const shared = own.filter((name) => name.endsWith('.js')).flatMap((name) =>
    [...read(`phone/${name}`).matchAll(/from '\.\.\/(shared\/\w+\.js)'/g)].map(([, path]) => path));
  for (const path of wanted.filter((name) => name !== 'worker.js' && name !== 'index.html')) {
    assert.ok(listed.includes(path), path);
  }
  for (const path of shared) assert.ok(listed.includes(`../${path}`), path);
  for (const path of listed) assert.ok(read(`phone/${path}`), path);
});
