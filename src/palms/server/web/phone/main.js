// The phone's page: scan, walk, and hear where you are.

import { Entrance, takeInvitation } from './choose.js';
import { loadWalk } from './kept.js';
import { canListen } from './listen.js';
import { Live } from './live.js';
import { bindOther } from './other.js';
import { loadPreferences } from './preferences.js';
import { Ring } from './ring.js';
import { element, show, showProblem } from './screens.js';
import { bindSettings } from './settings.js';
import { Sketch } from './sketch.js';
import { Sounds } from './sounds.js';
import { Speaker } from './speaker.js';
import { Texts, languageFor } from './texts.js';
import { Unable, hasAr } from './xr.js';

const preferences = loadPreferences();
const texts = await Texts.load(languageFor(navigator.languages));
document.documentElement.lang = texts.language;
texts.fill(document);

const sounds = new Sounds(preferences);
const speaker = new Speaker(
  { said: element('said'), details: element('details') }, preferences, texts.language,
);
const company = {
  texts, preferences, speaker, sounds,
  ring: new Ring(element('ring')),
  sketch: new Sketch(element('map')),
};
const entrance = new Entrance(texts, takeInvitation(location, history));
/** @type {Live | null} */
let live = null;

/** Begin a session, or go on with one; a button is being pressed. */
async function start(/** @type {Live} */ next, /** @type {string} */ problemId) {
  sounds.unlock();
  speaker.settle();
  keepAwake();
  try {
    await next.eyes.open(element('page'));
  } catch (problem) {
    showProblem(problemId, texts.of(problem instanceof Unable ? problem.key : 'problem.noPlanes'));
    return false;
  }
  return true;
}

/** @param {Live} next */
function bindLive(next) {
  live = next;
  next.addEventListener('over', (event) => {
    const { key } = /** @type {CustomEvent} */ (event).detail;
    element('over-text').textContent = texts.of(key);
    finish('over');
  });
  next.addEventListener('refused', (event) => {
    const { code, text } = /** @type {CustomEvent} */ (event).detail;
    const problem = code === 'forbidden' && entrance.ticket ? texts.of('choose.usedTicket') : text;
    entrance.spend();
    finish('choose');
    entrance.open().then(() => showProblem('choose-problem', problem));
  });
}

/** @param {'over' | 'choose'} screen */
function finish(screen) {
  live = null;
  document.body.classList.remove('in-ar', 'is-pushed');
  speaker.clear();
  element('viewers').hidden = true;
  element('share-place').hidden = true;
  element('place').textContent = '';
  show(screen);
}

async function begin(/** @type {Event} */ event) {
  event.preventDefault();
  if (live) return;
  if (!entrance.isReady) return entrance.open();
  const next = new Live(company, { ...entrance.terms, record: preferences.record }, {
    ticket: () => entrance.newTicket(),
  });
  if (!(await start(next, 'choose-problem'))) return;
  bindLive(next);
  next.socket.addEventListener('welcome', () => entrance.spend(), { once: true });
  next.connect();
  next.walk.beginScan('scan.start');
}

async function goOn() {
  if (!live) return;
  if (live.eyes.isOpen || (await start(live, 'paused-problem'))) live.walk.resume();
}

/** @param {import('./kept.js').Kept} kept */
function takeUp(kept) {
  const { session, key, isPushed } = kept;
  const next = new Live(company, { session, key }, { kept, isPushed });
  if (isPushed) return listenTo(next);
  bindLive(next);
  next.connect();
  next.showPause();
  show('paused', { focus: false });
}

/** Follow an app that pushes: this page speaks, asks and tells. */
function listenTo(/** @type {Live} */ next) {
  sounds.unlock();
  keepAwake();
  bindLive(next);
  document.body.classList.add('is-pushed');
  next.connect();
  show('walk');
  next.cue('push.start', {}, { asked: true });
}

function bindButtons() {
  const actions = {
    enough: () => live?.walk.finishScan(),
    'scan-repeat': () => speaker.repeat(),
    'scan-leave': () => live?.leaveOrStay(),
    where: () => live?.ask('where'),
    more: () => live?.ask('details'),
    near: () => live?.ask('near'),
    options: () => live?.ask('options'),
    repeat: () => speaker.repeat(),
    rescan: () => live?.walk.beginScan('scan.start'),
    pause: () => live?.walk.pause('byUser'),
    resume: goOn,
    'paused-end': () => live?.end(),
    end: () => live?.leaveOrStay(),
    share: () => live?.share(),
    dismiss: () => live?.dismissViewers(),
    listen: () => live?.listen(),
    again: openEntrance,
  };
  for (const [id, action] of Object.entries(actions)) element(id).addEventListener('click', action);
  element('start-form').addEventListener('submit', begin);
  element('tell-form').addEventListener('submit', (/** @type {Event} */ event) => {
    event.preventDefault();
    live?.tell(element('tell').value.trim());
    element('tell').value = '';
  });
  element('listen').hidden = !canListen;
}

async function openEntrance() {
  const isAble = await hasAr();
  show(isAble ? 'choose' : 'other', { focus: 'screen' in document.body.dataset });
  element('other-why').textContent = texts.of(isSecureContext ? 'other.why' : 'other.insecure');
  await entrance.open();
}

async function keepAwake() {
  try {
    await navigator.wakeLock?.request('screen');
  } catch {
    // a phone that is low on power says no; the walk goes on
  }
}

bindSettings(preferences, () => {
  speaker.settle();
  live?.sendPreferences();
});
bindButtons();
bindOther(company, entrance, listenTo);
speaker.settle();
document.addEventListener('visibilitychange', () => {
  if (live && document.visibilityState === 'visible') keepAwake();
});
addEventListener('hashchange', () => live || location.reload()); // another code was read
navigator.serviceWorker?.register('worker.js').catch(() => {});

const kept = loadWalk();
if (kept && !entrance.ticket && (kept.isPushed || (await hasAr()))) takeUp(kept);
else await openEntrance();
