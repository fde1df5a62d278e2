// The server's REST interface. The token stays in this tab (sessionStorage) and goes in a header.

const TOKEN = 'palms-token';

/** What the server answered when it refused, in one line. */
export class Refusal extends Error {
  /**
   * @param {number} status of HTTP; 0 when there was no answer
   * @param {string} text
   */
  constructor(status, text) {
    super(text);
    this.name = 'Refusal';
    this.status = status;
  }
}

/** The operator's token, as far as this tab knows it. */
export const token = {
  get: () => sessionStorage.getItem(TOKEN) ?? '',
  /** @param {string} text */
  set: (text) => sessionStorage.setItem(TOKEN, text.trim()),
  forget: () => sessionStorage.removeItem(TOKEN),
};

/**
 * Ask the server.
 *
 * @param {string} method
 * @param {string} path such as `/api/v1/buildings`
 * @param {object} [options]
 * @param {object} [options.json] the body as a value
 * @param {FormData} [options.form] the body as a form
 * @param {string} [options.bearer] a key or link instead of the token
 * @returns {Promise<Response>}
 * @throws {Refusal}
 */
export async function ask(method, path, { json, form, bearer = token.get() } = {}) {
  /** @type {Record<string, string>} */
  const headers = {};
  if (bearer) headers.authorization = `Bearer ${bearer}`;
  if (json) headers['content-type'] = 'application/json';
  let answer;
  try {
    answer = await fetch(path, {
      method,
      headers,
      body: form ?? (json && JSON.stringify(json)),
      keepalive: method === 'DELETE', // also when the page is being left
    });
  } catch {
    throw new Refusal(0, 'The server does not answer. Is it running?');
  }
  if (!answer.ok) throw new Refusal(answer.status, await reason(answer));
  return answer;
}

/** The same, where the answer is JSON. */
export async function askJson(/** @type {Parameters<typeof ask>} */ ...request) {
  return (await ask(...request)).json();
}

/** @param {Response} answer */
async function reason(answer) {
  try {
    return (await answer.json()).error;
  } catch {
    return `The server answered ${answer.status}.`;
  }
}

/**
 * Return a one-time ticket for the socket, where a token is known; else null: a socket cannot carry
 * the token itself.
 *
 * @param {object} wanted `{role, session}` or `{role, building}`
 * @returns {Promise<string | null>}
 */
export async function ticketFor(wanted) {
  if (!token.get()) return null;
  return (await askJson('POST', '/api/v1/tickets', { json: wanted })).ticket;
}
