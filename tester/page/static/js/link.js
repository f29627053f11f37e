// The connection to the page's process: pairing, questions, commands, and the messages of the service as they come.

const SECRET = "friction-tester secret";
/** Silence after which the connection counts as lost, ms: the service sends four snapshots a second. */
export const SILENCE_MS = 2000;
const AGAIN_MS = [500, 1000, 2000, 4000];
/** How long an answer may take, ms. */
const ANSWER_MS = 30000;

/** A refusal, with its reason in words. */
export class Refusal extends Error {}

/**
 * The connection. Events: "change" (status), "message" (detail: a message of the service), "entered".
 * `status`: "pairing" (a code is wanted), "opening", "entered", "lost"; `connected`: page and service have each other.
 */
export class Link extends EventTarget {
  constructor() {
    super();
    this.status = "opening";
    this.reason = "";
    this.role = "";
    this.name = "";
    this.expires = "";
    this.service = { connected: false, reason: "not connected yet" };
    this.heard = 0;
    this.number = 0;
    this.waiting = new Map();
    this.tries = 0;
    this.socket = null;
    this.pairing = null;
    setInterval(() => this.#listen(), 250);
  }

  /** Whether what is shown is live. */
  get connected() {
    return this.status === "entered" && this.service.connected && performance.now() - this.heard < SILENCE_MS;
  }

  /** Why it is not, in words. */
  get trouble() {
    if (this.status !== "entered") return this.reason || "no connection to the page's process";
    if (!this.service.connected) return this.service.reason || "the page's process has no connection to the service";
    return "no word from the machine for more than 2 s";
  }

  /** Open with the stored secret, or ask for a code. */
  begin() {
    if (secret()) this.#open({ type: "enter", secret: secret() });
    else this.#set("pairing", "");
  }

  /**
   * Pair this device.
   * @param {string} code six digits
   * @param {string} name the device's, for the list of who is paired
   * @param {boolean} keep whether it stays paired after the tab is closed
   * @returns {Promise<void>} rejected with a Refusal
   */
  pair(code, name, keep) {
    return new Promise((resolve, reject) => {
      this.pairing = { resolve, reject, keep };
      this.#open({ type: "pair", code, name });
    });
  }

  /** Forget the secret on this device. */
  leave() {
    forget();
    this.socket?.close();
    this.#set("pairing", "this device is not paired any more");
  }

  /**
   * Ask the page's process.
   * @param {string} query
   * @param {Object} [more]
   * @returns {Promise<any>} rejected with a Refusal
   */
  ask(query, more = {}) {
    return this.#send({ type: "ask", query, ...more });
  }

  /**
   * Send a command of the service's protocol.
   * @param {Object} action {"command": ...}
   * @param {string} [code] the code that the machine's screen shows
   * @returns {Promise<any>} rejected with a Refusal
   */
  command(action, code = "") {
    return this.#send({ type: "command", action, ...(code ? { code } : {}) });
  }

  #send(message) {
    if (this.status !== "entered" || this.socket?.readyState !== WebSocket.OPEN) {
      return Promise.reject(new Refusal(this.trouble));
    }
    const id = ++this.number;
    return new Promise((resolve, reject) => {
      const late = setTimeout(() => {
        this.waiting.delete(id);
        reject(new Refusal("no answer within 30 s"));
      }, ANSWER_MS);
      this.waiting.set(id, { resolve, reject, late });
      this.socket.send(JSON.stringify({ id, ...message }));
    });
  }

  #open(first) {
    this.socket?.close();
    const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket`);
    this.socket = socket;
    if (this.status !== "pairing") this.#set("opening", this.reason);
    socket.onopen = () => socket.send(JSON.stringify(first));
    socket.onmessage = (event) => this.#take(socket, JSON.parse(event.data));
    socket.onclose = () => this.#closed(socket);
  }

  #take(socket, message) {
    if (socket !== this.socket) return;
    this.heard = performance.now();
    switch (message.type) {
      case "paired":
        keep(message.secret, this.pairing?.keep);
        this.pairing?.resolve();
        this.pairing = null;
        this.#entered(message);
        break;
      case "entered":
        this.#entered(message);
        break;
      case "link":
        this.service = { connected: message.connected === true, reason: message.reason ?? "" };
        this.dispatchEvent(new Event("change"));
        break;
      case "service":
        this.dispatchEvent(new CustomEvent("message", { detail: message.message }));
        break;
      case "accepted":
      case "refused":
        this.#answer(message);
        break;
      case "bye":
        forget();
        this.#set("pairing", message.reason ?? "the pairing has ended");
        break;
      default: // a later version's message: nothing of this page depends on it
    }
  }

  #entered(message) {
    this.role = message.role;
    this.name = message.name ?? this.name;
    this.expires = message.expires_utc ?? "";
    this.tries = 0;
    this.#set("entered", "");
    this.dispatchEvent(new Event("entered"));
  }

  #answer(message) {
    const asked = this.waiting.get(message.id);
    if (asked) {
      this.waiting.delete(message.id);
      clearTimeout(asked.late);
      if (message.type === "accepted") asked.resolve(message.result);
      else asked.reject(new Refusal(message.reason));
    } else if (message.type === "refused" && this.status !== "entered") {
      if (this.pairing) this.pairing.reject(new Refusal(message.reason));
      else forget();
      this.pairing = null;
      this.#set("pairing", message.reason);
    }
  }

  #closed(socket) {
    if (socket !== this.socket) return;
    for (const { reject, late } of this.waiting.values()) {
      clearTimeout(late);
      reject(new Refusal("the connection was lost before the answer: look whether it was done"));
    }
    this.waiting.clear();
    this.pairing?.reject(new Refusal("the page's process closed the connection"));
    this.pairing = null;
    if (this.status === "pairing") return;
    this.#set("lost", "no connection to the page's process");
    setTimeout(
      () => {
        if (socket === this.socket && secret()) this.begin();
      },
      AGAIN_MS[Math.min(this.tries++, AGAIN_MS.length - 1)],
    );
  }

  #listen() {
    const now = this.connected;
    if (now !== this.was) {
      this.was = now;
      this.dispatchEvent(new Event("change"));
    }
  }

  #set(status, reason) {
    this.status = status;
    this.reason = reason;
    if (status !== "entered") this.service = { connected: false, reason: "" };
    this.dispatchEvent(new Event("change"));
  }
}

function secret() {
  return sessionStorage.getItem(SECRET) ?? localStorage.getItem(SECRET);
}

function keep(value, always) {
  sessionStorage.setItem(SECRET, value);
  if (always) localStorage.setItem(SECRET, value);
}

function forget() {
  sessionStorage.removeItem(SECRET);
  localStorage.removeItem(SECRET);
}
