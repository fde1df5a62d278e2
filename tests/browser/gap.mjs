// A network that can be cut: a way to the server through which all goes, or nothing.
import { createServer, connect } from 'node:net';
import { once } from 'node:events';

export class Network {
  #isCut = false;
  #sockets = new Set();

  /**
   * @param {import('node:test').TestContext} t
   * @param {string} server as `http://127.0.0.1:8123`
   */
  static async to(t, server) {
    const network = new Network();
    const { hostname, port } = new URL(server);
    const proxy = createServer((near) => network.#carry(near, () => connect(port, hostname)));
    proxy.listen(0, hostname);
    await once(proxy, 'listening');
    t.after(() => {
      network.cut();
      proxy.close();
    });
    network.url = `http://${hostname}:${proxy.address().port}`;
    return network;
  }

  #carry(near, reach) {
    if (this.#isCut) {
      near.destroy();
      return;
    }
    const far = reach();
    for (const [socket, other] of [[near, far], [far, near]]) {
      this.#sockets.add(socket);
      socket.on('error', () => {});
      socket.on('close', () => {
        this.#sockets.delete(socket);
        other.destroy();
      });
      socket.pipe(other);
    }
  }

  /** Break all connections; no new one is made. */
  cut() {
    this.#isCut = true;
    for (const socket of this.#sockets) socket.destroy();
  }

  /** Let all through again. */
  mend() {
    this.#isCut = false;
  }
}
