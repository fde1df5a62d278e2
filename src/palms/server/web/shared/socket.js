// A session of the server over a WebSocket that comes back by itself.
//
// Inputs are numbered here and kept until the server says that they are on its disk. After a
// broken connection hello is said again with the session's key, and what is not stored is sent
// again; the server takes each input once (docs/reference/messages.md).

/** @typedef {{ type: string, [field: string]: any }} Message */
/** @typedef {'connecting' | 'open' | 'waiting' | 'closed'} SocketState */

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 10_000;
const SILENCE_MS = 15_000; // without an answer to what was sent the connection is taken for dead
const PASSING = new Set(['full', 'slow', 'rate', 'stopping', 'defect']); // worth another try

/**
 * Return the address of the live socket of the server that a page came from.
 *
 * @param {{ protocol: string, host: string }} place such as `location`
 */
export function liveAddress(place) {
  return `${place.protocol === 'https:' ? 'wss' : 'ws'}://${place.host}/api/v1/live`;
}

/**
 * How long to wait before the next try: twice as long each time, up to ten seconds.
 *
 * @param {number} tries that have failed one after the other
 */
export function waitMs(tries) {
  return Math.min(FIRST_WAIT_MS * 2 ** tries, LONGEST_WAIT_MS);
}

/**
 * Says: `state` (a SocketState), `welcome`, `error` (fatal or not), `ended`, and every other
 * message by its type; `message` for each of them, `frame` for a binary one. The details of these
 * events are the messages.
 */
export class LiveSocket extends EventTarget {
  /** @type {WebSocket | null} */ #socket = null;
  /** @type {Message[]} */ #unstored = [];
  /** @type {number | null} */ #nextSeq = null;
  /** @type {SocketState} */ #state = 'closed';
  #hello;
  #ticket;
  #open;
  #tries = 0;
  #timer = 0;
  #watchdog = 0;

  /**
   * @param {Message | object} hello without `type` and `ticket`
   * @param {object} [options]
   * @param {() => Promise<string | null>} [options.ticket] asked before each hello that has no key,
   *   for a one-time ticket; null where none is needed
   * @param {() => WebSocket} [options.open]
   */
  constructor(hello, { ticket = async () => null, open = openHere } = {}) {
    super();
    this.#hello = /** @type {Message} */ ({ ...hello, type: 'hello' });
    this.#ticket = ticket;
    this.#open = open;
  }

  /** @returns {SocketState} */
  get state() {
    return this.#state;
  }

  /** Name of the session, from its welcome. */
  get session() {
    return this.#hello.session ?? null;
  }

  /** What the session goes on with; keep it as you would keep the walk itself. */
  get key() {
    return this.#hello.key ?? null;
  }

  /** Inputs that the server has not said to be on its disk. */
  get nUnstored() {
    return this.#unstored.length;
  }

  /** Connect, and come back whenever the connection breaks, until `close`. */
  async connect() {
    clearTimeout(this.#timer);
    this.#become('connecting');
    let ticket = null;
    try {
      ticket = this.key ? null : await this.#ticket();
    } catch (problem) {
      const { message } = /** @type {Error} */ (problem);
      this.#fail({ type: 'error', code: 'forbidden', text: message, fatal: true });
      return;
    }
    if (this.#state !== 'connecting') return;
    const socket = this.#open();
    this.#socket = socket;
    socket.binaryType = 'arraybuffer';
    const hello = ticket ? { ...this.#hello, ticket } : this.#hello;
    socket.onopen = () => socket.send(JSON.stringify(hello));
    socket.onmessage = ({ data }) => this.#take(data);
    socket.onclose = () => this.#lost(socket);
  }

  /**
   * Send an input; it is numbered, and kept until it is stored.
   *
   * @param {Message} input without `seq`
   * @returns {Message} the input as it is kept; it has its `seq` from the welcome on
   */
  send(input) {
    const numbered = { ...input };
    this.#unstored.push(numbered);
    if (this.#nextSeq === null) return numbered;
    numbered.seq = this.#nextSeq++;
    this.#put(numbered);
    return numbered;
  }

  /**
   * Send a message that is no input, such as `share`; lost when there is no connection.
   *
   * @param {Message} message
   */
  say(message) {
    this.#put(message);
  }

  /** Leave; the server keeps a walker's session for a while. */
  close() {
    this.#become('closed');
    this.#stop();
  }

  #stop() {
    clearTimeout(this.#timer);
    clearTimeout(this.#watchdog);
    this.#watchdog = 0;
    const socket = this.#socket;
    this.#socket = null;
    socket?.close();
  }

  /** @param {Message} message */
  #put(message) {
    if (this.#state !== 'open') return;
    this.#socket?.send(JSON.stringify(message));
    this.#watch();
  }

  #watch() {
    if (this.#watchdog) return;
    this.#watchdog = setTimeout(() => this.#lost(this.#socket), SILENCE_MS);
  }

  /** @param {string | ArrayBuffer} data */
  #take(data) {
    clearTimeout(this.#watchdog);
    this.#watchdog = 0;
    if (this.#unstored.length > 0 && this.#state === 'open') this.#watch();
    if (typeof data !== 'string') {
      this.#tell('frame', data);
      return;
    }
    const message = JSON.parse(data);
    if (message.type === 'welcome') this.#welcomed(message);
    if (message.type === 'ack') this.#forget(message.next_seq);
    if (message.type === 'error') {
      if (message.fatal) return this.#fail(message);
      if (message.code === 'gap') this.#sendFrom(message.next_seq);
    }
    if (message.type === 'ended') this.close();
    this.#tell(message.type, message);
    this.#tell('message', message);
  }

  /** @param {Message} welcome */
  #welcomed(welcome) {
    this.#tries = 0;
    this.#become('open');
    if (welcome.role !== 'walker') return;
    this.#hello = { ...this.#hello, session: welcome.session, key: welcome.key ?? this.key };
    this.#forget(welcome.next_seq);
    let seq = welcome.next_seq;
    for (const input of this.#unstored) input.seq = seq++;
    this.#nextSeq = seq;
    this.#sendFrom(welcome.next_seq);
  }

  /** @param {number} nextSeq */
  #forget(nextSeq) {
    this.#unstored = this.#unstored.filter(({ seq }) => seq === undefined || seq >= nextSeq);
  }

  /** @param {number} seq */
  #sendFrom(seq) {
    for (const input of this.#unstored) if (input.seq >= seq) this.#put(input);
  }

  /** @param {Message} error */
  #fail(error) {
    if (!PASSING.has(error.code)) this.close();
    this.#tell('error', error);
    this.#tell('message', error);
  }

  /** @param {WebSocket | null} socket */
  #lost(socket) {
    if (socket !== this.#socket || this.#state === 'closed') return;
    this.#stop();
    this.#become('waiting');
    this.#timer = setTimeout(() => this.connect(), waitMs(this.#tries++));
  }

  /** @param {SocketState} state */
  #become(state) {
    if (this.#state === state) return;
    this.#state = state;
    this.#tell('state', state);
  }

  /**
   * @param {string} kind
   * @param {any} detail
   */
  #tell(kind, detail) {
    this.dispatchEvent(new CustomEvent(kind, { detail }));
  }
}

function openHere() {
  return new WebSocket(liveAddress(location));
}
