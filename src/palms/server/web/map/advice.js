// Advice: what a phone needs to open its page.

/**
 * Whether only this machine can open an address.
 *
 * @param {string} hostname
 */
function isOwnMachine(hostname) {
  return hostname === 'localhost' || hostname === '[::1]' || hostname.startsWith('127.');
}

/**
 * Return what to do with the code of an address, in a sentence or two.
 *
 * @param {{ hostname: string, protocol: string }} place
 * @param {boolean} hasTicket
 */
export function phoneAdvice({ hostname, protocol }, hasTicket) {
  if (isOwnMachine(hostname)) {
    return 'This address works on this machine alone. For phones start the server with '
      + 'palms serve --host 0.0.0.0 --tls and open this page under the machine’s own address.';
  }
  if (protocol !== 'https:') return 'Phones scan over TLS only: start the server with --tls.';
  const once = hasTicket ? ' The code opens one session and is good for a few minutes.' : '';
  return `Scan the code with a phone in the same network.${once}`;
}
